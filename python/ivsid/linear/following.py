"""Thin door to the core's follower: bounds of parameters from interval rows that come one by one, in bounded memory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ivsid import _core
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, IntervalArray

# Parameters that share rows, at most.
# Source: resource: the core is compiled for each number, and 16 take 150 kB
MOST: Final = 16


@dataclass(frozen=True)
class Refuted:
    """The proof that no parameters explain the rows, or no constant ones.

    Attributes:
        time: of the row at which it was proved [s].
        since: time of the oldest row that the proof names, or begin of the window in which it was proved [s].
        rows: number of half-spaces that the proof names; 0 where windows contradict one another.
        column: whose ends do not meet; None for a combination of rows.
    """

    time: float
    since: float
    rows: int
    column: int | None


class Follower:
    """Bounds of n parameters from rows in their order.

    Args:
        start: bounds that are known to hold, shape (n,); finite.
        rates: most change of each parameter [1/s], shape (n,); 0 for a constant.
        window: length of the windows that are compared [s], which proves changes; None for one set over all rows.

    Raises:
        IvsidError: too many parameters, a start that is not finite, a rate below 0.
    """

    def __init__(self, start: IntervalArray, rates: FloatArray, window: float | None = None) -> None:
        if not 1 <= rates.size <= MOST:
            raise IvsidError(
                f"{rates.size} parameters share rows, and at most {MOST} can be followed; leave terms out of the model"
            )
        self._core = _core.Follower((start.lower, start.upper), np.ascontiguousarray(rates, dtype=np.float64), window)

    def take(self, time: FloatArray, rows: IntervalArray, right: IntervalArray) -> tuple[int, Refuted | None]:
        """Takes rows up to a proof.

        Args:
            time: at which each row holds, in order [s], shape (m,).
            rows: shape (m, n).
            right: shape (m,).

        Returns:
            The number of rows taken, and the proof at the last of them, or None.

        Raises:
            IvsidError: a row that is no interval, times out of order.
        """
        each = (rows.lower, rows.upper), (right.lower, right.upper)
        (lower, upper), (low, high) = ([np.ascontiguousarray(x) for x in pair] for pair in each)
        taken, proof = self._core.take(np.ascontiguousarray(time), (lower, upper), (low, high))
        return taken, None if proof is None else Refuted(*proof)

    @property
    def bounds(self) -> IntervalArray:
        """The proved bounds after the last row, shape (n,); of windows those that constant parameters would have."""
        lower, upper = self._core.bounds()
        return IntervalArray(lower, upper)
