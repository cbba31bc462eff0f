"""Accelerations from velocities under a stated jerk, in fractions.

The mean of an acceleration over a window is an exact difference of two velocities, and the acceleration at t differs from it by at
most J ((t - t_i)^2 + (t_j - t)^2) / (2 T) (docs/theory.md, "Sensor bounds"). Every window gives a valid bound.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property
from typing import Final, Protocol

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import Limits
from ivsid.verification.decimals import Decimals
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rational import Range, sided

# Lengths of windows, as shares of the length at which reading and jerk contribute equally.
# Source: definition: the windows that the rows of a result try
SHARES: Final = (0.5, 0.7, 1.0, 1.4)
# All lengths within this factor of those are tried, since the best length is estimated from a few rows. The factor exceeds the square
# root of the ratio of neighbouring shares, 1.2, so that no length between two shares is left out.
# Source: geometry/physics: overlap of the neighbourhoods of ``SHARES``
AROUND: Final = 1.25
# Rows from which the usual width of a velocity is estimated, which only chooses the windows.
# Source: resource: time of exact ranges
SAMPLED: Final = 101
# For each acceleration its velocity, and the channels that would measure it.
_SOURCES: Final = {"udot": ("u", ("udot", "ax")), "vdot": ("v", ("vdot", "ay")), "rdot": ("r", ("rdot",))}


class Source(Protocol):
    """A source of velocities."""

    def time(self, i: int) -> Range:
        """The time of a row [s]."""

    def logged(self, name: str) -> bool:
        """Whether a channel is logged and bounded."""

    def channel(self, name: str, i: int) -> Range | None:
        """The value of a channel at a row."""


class Rates:
    """udot, vdot [m/s^2], rdot [rad/s^2] where they are not measured and the vehicle file states their limits."""

    def __init__(self, log: Log, limits: Limits, exact: Decimals, source: Source) -> None:
        self.log, self.limits, self.exact, self.source = log, limits, exact, source
        self._lengths: dict[str, list[tuple[int, int]]] = {}

    def made(self, name: str) -> bool:
        """Whether this acceleration follows from its velocity."""
        if name not in _SOURCES or self._of(name)[1] is None:
            return False
        velocity, measured = _SOURCES[name]
        return self.source.logged(velocity) and not any(self.source.logged(m) for m in measured)

    def _of(self, name: str) -> tuple[float | None, float | None]:
        limits = self.limits
        if name == "rdot":
            return limits.yaw_acceleration, limits.yaw_jerk
        return limits.acceleration, limits.jerk

    def rate(self, name: str, i: int) -> Range | None:
        """The acceleration at a row; None where no window and no limit bounds it."""
        velocity = _SOURCES[name][0]
        limit, jerk = self._of(name)
        found = [] if limit is None else [sided(self.exact(limit))]
        if name not in self._lengths:
            self._lengths[name] = [] if jerk is None else list(self._windows(velocity, jerk))
        for before, after in self._lengths[name]:
            if i - before < 0 or i + after >= self.log.t.size:
                continue
            first, last = self.source.channel(velocity, i - before), self.source.channel(velocity, i + after)
            if first is None or last is None:
                continue
            start, now, end = (self.source.time(k) for k in (i - before, i, i + after))
            weight = ((now - start).square() + (end - now).square()) / ((end - start) * 2)
            found.append((last - first) / (end - start) + sided(weight * self.exact(jerk or 0.0)))
        if not found:
            return None
        lower, upper = max(f.low for f in found), min(f.high for f in found)
        if lower > upper:
            raise UnprovedError(f"no {name} at t = {self.log.t[i]!r} s fits all windows")
        return Range.raw(lower, upper)

    @cached_property
    def _rows(self) -> list[int]:
        return [int(k) for k in np.unique(np.linspace(0, self.log.t.size - 1, SAMPLED).astype(np.int64))]

    def _windows(self, velocity: str, jerk: float) -> Iterator[tuple[int, int]]:
        """Rows before and after: where reading and jerk contribute equally, and near that; one-sided windows for the ends."""
        known = [x for k in self._rows if (x := self.source.channel(velocity, k)) is not None]
        if not known:
            return
        width = float(np.median([float(Fraction(x.upper - x.lower)) for x in known]))
        best = np.sqrt(4 * width / jerk) / self.log.period
        halves: set[int] = set()
        for share in SHARES:
            halves |= set(range(max(1, int(0.5 * share * best / AROUND)), int(0.5 * share * best * AROUND) + 3))
        yield from ((h, h) for h in sorted(halves))
        for sided_ in range(max(1, int(0.7 * best / AROUND)), int(0.7 * best * AROUND) + 3):
            yield sided_, 0
            yield 0, sided_
