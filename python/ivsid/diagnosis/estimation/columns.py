"""Signatures while they are collected."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Columns:
    """Signatures by name, while they are collected.

    Attributes:
        names: of the columns.
        arrays: the columns, shape (rows, n) each.
        prior: standard deviations of the coefficients that are known beforehand, by name.
    """

    names: list[str] = field(default_factory=list)
    arrays: list[Array] = field(default_factory=list)
    prior: dict[str, float] = field(default_factory=dict)

    def add(self, name: str, array: Array, prior: float | None = None) -> None:
        """Appends a column, with the standard deviation of its coefficient if it is known beforehand."""
        self.names.append(name)
        self.arrays.append(array)
        if prior is not None:
            self.prior[name] = prior

    def joined(self, *others: Columns) -> Columns:
        """These columns, then others."""
        every = (self, *others)
        return Columns(
            [name for c in every for name in c.names],
            [array for c in every for array in c.arrays],
            {name: sigma for c in every for name, sigma in c.prior.items()},
        )
