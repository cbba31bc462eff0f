"""Static force tables of captive runs, and drag coefficients as intervals from them.

A model that is towed at a constant speed u feels F = -(linear u + quadratic u|u|). With bounds of every speed and force, each run is one
interval row; ``feasible_set`` proves the hull of all coefficients that fit every row. The bounds themselves rest on assumptions that no
recording proves (``ASSUMES``), so a result of this module is never called guaranteed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import Interval, IntervalArray
from ivsid.linear import regression
from ivsid.linear.regression import FeasibleStatus

Array = NDArray[np.float64]

# Accuracy of a gauge as a share of its nominal value, where the set states none: the accuracy class 0.1 of industrial load cells.
# Source: definition: VDI/VDE 2637, accuracy classes.
GAUGE_CLASS: Final = 1e-3
# Parts of a run whose means show how far its force has settled.
# Source: definition: quarters of a run.
PARTS: Final = 4
# What the bounds of a run rest on, a sentence each.
ASSUMES: Final = (
    f"each gauge and the speed err by at most {GAUGE_CLASS:.1%} of their nominal values, an accuracy class that the set does not state",
    f"the mean force of a run stands no further from its true mean than the mean of any of {PARTS} parts of the run does, seen and not proved",
    "the drag is linear and quadratic in the speed",
)


@dataclass(frozen=True)
class Run:
    """A captive run with its bounds.

    Attributes:
        speed: mean, lower and upper bound of the speed.
        force: mean, lower and upper bound of the mean force of the water on the hull.
    """

    speed: tuple[float, float, float]
    force: tuple[float, float, float]


def accuracy(nominal: float) -> Interval:
    """The error of a gauge under the assumed accuracy class, [-e, e] in the unit of its nominal value, rounded outward."""
    reach = (Interval(GAUGE_CLASS, GAUGE_CLASS) * abs(nominal)).upper
    return Interval(-reach, reach)


def static_run(speed: Array, force: IntervalArray, speed_error: Interval, force_error: Interval) -> Run:
    """A captive run as one point of a static force table.

    The speed lies between its least and largest reading, widened by its accuracy. The force lies about its mean, as far as the mean of
    any quarter of the run stands from it, widened by its accuracy. All ends are rounded outward.

    Args:
        speed: readings, shape (n,).
        force: readings of the force of the water on the hull, shape (n,).
        speed_error: of the speed, in its unit.
        force_error: of the force, in its unit.
    """
    middle = force.sum() / len(force)
    parts = [part for part in np.array_split(np.arange(len(force)), PARTS) if part.size]
    drift = max((abs(force[part].sum() / part.size - middle)).upper for part in parts)
    within, around = Interval(speed.min(), speed.max()) + speed_error, middle + force_error + Interval(-drift, drift)
    return Run(
        (float(speed.mean()), within.lower, within.upper),
        (middle.midpoint, around.lower, around.upper),
    )


def table(runs: list[Run], speed: str, force: str) -> dict[str, Array]:
    """The static force table in order of speed: mean, lower and upper bound of speed and force, shape (n,) each."""
    runs = sorted(runs, key=lambda r: r.speed[0])
    ends = ("", "_lower", "_upper")
    speeds = {f"{speed}{e}": np.array([r.speed[k] for r in runs]) for k, e in enumerate(ends)}
    return speeds | {f"{force}{e}": np.array([r.force[k] for r in runs]) for k, e in enumerate(ends)}


def drag_intervals(runs: list[Run], axis: str) -> dict[str, object]:
    """The drag coefficients of one axis: every pair that the bounds of the runs allow.

    Args:
        runs: with their bounds, at least one.
        axis: surge, sway or yaw, for the names of the coefficients.

    Returns:
        ``status``; the interval of each coefficient by its id, empty unless the status is ``enclosed``; ``inflation``, the factor on the
        widths of the bounds at which the model just stops to contradict the runs; ``guaranteed``, which is false, and ``assumes``, the
        sentences that forbid it.
    """
    speed = IntervalArray(*(np.array([r.speed[k] for r in runs]) for k in (1, 2)))
    rows = IntervalArray.stack([speed, speed.signed_square()], axis=1)
    right = IntervalArray(np.array([-r.force[2] for r in runs]), np.array([-r.force[1] for r in runs]))
    found = regression.feasible_set(rows, right)
    ids = [f"drag.{axis}.linear", f"drag.{axis}.quadratic"]
    enclosed = found.status is FeasibleStatus.ENCLOSED and found.value is not None
    ends = [] if found.value is None else zip(found.value.lower.tolist(), found.value.upper.tolist(), strict=True)
    return {
        "status": found.status.value,
        "guaranteed": False,
        "assumes": list(ASSUMES),
        "runs": len(runs),
        "coefficients": {i: list(e) for i, e in zip(ids, ends, strict=True)} if enclosed else {},
        "inflation": found.inflation,
    }
