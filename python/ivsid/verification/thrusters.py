"""Demands to forces in fractions: lag, azimuth and advance loss, at rows and over the steps between them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Final, TypeAlias

import numpy as np

from ivsid.verification.curves import Curve, Forces, clipped
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rational import ONE, Range, cosine, exponential, pi, sided, sine, weighted
from ivsid.verification.readings import Readings

# A step longer than this many periods has lost a row, and perhaps a demand with it: halfway between one period and two.
# Source: geometry/physics: a step over a lost row is two periods long
GAP: Final = 1.5
# A lag's start is forgotten when its weight falls below 2^-130, far below the last place of a double.
# Source: definition: IEEE 754 binary64
FORGOTTEN: Final = ONE >> 130

Motion: TypeAlias = tuple[Range, Range, Range]


class Thrusters:
    """The forces of all thrusters at rows and over steps; logged forces where the vehicle file has no thrusters."""

    def __init__(self, readings: Readings) -> None:
        self.readings, self.log, self.vehicle = readings, readings.log, readings.vehicle
        self.held = self.vehicle.log.demand == "hold"
        self.curves = [Curve(t, readings) for t in self.vehicle.thrusters]
        self.whole_step = Fraction(5, 2) * Fraction(self.log.period)
        self._lag: dict[tuple[int, int], tuple[Range, Range]] = {}
        self._states: dict[tuple[int, int], Range] = {}
        self._decays: dict[tuple[int, int], tuple[Range, Range]] = {}

    def present(self, i: int) -> bool:
        """Whether every demand and angle, or every logged force, is known at a row."""
        if not self.curves:
            return all(self.readings.channel(n, i) is not None for n in ("force_X", "force_Y", "moment_N"))
        names = [f"demand_{t.name}" for t in self.vehicle.thrusters]
        names += [f"azimuth_{t.name}" for t in self.vehicle.thrusters if t.steering == "azimuth"]
        names += [f"rudder_{t.name}" for t in self.vehicle.thrusters if t.rudder is not None]
        return all(self.readings.raw(n, i) is not None for n in names)

    def at_row(self, i: int, motion: Callable[[], Motion]) -> Forces:
        """X, Y [N], N [N m] at a row."""
        if not self.curves:
            x, y, n = (self._logged(name, i) for name in ("force_X", "force_Y", "moment_N"))
            return x, y, n
        return self._total([self._pushed(c, i, motion, over=False) for c in self.curves])

    def over_step(self, i: int, motion: Callable[[], Motion]) -> Forces:
        """Means of X, Y [N], N [N m] from a row to the next one."""
        if not self.curves:
            x, y, n = (self._between(name, i) for name in ("force_X", "force_Y", "moment_N"))
            return x, y, n
        return self._total([self._pushed(c, i, motion, over=True) for c in self.curves])

    def _between(self, name: str, i: int) -> Range:
        """A logged force over a step: from the samples of the log within it, else between the values of both rows."""
        swept = self._swept(name, i)
        if swept is None:
            return self._logged(name, i).hull(self._logged(name, i + 1))
        sensor = self.vehicle.sensors.moment if name == "moment_N" else self.vehicle.sensors.force
        if sensor is None:
            raise UnprovedError(f"nothing bounds {name}")
        return swept + sided(self.readings.exact(sensor.accuracy))

    def _swept(self, name: str, i: int) -> Range | None:
        """The range of a channel's readings over the step after a row; None where the log has rows alone."""
        sweep = self.log.over.get(name)
        if sweep is None:
            return None
        lower, upper = float(sweep.lower[i]), float(sweep.upper[i])
        if not (np.isfinite(lower) and np.isfinite(upper)):
            raise UnprovedError(f"{name} is not known over the step after t = {self.log.t[i]!r} s")
        return Range(Fraction(lower), Fraction(upper))

    def _logged(self, name: str, i: int) -> Range:
        force = self.readings.channel(name, i)
        if force is None:
            raise UnprovedError(f"{name} is missing in row {i}")
        return force

    @staticmethod
    def _total(each: list[Forces]) -> Forces:
        zero = Range(0)
        return sum((f[0] for f in each), zero), sum((f[1] for f in each), zero), sum((f[2] for f in each), zero)

    def _demand(self, name: str, i: int) -> Range:
        demand = self.readings.raw(name, i)
        if demand is None:
            raise UnprovedError(f"{name} is missing in row {i}")
        return demand

    def _pushed(self, curve: Curve, i: int, motion: Callable[[], Motion], *, over: bool) -> Forces:
        t, name = curve.thruster, f"demand_{curve.thruster.name}"
        shares = self._shares(curve, i, over=over)
        delay = self.readings.carried.delay(t)
        if delay is not None:
            thrust, swept = self._late(curve, i, delay, over=over)
        elif t.time_constant:
            at, mean = self._lagged(curve, i)
            thrust = mean if over else at
            swept = at.hull(self._lagged(curve, i + 1)[0]) if over and t.lag == "thrust" else thrust
            if t.steering == "azimuth" and f"azimuth_{t.name}" in self.log.over:
                thrust = swept
        else:
            demand = self._demand(name, i)
            if over and not self.held:
                demand = demand.hull(self._demand(name, i + 1))
            thrust = swept = curve.thrust(demand)
        factor = self.readings.carried.factor(t)
        thrust, swept = thrust * factor, swept * factor
        if t.advance_loss:
            x, y = curve.exact.pair(t.position)
            u, v, r = motion()
            inflow = (u - r * y) * shares[0] + (v + r * x) * shares[1]
            lost = abs(swept) * inflow * curve.exact(t.advance_loss)
            thrust, swept = thrust - lost, swept - lost
        forces = thrust * shares[0], thrust * shares[1], thrust * shares[2]
        if curve.blade is None:
            return forces
        blade = curve.blade.force(self._angle(f"rudder_{t.name}", i, over=over), swept, motion())
        return forces[0] + blade[0], forces[1] + blade[1], forces[2] + blade[2]

    def _late(self, curve: Curve, i: int, delay: Range, *, over: bool) -> tuple[Range, Range]:
        """Thrust at a row, or its mean over the step after it, of held demands that arrive late, and its range there."""
        last = i + 1 if over else i
        times, log = self.readings.time, self.log
        # Demands that have surely arrived before the end, back to one that has surely arrived at the start.
        begin, end = times(i) - delay, times(last) - delay
        k = last
        while k >= 0 and times(k).low > end.high:
            k -= 1
        acting = [k]
        while acting[-1] >= 0 and times(acting[-1]).high > begin.low:
            acting.append(acting[-1] - 1)
        if acting[-1] < 0:
            raise UnprovedError(f"the demand that acts at t = {log.t[i]!r} s was sent before the log")
        if not all(j + 1 >= log.t.size or self._kept(curve, j) for j in acting):
            raise UnprovedError(f"a demand that acts at t = {log.t[i]!r} s is missing")
        thrusts = [curve.thrust(self._demand(f"demand_{curve.thruster.name}", j)) for j in acting]
        swept = thrusts[0]
        for thrust in thrusts[1:]:
            swept = swept.hull(thrust)
        if not over or len(acting) != 2:
            return swept, swept
        step = times(last) - times(i)
        share = (end - times(acting[0])) / step
        return weighted(clipped(share, Range(0, 1)), thrusts[0], thrusts[1]), swept

    def _kept(self, curve: Curve, k: int) -> bool:
        """Whether the step after a row has lost no row, and its demand is known."""
        step = Fraction(float(self.log.t[k + 1])) - Fraction(float(self.log.t[k]))
        known = not np.isnan(self.log.columns[f"demand_{curve.thruster.name}"][k])
        return step <= Fraction(3, 2) * Fraction(self.log.period) and known

    def _shares(self, curve: Curve, i: int, *, over: bool) -> Forces:
        t = curve.thruster
        if t.steering == "azimuth":
            x, y = curve.exact.pair(t.position)
            angle = self._angle(f"azimuth_{t.name}", i, over=over)
            c, s = cosine(angle), sine(angle)
            return c, s, s * x - c * y
        return curve.shares

    def _angle(self, name: str, i: int, *, over: bool) -> Range:
        """An angle at a row, or its range over the step after it."""
        here = self._demand(name, i)
        swept = self._swept(name, i) if over else None
        if swept is not None:
            return swept
        if not over or self.held:
            return here
        both = here.hull(self._demand(name, i + 1) + self.readings.whole_turns(name, i))
        # A range of half a turn or more leaves both ways round possible.
        return both if (both.upper - both.lower) < pi().lower else Range(-4, 4)

    def _lagged(self, curve: Curve, i: int) -> tuple[Range, Range]:
        """Thrust at a row and its mean over the step after it, behind a first-order lag of held demands."""
        key = (self.curves.index(curve), i)
        if key in self._lag:
            return self._lag[key]
        covered = curve.range
        if covered is None or not self.held:
            raise UnprovedError(f"the lag of thruster {curve.thruster.name} has no start, or its demands are not held")
        shaft = curve.thruster.lag == "demand"
        state = self._state(curve, i, covered, shaft=shaft)
        if not shaft:
            goal, share = self._goal(curve, i, shaft=False), self._decay(curve, i)[1]
            made = state, state if goal is None else weighted(share, state, goal)
        else:
            following = self._state(curve, i + 1, covered, shaft=True) if i + 1 < self.log.t.size else state
            made = curve.of_shaft(state), curve.of_shaft(state.hull(following))
        self._lag[key] = made
        return made

    def _goal(self, curve: Curve, i: int, *, shaft: bool) -> Range | None:
        demand = self.readings.raw(f"demand_{curve.thruster.name}", i)
        if demand is None:
            return None
        return curve.inside(demand) if shaft else curve.thrust(demand)

    def _decay(self, curve: Curve, i: int) -> tuple[Range, Range]:
        """e^(-h / tau) over the step after a row, and the share of the start in the mean over it."""
        if i + 1 >= self.log.t.size:
            return Range(1), Range(1)
        key = (self.curves.index(curve), i)
        if key not in self._decays:
            step = self.readings.time(i + 1) - self.readings.time(i)
            ratio = step / curve.exact(curve.thruster.time_constant or 0.0)
            decay = exponential(-ratio)
            self._decays[key] = decay, (1 - decay) / ratio
        return self._decays[key]

    def _state(self, curve: Curve, i: int, covered: Range, *, shaft: bool) -> Range:
        """The lag's state at a row, from a start at the last gap or long enough ago: rest, or any state that the curve allows."""
        start = covered.hull(curve.neutral) if shaft else curve.thrust(covered).hull(Range(0))
        key = (self.curves.index(curve), i)
        if key in self._states:
            return self._states[key]
        # The start: a row whose state is known, a gap, or a row whose weight is forgotten.
        k, left = i, Range(1)
        while k > 0 and left.high > FORGOTTEN and self._whole(curve, k - 1):
            k -= 1
            left = left * self._decay(curve, k)[0]
            if (key[0], k) in self._states:
                start = self._states[key[0], k]
                break
        state = start
        for j in range(k, i):
            goal = self._goal(curve, j, shaft=shaft)
            assert goal is not None
            state = weighted(self._decay(curve, j)[0], state, goal)
        self._states[key] = state
        return state

    def _whole(self, curve: Curve, k: int) -> bool:
        t, name = self.log.t, f"demand_{curve.thruster.name}"
        step = Fraction(float(t[k + 1])) - Fraction(float(t[k]))
        return step <= self.whole_step and not np.isnan(self.log.columns[name][k : k + 2]).any()
