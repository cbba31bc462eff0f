"""Stamps out of order: which rows keep their place, and the gaps that stand in the place of the others.

A stamp that repeats, jumps or goes back is wrong, or its neighbour is. Rows that every longest increasing subsequence of the stamps has
are in order whatever the others are; the others are left out. What happened there is unknown, a new demand included. So neighbours are
left out as well until the hole is a gap, which nothing bridges.

Source: M. L. Fredman, On computing the length of longest increasing subsequences, Discrete Mathematics 11, 1975 (lengths by bisection).
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log.record import GAP

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

# Largest share of the rows of a log whose stamps are out of order; one such row is accepted in any log of MANY rows.
# Source: definition: a log with more has another fault, as two runs in one file
SHARE: Final = 0.01
# Rows of a log that may have a stamp out of order.
# Source: definition: of fewer rows none is beyond doubt
MANY: Final = 20


@dataclass(frozen=True)
class Order:
    """Rows in order.

    Attributes:
        kept: rows whose stamps increase strictly, shape (k,).
        wrong: rows whose stamps are out of order or missing, shape (m,).
        beside: number of rows that are left out beside them, so that each hole is a gap.
    """

    kept: Rows
    wrong: Rows
    beside: int


def in_order(stamps: Array) -> Order | None:
    """The rows that keep their places, or None where too many are out of order.

    Args:
        stamps: of the rows, shape (n,); NaN is missing.
    """
    sure = sure_rows(stamps)
    wrong = np.flatnonzero(~sure)
    if stamps.size < MANY or wrong.size > max(1.0, SHARE * stamps.size):
        return None
    kept = _with_gaps(stamps, np.flatnonzero(sure))
    return None if kept.size < 2 else Order(kept, wrong, stamps.size - kept.size - wrong.size)


def sure_rows(stamps: Array) -> NDArray[np.bool_]:
    """Whether a row stands in every longest strictly increasing subsequence, shape (n,)."""
    there = np.flatnonzero(np.isfinite(stamps))
    before = _lengths(stamps[there])
    after = _lengths(-stamps[there][::-1])[::-1]
    longest = int(before.max(initial=0))
    on_one = before + after == longest + 1
    # A place of the subsequence that one row alone can take is taken by it in all of them.
    rivals = np.bincount(before[on_one], minlength=longest + 1)
    sure = np.zeros(stamps.size, dtype=bool)
    sure[there] = on_one & (rivals[before] == 1)
    return sure


def _lengths(values: Array) -> NDArray[np.intp]:
    """Length of the longest strictly increasing subsequence that ends at each value, shape (n,)."""
    least: list[float] = []
    lengths = np.empty(values.size, dtype=np.intp)
    for k, value in enumerate(values.tolist()):
        if not least or value > least[-1]:
            least.append(value)
            lengths[k] = len(least)
            continue
        place = bisect_left(least, value)
        least[place] = value
        lengths[k] = place + 1
    return lengths


def _with_gaps(stamps: Array, sure: Rows) -> Rows:
    """The sure rows without those that stand so near to a hole that it would be no gap, by the median step of the rows that are left."""
    kept, hole = sure, 0.0
    while kept.size >= 2:
        # The median of the rows that are left may exceed that of all: holes only widen, so that this ends.
        wide = (GAP + 0.25) * float(np.median(np.diff(stamps[kept])))
        if wide <= hole:
            break
        hole, kept = wide, _widened(stamps, sure, wide)
    return kept


def _widened(stamps: Array, sure: Rows, hole: float) -> Rows:
    """The sure rows without those nearer than a hole to the other side of one."""
    keep = np.ones(sure.size, dtype=bool)
    for k in np.flatnonzero(np.diff(sure) > 1).tolist():
        first, last = k, k + 1
        while last < sure.size and stamps[sure[last]] - stamps[sure[first]] <= hole:
            keep[last] = False
            last += 1
            if last < sure.size and first > 0 and stamps[sure[last]] - stamps[sure[first]] <= hole:
                keep[first] = False
                first -= 1
    return sure[keep]
