"""The set that both logs allow, the fit's own and the planned one: its widest relative interval is to be narrow.

The rows of the planned log are those that ``identify`` would take, and the set is solved by the same method, so that a prediction and the
later result differ by the errors that sea and sensors draw, and by the truth that is not the estimate.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.identification.blocks import linked
from ivsid.intervals import IntervalArray
from ivsid.linear import regression
from ivsid.plans.known import known_rows
from ivsid.plans.sailed import Sailed
from ivsid.rows import build_rows, window_count
from ivsid.sensors.bounds import bound_log

# Value of an interval without an end: any plan that leaves fewer of them is better.
# Source: definition: far beyond the relative width of a finite interval that anybody plans for
OPEN: Final = 1e6
# Share of the mean relative interval beside the widest one in the search.
# Source: definition: a tenth breaks ties, and hardly trades the widest interval for the others
OTHERS: Final = 0.1


class Narrowing:
    """Intervals of all parameters after one more log.

    Args:
        fit: by ``identify``.
        window: lengths of the integral rows of the next log [s]; None takes those of the fit.
        truth: parameters of the vehicle that sails, in the fit's form.
    """

    name = "narrow"
    quantity = "widest relative interval"
    larger = False

    def __init__(
        self,
        fit: Identification,
        window: float | Sequence[float] | None = None,
        truth: Mapping[str, float] | None = None,
    ) -> None:
        self.fit, self.vehicle = fit, fit.vehicle
        self.terms = terms_of(fit.vehicle, fit.options["form"])
        self.ids = tuple(t.id for t in self.terms)
        self.window = fit.options["window"] if window is None else window
        self.truth = dict(fit.estimate if truth is None else truth)
        self.known = known_rows(fit, self.ids)

    def value(self, sailed: Sailed) -> float:
        """The widest relative interval; each open one counts ``OPEN``."""
        return widest(self.intervals(sailed), self.truth)

    def cost(self, sailed: Sailed) -> float:
        """The widest relative interval, and a share of the mean one: where sensors let the widest no narrower, the others count.

        Signs are those of the vehicle that sails, so that one cell of signs is solved for each programme, and not all of them.
        """
        found = self.intervals(sailed, signs=True)
        relative = [min(relative_width(ends, self.truth.get(k, math.nan)), 1.0) for k, ends in found.items()]
        return widest(found, self.truth) + OTHERS * sum(relative) / len(relative)

    def before(self) -> float:
        """The widest relative interval of the fit as it is."""
        return widest(self.intervals(None), self.truth)

    def details(self, sailed: Sailed) -> dict[str, object]:
        """The intervals by parameter."""
        return {k: list(ends) for k, ends in self.intervals(sailed).items()}

    def intervals(self, sailed: Sailed | None, *, signs: bool = False) -> dict[str, tuple[float, float]]:
        """The hull of the set of both logs, by parameter; of the fit's own log without another. A contradiction leaves the fit's own.

        Args:
            sailed: the planned log.
            signs: whether parameters keep the signs of the vehicle that sails.
        """
        matrix, right = self.known
        if sailed is not None:
            try:
                bounded = bound_log(sailed.log, self.vehicle, window_count(self.window))
                made = build_rows(
                    bounded,
                    self.vehicle,
                    self.terms,
                    added_mass=self.fit.options["form"] == "added",
                    kind=self.fit.options["rows"],
                    window=self.window,
                )
            except IvsidError:
                return self.intervals(None)
            matrix, right = _stacked(matrix, made.matrix), _stacked(right, made.right)
        used = [np.asarray((matrix.lower[:, j] != 0) | (matrix.upper[:, j] != 0)) for j in range(len(self.ids))]
        found = dict.fromkeys(self.ids, (-math.inf, math.inf))
        for columns in linked(used):
            mine = np.logical_or.reduce([used[j] for j in columns])
            part = IntervalArray(matrix.lower[mine][:, columns], matrix.upper[mine][:, columns])
            known = [int(np.sign(self.truth[self.ids[j]])) for j in columns] if signs else None
            hull = regression.feasible_set(part, right[np.flatnonzero(mine)], signs=known).value if mine.any() else None
            for k, j in enumerate(columns):
                p = self.fit.parameters[self.ids[j]]
                found[self.ids[j]] = (
                    (p.lower, p.upper) if hull is None else (float(hull.lower[k]), float(hull.upper[k]))
                )
        return found


def widest(intervals: dict[str, tuple[float, float]], middle: Mapping[str, float]) -> float:
    """The largest width over the size of the estimate; each open interval counts ``OPEN``."""
    relative = {k: relative_width(ends, middle.get(k, math.nan)) for k, ends in intervals.items()}
    finite = [x for x in relative.values() if math.isfinite(x)]
    return OPEN * (len(relative) - len(finite)) + max(finite, default=0.0)


def relative_width(ends: tuple[float, float], middle: float) -> float:
    """Width over the size of the middle or, where the interval holds 0, over its largest member; infinite without an end."""
    width = ends[1] - ends[0]
    size = max(abs(ends[0]), abs(ends[1])) if not math.isfinite(middle) or ends[0] <= 0 <= ends[1] else abs(middle)
    return width / size if math.isfinite(width) and size > 0 else math.inf


def _stacked(a: IntervalArray, b: IntervalArray) -> IntervalArray:
    return IntervalArray(np.concatenate([a.lower, b.lower]), np.concatenate([a.upper, b.upper]))
