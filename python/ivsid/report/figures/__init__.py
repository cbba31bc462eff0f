"""Figures: the only place that draws. Each function returns one figure with its caption."""

from ivsid.report.figures.canvas import COLOURS, FORCE_LABEL, Drawing
from ivsid.report.figures.diagnosis import force_residual, gain, net_force, ratios, separation, signature
from ivsid.report.figures.general import (
    allan_curves,
    channels,
    drag_curve,
    force_bounds,
    force_mid,
    intervals,
    motion,
    thrust_curve,
)

__all__ = [
    "COLOURS",
    "FORCE_LABEL",
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
    "net_force",
    "ratios",
    "separation",
    "signature",
    "thrust_curve",
]
