"""The unit of a demand, told by its range: servo pulse widths about 1500 microseconds, fractions about zero, or percentages."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.vehicle import Thruster

# Servo pulse widths [us]: 1100 to 1900 for the usual thrusters, with room for those that are calibrated to 1000 to 2000. The neutral is
# in the middle.
# Source: a standard: the servo pulse of hobby electronics, 1.5 ms plus or minus 0.5 ms; Blue Robotics Basic ESC, 1100 to 1900 us
PULSES: Final = (1000.0, 2000.0)
# The usual neutral of a pulse width [us].
# Source: a standard: the middle of the servo pulse
NEUTRAL: Final = 1500.0
# The usual distance of a full demand from neutral [us].
# Source: a standard: Blue Robotics Basic ESC, 1100 to 1900 us
HALF_RANGE: Final = 400.0
# Largest fraction of a command, rounding included.
# Source: definition: the whole, with a quantised end of the scale
WHOLE: Final = 1.05
# Largest percentage of a command, rounding included, and the least that the largest one of a log has to reach: below, another quantity of
# a few units is as likely.
# Source: definition: the whole in percent, with a quantised end of the scale, and a tenth of it
PERCENT: Final = (10.0, 105.0)


def percentages(demand: NDArray[np.float64]) -> bool:
    """Whether demands are of the size of percentages: none beyond 105, some beyond 10, and most of those that are not 0 beyond any fraction."""
    size = np.abs(demand[np.isfinite(demand) & (demand != 0.0)])
    if not size.size:
        return False
    return bool(PERCENT[0] < size.max() <= PERCENT[1] and np.median(size) > WHOLE)


def advice(thruster: Thruster, ends: tuple[float, float], demand: NDArray[np.float64]) -> tuple[str, str] | None:
    """The unit of demands, and the key to change, if another unit or neutral than the curve's tells them.

    Args:
        thruster: with its neutral.
        ends: of the demands that its curve covers, counted with the neutral.
        demand: all demands of a log, with at least one number.

    Returns:
        The fault and the remedy in words; None where the demands do not say.
    """
    low, high = ends
    least, most = float(np.nanmin(demand)), float(np.nanmax(demand))
    name, neutral = thruster.name, thruster.neutral
    span = "demand_range" if thruster.table is None else "table"
    fractions, pulses = max(abs(least), abs(most)) <= WHOLE, PULSES[0] <= least and most <= PULSES[1]
    if pulses and neutral == 0.0 and low <= 0.0 and high < PULSES[0]:
        factor = high / HALF_RANGE
        scaled = f'{{ from = "demand_{name}", scale = {factor:.6g}, offset = {-NEUTRAL * factor:.6g} }}'
        return (
            f"these are pulse widths in microseconds, and the curve of thruster {name} counts from {low:g} to {high:g} about its missing neutral",
            f"state neutral = {NEUTRAL:g} (the pulse width without thrust) under [[thrusters]], with the {span} as distances from it, or bring the "
            f"demands to the curve by demand_{name} = {scaled} under [log.columns]",
        )
    if pulses and neutral == 0.0 and thruster.gain is not None and low == -float("inf"):
        return (
            f"these look like pulse widths in microseconds, and the gain of thruster {name} counts from its missing neutral",
            f"state neutral = {NEUTRAL:g} (the pulse width without thrust) and demand_range = [-400, 400] under [[thrusters]]",
        )
    if pulses and neutral >= PULSES[0] and low - neutral >= PULSES[0]:
        return (
            f"the curve of thruster {name} is stated in pulse widths already, and neutral = {neutral:g} shifts it to {low:g} to {high:g}",
            f"leave neutral of thruster {name} out, or state its {span} as distances from neutral",
        )
    if fractions and (low > WHOLE or neutral >= PULSES[0]):
        bounded = low > -float("inf")
        middle = (neutral or NEUTRAL) if not bounded or low <= (neutral or NEUTRAL) <= high else 0.5 * (low + high)
        reach = high - middle if bounded else HALF_RANGE
        scaled = f'{{ from = "demand_{name}", scale = {reach:.6g}, offset = {middle:.6g} }}'
        return (
            f"these are fractions, and the curve of thruster {name} takes pulse widths in microseconds",
            f"bring the demands to the curve by demand_{name} = {scaled} under [log.columns], or leave neutral of thruster {name} out and state its "
            f"{span} in fractions",
        )
    if neutral == 0.0 and 0.0 < max(-low, high) <= WHOLE and percentages(demand):
        return (
            f"these are of the size of percentages, and the curve of thruster {name} counts from {low:g} to {high:g}",
            f'bring the demands to the curve by demand_{name} = {{ from = "demand_{name}", scale = 0.01 }} under [log.columns], or by the factor of '
            f"their own unit, or state its {span} in that unit",
        )
    return None
