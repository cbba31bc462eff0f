"""Figures: each function returns one drawing with its caption.

- ``canvas``: colours, sizes, and a figure as files; the same input gives the same bytes.
- ``measurements``: logs, Allan deviations, bollard-pull tables, towing runs.
- ``fits``: parameter intervals, predicted forces, simulated motion; ``following``: intervals along a log.
- ``tubes``: bounds of all consistent trajectories; ``plans``: the track of a planned trial.
- ``diagnosis``: signatures of findings, and force and motion before and after.
- ``plots``: the same drawings on demand, for ``result.plot()``; the only module that loads pyplot.

The chapter may use the values that the stages return, for their types, and the curve of a thrust table.
"""

from ivsid.report.figures.canvas import COLOURS, FORCE_LABEL, Drawing, warm
from ivsid.report.figures.diagnosis import (
    MISSING,
    QUANTITY,
    force_residual,
    gain,
    net_force,
    ratios,
    separation,
    signature,
    stretch,
)
from ivsid.report.figures.fits import force_bounds, force_mid, intervals, motion
from ivsid.report.figures.following import narrowing
from ivsid.report.figures.measurements import allan_curves, channels, drag_curve, thrust_curve
from ivsid.report.figures.plans import plan
from ivsid.report.figures.tubes import tube

__all__ = [
    "COLOURS",
    "FORCE_LABEL",
    "MISSING",
    "QUANTITY",
    "Drawing",
    "allan_curves",
    "channels",
    "drag_curve",
    "force_bounds",
    "force_mid",
    "force_residual",
    "gain",
    "intervals",
    "motion",
    "narrowing",
    "net_force",
    "plan",
    "ratios",
    "separation",
    "signature",
    "stretch",
    "thrust_curve",
    "tube",
    "warm",
]
