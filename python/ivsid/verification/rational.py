"""Exact ranges, and enclosures of irrational numbers: roots, angles, exponentials, the normal distribution.

Ends are whole multiples of 2^-1200: every double is one, half a unit in the last place of every double too, and sums are exact.
Products and quotients are rounded outward to such a multiple. Nothing here is a float operation.
"""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import isqrt
from statistics import NormalDist
from typing import Final, TypeAlias

# Ends are whole numbers of 2^-1200: the smallest double is 2^-1074, and what rounding loses stays far below its half.
# Source: definition: IEEE 754 binary64
SCALE: Final = 1200
# One in whole numbers of 2^-SCALE.
# Source: definition: 2^SCALE
ONE: Final = 1 << SCALE
# Binary places of the cosine's own whole numbers; ``_cosine_at`` bounds their roundings.
# Source: theorem: error bound in the docstring of ``_cosine_at``
BITS: Final = 256

Number: TypeAlias = "Range | Fraction | int"


def _floor(x: Fraction | int) -> int:
    return (x.numerator << SCALE) // x.denominator


class Range:
    """A closed interval; the operators hold every result of members.

    Attributes:
        low: lower end in units of 2^-1200.
        high: upper end likewise.
    """

    __slots__ = ("high", "low")

    def __init__(self, lower: Fraction | int, upper: Fraction | int | None = None) -> None:
        self.low = _floor(lower)
        self.high = -_floor(-(lower if upper is None else upper))

    @classmethod
    def raw(cls, low: int, high: int) -> Range:
        """From ends in units of 2^-1200."""
        new = cls.__new__(cls)
        new.low, new.high = low, high
        return new

    @classmethod
    def around(cls, value: float, *reaches: float) -> Range:
        """The numbers within the sum of ``reaches`` of a double."""
        n, d = value.as_integer_ratio()
        centre, reach = (n << SCALE) // d, 0
        for r in reaches:
            n, d = r.as_integer_ratio()
            reach += (n << SCALE) // d
        return cls.raw(centre - reach, centre + reach)

    @property
    def lower(self) -> Fraction:
        """The lower end."""
        return Fraction(self.low, ONE)

    @property
    def upper(self) -> Fraction:
        """The upper end."""
        return Fraction(self.high, ONE)

    def __repr__(self) -> str:
        return f"[{float(self.lower)!r}, {float(self.upper)!r}]"

    def __add__(self, other: Number) -> Range:
        o = to_range(other)
        return Range.raw(self.low + o.low, self.high + o.high)

    __radd__ = __add__

    def __neg__(self) -> Range:
        return Range.raw(-self.high, -self.low)

    def __sub__(self, other: Number) -> Range:
        o = to_range(other)
        return Range.raw(self.low - o.high, self.high - o.low)

    def __rsub__(self, other: Number) -> Range:
        return to_range(other) - self

    def __mul__(self, other: Number) -> Range:
        if isinstance(other, int):
            ends = self.low * other, self.high * other
            return Range.raw(min(ends), max(ends))
        o = to_range(other)
        a, b, c, d = self.low, self.high, o.low, o.high
        if not (a or b) or not (c or d):
            return ZERO
        if c >= 0:
            low, high = a * (c if a >= 0 else d), b * (d if b >= 0 else c)
        elif a >= 0:
            low, high = c * b, d * (b if d >= 0 else a)
        else:
            products = a * c, a * d, b * c, b * d
            low, high = min(products), max(products)
        return Range.raw(low >> SCALE, -(-high >> SCALE))

    __rmul__ = __mul__

    def __truediv__(self, other: Number) -> Range:
        if isinstance(other, int) and other > 0:
            return Range.raw(self.low // other, -(-self.high // other))
        o = to_range(other)
        if o.low <= 0 <= o.high:
            raise ZeroDivisionError("a divisor may be 0")
        if o.high < 0:
            return (-self) / (-o)
        low, high = self.low << SCALE, self.high << SCALE
        return Range.raw(low // (o.low if low < 0 else o.high), -(-high // (o.high if high < 0 else o.low)))

    def halved(self, times: int) -> Range:
        """``x / 2^times``."""
        return Range.raw(self.low >> times, -(-self.high >> times))

    def __abs__(self) -> Range:
        return Range.raw(max(self.low, -self.high, 0), max(-self.low, self.high))

    @property
    def magnitude(self) -> Fraction:
        """The largest absolute value."""
        return abs(self).upper

    @property
    def mignitude(self) -> Fraction:
        """The smallest absolute value."""
        return abs(self).lower

    def square(self) -> Range:
        """``x^2``."""
        size = abs(self)
        return Range.raw(size.low * size.low >> SCALE, -(-size.high * size.high >> SCALE))

    def signed_square(self) -> Range:
        """``x |x|``."""
        return Range.raw(self.low * abs(self.low) >> SCALE, -(-self.high * abs(self.high) >> SCALE))

    def cube(self) -> Range:
        """``x^3``."""
        return Range.raw(self.low**3 >> 2 * SCALE, -(-(self.high**3) >> 2 * SCALE))

    def negative_part(self) -> Range:
        """``min(x, 0)``."""
        return Range.raw(min(self.low, 0), min(self.high, 0))

    def positive_part(self) -> Range:
        """``max(x, 0)``."""
        return Range.raw(max(self.low, 0), max(self.high, 0))

    def hull(self, other: Range) -> Range:
        """The smallest range that holds both."""
        return Range.raw(min(self.low, other.low), max(self.high, other.high))

    def largest(self) -> Range:
        """The largest absolute value, as a range."""
        top = max(-self.low, self.high)
        return Range.raw(top, top)

    def inside(self, lower: Fraction, upper: Fraction) -> bool:
        """Whether all of it lies between two numbers."""
        below = lower.numerator << SCALE <= self.low * lower.denominator
        return below and self.high * upper.denominator <= upper.numerator << SCALE


ZERO: Final = Range(0)


def to_range(x: Number) -> Range:
    """A number as a range; a range as it is."""
    return x if isinstance(x, Range) else Range(x)


def sided(reach: Number) -> Range:
    """The numbers within ``reach`` of 0."""
    top = to_range(reach).high
    return Range.raw(-top, top)


def weighted(share: Range, a: Range, b: Range) -> Range:
    """The weighted mean p a + (1 - p) b for a share p in [0, 1]; it is linear in p, so that its extremes stand at the ends."""
    lows = [p * a.low + (ONE - p) * b.low for p in (share.low, share.high)]
    highs = [p * a.high + (ONE - p) * b.high for p in (share.low, share.high)]
    return Range.raw(min(lows) >> SCALE, -(-max(highs) >> SCALE))


def root(x: Range) -> Range:
    """Square root of the numbers of a range that are not negative."""
    low, high = max(x.low, 0) << SCALE, max(x.high, 0) << SCALE
    top = isqrt(high)
    return Range.raw(isqrt(low), top + (top * top < high))


@lru_cache(maxsize=1)
def pi() -> Range:
    """Pi by Machin's formula, with the remainders of two alternating series."""

    def inverse_tangent(n: int) -> Range:
        terms = [Fraction((-1) ** k, (2 * k + 1) * n ** (2 * k + 1)) for k in range(120)]
        odd, even = sum(terms, Fraction(0)), sum(terms[:-1], Fraction(0))
        return Range(min(odd, even), max(odd, even))

    return inverse_tangent(5) * 16 - inverse_tangent(239) * 4


def exponential(x: Range) -> Range:
    """``e^x``: a Taylor polynomial of x / 2^m, squared m times."""
    return _exponential(x.low, x.high)


@lru_cache(maxsize=4096)
def _exponential(low: int, high: int) -> Range:
    x = Range.raw(low, high)
    halvings = (max(abs(x).high, ONE) >> SCALE).bit_length() + 8
    y = x.halved(halvings)
    total = Range(1)
    for k in range(24, 0, -1):
        total = total * y / k + 1
    # |y| <= 2^-8: the remainder of the polynomial is less than twice its next term.
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
    return _cosine(x.low, x.high)


@lru_cache(maxsize=4096)
def _cosine(low: int, high: int) -> Range:
    x = Range.raw(low, high)
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
    """Cosine of a number in whole numbers of 2^-BITS: a Taylor polynomial of degree 80 in the angle y less whole turns, |y| < 4.

    The remainder, at most 4^82/82!, is below 2^-240. With S the rounded square (off by at most 10 units) and partial sums below
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
    """An upper bound of P(Z > x) for a standard normal Z and x > 0.

    P(0 < Z < x) is the density at x times x + x^3/3 + x^5/15 + ...; a partial sum is a lower bound of it.
    """
    term, total = Range(x), Range(x)
    for k in range(1, 40 + 4 * round(x * x)):
        term = term * (x * x / (2 * k + 1))
        total = total + term
    density = exponential(Range(-x * x / 2)) / root(2 * pi())
    return Fraction(1, 2) - (density * total).lower


def normal_factor(tail: Fraction) -> Fraction:
    """A factor k with P(Z > k) <= ``tail``, proved, and too large by less than 2e-10 of itself.

    Raises:
        ArithmeticError: no such factor was found.
    """
    start = Fraction(-NormalDist().inv_cdf(float(tail)))
    for slack in (1 << 44, 1 << 40, 1 << 36, 1 << 33):
        k = start * (1 + Fraction(1, slack))
        if k > 0 and upper_tail(k) <= tail:
            return k
    raise ArithmeticError(f"no factor for a tail of {float(tail):.3g} could be proved")
