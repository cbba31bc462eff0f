"""Refutations: a measured interval that does not meet the tube contradicts the model over the window before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ivsid.files.records import Lower, Upper
from ivsid.intervals import IntervalArray
from ivsid.tubes.equations import Equations
from ivsid.tubes.horizons import Horizon, window
from ivsid.tubes.inputs import VELOCITIES, Course

# Steps of all windows that are tried one after the other; beyond them lengths are doubled and halved.
# Source: resource: some seconds for a tube of all channels; windows up to 600 steps are the shortest without exception
TRIED: Final = 200_000


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

    @property
    def words(self) -> str:
        """Where the window starts and ends, in words."""
        return f"from the state at {self.start:.6g} s to the reading of {self.component} at {self.end:.6g} s"

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
    """The shortest window that ends at ``last`` and misses the reading there; the one from ``first`` does.

    Lengths are tried one after the other for ``TRIED`` steps in all, then doubled, and halved back to the shortest that shows it.
    """

    def shown(length: int) -> Refutation | None:
        return _missed(equations, course, last - length, last, given, parts)

    longest = last - first
    short, length, steps = 0, 1, 0
    while (found := shown(length)) is None:
        if length == longest:
            raise AssertionError("the whole window refutes")
        steps += length
        short, length = length, min(longest, length + 1 if steps < TRIED else 2 * length)
    while length - short > 1:
        middle = (short + length) // 2
        nearer = shown(middle)
        if nearer is None:
            short = middle
        else:
            found, length = nearer, middle
    return found


def _missed(
    equations: Equations, course: Course, begin: int, last: int, given: IntervalArray | None, parts: int
) -> Refutation | None:
    """The reading at ``last`` that misses the tube from ``begin`` on; None where none does, or where there is no tube."""
    followed = 3 if given is None else 1
    if not np.isfinite(course.measured.lower[begin, :followed]).all():
        return None
    bounds = window(equations, course, begin, last, given, parts=parts)
    if bounds.shape[0] != last - begin + 1:
        return None
    for k in range(followed):
        low, high = float(bounds.lower[-1, k]), float(bounds.upper[-1, k])
        reading = float(course.measured.lower[last, k]), float(course.measured.upper[last, k])
        if low > reading[1] or reading[0] > high:
            t = course.log.t
            return Refutation(VELOCITIES[k], float(t[begin]), float(t[last]), (low, high), reading, (begin, last))
    return None
