"""The paper's heuristic: narrow a wide parameter box until its force bounds would lose the measurements (V.C).

The paper keeps "the interval with the minimum end-to-end absolute error" against the measured force and moment. Read here as
a greedy search: halve one parameter's interval at a time, towards its lower, middle or upper part, taking the half whose bounds lie
closest to the measurements, while they still hold a given share of them. The result is a guess in plain floats. It is never
guaranteed: nothing keeps the true parameter inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.rows import RegressionRows

COVERAGE: Final = 0.95
STEPS: Final = 60


@dataclass(frozen=True)
class Constriction:
    """The narrowed box.

    Attributes:
        lower: shape (n,).
        upper: shape (n,).
        coverage: share of measured forces inside the bounds at the end.
        error: mean end-to-end absolute error at the end, over the rms of each channel's force.
        steps: how many halvings were accepted.
    """

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    coverage: float
    error: float
    steps: int


def constrict(
    rows: RegressionRows, lower: NDArray[np.float64], upper: NDArray[np.float64], coverage: float = COVERAGE
) -> Constriction:
    """Narrows the box [lower, upper], shape (n,) each, on the rows it came from."""
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise IvsidError("an unbounded parameter interval cannot be constricted; start from a bounded one")
    matrix = (rows.matrix.lower, rows.matrix.upper)
    measured = rows.right.midpoint
    scale = np.ones_like(measured)
    for channel in np.unique(rows.channel):
        here = rows.channel == channel
        scale[here] = max(float(np.sqrt(np.mean(measured[here] ** 2))), float(rows.right.radius[here].mean()), 1e-12)
    box = (np.array(lower), np.array(upper))
    held, error = _judge(matrix, box, measured, scale)
    needed = min(coverage, held)
    accepted = 0
    for _ in range(STEPS):
        trials = [c for j in range(lower.size) for c in _halves(box, j)]
        judged = [
            (e, h, c) for c in trials for h, e in [_judge(matrix, c, measured, scale)] if h >= needed and e < error
        ]
        if not judged:
            break
        error, held, box = min(judged, key=lambda x: x[0])
        accepted += 1
    return Constriction(box[0], box[1], held, error, accepted)


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
