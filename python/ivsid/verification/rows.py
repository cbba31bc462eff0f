"""Rows of certificates recomputed from the log and the vehicle file, in fractions (docs/theory.md, "Rows")."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cached_property
from typing import Final

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import Vehicle
from ivsid.verification import physical
from ivsid.verification.columns import Row, Unknown, in_motion, moves, share, summed, value
from ivsid.verification.errors import UncheckedError, UnprovedError
from ivsid.verification.physics import CHANNELS, Column, Columns, Meaning, Motion, State, model, moving, rigid_body
from ivsid.verification.rational import Range, pi, sided
from ivsid.verification.readings import AXES, Readings
from ivsid.verification.thrusters import GAP, Thrusters
from ivsid.verification.unchecked import not_recomputed
from ivsid.verification.weak import Weak

HALF: Final = Range(Fraction(1, 2))
QUARTER: Final = Range(Fraction(1, 4))
# A step is one sample if it differs from the period by less than this share of it; a lost row would add a whole period.
# Source: geometry/physics: a step over a lost row is two periods long
WHOLE_STEP: Final = 0.1
_NO_ACCELERATION: Final = moving(0)
ACCELERATION: Final = {"x": "udot", "y": "vdot"}
KINDS: Final = ("pointwise", "integral", "weak", *(f"bias.{axis}" for axis in AXES), *physical.KINDS)


class Rows:
    """Rows of a model, made on demand and kept."""

    def __init__(
        self,
        log: Log,
        vehicle: Vehicle,
        form: str,
        *,
        apart: bool = False,
        windows: int = 1,
        assumed: bool = False,
    ) -> None:
        self.log, self.vehicle, self.windows, self.assumed = log, vehicle, windows, assumed
        self.readings = Readings(log, vehicle, apart=apart, windows=windows)
        self._counts: set[int] = set()
        self.thrusters = Thrusters(self.readings)
        self.terms: dict[str, Meaning] = model(vehicle, form)
        exact = self.readings.exact
        mass = exact(vehicle.hull.mass)
        x_g, y_g = exact.pair(vehicle.hull.centre_of_gravity)
        mx, my, left_out = mass * x_g, mass * y_g, mass if form == "added" else None
        self.known: Column = lambda s: rigid_body(s, mx, my, left_out)
        self.turning = any(id_.startswith("wind.") for id_ in self.terms)
        self.unknowns = {f"bias.{a}.{c}": (a, c) for a in self.readings.apart for c in CHANNELS if self._has_bias(a, c)}
        self.beyond = not_recomputed(log, vehicle)
        self.weak = Weak(self)
        self._made: dict[tuple[str, str, int, int], Row] = {}
        self._node: dict[int, State] = {}
        self._over: dict[int, State] = {}
        self._forces: dict[int, tuple[Range, Range, Range]] = {}
        self._columns: dict[tuple[str, int, bool], Columns] = {}
        self._parts: dict[tuple[str, str], tuple[tuple[tuple[str, Range], ...], bool]] = {}
        self._step: dict[tuple[str, int], dict[str, Range]] = {}
        self._length: dict[int, Range] = {}

    def row(self, kind: str, channel: str, time: float, duration: float) -> Row:
        """The row of a channel's equation that starts at a time of the log and lasts so long; 0 for a pointwise one.

        Raises:
            UnprovedError: no such row can be made, and why.
            UncheckedError: the checker cannot recompute rows of this log.
        """
        if channel not in CHANNELS:
            raise UnprovedError(f"there is no equation '{channel}'")
        if kind not in KINDS:
            raise UnprovedError(f"there is no row of the kind '{kind}'")
        if self.beyond is not None:
            raise UncheckedError(self.beyond)
        if kind == "weak" and self.readings.stream is not None:
            raise UnprovedError("the pose moves over ground, and the equations through a current")
        if kind.startswith("bias."):
            return self._bias(kind.removeprefix("bias."), channel)
        if kind in physical.KINDS:
            if not self.assumed or duration:
                raise UnprovedError("the options of the result assume no physical bounds, or the row has a duration")
            return physical.physical_row(self, kind, channel, time)
        if (duration > 0) != (kind in ("integral", "weak")):
            raise UnprovedError(f"a row of {duration!r} s is not of the kind '{kind}'")
        first, last = self.span(time, duration)
        key = (kind, channel, first, last)
        if key not in self._made:
            self._made[key] = self._row(*key)
        return self._made[key]

    def span(self, time: float, duration: float) -> tuple[int, int]:
        """The first and the last row of the log that a row stands on."""
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
        return first, last

    def _row(self, kind: str, channel: str, first: int, last: int) -> Row:
        if kind == "pointwise":
            return self._pointwise(channel, first)
        if kind == "weak":
            return self.weak.row(channel, first, last)
        self._counts.add(last - first)
        if len(self._counts) > self.windows:
            raise UnprovedError(f"its rows are of more than the {self.windows} lengths of window that were bounded")
        return self._integral(channel, first, last)

    def _has_bias(self, axis: str, channel: str) -> bool:
        """Whether an accelerometer's bias adds to a channel's equation."""
        columns = [self.known, *(m.columns for m in self.terms.values())]
        return any(share(c, ACCELERATION[axis], channel).magnitude for c in columns)

    def _bias(self, axis: str, channel: str) -> Row:
        """The row of an unknown bias: with C the sum of the coefficients of the acceleration, the unknown is the bias times C."""
        id_ = f"bias.{axis}.{channel}"
        if id_ not in self.unknowns:
            raise UnprovedError(f"no {id_} was taken apart")
        reach = self.readings.bias(axis)
        matrix = {k: reach * share(m.columns, ACCELERATION[axis], channel) for k, m in self.terms.items()}
        return Row({**matrix, id_: Range(1)}, reach * share(self.known, ACCELERATION[axis], channel))

    def _velocity(self, name: str, i: int) -> Range:
        x = self.readings.channel(name, i)
        if x is None:
            raise UnprovedError(f"{name} is missing or unbounded in row {i}")
        return x

    def _ambient(self, channel: str) -> Range:
        return self.readings.ambient[channel == "yaw"]

    def _pointwise(self, channel: str, i: int) -> Row:
        """The equation at a row of the log."""
        if not self.thrusters.present(i):
            raise UnprovedError(f"a demand or force is missing at t = {self.log.t[i]!r} s")
        u, v, r = (self._velocity(n, i) for n in ("u", "v", "r"))
        ax, ay = (self.readings.channel(n, i) for n in ("ax", "ay"))
        udot = self._derivative("udot", i, None if ax is None else ax + v * r)
        vdot = self._derivative("vdot", i, None if ay is None else ay - u * r)
        limit = self.vehicle.sensors.limits.yaw_acceleration
        bound = None if limit is None or self.readings.has("rdot") else sided(self.readings.exact(limit))
        psi = self._heading(i) if self.turning else None
        state = State(u, v, r, udot, vdot, self._derivative("rdot", i, bound), ax, ay, psi)
        force = self.thrusters.at_row(i, lambda: (u, v, r))[CHANNELS.index(channel)]
        matrix = {k: value(m.columns, state, channel) for k, m in self.terms.items()}
        matrix |= {id_: Range(-1) for id_, (_, c) in self.unknowns.items() if c == channel}
        return Row(matrix, force - value(self.known, state, channel) + self._ambient(channel))

    def _derivative(self, name: str, i: int, otherwise: Range | None) -> Range | Unknown:
        """A measured acceleration, or ``otherwise``; an ``Unknown`` without either, which must not be used."""
        x = self.readings.channel(name, i) if self.readings.has(name) else otherwise
        return Unknown(name) if x is None else x

    def _heading(self, i: int) -> Range:
        psi = self.readings.heading(i)
        if psi is None:
            raise UnprovedError(f"psi is missing or unbounded in row {i}")
        return psi

    def _integral(self, channel: str, first: int, last: int) -> Row:
        """The mean of the equation over a window: exact differences, and a quadrature with a bound of its error."""
        steps = np.diff(self.log.t[first : last + 1])
        if not (steps <= GAP * np.median(np.diff(self.log.t))).all():
            raise UnprovedError(f"the window from t = {self.log.t[first]!r} s has a gap")
        for i in range(first, last + 1):
            if not self.thrusters.present(i):
                raise UnprovedError(f"a demand or force is missing at t = {self.log.t[i]!r} s")
        span = self.readings.time(last) - self.readings.time(first)
        lengths = [self.step_length(k) for k in range(first, last)]
        index = CHANNELS.index(channel)
        forces = [self._forces_over(k)[index] for k in range(first, last)]
        known = self._mean("", self.known, channel, first, last, lengths, span)
        right = summed(forces, lengths) / span - known + self._ambient(channel)
        matrix = {k: self._mean(k, m.columns, channel, first, last, lengths, span) for k, m in self.terms.items()}
        return Row(matrix, right)

    def _forces_over(self, k: int) -> tuple[Range, Range, Range]:
        if k not in self._forces:
            self._forces[k] = self.thrusters.over_step(k, self.swept(k))
        return self._forces[k]

    def step_length(self, k: int) -> Range:
        """Time from a row to the next one [s]."""
        if k not in self._length:
            self._length[k] = self.readings.time(k + 1) - self.readings.time(k)
        return self._length[k]

    def _mean(
        self, id_: str, columns: Column, channel: str, first: int, last: int, lengths: list[Range], span: Range
    ) -> Range:
        total = Range(0)
        factors, moved = self._parts_of(id_, columns, channel)
        for name, factor in factors:
            total = total + self._difference(name, first, last, lengths) * factor / span
        if moved:
            means = [self.step_mean(id_, columns, channel, k) for k in range(first, last)]
            total = total + summed(means, lengths) / span
        return total

    def _parts_of(self, id_: str, columns: Column, channel: str) -> tuple[tuple[tuple[str, Range], ...], bool]:
        """The coefficients of the accelerations in a column, by velocity, and whether it depends on velocities."""
        if (id_, channel) not in self._parts:
            units = {"u": "udot", "v": "vdot", "r": "rdot"}
            factors = ((name, share(columns, unit, channel)) for name, unit in units.items())
            self._parts[id_, channel] = tuple(f for f in factors if f[1].magnitude), moves(columns, channel)
        return self._parts[id_, channel]

    def _difference(self, name: str, first: int, last: int, lengths: list[Range]) -> Range:
        """The difference of u, v or r over a window, also from the means of an averaging accelerometer and of v r or u r."""
        difference = self._velocity(name, last) - self._velocity(name, first)
        own = {"u": "ax", "v": "ay"}.get(name, "")
        if not self.readings.averages(own) or own in {*self.log.clocks, *self.log.by_rate}:
            return difference
        total, t = Range(0), self.log.t
        for k, length in zip(range(first, last), lengths, strict=True):
            mean = self.readings.average(own, k + 1)
            # After a lost row the reading averages over the last sample alone, not over the step.
            if mean is None or abs(t[k + 1] - t[k] - self.log.period) > WHOLE_STEP * self.log.period:
                return difference
            turning: Column = (lambda s: {own: s.v * s.r}) if name == "u" else (lambda s: {own: -(s.u * s.r)})
            total = total + (mean + self.step_mean(f"turning.{own}", turning, own, k)) * length
        low, high = max(difference.low, total.low), min(difference.high, total.high)
        if low > high:
            raise UnprovedError(f"{name} and its averaged acceleration contradict each other")
        return Range.raw(low, high)

    @cached_property
    def _limits(self) -> dict[str, Range]:
        limits = self.vehicle.sensors.limits
        if limits.acceleration is None or limits.yaw_acceleration is None:
            raise UnprovedError("a window needs [sensors.limits] acceleration and yaw_acceleration")
        a, y = self.readings.exact(limits.acceleration), self.readings.exact(limits.yaw_acceleration)
        return {"u": a, "v": a, "r": y}

    def _rates(self, k: int) -> dict[str, Range]:
        """Bounds of the rates of u, v, r over a step; a current turns in body axes as the vessel does under it."""
        stream, limits = self.readings.stream, self._limits
        if stream is None:
            return limits
        r = self._velocity("r", k).hull(self._velocity("r", k + 1)) + self.step_length(k) * HALF * sided(limits["r"])
        moved = stream * r.largest()
        return {"u": limits["u"] + moved, "v": limits["v"] + moved, "r": limits["r"]}

    def step_mean(self, id_: str, columns: Column, channel: str, k: int) -> Range:
        """The mean of a column over a step: trapezoid +- L h / 4, with L a bound of its rate of change over the step."""
        key = (id_, k)
        if key not in self._step:
            self._step[key] = {}
        done = self._step[key]
        if channel not in done:
            ends = [moving(self._columns_of(id_, columns, i, over=False)[channel]).value for i in (k, k + 1)]
            rate = moving(self._columns_of(id_, columns, k, over=True)[channel]).rate.largest()
            done[channel] = (ends[0] + ends[1]) * HALF + sided(rate) * self.step_length(k) * QUARTER
        return done[channel]

    def _columns_of(self, id_: str, columns: Column, i: int, *, over: bool) -> Columns:
        """A parameter's columns of all channels, with their rates of change, at a row or over the step after it."""
        key = (id_, i, over)
        if key not in self._columns:
            self._columns[key] = columns(self._step_state(i) if over else self._node_state(i))
        return self._columns[key]

    def step_range(self, columns: Column, channel: str, k: int) -> Range:
        """The range of a column over a step."""
        return in_motion(columns, self._step_state(k), channel).value

    def motion(self, i: int) -> Callable[[], tuple[Range, Range, Range]]:
        """u, v, r at a row."""
        return lambda: (self._velocity("u", i), self._velocity("v", i), self._velocity("r", i))

    def _node_state(self, i: int) -> State:
        if i not in self._node:
            u, v, r = (Motion(self._velocity(n, i), sided(self._limits[n])) for n in ("u", "v", "r"))
            psi = Motion(self._heading(i), r.value) if self.turning else None
            self._node[i] = State(u, v, r, _NO_ACCELERATION, _NO_ACCELERATION, _NO_ACCELERATION, psi=psi)
        return self._node[i]

    def _step_state(self, k: int) -> State:
        if k not in self._over:
            self._over[k] = self._made_over(k)
        return self._over[k]

    def _made_over(self, k: int) -> State:
        limits = self._rates(k)
        u, v, r = (Motion(x, sided(limits[n])) for n, x in zip(("u", "v", "r"), self.swept(k)(), strict=True))
        if not self.turning:
            return State(u, v, r, _NO_ACCELERATION, _NO_ACCELERATION, _NO_ACCELERATION)
        # The heading lies within half the possible turn of each of the two rows, on the way between them.
        turned = Range(0).hull(self.step_length(k)) * HALF * r.value
        end = self._heading(k + 1) + self.readings.whole_turns("psi", k)
        if (end - self._heading(k)).largest().high >= pi().low:
            raise UnprovedError(f"the way round after t = {self.log.t[k]!r} s is not certain")
        psi = Motion((self._heading(k) + turned).hull(end - turned), r.value)
        return State(u, v, r, _NO_ACCELERATION, _NO_ACCELERATION, _NO_ACCELERATION, psi=psi)

    def swept(self, k: int) -> Callable[[], tuple[Range, Range, Range]]:
        """The ranges of u, v, r over a step."""

        def ranges() -> tuple[Range, Range, Range]:
            limits = self._rates(k)
            made = [
                self._velocity(n, k).hull(self._velocity(n, k + 1)) + self.step_length(k) * HALF * sided(limits[n])
                for n in ("u", "v", "r")
            ]
            return made[0], made[1], made[2]

        return ranges
