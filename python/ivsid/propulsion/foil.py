"""Lift and drag of a rudder, in the free stream or behind a propeller."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from ivsid.vehicle import Rudder

Number = TypeVar("Number", float, NDArray[np.float64])

# What a formula needs of its numbers. A simulation asks for one number at a time, of which NumPy would make an array first.
_OF_ARRAYS: Final = SimpleNamespace(
    sin=np.sin,
    cos=np.cos,
    sqrt=np.sqrt,
    sign=np.sign,
    whole=np.round,
    least=np.minimum,
    most=np.maximum,
    either=np.where,
)
_OF_FLOATS: Final = SimpleNamespace(
    sin=math.sin,
    cos=math.cos,
    sqrt=math.sqrt,
    sign=lambda x: math.copysign(1.0, x) if x else 0.0,
    whole=lambda x: round(x) if math.isfinite(x) else math.nan,
    least=min,
    most=max,
    either=lambda chosen, one, other: one if chosen else other,
)


def _functions(like: Number) -> SimpleNamespace:
    """The functions of floats or of arrays, whichever a number is."""
    return _OF_FLOATS if isinstance(like, float) else _OF_ARRAYS


def lift_slope(aspect_ratio: float) -> float:
    """dC_L/d alpha [1/rad] of a foil of small aspect ratio L: 2 pi L (L + 0.7) / (L + 1.7)^2 (Soeding)."""
    return 2 * math.pi * aspect_ratio * (aspect_ratio + 0.7) / (aspect_ratio + 1.7) ** 2


def lift_coefficient(alpha: Number, slope: float, stall: float) -> Number:
    """C_L: slope sin(alpha) up to the stall, then falling like a cosine to 0 across the flow.

    The foil works alike in flow from behind, so that angles count from the nearest multiple of pi.

    Args:
        alpha: angle of attack [rad].
        slope: dC_L/d alpha at 0 [1/rad].
        stall: angle of attack beyond which lift falls [rad].
    """
    f = _functions(alpha)
    a = alpha - math.pi * f.whole(alpha / math.pi)
    attached = slope * f.sin(a)
    past = (abs(a) - stall) / (math.pi / 2 - stall)
    beyond = slope * math.sin(stall) * f.cos(math.pi / 2 * past) * f.sign(a)
    return _value(f.either(abs(a) <= stall, attached, beyond), alpha)


def drag_coefficient(alpha: Number, slope: float, stall: float, least: float, aspect_ratio: float) -> Number:
    """C_D: friction, induced drag with a span efficiency of 0.9, and beyond the stall the drag of a plate.

    Args:
        alpha: angle of attack [rad].
        slope: dC_L/d alpha at 0 [1/rad].
        stall: angle of attack beyond which lift falls [rad].
        least: C_D at no angle of attack.
        aspect_ratio: span squared over area.
    """
    f = _functions(alpha)
    a = alpha - math.pi * f.whole(alpha / math.pi)
    reached = f.least(abs(a), stall)
    induced = (slope * f.sin(reached)) ** 2 / (0.9 * math.pi * aspect_ratio)
    return _value(least + induced + 1.2 * (f.sin(a) ** 2 - f.sin(reached) ** 2), alpha)


def _value(result: Any, like: Number) -> Number:
    if isinstance(like, float):
        return float(result)
    value: NDArray[np.float64] = result
    return value


def axial_speed(u: Number, thrust: Number, rudder: Rudder) -> Number:
    """The water's speed along the hull at the blade [m/s]: a thrust ahead adds 2 T / (rho A) to its square (momentum theory).

    A thrust astern sends its stream away from the rudder and adds nothing.

    Args:
        u: velocity relative to the water [m/s].
        thrust: of the propeller [N].
        rudder: with the diameter of the propeller.
    """
    f = _functions(u)
    squared = u * abs(u)
    if rudder.propeller_diameter is not None:
        disc = math.pi * rudder.propeller_diameter**2 / 4
        squared = squared + 2 * f.most(thrust, 0.0) / (rudder.density * disc)
    return _value(f.sign(squared) * f.sqrt(abs(squared)), u)


def rudder_force(
    rudder: Rudder, delta: Number, thrust: Number, u: Number, v: Number, r: Number
) -> tuple[Number, Number, Number]:
    """X, Y [N] and N [N m] of the blade, for floats or arrays of one shape.

    Args:
        rudder: the blade.
        delta: its angle [rad], positive with the trailing edge to starboard, which turns the vehicle to starboard.
        thrust: of the propeller ahead of it [N].
        u: velocity relative to the water ahead [m/s].
        v: to starboard [m/s].
        r: yaw rate [rad/s].
    """
    axial = axial_speed(u, thrust, rudder)
    across = v + rudder.position * r
    f = _functions(u)
    speed = f.sqrt(axial * axial + across * across)
    # NumPy's own for floats as well: that of the mathematical library differs in the last bit.
    alpha = delta + _value(np.arctan2(across, axial), u)
    slope = lift_slope(rudder.aspect_ratio)
    lift = lift_coefficient(alpha, slope, rudder.stall)
    drag = drag_coefficient(alpha, slope, rudder.stall, rudder.drag, rudder.aspect_ratio)
    # Lift is perpendicular to the blade's motion through the water, drag opposes it.
    pressure = 0.5 * rudder.density * rudder.area * speed
    surge = pressure * (lift * across - drag * axial)
    sway = -pressure * (lift * axial + drag * across)
    return _value(surge, u), _value(sway, u), _value(rudder.position * sway, u)
