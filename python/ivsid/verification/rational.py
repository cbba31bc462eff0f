"""Intervals of fractions, and enclosures of what is irrational: roots, angles, exponentials, the normal distribution.

Nothing here is a float operation: sums, products and quotients are exact until their fractions grow long, and are then rounded
outward to 256 bits. A number that a double holds exactly is never rounded.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import isqrt
from statistics import NormalDist
from typing import Final, TypeAlias

# Fractions with longer denominators are rounded outward to BITS significant bits.
LONG: Final = 640
BITS: Final = 256
ZERO: Final = Fraction(0)

Number: TypeAlias = "Range | Fraction | int"


def _short(x: Fraction, *, up: bool) -> Fraction:
    if x.denominator.bit_length() <= LONG:
        return x
    shift = BITS - x.numerator.bit_length() + x.denominator.bit_length()
    scaled = (x.numerator << shift) if shift >= 0 else x.numerator
    divisor = x.denominator if shift >= 0 else x.denominator << -shift
    whole = -(-scaled // divisor) if up else scaled // divisor
    return Fraction(whole, 1 << shift) if shift >= 0 else Fraction(whole << -shift)


class Range:
    """A closed interval of fractions; the operators hold every result of members."""

    __slots__ = ("lower", "upper")

    def __init__(self, lower: Fraction | int, upper: Fraction | int | None = None) -> None:
        low, high = lower, lower if upper is None else upper
        self.lower = _short(low if isinstance(low, Fraction) else Fraction(low), up=False)
        self.upper = _short(high if isinstance(high, Fraction) else Fraction(high), up=True)

    def __repr__(self) -> str:
        return f"[{float(self.lower)!r}, {float(self.upper)!r}]"

    def __add__(self, other: Number) -> Range:
        o = to_range(other)
        return Range(self.lower + o.lower, self.upper + o.upper)

    __radd__ = __add__

    def __neg__(self) -> Range:
        return Range(-self.upper, -self.lower)

    def __sub__(self, other: Number) -> Range:
        o = to_range(other)
        return Range(self.lower - o.upper, self.upper - o.lower)

    def __rsub__(self, other: Number) -> Range:
        return to_range(other) - self

    def __mul__(self, other: Number) -> Range:
        o = to_range(other)
        if self.lower >= 0 and o.lower >= 0:
            return Range(self.lower * o.lower, self.upper * o.upper)
        ends = [a * b for a in (self.lower, self.upper) for b in (o.lower, o.upper)]
        return Range(min(ends), max(ends))

    __rmul__ = __mul__

    def __truediv__(self, other: Number) -> Range:
        o = to_range(other)
        if o.lower <= 0 <= o.upper:
            raise ZeroDivisionError("a divisor may be 0")
        return self * Range(1 / o.upper, 1 / o.lower)

    def __abs__(self) -> Range:
        return Range(self.mignitude, self.magnitude)

    @property
    def magnitude(self) -> Fraction:
        """The largest absolute value."""
        return max(-self.lower, self.upper)

    @property
    def mignitude(self) -> Fraction:
        """The smallest absolute value."""
        return max(self.lower, -self.upper, ZERO)

    def square(self) -> Range:
        """``x^2``."""
        return Range(self.mignitude**2, self.magnitude**2)

    def signed_square(self) -> Range:
        """``x |x|``."""
        return Range(self.lower * abs(self.lower), self.upper * abs(self.upper))

    def negative_part(self) -> Range:
        """``min(x, 0)``."""
        return Range(min(self.lower, ZERO), min(self.upper, ZERO))

    def positive_part(self) -> Range:
        """``max(x, 0)``."""
        return Range(max(self.lower, ZERO), max(self.upper, ZERO))

    def hull(self, other: Range) -> Range:
        """The smallest range that holds both."""
        return Range(min(self.lower, other.lower), max(self.upper, other.upper))

    def inside(self, lower: Fraction, upper: Fraction) -> bool:
        """Whether all of it lies between two numbers."""
        return lower <= self.lower and self.upper <= upper


def to_range(x: Number) -> Range:
    """A number as the range of it alone."""
    return x if isinstance(x, Range) else Range(x)


def sided(reach: Number) -> Range:
    """All that is at most ``reach`` from 0."""
    top = to_range(reach).upper
    return Range(-top, top)


def root(x: Range) -> Range:
    """Square root of what is not negative."""

    def of(value: Fraction, *, up: bool) -> Fraction:
        shift = max(2 * BITS - value.numerator.bit_length() + value.denominator.bit_length(), 0)
        shift += shift % 2
        scaled = (value.numerator << shift) // value.denominator
        low = isqrt(scaled)
        exact = low * low * value.denominator == value.numerator << shift
        return Fraction(low + (up and not exact), 1 << (shift // 2))

    return Range(of(max(x.lower, ZERO), up=False), of(x.upper, up=True))


@lru_cache(maxsize=1)
def pi() -> Range:
    """Machin's formula with the remainders of two alternating series."""

    def inverse_tangent(n: int) -> Range:
        terms = [Fraction((-1) ** k, (2 * k + 1) * n ** (2 * k + 1)) for k in range(120)]
        odd, even = sum(terms, ZERO), sum(terms[:-1], ZERO)
        return Range(min(odd, even), max(odd, even))

    return inverse_tangent(5) * 16 - inverse_tangent(239) * 4


def exponential(x: Range) -> Range:
    """``e^x``: a Taylor polynomial of x / 2^m, squared m times."""
    size = max(x.magnitude, Fraction(1))
    halvings = (size.numerator // size.denominator).bit_length() + 8
    y = x * Fraction(1, 1 << halvings)
    total = Range(1)
    for k in range(24, 0, -1):
        total = total * y * Fraction(1, k) + 1
    # |y| <= 2^-8: what the polynomial leaves out is less than twice its next term.
    total = total + sided(2 * Fraction(1, 256) ** 25 / (1 << 80))
    for _ in range(halvings):
        total = total.square()
    return total


def tanh(x: Range) -> Range:
    """Hyperbolic tangent, by its value at both ends."""

    def of(value: Fraction) -> Range:
        decay = exponential(Range(-2 * abs(value)))
        share = (1 - decay) / (1 + decay)
        return share if value >= 0 else -share

    return Range(of(x.lower).lower, of(x.upper).upper)


def cosine(x: Range) -> Range:
    """Cosine of every angle of a range [rad]."""
    first, last = (_cosine_at(e) for e in (x.lower, x.upper))
    result = first.hull(last)
    turns = (x / pi()).upper, (x / pi()).lower
    for k in range(-(-turns[1].numerator // turns[1].denominator), turns[0].numerator // turns[0].denominator + 1):
        result = result.hull(Range((-1) ** (k % 2)))
        if k > turns[1] + 2:
            break
    return Range(max(result.lower, Fraction(-1)), min(result.upper, Fraction(1)))


def sine(x: Range) -> Range:
    """Sine of every angle of a range [rad]."""
    return cosine(x - pi() / 2)


def _cosine_at(x: Fraction) -> Range:
    """In whole numbers of 2^-BITS: a Taylor polynomial of degree 80 of what is left of whole turns, |y| < 4.

    The rest, at most 4^82/82!, is below 2^-240. With S the rounded square (off by at most 10 units) and partial sums below
    cosh 4 < 28, an error e of one partial sum becomes at most (16 e + 280) / (2k (2k - 1)) + 3 in the next: below 650 at the end.
    """
    turns = round(x / (2 * pi().lower))
    left = (Range(x) - pi() * (2 * turns)).lower
    y = (left.numerator << BITS) // left.denominator
    square = y * y >> BITS
    one = total = 1 << BITS
    for k in range(40, 0, -1):
        total = one - (total * square >> BITS) // ((2 * k - 1) * (2 * k))
    room = 1 << 20
    return Range(Fraction(total - room, one), Fraction(total + room, one))


def upper_tail(x: Fraction) -> Fraction:
    """A number that P(Z > x) of a standard normal Z does not exceed, for x > 0.

    P(0 < Z < x) is the density at x times x + x^3/3 + x^5/15 + ...; leaving terms out makes it smaller.
    """
    term, total = Range(x), Range(x)
    for k in range(1, 40 + 4 * round(x * x)):
        term = term * (x * x / (2 * k + 1))
        total = total + term
    density = exponential(Range(-x * x / 2)) / root(2 * pi())
    return Fraction(1, 2) - (density * total).lower


def normal_factor(tail: Fraction) -> Fraction:
    """A factor k with P(Z > k) <= ``tail``, proved, and larger than need be by less than 2e-10 of itself.

    Raises:
        ArithmeticError: no such factor was found.
    """
    start = Fraction(-NormalDist().inv_cdf(float(tail)))
    for slack in (1 << 44, 1 << 40, 1 << 36, 1 << 33):
        k = start * (1 + Fraction(1, slack))
        if k > 0 and upper_tail(k) <= tail:
            return k
    raise ArithmeticError(f"no factor for a tail of {float(tail):.3g} could be proved")
