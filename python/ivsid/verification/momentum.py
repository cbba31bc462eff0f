"""A bound of the momentum of surge and sway, proved once more in exact ranges (docs/theory.md, "Guaranteed simulation", "Momentum").

With ``p = (p_u, p_v)`` of one parameter for the whole run, columns of inertia are those of a turning frame: ``-r p_v`` in surge and ``r p_u``
in sway. The turn then does no work, and ``|p|`` grows by the forces less drag alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from math import isqrt
from typing import Final, TypeAlias

from ivsid.verification.rational import SCALE, Range
from ivsid.verification.turning import PAIRS, ROUNDED, Columns, Form

Vertex: TypeAlias = tuple[Range, ...]
# Factors of the accelerations by acceleration and channel.
Factors: TypeAlias = Sequence[Sequence[Range]]
# Parts of a quarter of the circle of directions.
# Source: resource: each costs the columns four times
QUARTER: Final = 4


class Momentum:
    """The momentum of a vehicle's surge and sway.

    Args:
        inertia: factors of the accelerations, by term (the known body last), acceleration and channel.
        vertices: of the parameters in surge and sway.
        columns: of all terms at given velocities, at rest of accelerations: by term and channel.
        forms: of the terms with inertia.
    """

    def __init__(
        self,
        inertia: Sequence[Factors],
        vertices: Sequence[Sequence[Vertex]],
        columns: Columns,
        forms: Sequence[list[Form] | None],
    ) -> None:
        self._columns = columns
        self._vertices = vertices
        self._inertia = inertia
        self._inertial = [any(abs(f[k][i]).high > 0 for k in range(3) for i in range(2)) for f in inertia]
        cosines = [Range(Fraction(k, QUARTER), Fraction(k + 1, QUARTER)) for k in range(QUARTER)]
        sines = [_root(Range(1) - c.square()) for c in cosines]
        self._directions = [
            (c * a, s * b) for c, s in zip(cosines, sines, strict=True) for a, b in product((1, -1), repeat=2)
        ]
        self._mass = [[self._hull(i, [f[k][i] for f in inertia]) for k in range(3)] for i in range(2)]
        self.turns = self._turns(forms)

    def _hull(self, i: int, parts: Sequence[Range]) -> Range:
        """The range of sum theta_j parts_j over the vertices of channel i, the known body counting once."""
        found: Range | None = None
        for vertex in self._vertices[i]:
            total = parts[-1]
            for value, part in zip(vertex, parts, strict=False):
                total = total + value * part
            found = total if found is None else found.hull(total)
        assert found is not None
        return found

    def _turns(self, forms: Sequence[list[Form] | None]) -> bool:
        """Whether the columns of inertia are those of a turning frame, and each of surge and sway has a momentum of its own."""
        mass = self._mass
        if mass[0][0].low <= 0 or mass[1][1].low <= 0 or abs(mass[0][1]).high or abs(mass[1][0]).high:
            return False
        for form, factors, inertial in zip(forms, self._inertia, self._inertial, strict=True):
            if not inertial:
                continue
            if form is None:
                return False
            for i, sign in ((0, -1), (1, 1)):
                # -r p_v in surge and r p_u in sway: each pair with r as its second takes a factor of the other channel.
                turned = [factors[a][1 - i] * sign if b == len(factors) - 1 else Range(0) for a, b in PAIRS]
                if any((x - y).magnitude > ROUNDED for x, y in zip(form[i], turned, strict=True)):
                    return False
        return True

    def size(self, nu: Sequence[Range]) -> Range:
        """``|p|`` over a box, at most, as a range of one number."""
        total = Range(0)
        for i in range(2):
            total = total + (self._mass[i][i] * nu[i] + self._mass[i][2] * nu[2]).square()
        return _root(total).largest()

    def after(self, c: Range, nu: Sequence[Range], force: Sequence[Range], h: Range) -> Range:
        """The bound after a part over the box ``nu``, from a bound c before it."""
        largest = self.size(nu)
        if largest.high <= c.high:
            return largest
        rate = 0
        for direction in self._directions:
            part = list(nu)
            for i in range(2):
                inside = (direction[i] * c.hull(largest) - self._mass[i][2] * nu[2]) / self._mass[i][i]
                part[i] = Range.raw(max(part[i].low, inside.low), min(part[i].high, inside.high))
            if any(x.low > x.high for x in part):
                continue
            columns = self._columns(part)
            power = Range(0)
            for i in range(2):
                drag = [Range(0) if inertial else x[i] for x, inertial in zip(columns, self._inertial, strict=True)]
                power = power + direction[i] * (force[i] - self._hull(i, drag))
            rate = max(rate, power.high)
        grown = c + Range.raw(rate, rate) * h.largest()
        # A little more, so that a momentum inside stays off the border of the box that the bound leaves.
        end = min(largest.high, grown.high + 1)
        return Range.raw(end, end)

    def within(self, c: Range, nu: Sequence[Range]) -> list[Range]:
        """A box cut to what ``|p| <= c`` leaves of it."""
        cut = list(nu)
        for i in range(2):
            inside = (Range.raw(-c.high, c.high) - self._mass[i][2] * nu[2]) / self._mass[i][i]
            cut[i] = Range.raw(max(nu[i].low, inside.low), min(nu[i].high, inside.high))
        return cut


def _root(x: Range) -> Range:
    """The square root of what is not negative, outward."""
    low, high = isqrt(max(x.low, 0) << SCALE), isqrt(max(x.high, 0) << SCALE) + 1
    return Range.raw(low, high)
