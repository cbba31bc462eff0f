"""A certificate's row once more from the log and the vehicle file, in fractions (METHODS 5.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Final

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import Vehicle
from ivsid.verification.physics import CHANNELS, Column, Columns, Meaning, Motion, State, model, moving, rigid_body
from ivsid.verification.rational import Range, sided
from ivsid.verification.readings import Readings
from ivsid.verification.thrusters import Thrusters, UnprovedError

HALF: Final = Range(Fraction(1, 2))
QUARTER: Final = Range(Fraction(1, 4))
_STILL: Final = moving(0)


@dataclass(frozen=True)
class Row:
    """The left-hand side by parameter and the right-hand side [N or N m], as ranges that hold the truth."""

    matrix: dict[str, Range]
    right: Range


class Rows:
    """Rows of a model, made when they are asked for."""

    def __init__(self, log: Log, vehicle: Vehicle, form: str) -> None:
        self.log, self.vehicle = log, vehicle
        self.readings = Readings(log, vehicle)
        self.thrusters = Thrusters(self.readings)
        self.terms: dict[str, Meaning] = model(vehicle, form)
        exact = self.readings.exact
        mass = exact(vehicle.hull.mass)
        x_g, y_g = exact.pair(vehicle.hull.centre_of_gravity)
        mx, my, left_out = mass * x_g, mass * y_g, mass if form == "added" else None
        self.known: Column = lambda s: rigid_body(s, mx, my, left_out)
        self._made: dict[tuple[str, int, int], Row] = {}
        self._node: dict[int, State] = {}
        self._step: dict[tuple[str, int], dict[str, Range]] = {}
        self._length: dict[int, Range] = {}

    def row(self, channel: str, time: float, duration: float) -> Row:
        """The row of a channel's equation that starts at a time of the log and lasts so long; 0 for a pointwise one.

        Raises:
            UnprovedError: no such row can be made, and why.
        """
        if channel not in CHANNELS:
            raise UnprovedError(f"there is no equation '{channel}'")
        t = self.log.t
        first = int(np.searchsorted(t, time))
        if first >= t.size or t[first] != time:
            raise UnprovedError(f"the log has no sample at t = {time!r} s")
        last = first
        if duration:
            near = int(np.searchsorted(t, time + duration))
            ends = [k for k in (near - 1, near, near + 1) if first < k < t.size and t[k] - t[first] == duration]
            if not ends:
                raise UnprovedError(f"the log has no window of {duration!r} s from t = {time!r} s")
            last = ends[0]
        key = (channel, first, last)
        if key not in self._made:
            self._made[key] = self._integral(*key) if duration else self._pointwise(channel, first)
        return self._made[key]

    def _velocity(self, name: str, i: int) -> Range:
        x = self.readings.channel(name, i)
        if x is None:
            raise UnprovedError(f"{name} is missing or unbounded in row {i}")
        return x

    def _ambient(self, channel: str) -> Range:
        return self.readings.ambient[channel == "yaw"]

    def _pointwise(self, channel: str, i: int) -> Row:
        """The equation at a sample."""
        if not self.thrusters.present(i):
            raise UnprovedError(f"a demand or force is missing at t = {self.log.t[i]!r} s")
        u, v, r = (self._velocity(n, i) for n in ("u", "v", "r"))
        ax, ay = (self.readings.channel(n, i) for n in ("ax", "ay"))
        udot = self._derivative("udot", i, None if ax is None else ax + v * r)
        vdot = self._derivative("vdot", i, None if ay is None else ay - u * r)
        limit = self.vehicle.sensors.limits.yaw_acceleration
        bound = None if limit is None or self.readings.has("rdot") else sided(self.readings.exact(limit))
        state = State(u, v, r, udot, vdot, self._derivative("rdot", i, bound), ax, ay)
        force = self.thrusters.at_row(i, lambda: (u, v, r))[CHANNELS.index(channel)]
        matrix = {k: _value(m.columns, state, channel) for k, m in self.terms.items()}
        return Row(matrix, force - _value(self.known, state, channel) + self._ambient(channel))

    def _derivative(self, name: str, i: int, otherwise: Range | None) -> Any:
        """A measured acceleration, or what follows from others; what is not known must not be used."""
        x = self.readings.channel(name, i) if self.readings.has(name) else otherwise
        return _Unknown(name) if x is None else x

    def _integral(self, channel: str, first: int, last: int) -> Row:
        """The mean of the equation over a window: exact differences, and a quadrature with its error."""
        steps = np.diff(self.log.t[first : last + 1])
        if not (steps <= 2.5 * np.median(np.diff(self.log.t))).all():
            raise UnprovedError(f"the window from t = {self.log.t[first]!r} s has a gap")
        for i in range(first, last + 1):
            if not self.thrusters.present(i):
                raise UnprovedError(f"a demand or force is missing at t = {self.log.t[i]!r} s")
        span = self.readings.time(last) - self.readings.time(first)
        lengths = [self._step_length(k) for k in range(first, last)]
        index = CHANNELS.index(channel)
        forces = [self.thrusters.over_step(k, self._swept(k))[index] for k in range(first, last)]
        known = self._mean("", self.known, channel, first, last, lengths, span)
        right = _total(forces, lengths) / span - known + self._ambient(channel)
        matrix = {k: self._mean(k, m.columns, channel, first, last, lengths, span) for k, m in self.terms.items()}
        return Row(matrix, right)

    def _step_length(self, k: int) -> Range:
        if k not in self._length:
            self._length[k] = self.readings.time(k + 1) - self.readings.time(k)
        return self._length[k]

    def _mean(
        self, id_: str, columns: Column, channel: str, first: int, last: int, lengths: list[Range], span: Range
    ) -> Range:
        total = Range(0)
        for name, unit in (("u", "udot"), ("v", "vdot"), ("r", "rdot")):
            factor = _value(columns, _at_rest(unit), channel)
            if factor.magnitude:
                total = total + (self._velocity(name, last) - self._velocity(name, first)) * factor / span
        if self._moves(columns, channel):
            means = [self._step_mean(id_, columns, channel, k) for k in range(first, last)]
            total = total + _total(means, lengths) / span
        return total

    @staticmethod
    def _moves(columns: Column, channel: str) -> bool:
        """Whether velocities stand in a column, asked at two states."""
        states = [State(*(Range(Fraction(x, 10)) for x in (*v, 0, 0, 0))) for v in ((3, 7, 11), (-9, 4, -2))]
        return any(_value(columns, s, channel).magnitude for s in states)

    @cached_property
    def _limits(self) -> dict[str, Range]:
        limits = self.vehicle.sensors.limits
        if limits.acceleration is None or limits.yaw_acceleration is None:
            raise UnprovedError("a window needs [sensors.limits] acceleration and yaw_acceleration")
        a, y = self.readings.exact(limits.acceleration), self.readings.exact(limits.yaw_acceleration)
        return {"u": a, "v": a, "r": y}

    def _step_mean(self, id_: str, columns: Column, channel: str, k: int) -> Range:
        """Trapezoid +- L h / 4, L bounding the rate of change over the step."""
        key = (id_, k)
        if key not in self._step:
            self._step[key] = {}
        done = self._step[key]
        if channel not in done:
            ends = [_moving(columns, self._node_state(i), channel).value for i in (k, k + 1)]
            rate = _moving(columns, self._step_state(k), channel).rate.largest()
            done[channel] = (ends[0] + ends[1]) * HALF + sided(rate) * self._step_length(k) * QUARTER
        return done[channel]

    def _node_state(self, i: int) -> State:
        if i not in self._node:
            u, v, r = (Motion(self._velocity(n, i), sided(self._limits[n])) for n in ("u", "v", "r"))
            self._node[i] = State(u, v, r, _STILL, _STILL, _STILL)
        return self._node[i]

    def _step_state(self, k: int) -> State:
        u, v, r = (Motion(x, sided(self._limits[n])) for n, x in zip(("u", "v", "r"), self._swept(k)(), strict=True))
        return State(u, v, r, _STILL, _STILL, _STILL)

    def _swept(self, k: int) -> Callable[[], tuple[Range, Range, Range]]:
        """All that u, v, r can be over a step."""

        def ranges() -> tuple[Range, Range, Range]:
            made = [
                self._velocity(n, k).hull(self._velocity(n, k + 1))
                + self._step_length(k) * HALF * sided(self._limits[n])
                for n in ("u", "v", "r")
            ]
            return made[0], made[1], made[2]

        return ranges


class _Unknown:
    """An acceleration that nothing bounds: it may stand in a column that is not used, and in no other."""

    def __init__(self, name: str) -> None:
        self.name = name

    def _used(self, *_: Any) -> _Unknown:
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __neg__ = _used


def _value(columns: Column, state: State, channel: str) -> Range:
    column = columns(state).get(channel)
    if isinstance(column, _Unknown):
        raise UnprovedError(f"{column.name} is neither measured nor bounded")
    return Range(0) if column is None else column


def _moving(columns: Callable[[State], Columns], state: State, channel: str) -> Motion:
    return moving(columns(state)[channel])


def _at_rest(derivative: str) -> State:
    """With one unit acceleration."""
    rates = [Range(int(derivative == name)) for name in ("udot", "vdot", "rdot")]
    return State(Range(0), Range(0), Range(0), *rates)


def _total(per_step: list[Range], lengths: list[Range]) -> Range:
    total = Range(0)
    for mean, length in zip(per_step, lengths, strict=True):
        total = total + mean * length
    return total
