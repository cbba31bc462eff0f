"""Channels as courses in time: values at the edges of windows, and integrals over them, from each channel's own samples."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log
from ivsid.log.angles import unwrapped

Array = NDArray[np.float64]
# Lengths of windows [s]: from a few samples of a fast log to a slow ship's turn.
# Source: geometry: each about twice the one before
LENGTHS: Final = (1.0, 2.0, 5.0, 10.0, 20.0, 40.0)
# Fewest windows that tell anything.
# Source: theorem: twelve independent pairs have a correlation of 0.9 by chance with the probability 4e-5 (Fisher 1915)
LEAST: Final = 12
# Samples that a log is judged by: a wrong set-up is the same from beginning to end.
# Source: resource: a quarter of a second on a long log
MOST: Final = 100_000


class Course:
    """A channel in time.

    Args:
        t: times [s], shape (n,).
        values: at these times; NaN is a missing sample.
        held: whether a value holds until the next one; else the course is a straight line.
    """

    def __init__(self, t: Array, values: Array, *, held: bool = False) -> None:
        there = np.isfinite(values)
        self.t, self.values = t[there], values[there]
        steps = np.diff(self.t)
        mean = self.values[:-1] if held else 0.5 * (self.values[1:] + self.values[:-1])
        self.total = np.r_[0.0, np.cumsum(mean * steps)]
        self.steps = steps

    def at(self, times: Array) -> Array:
        """Values at times; NaN outside of the samples."""
        if self.t.size < 2:
            return np.full(times.shape, np.nan)
        return np.interp(times, self.t, self.values, left=np.nan, right=np.nan)

    def change(self, edges: Array) -> Array:
        """The change over each window, shape (edges - 1,)."""
        return np.diff(self.at(edges)) + self._unknown(edges)

    def integral(self, edges: Array) -> Array:
        """The integral over each window, shape (edges - 1,)."""
        if self.t.size < 2:
            return np.full(edges.size - 1, np.nan)
        return np.diff(np.interp(edges, self.t, self.total, left=np.nan, right=np.nan)) + self._unknown(edges)

    def _unknown(self, edges: Array) -> Array:
        """NaN in windows that a step of more than half their length touches, else 0."""
        unknown = np.zeros(edges.size - 1)
        long = self.steps > 0.5 * (edges[1] - edges[0])
        if 2 * int(long.sum()) > long.size:
            # Windows of this length are too short for the channel.
            return np.full(edges.size - 1, np.nan)
        for k in np.flatnonzero(long):
            first, last = np.searchsorted(edges, (self.t[k], self.t[k + 1]))
            unknown[max(first - 1, 0) : last] = np.nan
        return unknown


def edges_of(t: Array, length: float) -> Array | None:
    """The edges of windows of a length [s] side by side, or None where there are too few of them."""
    count = int((t[-1] - t[0]) / length)
    return t[0] + length * np.arange(count + 1) if count >= LEAST else None


def angle_course(t: Array, psi: Array) -> Course:
    """The course of an angle [rad] through whole turns."""
    there = np.isfinite(psi)
    turned = np.full(psi.shape, np.nan)
    turned[there] = unwrapped(psi[there])[0]
    return Course(t, turned)


def shortened(log: Log) -> Log:
    """The first samples of a log, without bounds of their errors."""
    columns = {k: x[:MOST] for k, x in log.columns.items()}
    return replace(log, t=log.t[:MOST], columns=columns, rounding={}, over={})
