"""Differential tests against MPFR: the bounds of every function at points are its directed roundings, to the bit.

IVSID_CASES sets the number of operands of a function (default 4e4; `make nightly` runs 1e6, `make differential` 1e8).
Each back end is compared bit for bit with the operators in tests/rust/slices.rs, so one of them stands here for all.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import Any

import gmpy2
import numpy as np
import pytest

from ivsid import Interval, IntervalArray

# The operands are bits of all kinds; what NumPy says of their arithmetic is beside the point.
pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")

BLOCK = 50_000
PLACES = np.array(
    [
        *(0.0, 5e-324, 2.2250738585072014e-308, 1e-300, 1e-162, 2.0**-969, 2.0**-54, 2.0**-27, 2.0**-5, 0.5, 1.0, 1.5),
        *(math.pi / 2, math.pi, 2.0**27, 2.0**53, 709.78, 745.1, 1.34e154, 1e300, 1.7976931348623157e308),
    ]
)


def cases(default: float = 4e4) -> int:
    return int(float(os.environ.get("IVSID_CASES", default)))


def spicy(rng: np.random.Generator, n: int, span: float) -> np.ndarray:
    """Uniform in the span, of all binary exponents, and a few units from the places where functions break."""
    kind = rng.integers(0, 4, n)
    anywhere = rng.integers(0, 2**64, n, dtype=np.uint64).view(np.float64)
    near = (rng.choice(PLACES, n).view(np.int64) + rng.integers(-3, 4, n)).view(np.float64)
    moderate = np.ldexp(rng.uniform(-1, 1, n), rng.integers(-60, 12, n))
    x = np.choose(kind, [rng.uniform(-span, span, n), anywhere, near * rng.choice([-1, 1], n), moderate])
    return np.where(np.isfinite(x), x, 1.0)


def context(direction: int) -> gmpy2.context:
    return gmpy2.context(precision=53, emin=-1073, emax=1024, subnormalize=True, round=direction)


def judge(name: str, oracle: Callable[..., Any], result: IntervalArray, operands: list[np.ndarray]) -> None:
    lists = [o.tolist() for o in operands]
    for direction, bound in ((gmpy2.RoundDown, result.lower), (gmpy2.RoundUp, result.upper)):
        with gmpy2.context(context(direction)):
            exact = np.array([float(v) for v in map(oracle, *lists)])
        wrong = np.flatnonzero(~((exact == bound) | (np.isnan(exact) & result.empty)))
        if wrong.size:
            i = wrong[0]
            given, right = float(bound[i]).hex(), float(exact[i]).hex()
            shown = ", ".join(float(o[i]).hex() for o in operands)
            pytest.fail(f"{name}({shown}) rounded by {direction}: {given}, MPFR says {right}; {wrong.size} more")


ARITHMETIC: dict[str, tuple[Any, Any]] = {
    "add": (gmpy2.add, np.add),
    "sub": (gmpy2.sub, np.subtract),
    "mul": (gmpy2.mul, np.multiply),
    "div": (gmpy2.div, np.true_divide),
}

#: The function here, MPFR's, the span in which half of the operands lie, and the domain.
ELEMENTARY: dict[str, tuple[Any, Any, float, Callable[[np.ndarray], np.ndarray]]] = {
    "sqrt": (np.sqrt, gmpy2.sqrt, 4.0, np.abs),
    "exp": (np.exp, gmpy2.exp, 750.0, np.asarray),
    "exp2": (np.exp2, gmpy2.exp2, 1100.0, np.asarray),
    "log": (np.log, gmpy2.log, 4.0, np.abs),
    "log2": (np.log2, gmpy2.log2, 4.0, np.abs),
    "log10": (np.log10, gmpy2.log10, 4.0, np.abs),
    "sin": (np.sin, gmpy2.sin, 10.0, np.asarray),
    "cos": (np.cos, gmpy2.cos, 10.0, np.asarray),
    "tan": (np.tan, gmpy2.tan, 10.0, np.asarray),
    "asin": (np.arcsin, gmpy2.asin, 1.0, lambda x: np.where(np.abs(x) <= 1, x, 1 / x)),
    "acos": (np.arccos, gmpy2.acos, 1.0, lambda x: np.where(np.abs(x) <= 1, x, 1 / x)),
    "atan": (np.arctan, gmpy2.atan, 10.0, np.asarray),
    "sinh": (np.sinh, gmpy2.sinh, 720.0, np.asarray),
    "cosh": (np.cosh, gmpy2.cosh, 720.0, np.asarray),
    "tanh": (np.tanh, gmpy2.tanh, 20.0, np.asarray),
    "asinh": (np.arcsinh, gmpy2.asinh, 10.0, np.asarray),
    "acosh": (np.arccosh, gmpy2.acosh, 10.0, lambda x: np.where(np.abs(x) >= 1, np.abs(x), 1 + np.abs(x))),
    "atanh": (np.arctanh, gmpy2.atanh, 1.0, lambda x: np.where(np.abs(x) < 1, x, np.where(np.abs(x) > 1, 1 / x, 0.5))),
}


def test_one_ulp_is_noticed() -> None:
    x = np.array([0.5, 1.25, 3.0])
    right = np.exp(IntervalArray(x))
    judge("exp", gmpy2.exp, right, [x])
    for lower, upper in (
        (np.nextafter(right.lower, -np.inf), right.upper),
        (np.nextafter(right.lower, np.inf), right.upper),
        (right.lower, np.nextafter(right.upper, np.inf)),
    ):
        with pytest.raises(pytest.fail.Exception, match="MPFR says"):
            judge("exp", gmpy2.exp, IntervalArray(lower, upper), [x])


def blocks(count: int, seed: int) -> Any:
    rng = np.random.default_rng(seed)
    while count > 0:
        yield rng, min(BLOCK, count)
        count -= BLOCK


@pytest.mark.parametrize("name", ARITHMETIC)
def test_arithmetic(name: str) -> None:
    oracle, function = ARITHMETIC[name]
    for rng, n in blocks(cases(), 1):
        x, y = spicy(rng, n, 4.0), spicy(rng, n, 4.0)
        if name == "div":
            y = np.where(y == 0, 1.0, y)
        judge(name, oracle, function(IntervalArray(x), IntervalArray(y)), [x, y])


@pytest.mark.parametrize("name", ELEMENTARY)
def test_elementary(name: str) -> None:
    function, oracle, span, domain = ELEMENTARY[name]
    for rng, n in blocks(cases(), 2):
        x = domain(spicy(rng, n, span))
        if name in ("sin", "cos", "tan"):
            # MPFR takes milliseconds where the argument has a thousand bits; a few of those are enough.
            x = np.where((np.abs(x) > 1e30) & (rng.random(n) > 0.01), x % 100.0, x)
        if name == "log" or name.startswith("log"):
            x = np.where(x == 0, 1.0, x)
        judge(name, oracle, function(IntervalArray(x)), [x])


def test_atan2() -> None:
    for rng, n in blocks(cases(), 3):
        y, x = spicy(rng, n, 4.0), spicy(rng, n, 4.0)
        y = np.where((y == 0) & (x <= 0), 1.0, y)
        judge("atan2", gmpy2.atan2, np.arctan2(IntervalArray(y), IntervalArray(x)), [y, x])


def test_real_powers() -> None:
    for rng, n in blocks(cases(), 4):
        x = np.abs(spicy(rng, n, 4.0))
        x = np.where(x == 0, 1.0, x)
        # Half of the exponents leave results inside the range; exact roots and squares are frequent.
        y = np.where(
            rng.random(n) < 0.5, spicy(rng, n, 20.0), 700.0 * rng.uniform(-1, 1, n) / (np.abs(np.log(x)) + 1e-3)
        )
        exact = rng.random(n) < 0.1
        x = np.where(exact, rng.integers(1, 1 << 13, n).astype(float) ** 2, x)
        y = np.where(exact, rng.choice([0.5, -0.5, 1.5, 2.0, -2.0, 3.0, 0.25], n), y)
        judge("pow", lambda a, b: gmpy2.mpfr(a) ** b, IntervalArray(x) ** IntervalArray(y), [x, y])


@pytest.mark.parametrize("n", [-64, -7, -3, -2, -1, 0, 1, 2, 3, 4, 5, 10, 33, 64, 65, 1023])
def test_integer_powers(n: int) -> None:
    for rng, count in blocks(cases() // 10, 5):
        x = spicy(rng, count, 4.0)
        if n < 0:
            x = np.where(x == 0, 1.0, x)
        judge(f"power {n}", lambda a: gmpy2.mpfr(a) ** n, IntervalArray(x) ** n, [x])


def test_fused_multiply_add() -> None:
    rng = np.random.default_rng(6)
    n = cases() // 10
    x, y, z = spicy(rng, n, 4.0), spicy(rng, n, 4.0), spicy(rng, n, 4.0)
    # Products that cancel all but the last bits are where two roundings go wrong.
    z = np.where(rng.random(n) < 0.3, -x * y, z)
    z = np.where(np.isfinite(z), z, 1.0)
    for a, b, c in zip(x.tolist(), y.tolist(), z.tolist(), strict=True):
        given = Interval(a).fma(Interval(b), Interval(c))
        with gmpy2.context(context(gmpy2.RoundDown)):
            assert float(gmpy2.fma(a, b, c)) == given.lower, (a, b, c)
        with gmpy2.context(context(gmpy2.RoundUp)):
            assert float(gmpy2.fma(a, b, c)) == given.upper, (a, b, c)


def test_ranges_hold_the_values_of_members() -> None:
    """Intervals instead of points: the values at the ends and at inner points lie in the range."""
    rng = np.random.default_rng(7)
    for name, (function, _, span, domain) in ELEMENTARY.items():
        a, b = domain(rng.uniform(-span, span, 20_000)), domain(rng.uniform(-span, span, 20_000))
        x = IntervalArray(np.minimum(a, b), np.maximum(a, b))
        whole = function(x)
        for t in (0.0, 0.3, 0.77, 1.0):
            inside = np.clip(x.lower + t * (x.upper - x.lower), x.lower, x.upper)
            assert function(IntervalArray(inside)).subset(whole).all(), name


def test_exact_sum_is_that_of_rationals() -> None:
    from fractions import Fraction

    rng = np.random.default_rng(8)
    for n in (1, 2, 17, 1000):
        x = np.ldexp(rng.uniform(-1, 1, n), rng.integers(-300, 300, n))
        total = sum(map(Fraction, x.tolist()), Fraction())
        s = IntervalArray(x).sum()
        assert Fraction(s.lower) <= total <= Fraction(s.upper)
        assert s.lower == s.upper or math.nextafter(s.lower, math.inf) == s.upper
