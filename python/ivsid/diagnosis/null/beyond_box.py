"""The direction that parts a cause at its size from all declared errors inside their bounds.

A weighted prior lets every error take its share of a cause. Inside a box an error follows the cause up to its bound and stays there, so that all
that the cause has beyond the bounds is left.

Source: docs/theory.md, "Any thrust curve inside its accuracy"; Boyd and Vandenberghe, *Convex Optimization*, 2004, section 8.3.1 (separating a
point and a convex set).
"""

from __future__ import annotations

from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from ivsid.diagnosis.null.any_curve import DETERMINED, LEAST, AnyCurve
from ivsid.diagnosis.null.box_least_squares import inside_box
from ivsid.diagnosis.null.curve_errors import BEYOND_DEMAND

Array = NDArray[np.float64]
# Shares of the bounds that errors by the demand have beside those by the inflow, where a cause at its size is held against errors inside the box.
# Source: geometry: all, half and none, the ends and the middle of what a thrust error may be
SPLITS: Final = (1.0, 0.5, 0.0)
# Standard deviations below which nothing is left of a cause.
# Source: geometry: far below one, and above the rounding of a fit that no bound holds
NO_DIRECTION: Final = 1e-3


class Split(NamedTuple):
    """Errors that have a bound, for one split of it between errors by the demand and by the inflow.

    Attributes:
        at: which of the base they are.
        share: of its bound that each has.
        values: eigenvalues of their cross-products beside what has no bound, those of determined directions.
        vectors: their eigenvectors.
    """

    at: NDArray[np.bool_]
    share: Array
    values: Array
    vectors: Array


class BeyondBox:
    """Directions that part causes from all declared errors inside their bounds.

    Args:
        free: the base beside any thrust curve.
    """

    def __init__(self, free: AnyCurve) -> None:
        self.free = free
        self._base, names = np.asarray(free.projection.base), free.g.names
        curve = np.array([names[k].startswith(("~thrust.", "~hysteresis.")) for k in self._base])
        self._others = self._base[(free.box == 0) & ~curve]
        self._factor = cho_factor(free.g.normal(list(self._others)))

    @cached_property
    def _splits(self) -> tuple[Split, ...]:
        """The errors that have a bound, by split of it."""
        free, base, found = self.free, self._base, []
        total = free.g.total
        for split in SPLITS:
            share = np.array([_share(free.g.names[k], split) for k in base])
            at = (free.box > 0) & (share > 0)
            inside = base[at]
            cross = total[np.ix_(self._others, inside)]
            values, vectors = np.linalg.eigh(total[np.ix_(inside, inside)] - cross.T @ cho_solve(self._factor, cross))
            kept = values > DETERMINED * max(float(values.max(initial=0.0)), LEAST)
            if kept.any():
                found.append(Split(at, share[at], values[kept], vectors[:, kept]))
        return tuple(found)

    def of(self, total: Array, size: Array) -> Array:
        """What the bounds leave of a cause at a size, as coefficients of all columns, shape (all,).

        It is the difference of what errors inside their bounds leave of the cause and what errors without bounds leave: zero where none stands at
        its bound. What the latter leave is the course of the cause inside cells, which true curves have as well.

        Args:
            total: cross-products of all columns, those of the base first.
            size: of the cause, in unit lengths of its columns, and zero elsewhere, shape (all,).
        """
        free, base, others = self.free, self._base, self._others
        best, found = -np.inf, np.zeros(len(size))
        of_size = total[base] @ size
        of_others = total[others] @ size
        for at, share, values, vectors in self._splits:
            inside, bound = base[at], free.box[at] * share
            cross = total[np.ix_(inside, others)]
            left = of_size[at] - cross @ cho_solve(self._factor, of_others)
            root = vectors * np.sqrt(values)
            target = -(vectors.T @ left) / np.sqrt(values)
            free_of_bounds = vectors @ (target / np.sqrt(values))
            D = np.zeros(len(size))
            D[inside] = inside_box(root.T, target, bound) - free_of_bounds
            D[others] = -cho_solve(self._factor, cross.T @ D[inside])
            length = float(np.sqrt(max(float(D @ total @ D), 0.0)))
            if length <= NO_DIRECTION:
                continue
            # Standard deviations by which the cause at this size stands beyond the worst errors.
            shown = float(D @ total @ size) - float(free.worst(total[base] @ D))
            if shown / length > best:
                best, found = shown / length, D
        return found


def _share(name: str, split: float) -> float:
    """Share of its bound that a declared error has where errors of thrusts by the demand have a share ``split`` of theirs."""
    return 1.0 - split if name.startswith(BEYOND_DEMAND) else split if name.startswith("~cell.") else 1.0
