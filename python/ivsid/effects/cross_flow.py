"""Cross-flow integrals over the length of a hull, enclosed by their extremes in closed form.

With w = v + x r and x from -h to h the force is the integral of w |w|, the moment that of x w |w|. If w has one sign along the
hull (|v| >= |r| h), both are polynomials. Otherwise they are split at the zero of w, with s = v / r:

    force   sgn(v) (2 h v^2 + 2 h^3 r^2 / 3)      or  sgn(v) 2 |v| (h^2 |r| + v^2 / (3 |r|))
    moment  sgn(r) 4 h^3 |v| |r| / 3              or  sgn(r) (h^4 r^2 / 2 + v^2 (h^2 - s^2 / 6))

Derivatives of the force are twice the integral of |w| (by v) and of x |w| (by r). Derivatives of the moment are twice the integral
of x |w| (by v) and of x^2 |w| (by r). The integrals of |w| and x^2 |w| are not negative, and that of x |w| has the sign of v r.
Therefore the force grows with v, and with |r| where v > 0; the moment grows with r, and with |v| where r > 0. Their extremes over a
box stand at its corners and at its zeros. All three integrals grow in size with |v| and with |r|.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import FloatArray, Interval, IntervalArray

# From the sizes |v| and |r| as points, and half the length with the rounding of its decimals, to an integral.
Formula: TypeAlias = Callable[[IntervalArray, IntervalArray, Interval], IntervalArray]


def cross_flow_over(v: IntervalArray, r: IntervalArray, half: float, power: int) -> IntervalArray:
    """The range of the cross-flow integral over boxes of v and r; [-inf, inf] where a box is unbounded.

    Args:
        v: sideways velocity [m/s].
        r: yaw rate [rad/s], of the same shape.
        half: half the length of the hull [m], a decimal that was rounded.
        power: of x: 0 for the force [m^3/s^2], 1 for the moment [m^4/s^2].
    """
    (v_low, v_high, r_low, r_high), known = _finite(v, r)
    least = [
        np.where((a > 0) | (b < 0), np.minimum(abs(a), abs(b)), 0.0) for a, b in ((v_low, v_high), (r_low, r_high))
    ]
    most = [np.maximum(abs(a), abs(b)) for a, b in ((v_low, v_high), (r_low, r_high))]
    own, other = (0, 1) if power == 0 else (1, 0)
    low, high = ((v_low, v_high), (r_low, r_high))[own]
    ends = []
    for end, outer in ((low, low < 0), (high, high > 0)):
        # At the outer end the other velocity adds to the size; at the inner end its smallest value gives the extreme.
        pair = [abs(end), np.where(outer, most[other], least[other])]
        ends.append(_size(pair[own], pair[other], half, _FORCE if power == 0 else _MOMENT))
    below = np.where(low < 0, -ends[0].upper, ends[0].lower)
    above = np.where(high > 0, ends[1].upper, -ends[1].lower)
    return IntervalArray(np.where(known, below, -np.inf), np.where(known, above, np.inf))


def steepest_over(
    v: IntervalArray, r: IntervalArray, half: float
) -> tuple[IntervalArray, IntervalArray, IntervalArray]:
    """Symmetric enclosures of the integrals of |w|, x |w| and x^2 |w| over boxes of v [m/s] and r [rad/s], half [m].

    They are half the derivatives of force and moment.
    """
    (v_low, v_high, r_low, r_high), known = _finite(v, r)
    speed, turn = np.maximum(abs(v_low), abs(v_high)), np.maximum(abs(r_low), abs(r_high))
    found = []
    for formulas in (_PLAIN, _FIRST, _SECOND):
        reach = np.where(known, _size(speed, turn, half, formulas).upper, np.inf)
        found.append(IntervalArray(-reach, reach))
    return found[0], found[1], found[2]


def _finite(v: IntervalArray, r: IntervalArray) -> tuple[list[FloatArray], NDArray[np.bool_]]:
    bounds = [v.lower, v.upper, r.lower, r.upper]
    known: NDArray[np.bool_] = np.asarray(np.isfinite(bounds).all(axis=0))
    return [np.where(known, b, 0.0) for b in bounds], known


def _size(v: FloatArray, r: FloatArray, half: float, formulas: tuple[Formula, Formula]) -> IntervalArray:
    """An integral at |v| and |r|, ``formulas`` being those for one and for two signs of the flow along the hull.

    The hull of both is taken if the rounding of the length leaves the case open.
    """
    h = Interval(float(np.nextafter(half, 0.0)), float(np.nextafter(half, np.inf)))
    speed, turn = IntervalArray(v), IntervalArray(r)
    reach = turn * h
    one, two = v >= reach.lower, v < reach.upper
    simple = formulas[0](speed, turn, h)
    if not two.any():
        return simple
    # The rate may be 0 if the flow has one sign: any other value stands in for it there.
    split = formulas[1](IntervalArray(np.where(two, v, 0.0)), IntervalArray(np.where(two, r, 1.0)), h)
    lower = np.where(two, np.where(one, np.minimum(simple.lower, split.lower), split.lower), simple.lower)
    upper = np.where(two, np.where(one, np.maximum(simple.upper, split.upper), split.upper), simple.upper)
    return IntervalArray(lower, upper)


_FORCE: tuple[Formula, Formula] = (
    lambda v, r, h: v.square() * (2.0 * h) + r.square() * (h**3 * 2.0 / 3.0),
    lambda v, r, h: (r * h**2 + v.square() / (r * 3.0)) * v * 2.0,
)
_MOMENT: tuple[Formula, Formula] = (
    lambda v, r, h: v * r * (h**3 * 4.0 / 3.0),
    lambda v, r, h: r.square() * (h**4 * 0.5) + v.square() * (h**2 - (v / r).square() / 6.0),
)
_PLAIN: tuple[Formula, Formula] = (
    lambda v, _r, h: v * (2.0 * h),
    lambda v, r, h: r * h**2 + v.square() / r,
)
_FIRST: tuple[Formula, Formula] = (
    lambda _v, r, h: r * (h**3 * 2.0 / 3.0),
    lambda v, r, h: v * (h**2 - (v / r).square() / 3.0),
)
_SECOND: tuple[Formula, Formula] = (
    lambda v, _r, h: v * (h**3 * 2.0 / 3.0),
    lambda v, r, h: r * (h**4 * 0.5) + v * (v / r) * (v / r).square() / 6.0,
)
