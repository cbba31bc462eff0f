"""Of what a residual is a function: the quantity of the motion that orders it best, and its means along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BINS: Final = 14
# A quantity that comes first in the list is preferred to a later one that is hardly better.
HARDLY: Final = 0.95
# Samples of a low-passed force are as many as there are spans of this length [s].
MEMORY: Final = 1.5


@dataclass(frozen=True)
class Binned:
    """Means along a quantity.

    Attributes:
        centre: mean of the quantity in each bin, shape (k,).
        mean: of the values, shape (k,).
        error: standard error of each, shape (k,).
    """

    centre: Array
    mean: Array
    error: Array


def ordered_by(values: Array, quantities: Mapping[str, Array]) -> str:
    """The name of the quantity whose bins leave least of the values unexplained.

    Args:
        values: shape (n,).
        quantities: candidates by name, each of shape (n,), the preferred ones first.
    """
    shares = {name: _share(values, x) for name, x in quantities.items()}
    best = max(shares.values())
    return next(name for name, share in shares.items() if share >= HARDLY * best)


def binned(values: Array, quantity: Array, step: float) -> Binned:
    """Means in bins that hold equally many samples.

    Args:
        values: shape (n,).
        quantity: along which, shape (n,).
        step: between samples [s].
    """
    groups = _bins(quantity)
    centre = np.array([quantity[g].mean() for g in groups])
    mean = np.array([values[g].mean() for g in groups])
    error = np.array([values[g].std() / np.sqrt(max(g.size * step / MEMORY, 1.0)) for g in groups])
    return Binned(centre, mean, error)


def _bins(quantity: Array) -> list[NDArray[np.int64]]:
    order = np.argsort(quantity, kind="stable")
    return [g for g in np.array_split(order, BINS) if g.size]


def _share(values: Array, quantity: Array) -> float:
    """How much of the values' spread the means of the bins hold."""
    if np.ptp(quantity) <= 1e-12 * max(float(np.abs(quantity).max()), 1e-12):
        return 0.0
    total = float(np.sum((values - values.mean()) ** 2))
    between = sum(g.size * (values[g].mean() - values.mean()) ** 2 for g in _bins(quantity))
    return float(between / total) if total > 0 else 0.0
