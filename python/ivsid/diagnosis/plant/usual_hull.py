"""Length and plain numbers of a usual hull, for a vehicle file that states none: one of 60 kg and 1 m, scaled after Froude."""

from __future__ import annotations

from typing import Final

from ivsid.vehicle import Vehicle

# Mass over length cubed [kg/m^3].
# Source: definition: the catalogue's reference vehicle of 1 m, whose 58 kg (effects.effect.REFERENCE_MASS) are rounded
MASS_PER_CUBE: Final = 60.0
# Sway mass over dry mass: the mass of the water that moves along comes on top of the hull's.
# Source: measured: make constants
SWAY_MASS: Final = 1.4
# Inertia in yaw over mass and squared length: more than the 1/12 of a uniform rod, because the inertia of the water comes on top.
# Source: measured: make constants
YAW_INERTIA: Final = 0.12
# Quadratic sway drag over mass per length.
# Source: measured: make constants
SWAY_DRAG: Final = 2.5


def hull_length(vehicle: Vehicle) -> float:
    """The length of the hull [m], or that of a usual one of its mass."""
    return vehicle.hull.length or float((vehicle.hull.mass / MASS_PER_CUBE) ** (1 / 3))


def usual_numbers(vehicle: Vehicle) -> dict[str, float]:
    """Sway mass [kg], inertia in yaw [kg m^2] and quadratic sway drag [kg/m] of a usual hull of this mass and length."""
    m, length = vehicle.hull.mass, hull_length(vehicle)
    return {
        "mass.sway": SWAY_MASS * m,
        "inertia.yaw": YAW_INERTIA * m * length**2,
        "drag.sway.quadratic": SWAY_DRAG * m / length,
    }
