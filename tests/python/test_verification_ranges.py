"""Ranges of the checker against exact rationals and enclosures of MPFR: containment first, then the width that rounding may add."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import gmpy2
from hypothesis import given
from hypothesis import strategies as st

from ivsid.verification.rational import SCALE, Range, cosine, exponential

numbers = st.one_of(
    st.fractions(min_value=-1000, max_value=1000, max_denominator=10**6),
    st.floats(allow_nan=False, allow_infinity=False, min_value=-1e12, max_value=1e12).map(Fraction),
)
# A product or a quotient is rounded outward once, by less than this at each end.
UNIT = Fraction(1, 1 << SCALE)


@st.composite
def ranges(draw: st.DrawFn) -> tuple[Range, list[Fraction]]:
    """A range and members of it: its ends, and a number between them."""
    a, b = sorted((draw(numbers), draw(numbers)))
    share = draw(st.fractions(min_value=0, max_value=1, max_denominator=100))
    return Range(a, b), [a, b, a + share * (b - a)]


def _holds(found: Range, exact: list[Fraction], tolerance: Fraction) -> None:
    assert found.lower <= min(exact) and max(exact) <= found.upper
    assert min(exact) - found.lower <= tolerance and found.upper - max(exact) <= tolerance


@given(ranges(), ranges())
def test_operators_hold_every_result_of_members(
    a: tuple[Range, list[Fraction]], b: tuple[Range, list[Fraction]]
) -> None:
    (x, xs), (y, ys) = a, b
    room = UNIT * (2 + 2 * int(x.magnitude + y.magnitude))
    _holds(x + y, [p + q for p in xs for q in ys], room)
    _holds(x - y, [p - q for p in xs for q in ys], room)
    _holds(x * y, [p * q for p in xs for q in ys], room)
    if y.low > 0 or y.high < 0:
        # An end that is no whole multiple of the unit was moved by less than one.
        slack = room * (1 + 1 / y.mignitude) ** 2
        _holds(x / y, [p / q for p in xs for q in ys], slack)


@given(ranges(), st.integers(min_value=-50, max_value=50), st.integers(min_value=0, max_value=40))
def test_whole_numbers_and_halvings(a: tuple[Range, list[Fraction]], n: int, times: int) -> None:
    x, xs = a
    _holds(x * n, [p * n for p in xs], UNIT * (1 + abs(n)))
    if n:
        _holds(x / n, [p / n for p in xs], 2 * UNIT)
    _holds(x.halved(times), [p / 2**times for p in xs], 2 * UNIT)


@given(ranges(), ranges())
def test_inside_is_decided_exactly(a: tuple[Range, list[Fraction]], b: tuple[Range, list[Fraction]]) -> None:
    x, outer = a[0], b[0]
    assert x.inside(outer.lower, outer.upper) == (outer.lower <= x.lower and x.upper <= outer.upper)
    assert x.inside(x.lower, x.upper)
    assert not x.inside(x.lower + UNIT / 7, x.upper)
    assert not x.inside(x.lower, x.upper - UNIT / 7)


@given(st.floats(min_value=-60, max_value=60), st.floats(min_value=0, max_value=3))
def test_exponentials_and_cosines_hold_those_of_mpfr(start: float, width: float) -> None:
    first, last = Fraction(start), Fraction(start) + Fraction(width)
    x = Range(first, last)
    for p in (first, (first + last) / 2, last):
        for made, function in ((exponential(x), gmpy2.exp), (cosine(x), gmpy2.cos)):
            low, high = _enclosed(function, p)
            assert made.lower <= low and high <= made.upper
    if width == 0:
        assert exponential(x).upper <= exponential(x).lower * (1 + Fraction(1, 1 << 250))
        assert cosine(x).upper - cosine(x).lower < Fraction(1, 1 << 230)


def _enclosed(function: Callable[[gmpy2.mpfr], gmpy2.mpfr], p: Fraction) -> tuple[Fraction, Fraction]:
    """The function at a number of at most 1,200 binary places, rounded to 1,300 down and up."""
    found = []
    for mode in (gmpy2.RoundDown, gmpy2.RoundUp):
        with gmpy2.context(precision=1300, round=mode):
            argument = gmpy2.mpfr(gmpy2.mpq(p.numerator, p.denominator))
            value = gmpy2.mpq(function(argument))
        found.append(Fraction(int(value.numerator), int(value.denominator)))
    return found[0], found[1]
