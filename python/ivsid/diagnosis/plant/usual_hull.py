"""A length and plain numbers for a hull that states none: the catalogue's vehicle of 60 kg and 1 m, scaled after Froude."""

from __future__ import annotations

from typing import Final

from ivsid.vehicle import Vehicle

# Mass over length cubed [kg/m^3].
# Source: definition: the catalogue's typical sizes belong to a hull of 60 kg and 1 m
MASS_PER_CUBE: Final = 60.0
# Sway mass over dry mass: the mass of the water that moves along comes on top of the hull's.
# Source: none
SWAY_MASS: Final = 1.4
# Inertia in yaw over mass and squared length.
# Source: physics: 1/12 is a uniform rod's, and the added inertia comes on top
YAW_INERTIA: Final = 0.12
# Quadratic sway drag over mass per length.
# Source: none
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
