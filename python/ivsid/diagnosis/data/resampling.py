"""Columns of a log on the uniform clock, and the samples at which all of them were measured."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.between import FARTHEST, Rows
from ivsid.diagnosis.data.clock import usual_step
from ivsid.diagnosis.data.lost_rows import SAME, LostRows
from ivsid.log import Log

Array = NDArray[np.float64]
# Periods between two rows from which on rows between them are lost, however rows stray.
# Source: geometry: halfway to the distance over two lost rows
APART: Final = 2.5
# Share of a part by which a demand may come after its start and count as one of it, where rows stand off the clock.
# Source: geometry: halfway to the next part
NEAREST: Final = 0.5
# Beginnings of the names of columns that are sent, and stay in force.
# Source: definition: docs/guide.md, "Columns of a log"
SENT: Final = ("demand_", "azimuth_", "rudder_", "force_", "moment_")
# Columns of velocities, and of accelerations.
# Source: definition: docs/guide.md, "Columns of a log"
VELOCITIES: Final = ("u", "v", "r")
ACCELERATIONS: Final = ("ax", "ay", "udot", "vdot", "rdot")
# Share of the rows off the clock from which on held demands are followed part by part: one step would take them for as much as a step late.
# Source: definition: one in a hundred, as where a clock is uniform but for some rows
STRAY: Final = 0.01


def read_in(log: Log, group: Sequence[str]) -> list[str]:
    """The columns of a group that have two readings and more, between which others lie."""
    return [name for name in group if name in log.columns and np.count_nonzero(np.isfinite(log.columns[name])) > 1]


class Resampler:
    """Columns of a log on a uniform clock.

    Attributes:
        log: with irregular times.
        lost: its lost rows.
        clock: times of the uniform clock [s], shape (n,).
        h: its step [s].
        count: readings that are averaged over a step.
        good: samples at which every channel asked for so far was measured, shape (n,).
    """

    def __init__(self, log: Log, lost: LostRows, clock: Array, h: float, count: int = 1) -> None:
        self.log, self.lost, self.clock, self.h, self.count = log, lost, clock, h, count
        self.good = np.ones(clock.size, dtype=bool)

    def __call__(
        self, name: str, *, sent: bool = False, held: bool = False, unwrap: bool = False, since: int | None = None
    ) -> Array:
        """A column on the clock, shape (n,): a demand at its times, the mean of a reading over the step around them.

        Args:
            name: of the column.
            sent: a demand, which stays in force between its samples; a reading is not ``good`` in a gap.
            held: the last value at or before each time (a zero-order hold), in place of straight lines.
            unwrap: an angle is followed through whole turns.
            since: the mean of a reading over the step before each time instead: one that is a mean over the step before its row. Irregular rows count
                from the nearest of so many parts of a step on, as their demands do; from their own times on if it is 0.
        """
        if sent:
            t, x = self.lost.filled(name, unwrap=unwrap)
        else:
            there = np.isfinite(self.log.columns[name])
            t, x = self.log.t[there], self.log.columns[name][there]
            x = np.unwrap(x) if unwrap else x
        at = np.clip(np.searchsorted(t, self.clock + SAME * self.h, side="right") - 1, 0, t.size - 1)
        if held:
            found: Array = x[at]
            return found
        if sent:
            return np.interp(self.clock, t, x)
        nearest = np.minimum(np.abs(self.clock - t[at]), np.abs(t[np.minimum(at + 1, t.size - 1)] - self.clock))
        self.good &= nearest <= FARTHEST * self.h
        if since is not None and self.irregular:
            return self._since(t, x, since)
        places = self.places if since is None else self.places - self.places[-1]
        found = np.mean([np.interp(self.clock + k * self.h, t, x) for k in places], axis=0)
        return np.asarray(found, dtype=np.float64)

    def _since(self, t: Array, x: Array, parts: int) -> Array:
        """Means over the steps before the times of the clock, from those over the steps before irregular rows, shape (n,)."""
        if parts:
            part = self.h / parts
            t = self.clock[0] + np.floor((t - self.clock[0]) / part + NEAREST) * part
        # The first reading counts for all that lies before it.
        t = np.concatenate([[min(t[0], self.clock[0]) - self.h], t])
        whole = np.concatenate([[0.0], np.cumsum(x * np.diff(t))])
        return np.asarray(np.diff([np.interp(self.clock - q, t, whole) for q in (self.h, 0.0)], axis=0)[0] / self.h)

    @property
    def places(self) -> Array:
        """Places of the readings of a sample around it [steps], shape (count,)."""
        return (np.arange(self.count) - 0.5 * (self.count - 1)) / self.count

    @cached_property
    def irregular(self) -> bool:
        """Whether rows stand off the times at which the clock has its readings, or readings lie between rows since their own were lost."""
        at = (self.log.t - self.clock[0]) * (self.count / self.h) + 0.5 * (self.count - 1)
        off = float(np.mean(np.abs(at - np.round(at)) > SAME * self.count))
        return off > STRAY or self.between_rows

    @cached_property
    def between_rows(self) -> bool:
        """Whether no velocity or no acceleration was read at times of readings, and rows within a step stand for it."""
        read = (self.clock + self.places[:, None] * self.h).ravel()
        for names in filter(None, (read_in(self.log, group) for group in (VELOCITIES, ACCELERATIONS))):
            t = self.log.t[np.any([np.isfinite(self.log.columns[name]) for name in names], axis=0)]
            k = np.clip(np.searchsorted(t, read), 1, t.size - 1)
            away = np.minimum(np.abs(read - t[k - 1]), np.abs(t[k] - read)) / self.h
            if np.mean((away > SAME) & (away <= FARTHEST)) > STRAY:
                return True
        return False

    def rows(self, name: str, parts: int) -> Rows:
        """Rows with readings of a column around each place of readings.

        Args:
            name: of the column.
            parts: of a step, from which on demands are in force.
        """
        read, t = self.clock + self.places[:, None] * self.h, self.log.t[np.isfinite(self.log.columns[name])]
        k = np.clip(np.searchsorted(t, read, side="right") - 1, 0, t.size - 2)
        around = np.concatenate([t[k], t[k + 1]])
        there = [x for column, x in self.log.columns.items() if column.startswith(SENT)]
        sent = self.log.t[np.isfinite(there).any(axis=0)]
        at = np.floor((around - self.clock[0]) / (self.h / parts) + NEAREST).astype(np.int64)
        # A demand that was sent after a row, and begins at the same part, is not in force there.
        start = self.clock[0] + (at + NEAREST) * (self.h / parts)
        at -= np.searchsorted(sent, start, side="right") > np.searchsorted(sent, around, side="right")
        lost = t[k + 1] - t[k] > APART * usual_step(self.log, name)
        return Rows(
            (read - t[k]) / self.h, (t[k + 1] - read) / self.h, np.clip(at, 0, self.clock.size * parts - 1), lost
        )

    def between(self, name: str, parts: int) -> Array:
        """A held demand at equal parts of the steps of a clock that is slower than the log, shape (n, parts)."""
        t, x = self.lost.filled(name)
        clock = self.clock[:, None] + np.arange(parts) * (self.h / parts)
        # A row off the clock begins at the nearest part: at the next one, demands would act late as a rule.
        near = NEAREST if self.irregular else SAME
        at = np.searchsorted(t, clock + near * self.h / parts, side="right") - 1
        return np.asarray(x[np.clip(at, 0, t.size - 1)])

    def optional(self, name: str, *, since: int | None = None) -> Array | None:
        """A reading on the clock, shape (n,), or None if the log has no sample of it."""
        if name not in self.log.columns or not np.isfinite(self.log.columns[name]).any():
            return None
        return self(name, since=since)
