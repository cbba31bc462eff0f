"""Thrusts behind a first-order lag of held demands, in intervals."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray, follow
from ivsid.log import Log
from ivsid.propulsion.thrust import ThrustCurve

# Slack for a mean over a step, p a + (1 - p) b with 0 <= p <= 1, as a share of |a| + |b|.
# Source: theorem: four roundings of at most 2^-53 each, 4.4e-16.
STEP_ROUNDING: Final = 1e-15
# Slack for a decay exp(-step / tau), and per unit of step / tau.
# Source: definition: exp and the quotient before it are off by a few units of 2^-53, less than a tenth of this.
DECAY_ROUNDING: Final = 1e-14
# A step longer than this multiple of the period has lost a row, which may have held a new demand: demands in it are unknown.
# Source: geometry: the middle between a step of one period and of two.
GAP: Final = 1.5


def lagged(
    curve: ThrustCurve,
    demand: NDArray[np.float64],
    error: NDArray[np.float64],
    log: Log,
    there: NDArray[np.bool_],
    tau: float,
) -> tuple[IntervalArray, IntervalArray]:
    """The thrust [N] behind a first-order lag of held demands: at rows, shape (n,), and as means over steps, shape (n - 1,).

    Under a held demand with thrust G the lag is exact, T(t) = G + (T_0 - G) exp(-t / tau). Before the first row, after a gap and
    after a missing demand, T_0 is 0 or any thrust of the curve. A shaft on its way from rest to a curve that does not begin there
    gives any thrust between 0 and that of the curve's nearer end. For a lag of the shaft the second result is the range over a step.

    Args:
        curve: the thruster's.
        demand: shape (n,); any number where it is missing.
        error: largest distance of a logged demand from the one that was sent, shape (n,).
        log: its clock.
        there: whether a demand is known, shape (n,).
        tau: time constant [s].

    Raises:
        IvsidError: a curve without ends.
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
        # A demand outside the curve becomes that of its end before the shaft follows it.
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
    over = between(at[:-1], goal[:-1], share, slack + np.where(ratio > 1e-8, 0.0, 1e-8))
    return at, over


def _of_shaft(curve: ThrustCurve, speed: IntervalArray) -> IntervalArray:
    """The thrust [N] over a range of shaft speeds, those between rest and the curve included."""
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


def between(
    a: IntervalArray, b: IntervalArray, share: NDArray[np.float64], slack: NDArray[np.float64]
) -> IntervalArray:
    """The range of p a + (1 - p) b for shares p within ``slack`` of ``share``."""
    least, most = np.clip(share - slack, 0.0, 1.0), np.clip(share + slack, 0.0, 1.0)
    ends = [(p * a.lower + (1 - p) * b.lower, p * a.upper + (1 - p) * b.upper) for p in (least, most)]
    low = np.minimum(ends[0][0], ends[1][0]) - STEP_ROUNDING * (np.abs(a.lower) + np.abs(b.lower))
    high = np.maximum(ends[0][1], ends[1][1]) + STEP_ROUNDING * (np.abs(a.upper) + np.abs(b.upper))
    return IntervalArray(low, high)
