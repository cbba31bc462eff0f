"""Interval rows as a value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Term
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.memory.pieces import kept, pieces
from ivsid.memory.room import DOUBLE, room

# Rows at a sample, over a window, over two windows weighted by a hat; the rows that bound the bias of an accelerometer's axis; and those of
# physical bounds, which are assumptions and no measurements.
ROW_KINDS: Final = (
    "pointwise",
    "integral",
    "weak",
    "bias.x",
    "bias.y",
    "physical.least",
    "physical.most",
    "physical.drag",
)
_NAMED: Final = {"channel": np.int64, "time": np.float64, "duration": np.float64, "kind": np.int64}


@dataclass(frozen=True)
class RegressionRows:
    """Interval rows of a model.

    Attributes:
        terms: one for each column.
        matrix: shape (m, n).
        right: known forces, shape (m,) [N or N m].
        channel: index into ("surge", "sway", "yaw"), shape (m,).
        time: start of each row [s], shape (m,).
        duration: length of the window of each row [s], 0 for a pointwise row, shape (m,).
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
        """Some of the rows with some of the columns.

        Args:
            rows: flags of shape (m,), or indices.
            columns: indices.
        """
        terms = tuple(self.terms[j] for j in columns)
        wanted = list(columns)
        every = wanted == list(range(self.matrix.shape[1]))
        if rows.dtype == bool:
            count = np.count_nonzero(rows)
            first, last = (int(np.argmax(rows)), rows.size - int(np.argmax(rows[::-1]))) if count else (0, 0)
            if count < last - first:
                return self._scattered(rows, wanted, terms)
            # Successive rows are a view.
            rows = slice(first, last)  # type: ignore[assignment]
            matrix = self.matrix[rows]
            if not every:
                both = room((2, *matrix.shape[:1], len(wanted)), DOUBLE)
                for part in pieces(matrix.shape[0]):
                    both[0, part], both[1, part] = matrix.lower[part][:, wanted], matrix.upper[part][:, wanted]
                matrix = IntervalArray._raw(both, both.shape[1:])
        else:
            matrix = self.matrix[rows] if every else self.matrix[rows][:, wanted]
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

    def _scattered(self, flags: NDArray[np.bool_], columns: list[int], terms: tuple[Term, ...]) -> RegressionRows:
        """Scattered rows, copied a piece at a time."""
        ends = np.r_[0, np.cumsum([np.count_nonzero(flags[p]) for p in pieces(flags.size)])]
        both, right = room((2, int(ends[-1]), len(columns)), DOUBLE), room((2, int(ends[-1])), DOUBLE)
        for part, a, b in zip(pieces(flags.size), ends[:-1], ends[1:], strict=True):
            chosen = flags[part]
            for k, (m, y) in enumerate(((self.matrix.lower, self.right.lower), (self.matrix.upper, self.right.upper))):
                both[k, a:b], right[k, a:b] = m[part][chosen][:, columns], y[part][chosen]
        matrix, known = IntervalArray._raw(both, both.shape[1:]), IntervalArray._raw(right, right.shape[1:])
        return RegressionRows(
            terms,
            matrix,
            known,
            kept(self.channel, flags),
            kept(self.time, flags),
            kept(self.duration, flags),
            kept(self.kind, flags),
            self.assumes,
        )


class Space:
    """Memory for the rows of several makers, each row written once and in its place.

    Args:
        terms: one for each column.
        makers: number of makers of rows.
        most: largest number of rows of each.
    """

    def __init__(self, terms: tuple[Term, ...], makers: int, most: int) -> None:
        self.terms, self.makers, self.most = terms, makers, most
        m, n = makers * most, len(terms)
        self._matrix, self._right = room((2, m, n), DOUBLE), room((2, m), DOUBLE)
        self._wholes = {k: room(m, np.dtype(np.int64)) for k in ("channel", "kind")}
        self._numbers = {k: room(m, DOUBLE) for k in ("time", "duration")}
        self._filled: dict[tuple[int, int], int] = {}
        self._assumes: dict[tuple[int, int], tuple[str, ...]] = {}

    def put(self, maker: int, first: int, part: RegressionRows) -> None:
        """Keeps the rows of a maker from the samples from ``first`` on, at most one for each sample."""
        low = maker * self.most + first
        high = low + part.time.size
        self._matrix[0, low:high], self._matrix[1, low:high] = part.matrix.lower, part.matrix.upper
        self._right[0, low:high], self._right[1, low:high] = part.right.lower, part.right.upper
        for name, column in (*self._wholes.items(), *self._numbers.items()):
            column[low:high] = getattr(part, name)
        self._filled[maker, first] = part.time.size
        self._assumes[maker, first] = part.assumes

    def rows(self, maker: int) -> int:
        """The number of rows of a maker."""
        return sum(n for (k, _), n in self._filled.items() if k == maker)

    def done(self, maker: int | None = None) -> RegressionRows:
        """All rows, maker by maker, or those of one maker.

        The rows are moved together in place, so ask for each maker once and in order.
        """
        wanted = sorted(key for key in self._filled if maker in (None, key[0]))
        begin = m = 0 if maker is None else maker * self.most
        arrays = [*self._matrix, *self._right, *self._wholes.values(), *self._numbers.values()]
        for key in wanted:
            low, count = key[0] * self.most + key[1], self._filled[key]
            if low != m:
                for a in arrays:
                    a[m : m + count] = a[low : low + count]
            m += count
        size = m - begin
        matrix = IntervalArray._raw(self._matrix[:, begin:m], (size, len(self.terms)))
        right = IntervalArray._raw(self._right[:, begin:m], (size,))
        channel, kind = (self._wholes[k][begin:m] for k in ("channel", "kind"))
        time, duration = (self._numbers[k][begin:m] for k in ("time", "duration"))
        sentences = tuple(s for key in wanted if self._filled[key] for s in self._assumes[key])
        return RegressionRows(self.terms, matrix, right, channel, time, duration, kind, sentences)


def joined(parts: Sequence[RegressionRows], assumes: Sequence[str]) -> RegressionRows:
    """The rows of all parts in their order, with ``assumes`` before the sentences of the parts."""
    sentences = tuple(dict.fromkeys((*assumes, *(s for p in parts for s in p.assumes))))
    if len(parts) == 1:
        return replace(parts[0], assumes=sentences)
    named = {name: np.concatenate([getattr(p, name) for p in parts]) for name in _NAMED}
    matrix = IntervalArray.concatenate([p.matrix for p in parts])
    right = IntervalArray.concatenate([p.right for p in parts])
    return RegressionRows(parts[0].terms, matrix, right, **named, assumes=sentences)
