"""Cross-flow integrals over boxes, against the integrals in fractions."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from ivsid import IntervalArray
from ivsid.effects.cross_flow import cross_flow_over, steepest_over
from ivsid.effects.functions import cross_flow_force, cross_flow_moment
from ivsid.rows.motion import Motion
from sampling import spaced


def integral(v: Fraction, r: Fraction, half: Fraction, power: int, *, absolute: bool) -> Fraction:
    """Of x^power w |w|, or of x^power |w|, w = v + x r: by its antiderivative, on either side of the zero of w."""
    cuts = [-half, half]
    if r and -half < -v / r < half:
        cuts.insert(1, -v / r)
    total = Fraction(0)
    for low, high in pairwise(cuts):
        middle = v + (low + high) / 2 * r
        sign = (middle > 0) - (middle < 0)
        # Coefficients of w or of w^2, by powers of x.
        shape = [v, r] if absolute else [v * v, 2 * v * r, r * r]
        total += sign * sum(
            c * (high ** (k + power + 1) - low ** (k + power + 1)) / (k + power + 1) for k, c in enumerate(shape)
        )
    return total


def boxes(rng: np.random.Generator, count: int) -> tuple[IntervalArray, IntervalArray]:
    """Of every size, around zero and away from it, points too, and ones whose corners meet |v| = |r| h."""
    made = []
    for _ in range(2):
        centre = rng.uniform(-1, 1, count) * 10.0 ** rng.uniform(-6, 1, count)
        radius = abs(centre) * rng.choice([0.0, 1e-9, 0.1, 1.0, 3.0], count)
        made.append([centre - radius, centre + radius])
    (v_low, v_high), (r_low, r_high) = made
    v_low[:20] = v_high[:20] = r_low[:20] * 0.5
    r_low[20:40] = r_high[20:40] = v_high[20:40] * 2
    v_low[20:40] = np.minimum(v_low[20:40], v_high[20:40])
    for k, zero in enumerate((v_low, v_high, r_low, r_high)):
        zero[40 + 5 * k : 45 + 5 * k] = 0.0
    ordered = [(np.minimum(a, b), np.maximum(a, b)) for a, b in ((v_low, v_high), (r_low, r_high))]
    return IntervalArray(*ordered[0]), IntervalArray(*ordered[1])


@pytest.mark.sampled
@pytest.mark.parametrize("length", spaced(["1.0", "1.09", "2.4"], 1))
def test_every_point_of_a_box_has_its_integrals_inside(length):
    rng = np.random.default_rng(int(float(length) * 100))
    v, r = boxes(rng, 120)
    half, exact = 0.5 * float(length), Fraction(length) / 2
    found = [cross_flow_over(v, r, half, power) for power in (0, 1)]
    slopes = steepest_over(v, r, half)
    for k in range(v.size):
        sides = [(Fraction(float(q.lower[k])), Fraction(float(q.upper[k]))) for q in (v, r)]
        shares = [(Fraction(i, 4), Fraction(j, 4)) for i in range(5) for j in range(5)]
        points = [tuple(a + s * (b - a) for s, (a, b) in zip(share, sides, strict=True)) for share in shares]
        # The zeros of v and r, and where the flow begins to have two signs.
        points += [(x, y) for x in (sides[0][0], Fraction(0)) for y in (sides[1][1], Fraction(0))]
        for x, y in points:
            if not (sides[0][0] <= x <= sides[0][1] and sides[1][0] <= y <= sides[1][1]):
                continue
            for power in (0, 1):
                truth = integral(x, y, exact, power, absolute=False)
                assert Fraction(float(found[power].lower[k])) <= truth <= Fraction(float(found[power].upper[k]))
            for power in (0, 1, 2):
                truth = integral(x, y, exact, power, absolute=True)
                assert Fraction(float(slopes[power].lower[k])) <= truth <= Fraction(float(slopes[power].upper[k]))


def test_ends_are_attained_but_for_rounding():
    """The extremes stand at corners and zeros of the box, so an enclosure is as wide as what the corners span."""
    v, r = boxes(np.random.default_rng(7), 200)
    for power in (0, 1):
        found = cross_flow_over(v, r, 0.5, power)
        for k in range(v.size):
            places = [
                [Fraction(float(q.lower[k])), Fraction(float(q.upper[k]))]
                + ([Fraction(0)] if q.lower[k] <= 0 <= q.upper[k] else [])
                for q in (v, r)
            ]
            values = [integral(x, y, Fraction(1, 2), power, absolute=False) for x in places[0] for y in places[1]]
            slack = Fraction(1, 10**13) * max(abs(q) for q in values)
            assert Fraction(float(found.lower[k])) >= min(values) - slack
            assert Fraction(float(found.upper[k])) <= max(values) + slack


def test_the_rate_of_a_motion_holds_its_differences():
    """Secants in fractions: velocities and times are multiples of powers of two, so that the boxes are exact."""
    rng = np.random.default_rng(3)
    t = [Fraction(k, 256) for k in range(40)]
    half = Fraction(0.6)
    for _ in range(40):
        v0, r0, a, b = (Fraction(int(k), 64) for k in rng.integers(-64, 65, 4))
        v, r = [v0 + a * s for s in t], [r0 + b * s for s in t]
        span = [Motion(IntervalArray(np.array(float(min(q))), np.array(float(max(q)))), IntervalArray(np.array(-s), np.array(s)))
                for q, s in ((v, float(abs(a))), (r, float(abs(b))))]  # fmt: skip
        for function, power in ((cross_flow_force, 0), (cross_flow_moment, 1)):
            rate = function(*span, 0.6).rate
            values = [integral(x, y, half, power, absolute=False) for x, y in zip(v, r, strict=True)]
            slopes = [(q - p) / Fraction(1, 256) for p, q in pairwise(values)]
            assert Fraction(float(rate.lower)) <= min(slopes) and max(slopes) <= Fraction(float(rate.upper))
            assert a == b == 0 or any(slopes)
