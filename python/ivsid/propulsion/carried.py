"""Causes in thrusters that ``[model.fitted]`` states: a factor of the thrust, and a delay of the demand, in intervals.

A gain g multiplies the thrust, its error within the accuracy included, by 1 + g, and an asymmetry a by 1 - a to starboard of the centre
line and 1 + a to port. A demand that holds from row to row arrives d later. Its thrust over a step is that of the demand before, up to
the moment of arrival, and its own after it; the mean is a weighted mean of both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import Interval, IntervalArray, of_decimals
from ivsid.log import Log
from ivsid.propulsion.lag import GAP, between
from ivsid.vehicle import Thruster, Vehicle
from ivsid.vehicle.carried import Ends, ends_of, names_of, of_thruster

_GAIN: Final = "thruster.gain"
_ASYMMETRY: Final = "thruster.asymmetry"
_DELAY: Final = "thruster.delay"
# Slack of a moment of arrival [s], as a share of the times from which it is computed, and of its share of a step.
# Source: theorem: three roundings of 2^-53 each, 3.4e-16
ARRIVAL_ROUNDING: Final = 1e-15


@dataclass(frozen=True)
class Fitted:
    """What ``[model.fitted]`` states about one thruster.

    Attributes:
        factor: of the thrust, or None.
        delay: of the demand [s], or None.
    """

    factor: Interval | None = None
    delay: Ends | None = None


def carried_by(vehicle: Vehicle) -> tuple[dict[str, Fitted], tuple[str, ...]]:
    """What the thrusters of a vehicle carry by name, and the numbers of ``[model.fitted]`` that this takes into account.

    A gain beside a stated limit is left out, since the limit caps the thrust with its gain; a delay beside a lag or under demands that
    change on straight lines.
    """
    thrusters = vehicle.thrusters
    scaled = all(t.limit is None for t in thrusters)
    late = vehicle.log.demand == "hold" and not any(t.time_constant for t in thrusters)
    delays = {t.name: of_thruster(vehicle, _DELAY, t.name) for t in thrusters}
    late = late and all(d is None or ends_of(d)[0] >= 0 for d in delays.values())
    found = {}
    for t in thrusters:
        delay = delays[t.name]
        found[t.name] = Fitted(
            _factor(vehicle, t) if scaled else None, ends_of(delay) if late and delay is not None else None
        )
    names = [n for id_ in (_GAIN, _ASYMMETRY) if scaled for n in names_of(vehicle, id_)]
    return found, (*names, *(names_of(vehicle, _DELAY) if late else ()))


def _factor(vehicle: Vehicle, thruster: Thruster) -> Interval | None:
    gain, asymmetry = of_thruster(vehicle, _GAIN, thruster.name), vehicle.model.fitted.get(_ASYMMETRY)
    y = thruster.position[1]
    side = (y > 0) - (y < 0)
    factor: Interval | None = None if gain is None else of_decimals(ends_of(gain)) + 1.0
    if asymmetry is None or asymmetry.value is None or not side:
        return factor
    share: Interval = 1.0 - of_decimals(ends_of(asymmetry)) * float(side)
    both: Interval = share if factor is None else factor * share
    return both


@dataclass(frozen=True)
class Late:
    """Thrusts [N] of demands that arrive late.

    Attributes:
        at_rows: at each row, shape (n,).
        over_steps: means over each step to the next row, shape (n - 1,).
        swept: ranges over each step, shape (n - 1,).
        present: whether the demand that acts at a row is known, shape (n,).
        whole: whether all demands that act over a step are known, shape (n - 1,).
    """

    at_rows: IntervalArray
    over_steps: IntervalArray
    swept: IntervalArray
    present: NDArray[np.bool_]
    whole: NDArray[np.bool_]


def late(thrust: IntervalArray, log: Log, there: NDArray[np.bool_], delay: Ends) -> Late:
    """The thrusts of held demands that arrive late.

    Args:
        thrust: at rest, of the demand of each row, shape (n,).
        log: its clock.
        there: whether each demand is known, shape (n,).
        delay: range of the delay [s].
    """
    t, n = log.t, log.t.size
    reach = 2 * log.time_error + ARRIVAL_ROUNDING * (float(np.abs(t).max()) + delay[1])
    # A step that lost a row may have held a demand that the log lacks.
    whole = np.r_[np.diff(t) <= GAP * log.period, True] & there
    unknown = np.r_[0, np.cumsum(~whole)]

    def acting(first: NDArray[np.float64], last: NDArray[np.float64]) -> tuple[NDArray[np.int64], ...]:
        low = np.searchsorted(t, first - delay[1] - reach, "right") - 1
        high = np.searchsorted(t, last - delay[0] + reach, "right") - 1
        known = (low >= 0) & (unknown[np.maximum(high, 0) + 1] == unknown[np.maximum(low, 0)])
        low = np.where(known, low, 0)
        return low, np.where(known, np.maximum(high, low), low), known

    low, high, present = acting(t, t)
    first, last, over = acting(t[:-1], t[1:])
    swept = _hull(thrust, first, last)
    # With one arrival in a step the mean is that of both thrusts by their times; with more it lies in their range.
    step = np.diff(t)
    middle, half = 0.5 * (delay[0] + delay[1]), 0.5 * (delay[1] - delay[0])
    share = (t[1:] - t[last] - middle) / step
    slack = (half + 2 * reach) / step + ARRIVAL_ROUNDING * (1 + np.abs(share))
    mean = between(thrust[last], thrust[first], share, slack)
    one = last - first == 1
    lower, upper = np.where(one, mean.lower, swept.lower), np.where(one, mean.upper, swept.upper)
    return Late(
        _hull(thrust, low, high), IntervalArray(lower, upper), swept, present.astype(bool) & (n > 0), over.astype(bool)
    )


def _hull(x: IntervalArray, first: NDArray[np.int64], last: NDArray[np.int64]) -> IntervalArray:
    """The hull of the entries from ``first`` to ``last``, of the shape of both."""
    found: IntervalArray = x[first].hull(x[last])
    for k in range(1, int((last - first).max(initial=0))):
        found = found.hull(x[np.minimum(first + k, last)])
    return found
