"""Angles of directions, as ranges: the arctangent by a series with its remainder, and what a box of directions spans."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Final

from ivsid.verification.rational import ONE, Range, pi, root, sided

# Halvings of an angle of at most pi / 4, and terms of the series of what is left, below 1/10: the rest is below 10^-81.
HALVINGS: Final = 3
TERMS: Final = 40


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
    for k in range(TERMS, -1, -1):
        total = Range(Fraction(1, 2 * k + 1)) - square * total
    # The terms alternate and fall: what is left out is less than the next one.
    total = y * total + sided(Range(Fraction(1, 10 ** (2 * TERMS))))
    return total * (1 << HALVINGS)


def direction(y: Range, x: Range) -> Range:
    """All angles of (x, y) over a box, on one way round; every angle where the box holds the origin inside.

    Of the origin itself, where it only stands at the box's edge, no angle is meant.
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
    """Where x is not negative: the extremes stand at corners."""
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
