"""Intervals of many rows, made in pieces that stay in the processor's cache."""

from __future__ import annotations

from collections.abc import Callable

from ivsid.intervals import IntervalArray
from ivsid.memory.pieces import PIECE, over_pieces, pieces, processors
from ivsid.memory.room import DOUBLE, room

__all__ = ["PIECE", "interval_pieces", "over_pieces", "pieces", "processors"]


def interval_pieces(rows: int, work: Callable[[slice], IntervalArray]) -> IntervalArray:
    """The intervals of all rows, shape (rows,); ``work`` gives those of a piece."""
    parts = pieces(rows)
    if len(parts) == 1:
        return work(parts[0])
    both = room((2, rows), DOUBLE)

    def fill(part: slice) -> None:
        found = work(part)
        both[0, part], both[1, part] = found.lower, found.upper

    over_pieces(parts, fill)
    return IntervalArray._raw(both, (rows,))
