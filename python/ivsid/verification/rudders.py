"""The force of a rudder in fractions: lift and drag of a foil over all angles of attack, times the dynamic pressure.

Over half a turn the lift rises from -stall to stall and falls from there to the next -stall; the drag is least along the flow and most
across it. Over a range of angles the extremes therefore stand at its ends, or at one of these angles within it.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Final, TypeAlias

from ivsid.vehicle import Rudder
from ivsid.verification.angles import direction, nearest_turn
from ivsid.verification.decimals import Decimals
from ivsid.verification.rational import Range, cosine, pi, root, sided, sine

Forces: TypeAlias = tuple[Range, Range, Range]
# Induced drag is C_L^2 / (pi e L) with this e, a rectangular blade's loss against an elliptic lift of the same aspect ratio L.
# Source: Bertram 2012
SPAN_EFFICIENCY: Final = Fraction(9, 10)
# Drag coefficient of a flat plate across the flow.
# Source: Hoerner 1965
PLATE: Final = Fraction(6, 5)


class Blade:
    """One rudder, with the decimals of the vehicle file."""

    def __init__(self, rudder: Rudder, exact: Decimals) -> None:
        self.area, self.place, self.density = (exact(x) for x in (rudder.area, rudder.position, rudder.density))
        self.stall, self.least, self.ratio = (exact(x) for x in (rudder.stall, rudder.drag, rudder.aspect_ratio))
        self.within = sided(exact(rudder.accuracy)) + 1
        width = rudder.propeller_diameter
        self.disc = None if width is None else exact(width).square() * pi() / 4
        # Slope of the lift of a low-aspect-ratio foil: 2 pi L (L + 0.7) / (L + 1.7)^2 (Soeding 1982).
        ratio = self.ratio
        self.slope = pi() * 2 * ratio * (ratio + Fraction(7, 10)) / (ratio + Fraction(17, 10)).square()
        self.most_lift = self.slope * sine(self.stall)

    def force(self, delta: Range, thrust: Range, motion: Forces) -> Forces:
        """X, Y [N] and N [N m] at an angle [rad], behind a thrust [N], with u, v [m/s], r [rad/s] through the water."""
        u, v, r = motion
        axial, across = self.axial(u, thrust), v + self.place * r
        alpha = delta + direction(across, axial)
        lift, drag = self.lift(alpha) * self.within, self.drag(alpha) * self.within
        pressure = root(axial.square() + across.square()) * self.density * self.area / 2
        surge = pressure * (lift * across - drag * axial)
        sway = -(pressure * (lift * axial + drag * across))
        return surge, sway, sway * self.place

    def axial(self, u: Range, thrust: Range) -> Range:
        """The water's speed along the hull at the blade [m/s]: a thrust T ahead adds 2 T / (rho A) to its square (momentum theory)."""
        squared = u.signed_square()
        if self.disc is not None:
            squared = squared + thrust.positive_part() * 2 / (self.disc * self.density)
        ahead, astern = root(squared.positive_part()), root(-squared.negative_part())
        return Range.raw(
            -astern.high if squared.low < 0 else ahead.low, -astern.low if squared.high < 0 else ahead.high
        )

    def lift(self, alpha: Range) -> Range:
        """C_L over a range of angles."""
        found = self._lift_at(alpha.lower).hull(self._lift_at(alpha.upper))
        if _passes(alpha, self.stall):
            found = found.hull(self.most_lift)
        return found.hull(-self.most_lift) if _passes(alpha, -self.stall) else found

    def drag(self, alpha: Range) -> Range:
        """C_D over a range of angles."""
        found = self._drag_at(alpha.lower).hull(self._drag_at(alpha.upper))
        if _passes(alpha, pi() / 2):
            found = found.hull(self._drag_from(pi() / 2))
        return found.hull(self.least) if _passes(alpha, Range(0)) else found

    def _lift_at(self, alpha: Fraction) -> Range:
        a = _reduced(alpha)
        attached = self.slope * sine(a)
        if abs(a).high <= self.stall.low:
            return attached
        past = (abs(a) - self.stall) / (pi() / 2 - self.stall)
        beyond = self.most_lift * cosine(past * pi() / 2) * (1 if a.high > 0 else -1)
        return beyond if abs(a).low > self.stall.high else beyond.hull(attached)

    def _drag_at(self, alpha: Fraction) -> Range:
        return self._drag_from(abs(_reduced(alpha)))

    def _drag_from(self, a: Range) -> Range:
        reached = Range.raw(min(a.low, self.stall.low), min(a.high, self.stall.high))
        induced = (self.slope * sine(reached)).square() / (pi() * SPAN_EFFICIENCY * self.ratio)
        plate = sine(a).square() - sine(reached).square()
        return self.least + induced + plate.positive_part() * PLATE


def _reduced(alpha: Fraction) -> Range:
    """An angle less the nearest multiple of pi."""
    angle = Range(alpha)
    return angle - pi() * nearest_turn(angle)


def _passes(alpha: Range, place: Range) -> bool:
    """Whether a range of angles may hold ``place`` plus a multiple of pi."""
    after = (alpha - place) / pi()
    first = -(-after.lower.numerator // after.lower.denominator)
    return (place + pi() * first).low <= alpha.high
