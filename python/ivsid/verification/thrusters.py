"""Demands to forces in fractions: tables, polynomials, quadratics, and what the vehicle file claims beyond them."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Final, TypeAlias

import numpy as np

from ivsid import units
from ivsid.vehicle import Thruster
from ivsid.verification.errors import UncheckedError, UnprovedError
from ivsid.verification.rational import ONE, Range, cosine, exponential, pi, sided, sine, weighted
from ivsid.verification.readings import Readings

GAP: Final = 2.5
# What is left of a thrust after so many steps of a lag is far below a double's last place.
FORGOTTEN: Final = ONE >> 130
# Decimals of a demand and of the curve's end may round apart by this share of them.
EDGE: Final = Fraction(2, 10**12)

Forces: TypeAlias = tuple[Range, Range, Range]
Motion: TypeAlias = tuple[Range, Range, Range]


class Curve:
    """The static curve of one thruster, over ranges of demands."""

    def __init__(self, thruster: Thruster, readings: Readings) -> None:
        self.thruster, self.exact = thruster, readings.exact
        self.neutral = self.exact(thruster.neutral)
        self._known: dict[tuple[int, int], Range] = {}

    @cached_property
    def knots(self) -> tuple[list[Fraction], list[Fraction], bool]:
        """Demands, thrusts [N], and whether the first piece is straight."""
        table = self.thruster.table
        assert table is not None
        factor = Fraction(repr(units.FORCE[table.unit]))
        demand = [self.exact(d).lower for d in table.demand]
        thrust = [self.exact(f).lower * factor for f in table.thrust]
        straight = demand[0] > 0 and thrust[0] > 0
        return ([Fraction(0), *demand], [Fraction(0), *thrust], True) if straight else (demand, thrust, False)

    @cached_property
    def shares(self) -> Forces:
        """Of a thrust in X, Y and N, for a thruster that does not turn."""
        x, y = self.exact.pair(self.thruster.position)
        if self.thruster.azimuth == 0.0:
            return Range(1), Range(0), -y
        c, s = (f(self.exact(self.thruster.azimuth)) for f in (cosine, sine))
        return c, s, s * x - c * y

    @cached_property
    def slopes(self) -> list[Fraction]:
        """PCHIP's slopes at the knots that its cubics join (Fritsch and Carlson, with their one-sided ends)."""
        demand, thrust, straight = self.knots
        x, y = (demand[1:], thrust[1:]) if straight else (demand, thrust)
        h = [b - a for a, b in pairwise(x)]
        m = [(b - a) / s for (a, b), s in zip(pairwise(y), h, strict=True)]
        inner = []
        for k in range(1, len(h)):
            if m[k - 1] * m[k] <= 0:
                inner.append(Fraction(0))
                continue
            w, v = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
            inner.append((w + v) / (w / m[k - 1] + v / m[k]))
        if len(h) == 1:
            return [m[0], m[0]]
        return [_end_slope(h[0], h[1], m[0], m[1]), *inner, _end_slope(h[-1], h[-2], m[-1], m[-2])]

    def _at(self, d: Fraction) -> Fraction:
        """The table's thrust at one demand inside it."""
        demand, thrust, straight = self.knots
        k = min(max(bisect_right(demand, d) - 1, 0), len(demand) - 2)
        h, s = demand[k + 1] - demand[k], (d - demand[k]) / (demand[k + 1] - demand[k])
        if len(demand) == 2 or (straight and (k == 0 or len(demand) == 3)):
            return thrust[k] + s * (thrust[k + 1] - thrust[k])
        first = k - 1 if straight else k
        a, b = self.slopes[first], self.slopes[first + 1]
        left, right = (1 + 2 * s) * (1 - s) ** 2, s * s * (3 - 2 * s)
        return left * thrust[k] + right * thrust[k + 1] + h * (s * (1 - s) ** 2 * a - s * s * (1 - s) * b)

    @cached_property
    def range(self) -> Range | None:
        """The demands that the curve covers; None for a curve without end."""
        if self.thruster.table is not None:
            return Range(self.knots[0][0], self.knots[0][-1]) + self.neutral
        ends = self.thruster.demand_range
        return None if ends is None else Range(self.exact(ends[0]).lower, self.exact(ends[1]).upper) + self.neutral

    def thrust(self, demand: Range) -> Range:
        """Thrust [N] over a range of demands, with its accuracy.

        Raises:
            UnprovedError: a demand outside the table.
        """
        key = (demand.low, demand.high)
        if key not in self._known:
            self._known[key] = self._thrust(demand)
        return self._known[key]

    def inside(self, demand: Range) -> Range:
        """Demands with those outside of the curve held at its ends.

        Raises:
            UnprovedError: a demand may lie outside, and the vehicle file does not say that it is held there.
        """
        if (covered := self.range) is None:
            return demand
        edge = covered.magnitude * EDGE
        if self.thruster.outside != "hold" and not demand.inside(covered.lower - edge, covered.upper + edge):
            raise UnprovedError(f"a demand of thruster {self.thruster.name} lies outside its curve")
        return clipped(demand, covered)

    def of_shaft(self, speed: Range) -> Range:
        """The thrust at a shaft's speed; on its way from rest to a curve that does not begin there, anything between none and the nearer end's."""
        covered, rest = self.range, self.neutral
        assert covered is not None
        thrust = self.thrust(clipped(speed, covered))
        below, above = rest.low < covered.low, rest.high > covered.high
        starting = (below and speed.low < covered.low) or (above and speed.high > covered.high)
        return thrust.hull(Range(0)) if starting else thrust

    def _thrust(self, demand: Range) -> Range:
        t = self.thruster
        demand = self.inside(demand)
        force = self._claimed(demand - self.neutral, self._over(demand - self.neutral))
        accuracy = t.accuracy
        return force + sided(self.exact(accuracy.absolute) + self.exact(accuracy.relative) * force.largest())

    def _over(self, d: Range) -> Range:
        t = self.thruster
        if t.table is not None:
            demand, thrust, _ = self.knots
            low, high = max(d.lower, demand[0]), min(d.upper, demand[-1])
            # Monotone between its knots: the extremes stand at the ends and at the knots between.
            between = thrust[bisect_left(demand, low) : bisect_right(demand, high)]
            values = [self._at(low), self._at(high), *between]
            return Range(min(values), max(values))
        if t.quadratic is not None:
            ahead, astern = self.exact(t.quadratic.forward), self.exact(t.quadratic.astern)
            return d.positive_part().square() * ahead - d.negative_part().square() * astern
        total = Range(0)
        for c in t.polynomial if t.polynomial is not None else (t.gain or 0.0, 0.0):
            total = total * d + self.exact(c)
        return total

    def _claimed(self, d: Range, force: Range) -> Range:
        t = self.thruster
        if t.dead_band is not None:
            band = self.exact(t.dead_band)
            if d.magnitude < band.lower:
                force = Range(0)
            elif d.mignitude < band.upper:
                force = force.hull(Range(0))
        if t.limit is not None:
            cap = self.exact(t.limit).upper
            force = Range(min(max(force.lower, -cap), cap), min(max(force.upper, -cap), cap))
        if t.reverse_factor is not None:
            force = force.positive_part() + force.negative_part() * self.exact(t.reverse_factor)
        return force


def clipped(x: Range, covered: Range) -> Range:
    """Each end brought into another range."""
    ends = [min(max(e, covered.low), covered.high) for e in (x.low, x.high)]
    return Range.raw(ends[0], ends[1])


def _end_slope(h: Fraction, h_next: Fraction, m: Fraction, m_next: Fraction) -> Fraction:
    slope = ((2 * h + h_next) * m - h * m_next) / (h + h_next)
    if slope * m <= 0:
        return Fraction(0)
    return 3 * m if m * m_next <= 0 and abs(slope) > 3 * abs(m) else slope


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
        return all(self.readings.raw(n, i) is not None for n in names)

    def at_row(self, i: int, motion: Callable[[], Motion]) -> Forces:
        """X, Y [N], N [N m] at a row."""
        if not self.curves:
            x, y, n = (self._logged(name, i) for name in ("force_X", "force_Y", "moment_N"))
            return x, y, n
        return self._total([self._pushed(c, i, motion, over=False) for c in self.curves])

    def over_step(self, i: int, motion: Callable[[], Motion]) -> Forces:
        """Their means from a row to the next one."""
        if not self.curves:
            x, y, n = (self._between(name, i) for name in ("force_X", "force_Y", "moment_N"))
            return x, y, n
        return self._total([self._pushed(c, i, motion, over=True) for c in self.curves])

    def _between(self, name: str, i: int) -> Range:
        """A logged force over a step: from all samples that the log has there, else between the values of both rows."""
        swept = self._swept(name, i)
        if swept is None:
            return self._logged(name, i).hull(self._logged(name, i + 1))
        sensor = self.vehicle.sensors.moment if name == "moment_N" else self.vehicle.sensors.force
        if sensor is None:
            raise UnprovedError(f"nothing bounds {name}")
        return swept + sided(self.readings.exact(sensor.accuracy))

    def _swept(self, name: str, i: int) -> Range | None:
        """The readings of a channel over the step after a row; None where the rows are all that the log has."""
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
        if t.rudder is not None:
            raise UncheckedError(f"the force of the rudder behind thruster {t.name} is not recomputed by the checker")
        shares = self._shares(curve, i, over=over)
        if t.time_constant:
            at, mean = self._lagged(curve, i)
            thrust = mean if over else at
            swept = at.hull(self._lagged(curve, i + 1)[0]) if over and t.lag == "thrust" else thrust
        else:
            demand = self._demand(name, i)
            if over and not self.held:
                demand = demand.hull(self._demand(name, i + 1))
            thrust = swept = curve.thrust(demand)
        if t.advance_loss:
            x, y = curve.exact.pair(t.position)
            u, v, r = motion()
            inflow = (u - r * y) * shares[0] + (v + r * x) * shares[1]
            thrust = thrust - abs(swept) * inflow * curve.exact(t.advance_loss)
        return thrust * shares[0], thrust * shares[1], thrust * shares[2]

    def _shares(self, curve: Curve, i: int, *, over: bool) -> Forces:
        t = curve.thruster
        if t.steering == "azimuth":
            x, y = curve.exact.pair(t.position)
            angle = self._angle(f"azimuth_{t.name}", i, over=over)
            c, s = cosine(angle), sine(angle)
            return c, s, s * x - c * y
        return curve.shares

    def _angle(self, name: str, i: int, *, over: bool) -> Range:
        """An angle at a row, or all that it passes over the step after it."""
        here = self._demand(name, i)
        swept = self._swept(name, i) if over else None
        if swept is not None:
            return swept
        if not over or self.held:
            return here
        both = here.hull(self._demand(name, i + 1) + self.readings.whole_turns(name, i))
        # Where half a turn is not excluded, either way round is possible.
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
        """The lag's state at a row: from rest or all that the curve allows, at the last gap or long enough ago."""
        start = covered.hull(curve.neutral) if shaft else curve.thrust(covered).hull(Range(0))
        key = (self.curves.index(curve), i)
        if key in self._states:
            return self._states[key]
        # From a row whose state is known, a gap, or so long ago that what was then is forgotten.
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
