"""Angles of directions, as ranges: the arctangent by a series with its remainder, and the span of a box of directions."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Final

from ivsid.verification.rational import ONE, Range, pi, root, sided

# Halvings of an angle of at most pi / 4: the tangent of the rest is below 1/10, so that the series converges fast.
# Source: theorem: half-angle formula, tan(a / 2) = tan a / (1 + sqrt(1 + tan^2 a))
HALVINGS: Final = 3
# Terms of the alternating series of the rest: the first one left out is below 10^-81.
# Source: theorem: Leibniz, remainder of an alternating series
TERMS: Final = 40
_ODD: Final = tuple(Range(Fraction(1, 2 * k + 1)) for k in range(TERMS + 1))


@lru_cache(maxsize=4096)
def arctangent(x: Fraction) -> Range:
    """The arctangent of one number [rad]."""
    if x < 0:
        return -arctangent(-x)
    if x > 1:
        return pi() / 2 - arctangent(1 / x)
    y = Range(x)
    for _ in range(HALVINGS):
        y = y / (root(y.square() + 1) + 1)
    square, total = y.square(), Range(0)
    for share in reversed(_ODD):
        total = share - square * total
    # The terms alternate and fall: the remainder is less than the first term left out.
    total = y * total + sided(Range(Fraction(1, 10 ** (2 * TERMS))))
    return total * (1 << HALVINGS)


def direction(y: Range, x: Range) -> Range:
    """All angles of (x, y) over a box, without a jump of a turn; every angle where the box holds the origin inside.

    The origin has no angle: one at the box's edge is left out.
    """
    if x.low >= 0:
        return _ahead(y, x)
    if y.low >= 0:
        return _ahead(-x, y) + pi() / 2
    if y.high <= 0:
        return _ahead(x, -y) - pi() / 2
    if x.high <= 0:
        return _ahead(-y, -x) + pi()
    return Range(-1, 1) * pi()


def _ahead(y: Range, x: Range) -> Range:
    """Angles over a box with x >= 0: the extremes stand at corners."""
    found = [_corner(a, b) for a in {y.low, y.high} for b in {x.low, x.high} if a or b]
    if not found:
        return Range(-1, 1) * pi()
    result = found[0]
    for more in found[1:]:
        result = result.hull(more)
    return result


def _corner(y: int, x: int) -> Range:
    if x == 0:
        return (pi() / 2) * (1 if y > 0 else -1)
    # Rounded outward: an arctangent rises by less than its argument.
    return arctangent(Fraction((y << 240) // x, 1 << 240)) + Range(0, Fraction(1, 1 << 240))


def nearest_turn(angle: Range) -> int:
    """The multiple of pi that is nearest to an angle's middle."""
    middle = Range.raw(angle.low + angle.high, angle.low + angle.high) / (pi() * 2)
    return round(Fraction(middle.low, ONE))
