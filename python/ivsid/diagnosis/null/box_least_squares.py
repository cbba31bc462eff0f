"""Least squares inside a symmetric box, by block principal pivoting on the normal equations.

Each step solves for the variables that are free, and moves at once every variable that breaks the conditions of the minimum: free ones beyond
their bound onto it, and those at a bound from which the gradient leads back off it. A few steps suffice where most errors stand at their bounds,
of which SciPy's interior method takes twenty. Where such steps no longer gain, single moves follow, and where these do not end, SciPy's method.

Source: Portugal, Judice and Vicente, "A comparison of block pivoting and interior-point algorithms for linear least squares problems with
nonnegative variables", Mathematics of Computation 63, 1994; Karush, Kuhn and Tucker for the conditions.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

Array = NDArray[np.float64]
# Share of the mean information that is added to each variable: directions that nothing determines stay where they are.
# Source: geometry: a thousandth of the share below which eigenvalues are cut off
STAYS: Final = 1e-12
# Share of a bound, and of the gradient's scale, by which a condition may be missed.
# Source: geometry: above the rounding of a solve, and below any size that matters
MISSED: Final = 1e-9
# Steps without a gain before single moves, and steps at most.
# Source: resource: 18 steps were the most of 39 problems of null logs
PATIENCE: Final = 10
STEPS: Final = 100


def inside_box(root: Array, target: Array, bound: Array) -> Array:
    """The point inside a box that is nearest to a target, shape (variables,).

    Args:
        root: of each residual by a unit of each variable, shape (residuals, variables).
        target: of the residuals, shape (residuals,).
        bound: of each variable on both sides, positive, shape (variables,).
    """
    found = _pivoted(root.T @ root, root.T @ target, bound)
    return np.asarray(lsq_linear(root, target, bounds=(-bound, bound)).x) if found is None else found


def _pivoted(H: Array, g: Array, bound: Array) -> Array | None:
    """The least of x'Hx / 2 - g'x inside the box, or None where pivoting does not end."""
    n = g.size
    H = H + STAYS * np.trace(H) / n * np.eye(n)
    slope = MISSED * max(float(np.abs(g).max(initial=0.0)), float((np.abs(H) @ bound).max(initial=0.0)))
    side = np.zeros(n)
    fewest, patience = n + 1, PATIENCE
    for _ in range(STEPS):
        free = side == 0
        x = side * bound
        if free.any():
            try:
                x[free] = np.linalg.solve(H[np.ix_(free, free)], g[free] - H[np.ix_(free, ~free)] @ x[~free])
            except np.linalg.LinAlgError:
                return None
        rest = g - H @ x
        wrong = np.where(free, np.abs(x) > (1.0 + MISSED) * bound, side * rest < -slope)
        count = int(wrong.sum())
        if count == 0:
            return np.clip(x, -bound, bound)
        if count < fewest:
            fewest, patience = count, PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            wrong = np.arange(n) == np.flatnonzero(wrong)[-1]
        side = np.where(wrong, np.where(free, np.sign(x), 0.0), side)
    return None
