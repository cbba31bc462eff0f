"""Functions that IEEE 1788 recommends: at points against MPFR to the bit, over intervals against their poles and extremes.

IVSID_CASES sets the number of operands of a function, as in tests/python/test_oracle.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import gmpy2
import numpy as np
import pytest

from ivsid import Interval, IntervalArray, IvsidError
from test_oracle import blocks, cases, judge, spicy

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")

# More bits than 1 + x^2 has for any double x, with 200 to spare where a difference cancels.
BITS = 2400


def precisely(function: Callable[..., Any], bits: int = BITS) -> Callable[..., Any]:
    """A function in many bits, rounded once by the context of the caller."""

    def oracle(*operands: float) -> Any:
        with gmpy2.context(
            gmpy2.get_context(), precision=bits, emin=-100_000, emax=100_000, subnormalize=False, round=0
        ):
            value = function(*map(gmpy2.mpfr, operands))
        return +value

    return oracle


def _turned(function: Callable[[Any], Any], exact: Callable[[Fraction], float | None]) -> Callable[[Any], Any]:
    def of(x: Any) -> Any:
        rest = gmpy2.fmod(x, 2)
        found = exact(Fraction(*map(int, rest.as_integer_ratio())))
        return (
            gmpy2.mpfr(found) if found is not None else function(gmpy2.const_pi(gmpy2.get_context().precision) * rest)
        )

    return of


def _sine(x: Fraction) -> float | None:
    return [0.0, 1.0, 0.0, -1.0][int(2 * x) % 4] if (2 * x).denominator == 1 else None


def _tangent(x: Fraction) -> float | None:
    if (4 * x).denominator != 1:
        return None
    return [0.0, 1.0, math.nan, -1.0][int(4 * x) % 4]


def _half_turns(angle: Callable[..., Any], exact: dict[Any, float]) -> Callable[..., Any]:
    def of(*x: Any) -> Any:
        key = x[0] if len(x) == 1 else _direction(*x)
        if key in exact:
            return gmpy2.mpfr(exact[key])
        return angle(*x) / gmpy2.const_pi(gmpy2.get_context().precision)

    return of


def _direction(y: Any, x: Any) -> Any:
    if x == 0 or y == 0 or abs(x) == abs(y):
        return int(gmpy2.sign(y)), int(gmpy2.sign(x))
    return None


EIGHTHS = {(0, 1): 0.0, (1, 1): 0.25, (1, 0): 0.5, (1, -1): 0.75, (0, -1): 1.0}
EIGHTHS |= {(-a, b): -angle for (a, b), angle in EIGHTHS.items() if a}


def clipped(x: Any, least: float, most: float) -> Any:
    """Beyond the range of doubles, where more bits would be needed, every value is rounded alike."""
    return min(max(x, gmpy2.mpfr(least)), gmpy2.mpfr(most))


def unit(x: np.ndarray) -> np.ndarray:
    return np.where(np.abs(x) <= 1, x, 1 / x)


def other_than_zero(x: np.ndarray) -> np.ndarray:
    return np.where(x == 0, 0.5, x)


def above_minus_one(x: np.ndarray) -> np.ndarray:
    return np.where(x > -1, x, np.where(x == -1, 1.0, 1 / x))


#: The oracle, the span in which half of the operands lie, and the domain.
FUNCTIONS: dict[str, tuple[Any, float, Callable[[np.ndarray], np.ndarray]]] = {
    "expm1": (gmpy2.expm1, 750.0, np.asarray),
    "exp2m1": (precisely(lambda x: gmpy2.exp2(clipped(x, -1200, 2000)) - 1), 1100.0, np.asarray),
    "exp10m1": (precisely(lambda x: gmpy2.exp10(clipped(x, -350, 700)) - 1), 330.0, np.asarray),
    "log1p": (gmpy2.log1p, 4.0, above_minus_one),
    "log2p1": (precisely(lambda x: gmpy2.log2(1 + x)), 4.0, above_minus_one),
    "log10p1": (precisely(lambda x: gmpy2.log10(1 + x)), 4.0, above_minus_one),
    "cbrt": (gmpy2.cbrt, 10.0, np.asarray),
    "rsqrt": (gmpy2.rec_sqrt, 10.0, lambda x: np.abs(other_than_zero(x))),
    "sinpi": (precisely(_turned(gmpy2.sin, _sine)), 4.0, np.asarray),
    "cospi": (precisely(_turned(gmpy2.cos, lambda x: _sine(x + Fraction(1, 2)))), 4.0, np.asarray),
    "tanpi": (precisely(_turned(gmpy2.tan, _tangent)), 4.0, np.asarray),
    "arcsinpi": (precisely(_half_turns(gmpy2.asin, {0: 0.0, 1: 0.5, -1: -0.5})), 1.0, unit),
    "arccospi": (precisely(_half_turns(gmpy2.acos, {0: 0.5, 1: 0.0, -1: 1.0})), 1.0, unit),
    "arctanpi": (precisely(_half_turns(gmpy2.atan, {0: 0.0, 1: 0.25, -1: -0.25})), 10.0, np.asarray),
    "sec": (gmpy2.sec, 10.0, np.asarray),
    "csc": (gmpy2.csc, 10.0, other_than_zero),
    "cot": (gmpy2.cot, 10.0, other_than_zero),
    "arccot": (precisely(lambda x: gmpy2.const_pi(BITS) / 2 - gmpy2.atan(x)), 10.0, np.asarray),
    "sech": (gmpy2.sech, 720.0, np.asarray),
    "csch": (gmpy2.csch, 720.0, other_than_zero),
    "coth": (gmpy2.coth, 20.0, other_than_zero),
    "arccoth": (
        precisely(lambda x: gmpy2.atanh(1 / x)),
        10.0,
        lambda x: np.where(np.abs(x) > 1, x, np.where(np.abs(x) < 1, 1 / other_than_zero(x), 2.0)),
    ),
}
TRIGONOMETRIC = ("sec", "csc", "cot")


def special(name: str, rng: np.random.Generator, n: int) -> np.ndarray:
    """Arguments with exact values: integers and powers of two and ten, with their neighbours, less one, quarters."""
    k = rng.integers(-60, 60, n)
    made = [
        k.astype(float),
        k / 4,
        np.ldexp(1.0, k),
        np.ldexp(1.0, k) - 1,
        10.0 ** (k / 3).astype(int) - 1,
        (k / 4) ** 3,
    ]
    x = np.choose(rng.integers(0, len(made), n), made)
    return np.where(rng.random(n) < 0.7, x, np.nextafter(x, rng.choice([-np.inf, np.inf], n)))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_points_are_the_directed_roundings_of_mpfr(name: str) -> None:
    oracle, span, domain = FUNCTIONS[name]
    for rng, n in blocks(cases(1e3), 21):
        x = np.where(rng.random(n) < 0.2, special(name, rng, n), spicy(rng, n, span))
        x = domain(np.where(np.isfinite(x), x, 1.0))
        x = np.where(np.isfinite(x), x, 2.0)
        if name in TRIGONOMETRIC:
            x = np.where((np.abs(x) > 1e30) & (rng.random(n) > 0.01), 0.5 + x % 100.0, x)
        judge(name, oracle, getattr(IntervalArray(x), name)(), [x])
        one = getattr(Interval(float(x[0])), name)()
        assert one == getattr(IntervalArray(x), name)()[0]


def test_angles_in_half_turns_of_points() -> None:
    oracle = precisely(_half_turns(gmpy2.atan2, EIGHTHS))
    for rng, n in blocks(cases(1e3), 22):
        y, x = spicy(rng, n, 4.0), spicy(rng, n, 4.0)
        y = np.where((y == 0) & (x <= 0), 1.0, y)
        x = np.where(rng.random(n) < 0.1, y * rng.choice([-1, 1], n), x)
        y = np.where((y == 0) & (x == 0), 1.0, y)
        judge("arctan2pi", oracle, IntervalArray(y).arctan2pi(IntervalArray(x)), [y, x])


def test_lengths_of_vectors() -> None:
    for rng, n in blocks(cases(1e3), 23):
        x, y = spicy(rng, n, 4.0), spicy(rng, n, 4.0)
        y = np.where(rng.random(n) < 0.5, x * rng.choice([0.75, 2.4, 1.0, 2.0**-26, 2.0**-27], n), y)
        y = np.where(np.isfinite(y), y, 1.0)
        judge("hypot", gmpy2.hypot, np.hypot(IntervalArray(x), IntervalArray(y)), [x, y])


@pytest.mark.parametrize("n", [-(2**31), -1000, -7, -3, -2, -1, 1, 2, 3, 4, 5, 10, 63, 1001, 2**31 - 1])
def test_integer_roots(n: int) -> None:
    for rng, count in blocks(cases(1e3), 24):
        x = other_than_zero(spicy(rng, count, 10.0))
        exact = (
            np.ldexp(1.0, rng.integers(-30, 30, count))
            if abs(n) > 60
            else rng.integers(1, 4, count) ** float(min(abs(n), 30))
        )
        x = np.where(rng.random(count) < 0.2, exact, x)
        x = np.abs(x) if n % 2 == 0 else x

        def oracle(v: float) -> Any:
            return gmpy2.rootn(gmpy2.mpfr(v), n) if n > 0 else precisely(lambda w: 1 / gmpy2.rootn(w, -n), 300)(v)

        if n > 0:
            judge(f"rootn {n}", oracle, IntervalArray(x).rootn(n), [x])
            continue
        # A reciprocal root is exact where the root is a power of two: MPFR's quotient is exact there, too.
        judge(f"rootn {n}", oracle, IntervalArray(x).rootn(n), [x])


def test_compound_growth() -> None:
    few, many = gmpy2.mpfr(2.0) ** -2000, gmpy2.mpfr(2.0) ** 5000
    oracle = precisely(lambda x, y: min(max((1 + x) ** y, few), many) - 1, 2500)
    for rng, n in blocks(cases(5e2), 25):
        x = above_minus_one(spicy(rng, n, 4.0))
        x = np.where(rng.random(n) < 0.3, np.ldexp(1.0, rng.integers(-20, 20, n)) - 1, x)
        x = np.where(rng.random(n) < 0.2, rng.integers(1, 9, n).astype(float) ** 2 - 1, x)
        x = np.where(x <= -1, 0.5, x)
        y = np.where(rng.random(n) < 0.5, rng.integers(-40, 40, n) / 4, spicy(rng, n, 20.0))
        y = np.where(rng.random(n) < 0.3, 700.0 * rng.uniform(-1, 1, n) / (np.abs(np.log1p(x)) + 1e-3), y)
        judge("compoundm1", oracle, IntervalArray(x).compoundm1(IntervalArray(y)), [x, y])


# Intervals: an oracle of ends, poles and extremes. The values at single points are those that were tested above.

PI = Fraction(*map(int, gmpy2.const_pi(1500).as_integer_ratio()))
HALF = Fraction(1, 2)
#: Distance and first of the poles and of the extremes with their values, in units of half turns.
SHAPES: dict[str, tuple[Fraction, list[Fraction], dict[Fraction, float]]] = {
    "sinpi": (Fraction(1), [], {HALF: 1.0, 3 * HALF: -1.0}),
    "cospi": (Fraction(1), [], {Fraction(0): 1.0, Fraction(1): -1.0}),
    "tanpi": (Fraction(1), [HALF, 3 * HALF], {}),
    "sec": (PI, [HALF, 3 * HALF], {Fraction(0): 1.0, Fraction(1): -1.0}),
    "csc": (PI, [Fraction(0), Fraction(1)], {HALF: 1.0, 3 * HALF: -1.0}),
    "cot": (PI, [Fraction(0), Fraction(1)], {}),
}


def passed(lo: Fraction, hi: Fraction, place: Fraction, unit: Fraction) -> bool:
    """Whether one of the numbers (place + 2 k) unit lies strictly between."""
    k = math.floor((lo / unit - place) / 2) + 1
    return (place + 2 * k) * unit < hi


@pytest.mark.parametrize("name", SHAPES)
def test_ranges_of_periodic_functions(name: str) -> None:
    scale, poles, extremes = SHAPES[name]
    rng = np.random.default_rng(31)
    for _ in range(3000):
        lo = float(rng.choice([rng.uniform(-8, 8), rng.integers(-16, 16) / 4, 0.0]))
        hi = lo + float(rng.choice([rng.uniform(0, 7), rng.integers(0, 12) / 4, rng.exponential(1e-3)]))
        if rng.random() < 0.1:
            lo, hi = min(lo, 0.0), 0.0
        a, b = Fraction(lo), Fraction(hi)
        found = getattr(Interval(lo, hi), name)()
        if lo < hi and any(passed(a, b, pole, scale) for pole in poles):
            assert (found.lower, found.upper) == (-math.inf, math.inf), (lo, hi)
            continue
        values = [getattr(Interval(end), name)() for end in (lo, hi)]
        lower = min((v.lower for v in values if not v.empty), default=math.inf)
        upper = max((v.upper for v in values if not v.empty), default=-math.inf)
        for place, value in extremes.items():
            if passed(a, b, place, scale):
                lower, upper = min(lower, value), max(upper, value)
        if lo < hi:
            # A pole at an end is a limit, with the sign that the function has inside.
            inside = getattr(Interval(float((a + b) / 2) if name != "tanpi" else float(a + (b - a) / 2)), name)()
            for end, falls in ((a, True), (b, False)):
                if any((end / scale - pole) % 2 == 0 for pole in poles):
                    near = {"tanpi": -math.inf if falls else math.inf, "cot": math.inf if falls else -math.inf}
                    limit = near.get(name, math.copysign(math.inf, inside.midpoint))
                    lower, upper = min(lower, limit), max(upper, limit)
        if lower > upper:
            assert found.empty
            continue
        assert (found.lower, found.upper) == (lower, upper), (lo, hi)


MONOTONE_BESIDE_ZERO = ("csch", "coth", "arccoth")


@pytest.mark.parametrize("name", MONOTONE_BESIDE_ZERO)
def test_ranges_beside_a_pole_at_zero(name: str) -> None:
    pole = 1.0 if name == "arccoth" else 0.0
    f = lambda lo, hi: getattr(Interval(lo, hi), name)()  # noqa: E731 - one name for both signs
    right = f(pole, 3.0)
    assert (right.lower, right.upper) == (f(3.0, 3.0).lower, math.inf)
    left = f(-3.0, -pole)
    assert (left.lower, left.upper) == (-math.inf, f(-3.0, -3.0).upper)
    assert f(-3.0, 2.0) == Interval.entire()
    assert f(-pole, pole).empty
    both = f(2.0, 5.0)
    assert (both.lower, both.upper) == (f(5.0, 5.0).lower, f(2.0, 2.0).upper)
    assert f(2.0, math.inf).lower == (1.0 if name == "coth" else 0.0)


def test_ranges_of_roots_and_lengths() -> None:
    x = Interval(-8.0, 27.0)
    assert x.rootn(3) == Interval(-2.0, 3.0)
    assert x.rootn(-3) == Interval.entire()
    assert Interval(0.0, 16.0).rootn(-4) == Interval(0.5, math.inf)
    assert Interval(-8.0, 0.0).rootn(-3) == Interval(-math.inf, -0.5)
    assert Interval(-5.0, -1.0).rootn(2).empty
    assert x.rootn(0).empty
    assert Interval(0.0, 0.0).rootn(-1).empty
    assert Interval(-4.0, 0.0).rsqrt().empty
    assert Interval(-4.0, 4.0).rsqrt() == Interval(0.5, math.inf)
    assert Interval(-3.0, 4.0).hypot(Interval(0.0, 3.0)) == Interval(0.0, 5.0)
    assert Interval(0.0, math.inf).hypot(1.0) == Interval(1.0, math.inf)
    with pytest.raises(IvsidError, match="rootn takes an integer"):
        IntervalArray([1.0]).rootn(2**31)


def test_compound_growth_of_boxes_is_that_of_powers() -> None:
    """Where 1 + x and the power less 1 are exact, both functions have the same ends."""
    rng = np.random.default_rng(32)
    for _ in range(2000):
        base = np.sort(rng.choice([0.0, 0.0625, 0.25, 1.0, 4.0, 16.0, math.inf], 2))
        y = np.sort(rng.choice([-math.inf, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, math.inf], 2))
        if math.isinf(base[0]) or y[0] == math.inf or y[1] == -math.inf:
            continue
        power = Interval(*base.tolist()) ** Interval(*y.tolist())
        found = Interval(*(base - 1).tolist()).compoundm1(Interval(*y.tolist()))
        if power.empty:
            assert found.empty
            continue
        assert (found.lower, found.upper) == (power.lower - 1, power.upper - 1), (base, y)


def test_shapes_broadcast_and_empty_ones_stay() -> None:
    x = IntervalArray(np.array([[1.0], [2.0]]))
    assert x.hypot(np.array([3.0, 4.0])).shape == (2, 2)
    assert x.compoundm1(2.0).shape == (2, 1)
    assert x.rootn(2).shape == (2, 1)
    assert IntervalArray([-2.0]).log1p().empty.all()
    assert Interval.empty_set().sinpi().empty
