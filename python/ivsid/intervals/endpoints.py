"""Bounds that may be reversed, the result of the published method."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals.array import IntervalArray
from ivsid.intervals.floats import FloatArray


class EndpointPair:
    """Two arrays of bounds that may be reversed, the result of the published method (paper, eq. 11-13).

    A pair has no arithmetic, and it encloses nothing by itself.

    Attributes:
        lower: the method's lower bounds, any shape.
        upper: the method's upper bounds, of the same shape.
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
        """Whether each pair contains the entry of an exact hull of the same shape; elsewhere the pair is no enclosure."""
        inside: NDArray[np.bool_] = (self.lower <= hull.lower) & (hull.upper <= self.upper)
        return inside

    def __repr__(self) -> str:
        return f"EndpointPair(lower={self.lower!r}, upper={self.upper!r}, improper={int(self.improper.sum())})"
