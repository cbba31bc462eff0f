"""The direction that parts a cause at its size from all declared errors inside their bounds.

A weighted prior lets every error take its share of a cause. Inside a box an error follows the cause up to its bound and stays there, so that all
that the cause has beyond the bounds is left.

Source: docs/theory.md, "Any thrust curve inside its accuracy"; Boyd and Vandenberghe, *Convex Optimization*, 2004, section 8.3.1 (separating a
point and a convex set).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import RIDGE
from ivsid.diagnosis.null.any_curve import DETERMINED, LEAST, AnyCurve
from ivsid.diagnosis.null.box_least_squares import inside_box

Array = NDArray[np.float64]
# Shares of the bounds that errors by the demand have beside those by the inflow, where a cause at its size is held against errors inside the box.
# Source: geometry: all, half and none, the ends and the middle of what a thrust error may be
SPLITS: Final = (1.0, 0.5, 0.0)
# Standard deviations below which nothing is left of a cause.
# Source: geometry: far below one, and above the rounding of a fit that no bound holds
NO_DIRECTION: Final = 1e-3


def beyond_box(free: AnyCurve, total: Array, prior: Array, size: Array) -> Array:
    """What the bounds of declared errors leave of a cause at a size, as coefficients of all columns, shape (all,).

    It is the difference of what errors inside their bounds leave of the cause and what errors without bounds leave: zero where none stands at its
    bound. What the latter leave is the course of the cause inside cells, which true curves have as well.

    Args:
        free: the base beside any thrust curve.
        total: cross-products of all columns.
        prior: their precisions.
        size: of the cause, in unit lengths of its columns, and zero elsewhere, shape (all,).
    """
    base, names = np.asarray(free.projection.base), free.g.names
    curve = np.array([names[k].startswith(("~thrust.", "~hysteresis.")) for k in base])
    others = base[(free.box == 0) & ~curve]
    solved = np.linalg.solve(total[np.ix_(others, others)] + np.diag(prior[others] + RIDGE), total[others])
    best, found = -np.inf, np.zeros(len(prior))
    for split in SPLITS:
        share = np.array([_share(names[k], split) for k in base])
        at = (free.box > 0) & (share > 0)
        inside, bound = base[at], (free.box * share)[at]
        left = total[inside] - total[np.ix_(inside, others)] @ solved
        values, vectors = np.linalg.eigh(left[:, inside])
        kept = values > DETERMINED * max(float(values.max(initial=0.0)), LEAST)
        if not kept.any():
            continue
        root = vectors[:, kept] * np.sqrt(values[kept])
        target = -(vectors[:, kept].T @ (left @ size)) / np.sqrt(values[kept])
        free_of_bounds = vectors[:, kept] @ (target / np.sqrt(values[kept]))
        D = np.zeros(len(prior))
        D[inside] = inside_box(root.T, target, bound) - free_of_bounds
        D[others] = -solved @ D
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
    return 1.0 - split if name.startswith("~inflow.") else split if name.startswith("~cell.") else 1.0
