"""The static curve of a thruster in fractions: tables, polynomials, quadratics; dead band, limit and reverse factor."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Final, TypeAlias

from ivsid.files import units
from ivsid.vehicle import Thruster
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rational import Range, cosine, sided, sine
from ivsid.verification.readings import Readings
from ivsid.verification.rudders import Blade

# A demand at the curve's end may lie beyond it by the roundings of both decimals, each half a unit in the last place; this share of
# the demand is larger than all of them, and far below any accuracy.
# Source: definition: rounding of IEEE 754 doubles, 2^-53
EDGE: Final = Fraction(2, 10**12)

Forces: TypeAlias = tuple[Range, Range, Range]


class Curve:
    """The static curve of one thruster, over ranges of demands."""

    def __init__(self, thruster: Thruster, readings: Readings) -> None:
        self.thruster, self.exact = thruster, readings.exact
        self.neutral = self.exact(thruster.neutral)
        self.blade = None if thruster.rudder is None else Blade(thruster.rudder, self.exact)
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
        """Shares of a thrust in X, Y [1] and N [m], for a thruster that does not turn."""
        x, y = self.exact.pair(self.thruster.position)
        if self.thruster.azimuth == 0.0:
            return Range(1), Range(0), -y
        c, s = (f(self.exact(self.thruster.azimuth)) for f in (cosine, sine))
        return c, s, s * x - c * y

    @cached_property
    def slopes(self) -> list[Fraction]:
        """Slopes at the knots of the cubics (PCHIP; Fritsch and Carlson 1980, with their one-sided ends)."""
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
        """Demands, with those outside of the curve moved to its ends.

        Raises:
            UnprovedError: a demand may lie outside, and the vehicle file does not state ``outside = "hold"``.
        """
        if (covered := self.range) is None:
            return demand
        edge = covered.magnitude * EDGE
        if self.thruster.outside != "hold" and not demand.inside(covered.lower - edge, covered.upper + edge):
            raise UnprovedError(f"a demand of thruster {self.thruster.name} lies outside its curve")
        return clipped(demand, covered)

    def of_shaft(self, speed: Range) -> Range:
        """Thrust [N] at a shaft's speed; between rest and a curve that does not begin there, anything from 0 to the nearer end."""
        covered, rest = self.range, self.neutral
        assert covered is not None
        thrust = self.thrust(clipped(speed, covered))
        below, above = rest.low < covered.low, rest.high > covered.high
        starting = (below and speed.low < covered.low) or (above and speed.high > covered.high)
        return thrust.hull(Range(0)) if starting else thrust

    def _thrust(self, demand: Range) -> Range:
        t = self.thruster
        demand = self.inside(demand)
        force = self._as_stated(demand - self.neutral, self._over(demand - self.neutral))
        accuracy = t.accuracy
        return force + sided(self.exact(accuracy.absolute) + self.exact(accuracy.relative) * force.largest())

    def _over(self, d: Range) -> Range:
        t = self.thruster
        if t.table is not None:
            demand, thrust, _ = self.knots
            low, high = max(d.lower, demand[0]), min(d.upper, demand[-1])
            # PCHIP is monotone between its knots: the extremes stand at the ends and at the knots between them.
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

    def _as_stated(self, d: Range, force: Range) -> Range:
        """The force with the dead band, the limit and the reverse factor that the vehicle file states."""
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
    """A range with each end clipped to another range."""
    ends = [min(max(e, covered.low), covered.high) for e in (x.low, x.high)]
    return Range.raw(ends[0], ends[1])


def _end_slope(h: Fraction, h_next: Fraction, m: Fraction, m_next: Fraction) -> Fraction:
    slope = ((2 * h + h_next) * m - h * m_next) / (h + h_next)
    if slope * m <= 0:
        return Fraction(0)
    return 3 * m if m * m_next <= 0 and abs(slope) > 3 * abs(m) else slope
