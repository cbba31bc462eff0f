"""Lift and drag of a rudder, in its own flow or behind a propeller."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ivsid.vehicle import Rudder


def lift_slope(aspect_ratio: float) -> float:
    """dC_L/d alpha of a foil of small aspect ratio (Soeding): 2 pi L (L + 0.7) / (L + 1.7)^2."""
    return 2 * math.pi * aspect_ratio * (aspect_ratio + 0.7) / (aspect_ratio + 1.7) ** 2


def lift_coefficient(alpha: Any, slope: float, stall: float) -> Any:
    """C_L at an angle of attack [rad]: slope sin(alpha) up to the stall, then falling like a cosine to none across the flow.

    In flow from behind the foil works alike, so angles count from the nearest multiple of pi.
    """
    a = alpha - np.pi * np.round(alpha / np.pi)
    attached = slope * np.sin(a)
    past = (np.abs(a) - stall) / (math.pi / 2 - stall)
    beyond = slope * math.sin(stall) * np.cos(math.pi / 2 * past) * np.sign(a)
    return _value(np.where(np.abs(a) <= stall, attached, beyond), alpha)


def drag_coefficient(alpha: Any, slope: float, stall: float, least: float, aspect_ratio: float) -> Any:
    """C_D: friction, induced drag with a span efficiency of 0.9, and beyond the stall the drag of a plate."""
    a = alpha - np.pi * np.round(alpha / np.pi)
    reached = np.minimum(np.abs(a), stall)
    induced = (slope * np.sin(reached)) ** 2 / (0.9 * math.pi * aspect_ratio)
    return _value(least + induced + 1.2 * (np.sin(a) ** 2 - np.sin(reached) ** 2), alpha)


def _value(result: Any, like: Any) -> Any:
    return float(result) if isinstance(like, float) else result


def axial_speed(u: Any, thrust: Any, rudder: Rudder) -> Any:
    """The water's speed along the hull at the blade [m/s]: the slipstream of a thrust ahead adds 2 T / (rho A) to its square.

    Momentum theory; a thrust astern sends its stream away from the rudder.
    """
    squared = u * np.abs(u)
    if rudder.propeller_diameter is not None:
        disc = math.pi * rudder.propeller_diameter**2 / 4
        squared = squared + 2 * np.maximum(thrust, 0.0) / (rudder.density * disc)
    return _value(np.sign(squared) * np.sqrt(np.abs(squared)), u)


def rudder_force(rudder: Rudder, delta: Any, thrust: Any, u: Any, v: Any, r: Any) -> tuple[Any, Any, Any]:
    """X, Y [N] and N [N m] of the blade, for floats or arrays.

    Args:
        rudder: the blade.
        delta: its angle [rad], trailing edge to starboard positive: the vehicle turns to starboard.
        thrust: of the propeller before it [N].
        u: velocity relative to the water ahead [m/s].
        v: to starboard [m/s].
        r: yaw rate [rad/s].
    """
    axial = axial_speed(u, thrust, rudder)
    across = v + rudder.position * r
    speed = np.sqrt(axial * axial + across * across)
    alpha = delta + np.arctan2(across, axial)
    slope = lift_slope(rudder.aspect_ratio)
    lift = lift_coefficient(alpha, slope, rudder.stall)
    drag = drag_coefficient(alpha, slope, rudder.stall, rudder.drag, rudder.aspect_ratio)
    # Lift stands across the blade's way through the water, drag against it.
    pressure = 0.5 * rudder.density * rudder.area * speed
    surge = pressure * (lift * across - drag * axial)
    sway = -pressure * (lift * axial + drag * across)
    return _value(surge, u), _value(sway, u), _value(rudder.position * sway, u)
