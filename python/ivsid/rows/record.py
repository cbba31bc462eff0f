"""What interval rows are, as a value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Term
from ivsid.intervals import FloatArray, IntervalArray

# At a sample, over a window, over two windows weighted by a hat; and what bounds the bias of an accelerometer's axis.
ROW_KINDS: Final = ("pointwise", "integral", "weak", "bias.x", "bias.y")


@dataclass(frozen=True)
class RegressionRows:
    """Interval rows of a model.

    Attributes:
        terms: one for each column.
        matrix: shape (m, n).
        right: known forces, shape (m,) [N or N m].
        channel: index into ("surge", "sway", "yaw"), shape (m,).
        time: start of each row [s], shape (m,).
        duration: length of its window [s], 0 for a pointwise row, shape (m,).
        kind: index into ``ROW_KINDS``, shape (m,).
        assumes: sentences that the rows rely on, beyond the sensor bounds.
    """

    terms: tuple[Term, ...]
    matrix: IntervalArray
    right: IntervalArray
    channel: NDArray[np.int64]
    time: FloatArray
    duration: FloatArray
    kind: NDArray[np.int64]
    assumes: tuple[str, ...]

    def take(self, rows: NDArray[Any], columns: Sequence[int]) -> RegressionRows:
        """Some of the rows, with some of the columns."""
        terms = tuple(self.terms[j] for j in columns)
        matrix = self.matrix[rows][:, list(columns)]
        return RegressionRows(
            terms,
            matrix,
            self.right[rows],
            self.channel[rows],
            self.time[rows],
            self.duration[rows],
            self.kind[rows],
            self.assumes,
        )
