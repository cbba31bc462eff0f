"""The force of a rudder in intervals of its angle, the propeller's thrust and the motion: the formulas of ``foil``, enclosed."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from ivsid.intervals import IntervalArray
from ivsid.propulsion.foil import drag_coefficient, lift_coefficient, lift_slope
from ivsid.vehicle import Rudder

# Coefficients in floats, from decimals of the file that were rounded once, are good to some 1e-15 of their size; the curve is
# Lipschitz with a constant of a few.
ROUNDING: Final = 1e-12

# NumPy's types know no intervals, its functions do.
_atan2: Any = np.arctan2
_maximum: Any = np.maximum
_sqrt: Any = np.sqrt


def _given(x: float) -> IntervalArray:
    return IntervalArray.around(x, np.spacing(abs(x)))


def _over(low: Any, high: Any, function: Any, tops: tuple[float, ...], bottoms: tuple[float, ...]) -> IntervalArray:
    """The range of a function of period pi that is monotone between its tops and bottoms."""
    ends = function(low), function(high)
    least, most = np.minimum(*ends), np.maximum(*ends)
    for places, extreme in ((tops, np.maximum), (bottoms, np.minimum)):
        for place in places:
            # Widened by far more than the place's rounding: a range that only touches it may count it in.
            first = np.ceil((low - place) / math.pi - ROUNDING)
            reached = first * math.pi + place <= high + ROUNDING
            value = function(np.full(np.shape(low), place))
            if extreme is np.maximum:
                most = np.where(reached, np.maximum(most, value), most)
            else:
                least = np.where(reached, np.minimum(least, value), least)
    slack = ROUNDING * (1 + np.abs(least) + np.abs(most))
    return IntervalArray(least - slack, most + slack)


def lift_over(alpha: IntervalArray, slope: float, stall: float) -> IntervalArray:
    """C_L over all angles of an interval: it rises from -stall to stall and falls from there to the next -stall."""
    return _over(alpha.lower, alpha.upper, lambda a: np.asarray(lift_coefficient(a, slope, stall)), (stall,), (-stall,))


def drag_over(alpha: IntervalArray, slope: float, rudder: Rudder) -> IntervalArray:
    """C_D over all angles of an interval: least along the flow, most across it."""

    def drag(a: Any) -> Any:
        return np.asarray(drag_coefficient(a, slope, rudder.stall, rudder.drag, rudder.aspect_ratio))

    return _over(alpha.lower, alpha.upper, drag, (math.pi / 2,), (0.0,))


def axial_over(u: IntervalArray, thrust: IntervalArray, rudder: Rudder) -> IntervalArray:
    """The water's speed along the hull at the blade [m/s], as ``foil.axial_speed``."""
    squared = u.signed_square()
    if rudder.propeller_diameter is not None:
        disc = _given(rudder.propeller_diameter).square() * IntervalArray.around(math.pi, np.spacing(math.pi)) / 4.0
        squared = squared + _maximum(thrust, 0.0) * 2.0 / (disc * _given(rudder.density))
    ahead, astern = _sqrt(_maximum(squared, 0.0)), _sqrt(_maximum(-squared, 0.0))
    # One of the two is 0 at any point: the root with its sign.
    return IntervalArray(
        np.where(squared.lower >= 0, ahead.lower, -astern.upper),
        np.where(squared.upper <= 0, -astern.lower, ahead.upper),
    )


def rudder_over(
    rudder: Rudder,
    delta: IntervalArray,
    thrust: IntervalArray,
    motion: tuple[IntervalArray, IntervalArray, IntervalArray],
) -> tuple[IntervalArray, IntervalArray, IntervalArray]:
    """X, Y [N] and N [N m] of the blade.

    Args:
        rudder: the blade; its ``accuracy`` bounds the error of both coefficients as a share.
        delta: its angle [rad].
        thrust: of the propeller before it [N].
        motion: u, v [m/s], r [rad/s] relative to the water.
    """
    u, v, r = motion
    place = _given(rudder.position)
    axial, across = axial_over(u, thrust, rudder), v + place * r
    speed = _sqrt(axial.square() + across.square())
    alpha = delta + _atan2(across, axial)
    slope = lift_slope(rudder.aspect_ratio)
    off = float(np.nextafter(rudder.accuracy, np.inf)) if rudder.accuracy else 0.0
    error = IntervalArray(1.0 - off, 1.0 + off)
    lift, drag = lift_over(alpha, slope, rudder.stall) * error, drag_over(alpha, slope, rudder) * error
    pressure = speed * (_given(rudder.density) * _given(rudder.area) * 0.5)
    surge = pressure * (lift * across - drag * axial)
    sway = -(pressure * (lift * axial + drag * across))
    return surge, sway, sway * place
