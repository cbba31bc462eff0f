"""The paper's heuristic (V.C): a wide parameter box is narrowed until its force bounds would lose the measurements.

The paper keeps "the interval with the minimum end-to-end absolute error" against the measured force and moment. This module reads
that as a greedy search. Each step halves the interval of one parameter, to its lower, middle or upper part. It takes the half whose
force bounds are closest to the measurements among those whose bounds contain a given share of them. The result is a guess in plain
floats and never guaranteed: nothing keeps the true parameter inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.rows import RegressionRows

# Share of the measured forces that the bounds of the narrowed box contain, where none is given.
# Source: measured: make constants
COVERAGE: Final = 0.95
# Largest number of halvings.
# Source: resource: bounds the time of the search
STEPS: Final = 60


@dataclass(frozen=True)
class Constriction:
    """A narrowed box of n parameters.

    Attributes:
        lower: shape (n,).
        upper: shape (n,).
        coverage: share of measured forces inside the bounds of the box.
        error: mean end-to-end absolute error, relative to the rms force of each channel.
        steps: number of accepted halvings.
    """

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    coverage: float
    error: float
    steps: int


def constrict(
    rows: RegressionRows, lower: NDArray[np.float64], upper: NDArray[np.float64], coverage: float = COVERAGE
) -> Constriction:
    """Narrows a box of parameters.

    Args:
        rows: from which the box was made, m rows of n columns.
        lower: shape (n,).
        upper: shape (n,).
        coverage: share of measured forces that the bounds must contain.

    Raises:
        IvsidError: an unbounded box.
    """
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise IvsidError("an unbounded parameter interval cannot be constricted; start from a bounded one")
    matrix = (rows.matrix.lower, rows.matrix.upper)
    measured = rows.right.midpoint
    scale = np.ones_like(measured)
    for channel in np.unique(rows.channel):
        here = rows.channel == channel
        scale[here] = max(float(np.sqrt(np.mean(measured[here] ** 2))), float(rows.right.radius[here].mean()), 1e-12)
    box = (np.array(lower), np.array(upper))
    inside, error = _judge(matrix, box, measured, scale)
    needed = min(coverage, inside)
    accepted = 0
    for _ in range(STEPS):
        trials = [c for j in range(lower.size) for c in _halves(box, j)]
        judged = [
            (e, h, c) for c in trials for h, e in [_judge(matrix, c, measured, scale)] if h >= needed and e < error
        ]
        if not judged:
            break
        error, inside, box = min(judged, key=lambda x: x[0])
        accepted += 1
    return Constriction(box[0], box[1], inside, error, accepted)


_Box = tuple[NDArray[np.float64], NDArray[np.float64]]


def _halves(box: _Box, j: int) -> list[_Box]:
    width = box[1][j] - box[0][j]
    found = []
    for start in (0.0, 0.25, 0.5):
        low, high = box[0].copy(), box[1].copy()
        low[j], high[j] = box[0][j] + start * width, box[0][j] + (start + 0.5) * width
        found.append((low, high))
    return found


def _judge(matrix: _Box, box: _Box, measured: NDArray[np.float64], scale: NDArray[np.float64]) -> tuple[float, float]:
    """Share of measurements inside the predicted bounds, and the mean distance of the farther bound."""
    products = [m * b for m in matrix for b in box]
    low = np.minimum.reduce(products).sum(axis=1)
    high = np.maximum.reduce(products).sum(axis=1)
    inside = float(np.mean((low <= measured) & (measured <= high)))
    distance = np.maximum(np.abs(low - measured), np.abs(high - measured)) / scale
    return inside, float(distance.mean())
