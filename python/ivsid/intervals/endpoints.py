"""Bounds that may be reversed: what the published method gives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals.array import FloatArray, IntervalArray


class EndpointPair:
    """Two arrays of bounds that may be reversed: what the published method gives. It has no arithmetic and no claim.

    Attributes:
        lower: what the method calls lower bounds.
        upper: what the method calls upper bounds.
        improper: where the lower bound lies above the upper one.
    """

    __slots__ = ("improper", "lower", "upper")

    def __init__(self, lower: FloatArray, upper: FloatArray) -> None:
        self.lower, self.upper = lower, upper
        self.improper: NDArray[np.bool_] = lower > upper

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of either array."""
        return self.lower.shape

    def holds(self, hull: IntervalArray) -> NDArray[np.bool_]:
        """Where the pair holds the entry of an exact hull of the same shape; elsewhere it is not an enclosure."""
        inside: NDArray[np.bool_] = (self.lower <= hull.lower) & (hull.upper <= self.upper)
        return inside

    def __repr__(self) -> str:
        return f"EndpointPair(lower={self.lower!r}, upper={self.upper!r}, improper={int(self.improper.sum())})"
