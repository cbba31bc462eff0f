"""Reverse operations in Python: against ends that MPFR computes, to the bit.

The closure of the solutions has its ends among few points: ends of the operands, values of the inverse function, corners of a box, and the places where a ray of an
angle leaves it. All of them are computed in 2,400 bits, tried one by one, and rounded outward. IVSID_CASES sets the number of operands, as in test_oracle.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise
from typing import Any

import gmpy2
import numpy as np
import pytest

from ivsid import Interval, IntervalArray, IvsidError
from test_oracle import cases, context

# The tangent of the least double differs from it by 2^-2149 of its size; 2^5000 stands for infinity, beyond all corners that finite ends make.
BITS, FAR = 2400, gmpy2.mpfr(2) ** 5000
WIDE = gmpy2.context(precision=BITS, emin=-100_000, emax=100_000, round=0)
ENTIRE = Interval.entire()
Box = tuple[float, float]


def outward(candidates: list[Any]) -> Interval:
    """The tightest interval of doubles around the numbers."""
    if not candidates:
        return Interval.empty_set()
    with gmpy2.context(context(gmpy2.RoundDown)):
        low = float(gmpy2.mpfr(min(candidates)))
    with gmpy2.context(context(gmpy2.RoundUp)):
        high = float(gmpy2.mpfr(max(candidates)))
    return Interval(low, high)


def number(end: float) -> Any:
    """The end in many bits; an infinite one far beyond all corners that a finite one makes."""
    return gmpy2.mpfr(end) if math.isfinite(end) else math.copysign(1, end) * FAR


def drawn(rng: np.random.Generator) -> Box:
    """Ends of all signs and sizes, a point, a zero or an infinity among them."""
    size = float(rng.choice([1.0, 1.0, 1.0, 1e-300, 1e150, 1e-9]))
    a, b = (size * rng.choice([rng.uniform(-3, 3), rng.integers(-2, 3)]) for _ in range(2))
    a, b = float(min(a, b)), float(max(a, b))
    b = a if rng.random() < 0.1 else b
    return (-math.inf if rng.random() < 0.07 else a, math.inf if rng.random() < 0.07 else b)


# The angle of a point. A solution is a member of the cone of the angles and of the box of both sides.


def holds_angle(c: Box, s: Any, t: Any) -> bool:
    return (s, t) != (0, 0) and c[0] <= gmpy2.atan2(t, s) <= c[1]


def directions(c: Box) -> Iterator[tuple[Any, Any]]:
    """A direction of every kind that the cone has: of its ends, of the axes, and between them."""
    pi = gmpy2.const_pi(BITS)
    turns = [pi * k / 2 for k in range(-2, 3)]
    ends = [max(-pi, min(pi, gmpy2.mpfr(end))) for end in c]
    if c[1] < -pi or c[0] > pi:
        return
    places = sorted({*ends, *(t for t in turns if ends[0] <= t <= ends[1])})
    axes = {0: (1, 0), 1: (0, 1), 2: (-1, 0), -1: (0, -1)}
    for k, direction in axes.items():
        if c[0] <= pi * k / 2 <= c[1]:
            yield direction
    for angle in [*ends, *((a + b) / 2 for a, b in pairwise(places))]:
        if angle not in turns:
            yield gmpy2.cos(angle), gmpy2.sin(angle)


def corners(x: Box, y: Box, c: Box) -> list[tuple[Any, Any]]:
    """Points among which the closure of the solutions has its least and its greatest coordinates."""
    xs, ys = [number(e) for e in x], [number(e) for e in y]
    found = [(s, t) for s in xs for t in ys if holds_angle(c, s, t)]
    # Where the axis belongs to the cone it leaves the box, too; below the axis the cone comes up to it without the angle -pi.
    below = c[0] <= -gmpy2.const_pi(BITS) <= c[1] and ys[0] < 0
    for s in xs:
        if ys[0] <= 0 <= ys[1] and (holds_angle(c, s, gmpy2.mpfr(0)) or (below and s < 0)):
            found.append((s, gmpy2.mpfr(0)))
    for end in c:
        if abs(end) > gmpy2.const_pi(BITS):
            continue
        cos, sin = gmpy2.cos(gmpy2.mpfr(end)), gmpy2.sin(gmpy2.mpfr(end))
        for s in xs:
            if s * cos > 0 and ys[0] <= s * sin / cos <= ys[1]:
                found.append((s, s * sin / cos))
        for t in ys:
            if t * sin > 0 and xs[0] <= t * cos / sin <= xs[1]:
                found.append((t * cos / sin, t))
    if xs[0] <= 0 <= xs[1] and ys[0] <= 0 <= ys[1]:
        for a, b in directions(c):
            inside = ((a > 0 and xs[1] > 0) or (a < 0 and xs[0] < 0) or a == 0) and (
                (b > 0 and ys[1] > 0) or (b < 0 and ys[0] < 0) or b == 0
            )
            if inside:
                found.append((gmpy2.mpfr(0), gmpy2.mpfr(0)))
                break
    return found


def angles(rng: np.random.Generator, x: Box, y: Box) -> Box:
    """Angles of all kinds: of a member of the box alone, about the axes and pi, wide ones, tiny ones."""
    kind = rng.integers(0, 5)
    if kind == 0:
        s, t = (float(np.clip(rng.uniform(-3, 3), *side)) for side in (x, y))
        low = math.atan2(t, s)
        return (low, low) if rng.random() < 0.3 else (low, float(np.nextafter(low, 4)))
    if kind == 1:
        at = float(rng.choice([0.0, math.pi / 2, -math.pi / 2, math.pi, -math.pi]))
        return (at - float(rng.choice([0.0, 1e-16, 0.3])), at + float(rng.choice([0.0, 4.5e-16, 0.3])))
    if kind == 2:
        low = float(rng.choice([5e-324, 1e-300, 1e-20])) * float(rng.choice([1, -1]))
        return (min(low, 2 * low), max(low, 2 * low))
    low, high = sorted(rng.uniform(-4, 4, 2).tolist())
    return (low, high)


@pytest.fixture(scope="module")
def planes() -> list[tuple[Box, Box, Box, list[tuple[Any, Any]]]]:
    rng, found = np.random.default_rng(71), []
    with gmpy2.context(WIDE):
        for _ in range(cases(1.5e2)):
            x, y = drawn(rng), drawn(rng)
            c = angles(rng, x, y)
            found.append((x, y, c, corners(x, y, c)))
    return found


@pytest.mark.parametrize("name", ["arctan2_rev_y", "arctan2_rev_x"])
def test_reverses_of_atan2_are_the_roundings_of_mpfr(name: str, planes: Any) -> None:
    nonempty, moved = 0, 0
    for x, y, c, points in planes:
        sought, other, k = (y, x, 1) if name.endswith("y") else (x, y, 0)
        right = outward([p[k] for p in points])
        found = getattr(Interval(*other), name)(Interval(*c), Interval(*sought))
        assert found == right, (x, y, c, found, right)
        nonempty += not right.empty
        moved += not right.empty and right != Interval(*sought)
    assert nonempty > len(planes) / 3 and moved > len(planes) / 8


# Functions of one number: solutions at the ends of the values, and the ends of the operand.


def both(root: Any) -> list[Any]:
    return [root, -root]


def shifted(angles: list[Any], period: Any) -> list[Any]:
    return [a + k * period for a in angles for k in range(-8, 9)]


def pi() -> Any:
    return gmpy2.const_pi(BITS)


def at_tan(v: Any) -> list[Any]:
    # Infinite values stand for the open ends of a branch.
    return shifted([gmpy2.atan(v) if abs(v) < FAR else pi() / 2], pi())


ONE_NUMBER: dict[str, tuple[Callable[[Any], Any], Callable[[Any], list[Any]]]] = {
    "sqr_rev": (lambda t: t * t, lambda v: both(gmpy2.sqrt(v)) if v >= 0 else []),
    "abs_rev": (abs, lambda v: both(v) if v >= 0 else []),
    "sin_rev": (gmpy2.sin, lambda v: shifted([gmpy2.asin(v), pi() - gmpy2.asin(v)], 2 * pi()) if abs(v) <= 1 else []),
    "cos_rev": (gmpy2.cos, lambda v: shifted(both(gmpy2.acos(v)), 2 * pi()) if abs(v) <= 1 else []),
    "tan_rev": (gmpy2.tan, at_tan),
    "cosh_rev": (gmpy2.cosh, lambda v: both(gmpy2.acosh(v)) if v >= 1 else []),
}


def holds(c: Box, value: Any) -> bool:
    return c[0] <= value <= c[1]


@pytest.mark.parametrize("name", ONE_NUMBER)
def test_reverses_of_functions_are_the_roundings_of_mpfr(name: str) -> None:
    function, inverse = ONE_NUMBER[name]
    rng, nonempty, moved = np.random.default_rng(72), 0, 0
    for _ in range(cases(2e2)):
        c = sorted(rng.choice([rng.uniform(-1.2, 1.5, 2), rng.uniform(0.5, 9, 2), rng.integers(-1, 3, 2)]).tolist())
        x = sorted(rng.choice([rng.uniform(-9, 9, 2), rng.uniform(0, 2, 2), rng.integers(-3, 4, 2)]).tolist())
        with gmpy2.context(WIDE):
            ends = [gmpy2.mpfr(e) for e in x]
            points = [e for e in ends if holds(c, function(e))]
            points += [t for v in c for t in inverse(gmpy2.mpfr(v)) if ends[0] <= t <= ends[1]]
        found = getattr(Interval(*c), name)(Interval(*x))
        assert found == outward(points), (c, x, found, outward(points))
        nonempty += not found.empty
        moved += not found.empty and found != Interval(*x)
    assert nonempty > 50 and moved > 40


@pytest.mark.parametrize("n", [-3, -2, 2, 3, 7])
def test_reverses_of_integer_powers_are_the_roundings_of_mpfr(n: int) -> None:
    rng, nonempty = np.random.default_rng(73), 0
    for _ in range(cases(1e2)):
        c, x = (sorted(rng.choice([rng.uniform(-3, 9, 2), rng.uniform(0.1, 1, 2)]).tolist()) for _ in range(2))
        with gmpy2.context(WIDE):
            ends = [gmpy2.mpfr(e) for e in x]
            points = [e for e in ends if holds(c, e**n)]
            for v in map(gmpy2.mpfr, c):
                root = gmpy2.rootn(abs(v), abs(n))
                root = root if n > 0 else 1 / root
                sides = both(root) if n % 2 == 0 and v > 0 else [root * (1 if v > 0 else -1)] if n % 2 else []
                points += [t for t in sides if ends[0] <= t <= ends[1]]
        assert Interval(*c).powi_rev(n, Interval(*x)) == outward(points), (n, c, x)
        nonempty += bool(points)
    assert nonempty > 25


def test_reverses_of_products_are_the_roundings_of_fractions() -> None:
    rng, moved = np.random.default_rng(74), 0
    for _ in range(cases(3e2)):
        b, c, x = (sorted(rng.choice([rng.uniform(-2, 5, 2), rng.integers(-2, 4, 2)]).tolist()) for _ in range(3))
        (b0, b1), (c0, c1), ends = ([Fraction(e) for e in side] for side in (b, c, x))
        points = [e for e in ends if min(b0 * e, b1 * e) <= c1 and max(b0 * e, b1 * e) >= c0]
        points += [q / p for p in (b0, b1) if p for q in (c0, c1) if ends[0] <= q / p <= ends[1]]
        # Where both hold 0, every number is a solution; a gap of the solutions ends in the quotients.
        with gmpy2.context(WIDE):
            right = outward([gmpy2.mpq(p) for p in points])
        found = Interval(*b).mul_rev(Interval(*c), Interval(*x))
        assert found == right, (b, c, x, found, right)
        moved += not right.empty and right != Interval(*x)
    assert moved > 50


def test_reverses_of_real_powers_are_the_roundings_of_mpfr() -> None:
    rng = np.random.default_rng(76)
    for _ in range(cases(1e2)):
        y, base, value = (sorted(rng.uniform(0.2, 3, 2).tolist()) for _ in range(3))
        with gmpy2.context(WIDE):
            roots = [gmpy2.mpfr(q) ** (1 / gmpy2.mpfr(p)) for p in y for q in value]
            logs = [gmpy2.log(gmpy2.mpfr(q)) / gmpy2.log(gmpy2.mpfr(p)) for p in base for q in value]
        assert Interval(*y).pow_rev_base(Interval(*value)) == outward(roots)
        if base[0] > 1 or base[1] < 1:
            assert Interval(*base).pow_rev_exponent(Interval(*value)) == outward(logs)


def test_a_product_is_undone_in_two_parts_beside_zero() -> None:
    below, above = Interval(-1.0, 2.0).mul_rev_to_pair(Interval(1.0, 2.0))
    assert below == Interval(-math.inf, -1.0) and above == Interval(0.5, math.inf)
    whole, none = Interval(1.0, 2.0).mul_rev_to_pair(4.0)
    assert whole == Interval(2.0, 4.0) and none.empty
    assert Interval(-1.0, 2.0).mul_rev(Interval(1.0, 2.0), Interval(-0.9, 3.0)) == Interval(0.5, 3.0)
    pair = IntervalArray([1.0, -1.0], [2.0, 2.0]).mul_rev_to_pair(IntervalArray([4.0, 1.0], [4.0, 2.0]))
    assert (pair[0][0], pair[0][1], pair[1][1]) == (whole, below, above) and pair[1].empty.tolist() == [True, False]


NAMES = ("sqr_rev", "abs_rev", "sin_rev", "cos_rev", "tan_rev", "cosh_rev")
PAIRS = ("mul_rev", "pow_rev_base", "pow_rev_exponent", "arctan2_rev_y", "arctan2_rev_x")


def test_arrays_have_the_bits_of_single_intervals() -> None:
    rng = np.random.default_rng(75)
    b, c, x = (IntervalArray(e, e + rng.exponential(1.0, (4, 3))) for e in rng.uniform(-2, 3, (3, 4, 3)))
    for name in NAMES:
        found, free = getattr(c, name)(x), getattr(c, name)()
        for at in np.ndindex(4, 3):
            assert found[at] == getattr(c[at], name)(x[at]) and free[at] == getattr(c[at], name)(ENTIRE)
    for name in PAIRS:
        found = getattr(b, name)(c, x)
        for at in np.ndindex(4, 3):
            assert found[at] == getattr(b[at], name)(c[at], x[at])
    cubes = c.powi_rev(3, x)
    assert all(cubes[at] == c[at].powi_rev(3, x[at]) for at in np.ndindex(4, 3))


def test_shapes_broadcast_and_others_are_refused() -> None:
    column, row = IntervalArray([[1.0], [4.0]]), IntervalArray([-3.0, 0.0, 1.0], [3.0, 3.0, 1.5])
    assert column.sqr_rev(row).shape == (2, 3) == Interval(1.0, 4.0).mul_rev(column, row).shape
    assert Interval(4.0).sqr_rev(np.float64(2.0)) == Interval(2.0) == Interval(4.0).powi_rev(2, np.array(2.0))
    assert Interval(4.0).powi_rev(np.int64(2), row)[1] == Interval(2.0)
    with pytest.raises(IvsidError, match=r"shapes \(2, 1\) and \(3, 3\) do not fit"):
        column.sqr_rev(IntervalArray(np.ones((3, 3))))
    for n in (2**31, 2.0, None, "two"):
        with pytest.raises(IvsidError, match="powi_rev takes an integer between"):
            Interval(4.0).powi_rev(n)
        with pytest.raises(IvsidError, match="powi_rev takes an integer between"):
            column.powi_rev(n)
    with pytest.raises(IvsidError, match="the lower bound"):
        Interval(4.0).sqr_rev("text")
