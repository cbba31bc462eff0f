"""Rows that a log has lost, one or two in a row: when they were, and what its demands may have been there.

A reading between two rows is interpolated. A demand that was sent in a lost row is not known: a line between its neighbours is right for one that
changes evenly, and off by half of a jump for one that jumps.

Source: docs/theory.md, "Lost rows".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log

Array = NDArray[np.float64]
# Rows whose distance is a number of periods within this share of one have lost the rows between them.
# Source: geometry: rows that stray by a third of a period either way are never as far apart without a loss
WITHIN: Final = 0.25
# Most rows in a row that count as lost one by one; more are a gap.
# Source: geometry: each of two has a row beside it, and the middle one of three has none
MOST: Final = 2
# Times closer than this are the same [steps].
# Source: geometry: stamps rounded to a millisecond are off by at most 0.0125 of the shortest step, 1/25 s
SAME: Final = 0.02


@dataclass(frozen=True)
class LostDemands:
    """Losses on the clock of a diagnosis, and how much of each change of a demand over one may have come as a jump.

    Attributes:
        before: samples at or before the row before each loss, shape (losses,).
        after: samples at or after the row after it, shape (losses,).
        jump: time for which a jump may be off the line [s], by thruster and by loss, shape (thrusters, losses).
    """

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    jump: Array


class LostRows:
    """The lost rows of a log.

    Attributes:
        log: with its rows.
        before: indices of the rows before losses, shape (losses,).
        missing: rows in each loss, shape (losses,).
        t: times of lost rows [s], shape (lost,).
    """

    def __init__(self, log: Log) -> None:
        self.log = log
        apart = np.diff(log.t) / log.period
        missing = np.round(apart).astype(np.int64) - 1
        there = (missing >= 1) & (missing <= MOST) & (np.abs(apart - np.round(apart)) < WITHIN)
        self.before, self.missing = np.flatnonzero(there), missing[there]
        self.t = self._times(np.ones(self.before.size, dtype=bool))

    def _times(self, losses: NDArray[np.bool_]) -> Array:
        """Times of the rows of some losses [s]."""
        count = self.missing[losses]
        first = np.repeat(np.cumsum(count) - count, count)
        share = (np.arange(first.size) - first + 1) / (np.repeat(count, count) + 1)
        before = np.repeat(self.before[losses], count)
        return np.asarray(self.log.t[before] + share * (self.log.t[before + 1] - self.log.t[before]))

    def filled(self, name: str, *, unwrap: bool = False) -> tuple[Array, Array]:
        """Times and values of a demand, on straight lines where rows were lost.

        Args:
            name: of its column.
            unwrap: an angle is followed through whole turns.
        """
        values = self.log.columns[name]
        there = np.isfinite(values)
        t, x = self.log.t[there], values[there]
        if unwrap:
            x = np.unwrap(x)
        # A cell that is empty beside a loss says that the demand has rows of its own.
        lost = self._times(there[self.before] & there[self.before + 1])
        at = np.searchsorted(t, lost)
        return np.insert(t, at, lost), np.insert(x, at, np.interp(lost, t, _turned(name, x)))

    def demands(self, columns: Sequence[Sequence[str]], clock: Array) -> LostDemands | None:
        """Losses on a clock, or None if there are none.

        Args:
            columns: names of the demands of each thruster.
            clock: times [s], shape (n,).
        """
        if not self.before.size:
            return None
        share = np.stack([np.max([self._jump(name) for name in names], axis=0) for names in columns])
        whole = clock[1] - clock[0]
        before = np.floor((self.log.t[self.before] - clock[0]) / whole + SAME).astype(np.int64)
        after = np.ceil((self.log.t[self.before + 1] - clock[0]) / whole - SAME).astype(np.int64)
        last = clock.size - 1
        # A jump at the first or at the last of the rows is half of it off in each row.
        off = 0.5 * self.missing * self.log.period
        return LostDemands(np.clip(before, 0, last), np.clip(after, 0, last), share * off)

    def _jump(self, name: str) -> Array:
        """The share of the change of a demand over each loss that its slopes on either side do not explain, at most 1, shape (losses,)."""
        x, t, k, last = _turned(name, self.log.columns[name]), self.log.t, self.before, self.log.t.size - 1
        change, time = x[k + 1] - x[k], t[k + 1] - t[k]
        left, right = np.maximum(k - 1, 0), np.minimum(k + 2, last)
        slopes = [(x[b] - x[a]) / np.maximum(t[b] - t[a], self.log.period) for a, b in ((left, k), (k + 1, right))]
        # Both together hold a bend, and either alone is no jump's where one lies beside the loss.
        tried = [np.abs(change - time * s) for s in (*slopes, 0.5 * (slopes[0] + slopes[1]))]
        # Beside an empty cell no slope is known, and all of the change may be a jump.
        rest = np.fmin.reduce([*tried, np.where(np.isnan(tried).all(axis=0), np.abs(change), np.nan)])
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.nan_to_num(np.minimum(rest / np.abs(change), 1.0), nan=0.0))


def _turned(name: str, x: Array) -> Array:
    """A column, of which an angle takes the shorter way from one cell that is not empty to the next."""
    if not name.startswith("azimuth_"):
        return x
    there = np.isfinite(x)
    out = x.copy()
    out[there] = np.unwrap(x[there])
    return out
