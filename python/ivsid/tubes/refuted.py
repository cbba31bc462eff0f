"""Refutations: a measured interval that does not meet the tube contradicts the model over the window before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ivsid.files.records import Lower, Upper
from ivsid.intervals import IntervalArray
from ivsid.tubes.equations import Equations
from ivsid.tubes.horizons import Horizon, window
from ivsid.tubes.inputs import VELOCITIES, Course


@dataclass(frozen=True)
class Refutation:
    """A reading that no consistent vehicle gives.

    Attributes:
        component: u, v or r.
        start: of the window [s].
        end: of the window, the time of the reading [s].
        tube: bounds of the component there.
        measured: interval of the reading.
        rows: numbers of the first and the last row.
    """

    component: str
    start: float
    end: float
    tube: tuple[float, float]
    measured: tuple[float, float]
    rows: tuple[int, int]

    def record(self) -> dict[str, object]:
        """The record of result.json, with bounds rounded outward."""
        return {
            "component": self.component,
            "start": self.start,
            "end": self.end,
            "rows": list(self.rows),
            "tube": {"lower": Lower(self.tube[0]), "upper": Upper(self.tube[1])},
            "measured": {"lower": Lower(self.measured[0]), "upper": Upper(self.measured[1])},
        }


def outside(bounds: IntervalArray, course: Course, followed: int) -> IntervalArray | np.ndarray:
    """Whether the measured interval of each velocity misses the tube, shape (n, 3)."""
    missed = (bounds.lower[:, :3] > course.measured.upper) | (course.measured.lower > bounds.upper[:, :3])
    missed[:, followed:] = False
    return missed


def refutations(
    equations: Equations, course: Course, horizon: Horizon, given: IntervalArray | None, *, parts: int, most: int = 1
) -> tuple[list[Refutation], int]:
    """The first refutations of a horizon, each over the shortest window that shows it, and the number of rows outside.

    Args:
        equations: of the fit.
        course: of the log.
        horizon: its tubes.
        given: where surge alone is followed.
        parts: equal parts of each step.
        most: number of windows whose first row outside is examined.
    """
    missed = np.asarray(outside(horizon.bounds, course, 3 if given is None else 1))
    rows = np.flatnonzero(missed.any(axis=1))
    found: list[Refutation] = []
    for w in horizon.windows:
        here = rows[(rows > w.first) & (rows <= w.proved)]
        if here.size and len(found) < most:
            found.append(_shortest(equations, course, w.first, int(here[0]), given, parts))
    return found, int(rows.size)


def _shortest(
    equations: Equations, course: Course, first: int, last: int, given: IntervalArray | None, parts: int
) -> Refutation:
    """The shortest window that ends at ``last`` and misses the reading there; the one from ``first`` does."""
    for begin in [*range(last - 1, first, -1), first]:
        if not np.isfinite(course.measured.lower[begin, : 3 if given is None else 1]).all():
            continue
        bounds = window(equations, course, begin, last, given, parts=parts)
        if bounds.shape[0] != last - begin + 1:
            continue
        for k in range(3 if given is None else 1):
            low, high = float(bounds.lower[-1, k]), float(bounds.upper[-1, k])
            reading = float(course.measured.lower[last, k]), float(course.measured.upper[last, k])
            if low > reading[1] or reading[0] > high:
                t = course.log.t
                return Refutation(VELOCITIES[k], float(t[begin]), float(t[last]), (low, high), reading, (begin, last))
    raise AssertionError("the whole window refutes")
