"""Means of a residual along the quantity of the motion that orders it best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Bins along a quantity.
# Source: measured: make constants
BINS: Final = 14
# An earlier quantity is preferred to a later one if it orders at least this share of what the best orders.
# Source: measured: make constants
PREFERRED: Final = 0.95
# Time between independent samples of a force that is low-passed at 0.35 Hz [s].
# Source: theorem: sampling theorem, Shannon 1949; 1 / (2 * 0.35 Hz) = 1.43 s
MEMORY: Final = 1.5
# A quantity whose range is below this share of its size is constant.
# Source: definition: rounding of doubles, with a margin
CONSTANT: Final = 1e-12


@dataclass(frozen=True)
class Binned:
    """Means along a quantity.

    Attributes:
        centre: mean of the quantity in each bin, shape (k,).
        mean: mean of the values in each bin, shape (k,).
        error: standard error of each mean, shape (k,).
    """

    centre: Array
    mean: Array
    error: Array


def ordered_by(values: Array, quantities: Mapping[str, Array]) -> str:
    """Name of the quantity whose bins explain most of the values.

    Args:
        values: shape (n,).
        quantities: by name, each of shape (n,), the preferred ones first.
    """
    shares = {name: _share(values, x) for name, x in quantities.items()}
    best = max(shares.values())
    return next(name for name, share in shares.items() if share >= PREFERRED * best)


def binned(values: Array, quantity: Array, step: float) -> Binned:
    """Means in bins of equally many samples.

    Args:
        values: shape (n,).
        quantity: along which the values are binned, shape (n,).
        step: time between samples [s].
    """
    groups = _bins(quantity)
    centre = np.array([quantity[g].mean() for g in groups])
    mean = np.array([values[g].mean() for g in groups])
    error = np.array([values[g].std() / np.sqrt(max(g.size * step / MEMORY, 1.0)) for g in groups])
    return Binned(centre, mean, error)


def _bins(quantity: Array) -> list[NDArray[np.int64]]:
    """Indices of the samples in each bin."""
    order = np.argsort(quantity, kind="stable")
    return [g for g in np.array_split(order, BINS) if g.size]


def _share(values: Array, quantity: Array) -> float:
    """Share of the values' variance between the bins."""
    if np.ptp(quantity) <= CONSTANT * max(float(np.abs(quantity).max()), CONSTANT):
        return 0.0
    total = float(np.sum((values - values.mean()) ** 2))
    between = sum(g.size * (values[g].mean() - values.mean()) ** 2 for g in _bins(quantity))
    return float(between / total) if total > 0 else 0.0
