"""Thrusts behind a first-order lag of held demands, in intervals."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray, follow
from ivsid.log import Log
from ivsid.propulsion.thrust import ThrustCurve

# A mean over a step, p a + (1 - p) b with 0 <= p <= 1, is rounded four times, each by at most 2^-53 of |a| + |b|.
STEP_ROUNDING: Final = 1e-15
# exp and the quotient before it are good to a few units in the last place.
DECAY_ROUNDING: Final = 1e-14
# A step this much longer than the usual one has lost a row, and the row may have carried a new demand: demands in it are unknown.
GAP: Final = 1.5


def lagged(
    curve: ThrustCurve,
    demand: NDArray[np.float64],
    error: NDArray[np.float64],
    log: Log,
    there: NDArray[np.bool_],
    tau: float,
) -> tuple[IntervalArray, IntervalArray]:
    """The thrust behind a first-order lag of held demands, at rows and as mean over steps.

    Under a held demand with thrust G the lag is exact, T(t) = G + (T_0 - G) exp(-t / tau); T_0 is nothing or whatever the curve allows
    before the first row, and again after a gap or a missing demand. On its way from rest to a curve that does not begin there a shaft
    gives anything between no thrust and that of the curve's nearer end.
    """
    shaft = curve.thruster.lag == "demand"
    low, high = curve.range
    if not np.isfinite(low) or not np.isfinite(high):
        raise IvsidError(
            f"thruster {curve.thruster.name} claims a time_constant, and what it did before the log is anything its curve allows; "
            "end the curve with demand_range = [lowest, highest]"
        )
    everything = curve.interval(np.array([low]), np.array([high]))
    rest = curve.thruster.neutral
    if shaft:
        # A demand outside the curve is held at its end before the shaft follows it.
        goal = IntervalArray(*curve.inside(demand - error, demand + error))
        start = min(low, rest), max(high, rest)
    else:
        goal = curve.interval(demand, error=error)
        start = min(float(everything.lower[0]), 0.0), max(float(everything.upper[0]), 0.0)
    steps = np.diff(log.t)
    whole = (steps <= GAP * log.period) & there[:-1] & there[1:]
    ratio = steps / tau
    slack = DECAY_ROUNDING * (1 + ratio) + 2 * np.max(log.time_error) / tau
    at = follow(start, goal, np.exp(-ratio), slack, whole)
    if shaft:
        reach = at[:-1].hull(at[1:])
        return _of_shaft(curve, at), _of_shaft(curve, reach)
    share = np.where(ratio > 1e-8, -np.expm1(-ratio) / np.maximum(ratio, 1e-300), 1.0)
    over = _between(at[:-1], goal[:-1], share, slack + np.where(ratio > 1e-8, 0.0, 1e-8))
    return at, over


def _of_shaft(curve: ThrustCurve, speed: IntervalArray) -> IntervalArray:
    """The thrust at a shaft's speed, from rest on."""
    low, high = curve.range
    thrust = curve.interval(np.clip(speed.lower, low, high), np.clip(speed.upper, low, high))
    rest = curve.thruster.neutral
    if low <= rest <= high:
        return thrust
    starting = speed.lower < low if rest < low else speed.upper > high
    return IntervalArray(
        np.where(starting, np.minimum(thrust.lower, 0.0), thrust.lower),
        np.where(starting, np.maximum(thrust.upper, 0.0), thrust.upper),
    )


def _between(
    a: IntervalArray, b: IntervalArray, share: NDArray[np.float64], slack: NDArray[np.float64]
) -> IntervalArray:
    """P a + (1 - p) b for a share p within its slack."""
    least, most = np.clip(share - slack, 0.0, 1.0), np.clip(share + slack, 0.0, 1.0)
    ends = [(p * a.lower + (1 - p) * b.lower, p * a.upper + (1 - p) * b.upper) for p in (least, most)]
    low = np.minimum(ends[0][0], ends[1][0]) - STEP_ROUNDING * (np.abs(a.lower) + np.abs(b.lower))
    high = np.maximum(ends[0][1], ends[1][1]) + STEP_ROUNDING * (np.abs(a.upper) + np.abs(b.upper))
    return IntervalArray(low, high)
