"""Rudder forces over intervals of the angle, the propeller's thrust and the motion: the formulas of ``foil``, enclosed."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray, Operand
from ivsid.propulsion.foil import drag_coefficient, lift_coefficient, lift_slope
from ivsid.vehicle import Rudder

# Slack for coefficients in floats, relative and absolute, and for angles [rad].
# Source: definition: a hundred times the rounding of a dozen operations in float64 on decimals that were rounded once.
ROUNDING: Final = 1e-12

# NumPy's types admit no intervals as operands of these functions, its functions do.
_Binary: TypeAlias = Callable[[IntervalArray, Operand], IntervalArray]
_atan2 = cast(_Binary, np.arctan2)
_maximum = cast(_Binary, np.maximum)

Points: TypeAlias = NDArray[np.float64]


def _given(x: float) -> IntervalArray:
    return IntervalArray.around(x, np.spacing(abs(x)))


def _over(
    low: Points,
    high: Points,
    function: Callable[[Points], Points],
    maxima: tuple[float, ...],
    minima: tuple[float, ...],
) -> IntervalArray:
    """The range from ``low`` to ``high`` of a function of period pi that is monotone between its maxima and minima."""
    ends = function(low), function(high)
    least, most = np.minimum(*ends), np.maximum(*ends)
    for places, extreme in ((maxima, np.maximum), (minima, np.minimum)):
        for place in places:
            # The slack exceeds the rounding of the place: a range that ends just before it may count it in, which is safe.
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
    """The range of C_L over intervals of the angle [rad]: it rises from -stall to stall and falls to the next -stall."""
    return _over(alpha.lower, alpha.upper, lambda a: np.asarray(lift_coefficient(a, slope, stall)), (stall,), (-stall,))


def drag_over(alpha: IntervalArray, slope: float, rudder: Rudder) -> IntervalArray:
    """The range of C_D over intervals of the angle [rad]: least along the flow, largest across it."""

    def drag(a: Points) -> Points:
        return np.asarray(drag_coefficient(a, slope, rudder.stall, rudder.drag, rudder.aspect_ratio))

    return _over(alpha.lower, alpha.upper, drag, (math.pi / 2,), (0.0,))


def axial_over(u: IntervalArray, thrust: IntervalArray, rudder: Rudder) -> IntervalArray:
    """The range of ``foil.axial_speed`` [m/s] over u [m/s] and the thrust [N]."""
    squared = u.signed_square()
    if rudder.propeller_diameter is not None:
        disc = _given(rudder.propeller_diameter).square() * IntervalArray.around(math.pi, np.spacing(math.pi)) / 4.0
        squared = squared + _maximum(thrust, 0.0) * 2.0 / (disc * _given(rudder.density))
    ahead, astern = np.sqrt(_maximum(squared, 0.0)), np.sqrt(_maximum(-squared, 0.0))
    # At every point one of the two is 0, so that their difference is the root with its sign.
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
    """X, Y [N] and N [N m] of the blade, each of the shape of the arguments.

    Args:
        rudder: the blade; its ``accuracy`` bounds the error of both coefficients as a share.
        delta: its angle [rad].
        thrust: of the propeller ahead of it [N].
        motion: u, v [m/s], r [rad/s] relative to the water.
    """
    u, v, r = motion
    place = _given(rudder.position)
    axial, across = axial_over(u, thrust, rudder), v + place * r
    speed = np.sqrt(axial.square() + across.square())
    alpha = delta + _atan2(across, axial)
    slope = lift_slope(rudder.aspect_ratio)
    off = float(np.nextafter(rudder.accuracy, np.inf)) if rudder.accuracy else 0.0
    error = IntervalArray(1.0 - off, 1.0 + off)
    lift, drag = lift_over(alpha, slope, rudder.stall) * error, drag_over(alpha, slope, rudder) * error
    pressure = speed * (_given(rudder.density) * _given(rudder.area) * 0.5)
    surge = pressure * (lift * across - drag * axial)
    sway = -(pressure * (lift * axial + drag * across))
    return surge, sway, sway * place
