"""Static force tables of captive runs, and drag coefficients as intervals from them.

A model that is towed at a constant speed u feels F = -(linear u + quadratic u|u|). With bounds of every speed and force, each run is one
interval row; ``feasible_set`` proves the hull of all coefficients that fit every row.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.linear import regression
from ivsid.linear.regression import FeasibleStatus

Array = NDArray[np.float64]

# Accuracy of a gauge as a share of its nominal value, where the set states none: the accuracy class 0.1 of industrial load cells.
# Source: definition: VDI/VDE 2637, accuracy classes.
GAUGE_CLASS: Final = 1e-3
# Parts of a run whose means show how far its force has settled.
# Source: definition: quarters of a run.
PARTS: Final = 4


@dataclass(frozen=True)
class Run:
    """A captive run with its bounds.

    Attributes:
        speed: mean, lower and upper bound of the speed.
        force: mean, lower and upper bound of the mean force of the water on the hull.
    """

    speed: tuple[float, float, float]
    force: tuple[float, float, float]


def static_run(speed: Array, force: Array, speed_accuracy: float, force_accuracy: float) -> Run:
    """A captive run as one point of a static force table.

    The speed lies between its least and largest reading, widened by its accuracy. The force lies about its mean, as far as the mean of
    any quarter of the run stands from it, widened by its accuracy.

    Args:
        speed: readings, shape (n,).
        force: readings of the force of the water on the hull, shape (n,).
        speed_accuracy: of the speed, in its unit.
        force_accuracy: of the force, in its unit.
    """
    middle = float(force.mean())
    settled = max(abs(float(part.mean()) - middle) for part in np.array_split(force, PARTS))
    width = settled + force_accuracy
    return Run(
        (float(speed.mean()), float(speed.min()) - speed_accuracy, float(speed.max()) + speed_accuracy),
        (middle, middle - width, middle + width),
    )


def table(runs: list[Run], speed: str, force: str) -> dict[str, Array]:
    """The static force table in order of speed: mean, lower and upper bound of speed and force, shape (n,) each."""
    runs = sorted(runs, key=lambda r: r.speed[0])
    ends = ("", "_lower", "_upper")
    speeds = {f"{speed}{e}": np.array([r.speed[k] for r in runs]) for k, e in enumerate(ends)}
    return speeds | {f"{force}{e}": np.array([r.force[k] for r in runs]) for k, e in enumerate(ends)}


def drag_intervals(runs: list[Run], axis: str) -> dict[str, object]:
    """The drag coefficients of one axis: proved under the bounds of the runs, or said not to be.

    Args:
        runs: with their bounds, at least one.
        axis: surge, sway or yaw, for the names of the coefficients.

    Returns:
        ``status`` and ``guaranteed``; the interval of each coefficient by its id, empty unless the status is ``enclosed``; ``inflation``, the
        factor on the widths of the bounds at which the model just stops to contradict the runs.
    """
    low, high = (np.array([r.speed[k] for r in runs]) for k in (1, 2))
    # u|u| grows with u. One step outward holds the rounding of its product and of the bounds.
    square = [np.nextafter(u * np.abs(u), sign * np.inf) for u, sign in ((low, -1), (high, 1))]
    rows = IntervalArray(np.c_[np.nextafter(low, -np.inf), square[0]], np.c_[np.nextafter(high, np.inf), square[1]])
    right = IntervalArray(np.array([-r.force[2] for r in runs]), np.array([-r.force[1] for r in runs]))
    found = regression.feasible_set(rows, right)
    ids = [f"drag.{axis}.linear", f"drag.{axis}.quadratic"]
    enclosed = found.status is FeasibleStatus.ENCLOSED and found.value is not None
    ends = [] if found.value is None else zip(found.value.lower.tolist(), found.value.upper.tolist(), strict=True)
    return {
        "status": found.status.value,
        "guaranteed": found.guaranteed and enclosed,
        "runs": len(runs),
        "coefficients": {i: list(e) for i, e in zip(ids, ends, strict=True)} if enclosed else {},
        "inflation": found.inflation,
    }
