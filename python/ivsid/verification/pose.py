"""Velocities from positions and headings, in fractions, for logs without a velocity sensor (docs/theory.md, "Sensor bounds").

The mean of a velocity over a window is an exact difference of two poses. The velocity at t differs from it by at most
A ((t - t_i)^2 + (t_j - t)^2) / (2 T), with A a bound of the acceleration in earth axes. Floats choose the window and the row whose
bound, carried over at the stated limit, is the narrowest; the choice is then computed exactly, and any choice gives a valid bound.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log
from ivsid.vehicle import Sensors
from ivsid.verification.decimals import Decimals
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rational import Range, cosine, pi, root, sided, sine

# Lengths of windows that are tried, as shares of the length at which sensor and acceleration contribute equally; every window is valid.
# Source: definition: the windows that the rows of a result try
SHARES: Final = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0)
Array = NDArray[np.float64]
# The reading of a channel at a row; None where it is missing.
Raw: TypeAlias = Callable[[str, int], Range | None]


@dataclass(frozen=True)
class _Proposal:
    """For each row: the window, and the row whose bound is carried over."""

    half: NDArray[np.int64]
    row: NDArray[np.int64]
    known: NDArray[np.bool_]


class PoseVelocities:
    """u, v [m/s], r [rad/s] at rows with a pose."""

    def __init__(
        self,
        log: Log,
        sensors: Sensors,
        exact: Decimals,
        raw: Raw,
        time: Callable[[int], Range],
        wanted: tuple[str, ...],
    ) -> None:
        self.log, self.raw, self.time, self.wanted = log, raw, time, wanted
        limits = sensors.limits
        assert sensors.heading is not None and limits.yaw_acceleration is not None
        self.moving = "u" in wanted
        self.heading, self.yaw = exact(sensors.heading.accuracy), exact(limits.yaw_acceleration)
        self.place = exact(sensors.position.accuracy) if sensors.position is not None else Range(0)
        self.limit = exact(limits.acceleration) if limits.acceleration is not None else Range(0)
        psi = log.columns["psi"]
        there = ~np.isnan(psi)
        turned = np.full(psi.shape, np.nan)
        turned[there] = np.unwrap(psi[there])
        self.turns = np.where(there, np.round((turned - psi) / (2 * np.pi)), 0.0).astype(np.int64)
        # Two readings less than pi - 2 e apart differ by the shorter way round, if the vehicle turned by less than pi.
        off = np.broadcast_to(sensors.heading.accuracy + log.rounding.get("psi", np.zeros(1)), psi.shape)[there]
        uncertain = np.zeros(psi.shape, dtype=np.int64)
        uncertain[np.flatnonzero(there)[1:]] = np.abs(np.diff(turned[there])) >= np.pi - off[1:] - off[:-1] - 1e-9
        self.piece = np.cumsum(uncertain)
        self.halves = self._windows(sensors)
        self._exact: dict[tuple[int, int], dict[str, Range]] = {}
        self._proposed = self._propose(turned)

    @classmethod
    def of(
        cls, log: Log, sensors: Sensors, exact: Decimals, raw: Raw, time: Callable[[int], Range]
    ) -> PoseVelocities | None:
        """The velocities that a log lacks and its pose gives; None where it lacks none, or the pose is not bounded."""
        limits, columns = sensors.limits, log.columns
        turn = "psi" in columns and sensors.heading is not None and limits.yaw_acceleration is not None
        move = (
            turn
            and "x" in columns
            and "y" in columns
            and sensors.position is not None
            and limits.acceleration is not None
        )
        wanted = tuple(n for n in ("u", "v", "r") if n not in columns and (turn if n == "r" else move))
        if not wanted or ("u" in columns) != ("v" in columns) or sensors.from_pose != "enclosed":
            return None
        return cls(log, sensors, exact, raw, time, wanted)

    def velocity(self, name: str, i: int) -> Range | None:
        """The range of a velocity at a row; None where no window covers it.

        Raises:
            UnprovedError: the bounds contradict each other.
        """
        lower, upper = self._proposed[name]
        if not lower.known[i]:
            return None
        rate = self.yaw if name == "r" else self.limit
        ends = []
        for proposal in (lower, upper):
            row = int(proposal.row[i])
            near = self._from_window(row, int(proposal.half[row]), name)
            apart = abs(self.time(i) - self.time(row)) if row != i else Range(0)
            ends.append(near + sided(rate * apart))
        if ends[0].lower > ends[1].upper:
            raise UnprovedError("the pose moves as no velocity within the limits can")
        return Range(ends[0].lower, ends[1].upper)

    def _windows(self, sensors: Sensors) -> list[int]:
        best = []
        if sensors.heading is not None and sensors.limits.yaw_acceleration is not None:
            best.append(np.sqrt(8 * sensors.heading.accuracy / sensors.limits.yaw_acceleration))
        if self.moving and sensors.position is not None and sensors.limits.acceleration is not None:
            best.append(np.sqrt(8 * sensors.position.accuracy / (np.sqrt(2.0) * sensors.limits.acceleration)))
        halves = {max(1, round(0.5 * s * b / self.log.period)) for b in best for s in SHARES}
        return sorted(h for h in halves if 2 * h < self.log.t.size)

    def turned(self, i: int) -> Range:
        """The heading of a row [rad], unwrapped."""
        return self._read("psi", i) + pi() * (2 * int(self.turns[i])) + sided(self.heading)

    def _read(self, name: str, i: int) -> Range:
        """A reading of a row that has a pose."""
        reading = self.raw(name, i)
        assert reading is not None
        return reading

    def _from_window(self, at: int, half: int, name: str) -> Range:
        key = (at, half)
        known = self._exact.setdefault(key, {})
        if name not in known:
            known.update(self._window(at, half, moving=name != "r"))
        return known[name]

    def _window(self, at: int, half: int, *, moving: bool) -> dict[str, Range]:
        psi0, psi1 = self.turned(at - half), self.turned(at + half)
        before = self.time(at) - self.time(at - half)
        after, span = self.time(at + half) - self.time(at), self.time(at + half) - self.time(at - half)
        weight = (before.square() + after.square()) / (span * 2)
        mean = (psi1 - psi0) / span
        found = {"r": mean + sided(weight * self.yaw)}
        if not moving:
            return found
        x0, y0, x1, y1 = (self._read(c, i) + sided(self.place) for i in (at - half, at + half) for c in ("x", "y"))
        own = root(Range(2)) * self.limit
        rate = (mean + sided(span * self.yaw / 2)).largest()
        north, east = (x1 - x0) / span, (y1 - y0) / span
        room = 1 - rate * span / 2
        speed = root(north.square() + east.square())
        fastest = (speed + own * span / 2) / Range(room.lower)
        off = sided((own + rate * fastest) * weight)
        heading = self.turned(at)
        c, s = cosine(heading), sine(heading)
        return {**found, "u": north * c + east * s + off, "v": east * c - north * s + off}

    def _propose(self, psi: Array) -> dict[str, tuple[_Proposal, _Proposal]]:
        """The window and the row whose bound is the narrowest at each row, in floats."""
        n, t = self.log.t.size, self.log.t
        low = {name: np.full(n, -np.inf) for name in self.wanted}
        high = {name: np.full(n, np.inf) for name in self.wanted}
        which = {(name, end): np.zeros(n, dtype=np.int64) for name in self.wanted for end in (0, 1)}
        for half in self.halves:
            at, bounds = self._approximate(psi, half)
            for name in self.wanted:
                middle, reach = bounds[name]
                better = (middle - reach > low[name][at]) & np.isfinite(middle)
                low[name][at[better]], which[name, 0][at[better]] = (middle - reach)[better], half
                better = (middle + reach < high[name][at]) & np.isfinite(middle)
                high[name][at[better]], which[name, 1][at[better]] = (middle + reach)[better], half
        made = {}
        for name in self.wanted:
            rate = float((self.yaw if name == "r" else self.limit).upper)
            known = np.isfinite(low[name])
            made[name] = (
                _Proposal(which[name, 0], _narrowest(-low[name], t, rate), known),
                _Proposal(which[name, 1], _narrowest(high[name], t, rate), known),
            )
        return made

    def _approximate(self, psi: Array, half: int) -> tuple[NDArray[np.int64], dict[str, tuple[Array, Array]]]:
        """Middle and half-width of each velocity, in floats; NaN where it has none."""
        t, n = self.log.t, self.log.t.size
        at = np.arange(half, n - half)
        i, j = at - half, at + half
        span = t[j] - t[i]
        weight = ((t[at] - t[i]) ** 2 + (t[j] - t[at]) ** 2) / (2 * span)
        error, yaw = float(self.heading.upper), float(self.yaw.upper)
        mean = np.where(self.piece[i] == self.piece[j], psi[j] - psi[i], np.nan) / span
        result = {"r": (mean, 2 * error / span + weight * yaw)}
        if not self.moving:
            return at, result
        x, y, off = self.log.columns["x"], self.log.columns["y"], 2 * float(self.place.upper) / span
        own = np.sqrt(2.0) * float(self.limit.upper)
        rate = np.abs(mean) + 2 * error / span + 0.5 * span * yaw
        north, east = (x[j] - x[i]) / span, (y[j] - y[i]) / span
        room = 1 - 0.5 * rate * span
        speed = np.hypot(np.abs(north) + off, np.abs(east) + off)
        fastest = (speed + 0.5 * own * span) / np.where(room > 1e-9, room, np.nan)
        reach = (own + rate * fastest) * weight
        north_range = (north - off, north + off)
        east_range = (east - off, east + off)
        c, s = _cosines(psi[at], error), _cosines(psi[at] - np.pi / 2, error)
        u = _sum(_product(north_range, c), _product(east_range, s))
        v = _sum(_product(east_range, c), _product((-north_range[1], -north_range[0]), s))
        for name, (least, most) in (("u", u), ("v", v)):
            here = 0.5 * (least + most) + 0.0 * x[at] * y[at] + 0.0 * mean
            result[name] = (here, 0.5 * (most - least) + reach)
        return at, result


Ends = tuple[Array, Array]


def _cosines(x: Array, error: float) -> Ends:
    """Least and largest cosine of the angles within ``error`` of x."""
    k = np.ceil((x - error) / np.pi)
    inside = k * np.pi <= x + error
    ends = np.cos(x - error), np.cos(x + error)
    low, high = np.minimum(*ends), np.maximum(*ends)
    return np.where(inside & (k % 2 == 1), -1.0, low), np.where(inside & (k % 2 == 0), 1.0, high)


def _product(a: Ends, b: Ends) -> Ends:
    corners = [p * q for p in a for q in b]
    return np.minimum.reduce(corners), np.maximum.reduce(corners)


def _sum(a: Ends, b: Ends) -> Ends:
    return a[0] + b[0], a[1] + b[1]


def _narrowest(bound: Array, t: Array, rate: float) -> NDArray[np.int64]:
    """For each row, the row k with the least ``bound[k] + rate |t - t_k|``."""

    def running(values: Array) -> NDArray[np.int64]:
        new = values < np.r_[np.inf, np.minimum.accumulate(values)[:-1]]
        return np.maximum.accumulate(np.where(new, np.arange(values.size), 0))

    before = running(bound - rate * t)
    after = (t.size - 1 - running((bound + rate * t)[::-1]))[::-1]
    near = np.arange(t.size)
    cost = [bound[k] + rate * np.abs(t - t[k]) for k in (before, after, near)]
    best = np.argmin(np.where(np.isfinite(cost), cost, np.inf), axis=0)
    return np.where(best == 0, before, np.where(best == 1, after, near))
