"""Length and plain numbers of a usual hull, for a vehicle file that states none: one of 60 kg and 1 m, scaled after Froude; and what no hull has."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from ivsid.effects import EFFECTS, Term, terms_of
from ivsid.effects.drag import SWAY_QUADRATIC
from ivsid.effects.inertia import INERTIA_YAW, MASS_SWAY
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
# Most that a drag or a coupling beside the plain model's is, in its typical size for the hull's mass.
# Source: measured: vessels of 5 kg to 27,000 t by strangers had a thousand times at most, in yaw; a drag astern in a log that never goes astern came to 25,000 and more
FARTHEST: Final = 1e4


def hull_length(vehicle: Vehicle) -> float:
    """The length of the hull [m], or that of a usual one of its mass."""
    return vehicle.hull.length or float((vehicle.hull.mass / MASS_PER_CUBE) ** (1 / 3))


def usual_numbers(vehicle: Vehicle) -> dict[str, float]:
    """Numbers of a usual hull of this mass and length for the plain model's terms that a log without turning may leave open, by id.

    Sway mass [kg], inertia in yaw [kg m^2] and quadratic sway drag [kg/m] are scaled from shapes of hulls. Further drags of the vehicle file's
    model that act in turns have the catalogue's typical size.
    """
    m, length = vehicle.hull.mass, hull_length(vehicle)
    effects = [EFFECTS[t.id] for t in terms_of(vehicle) if t.id in EFFECTS]
    return {
        **{e.id: e.parameters[0].scaled(m) for e in effects if e.turning and len(e.parameters) == 1},
        MASS_SWAY.id: SWAY_MASS * m,
        INERTIA_YAW.id: YAW_INERTIA * m * length**2,
        SWAY_QUADRATIC.id: SWAY_DRAG * m / length,
    }


def typical_sizes(vehicle: Vehicle) -> dict[str, tuple[float, float]]:
    """Number of a usual hull and typical size of each parameter of the vehicle file's model, by id; masses along the hull are left out.

    A drag has its typical size. A coupling may have either sign, and a usual hull has none.
    """
    m, found = vehicle.hull.mass, {}
    for effect in (EFFECTS[t.id] for t in terms_of(vehicle) if t.id in EFFECTS):
        if len(effect.parameters) == 1 and effect.of_hull is None:
            size = abs(effect.parameters[0].scaled(m))
            found[effect.id] = (0.0 if effect.parameters[0].signed else size, size)
    shapes = usual_numbers(vehicle)
    return found | {i: (shapes[i], shapes[i]) for i in (MASS_SWAY.id, INERTIA_YAW.id, SWAY_QUADRATIC.id)}


def hull_limits(vehicle: Vehicle, terms: Iterable[Term]) -> dict[str, tuple[float, float]]:
    """Least and most value of the terms' parameters that a hull of this mass and length has, by id; terms without limits are left out.

    A mass lies between shares of the dry mass, a drag that cannot drive is not negative, and one that the log does not excite stays where passes
    of the filters can follow it.
    """
    m, length = vehicle.hull.mass, hull_length(vehicle)
    found = {}
    for term in terms:
        effect = EFFECTS.get(term.id)
        if effect is None or len(effect.parameters) != 1:
            continue
        if effect.of_hull is not None:
            one = m * length**2 if effect.parameters[0].unit == "kg m^2" else m
            found[term.id] = (effect.of_hull[0] * one, effect.of_hull[1] * one)
            continue
        most = float(np.inf) if effect.plain else FARTHEST * abs(effect.parameters[0].scaled(m))
        least = -most if effect.parameters[0].signed else 0.0
        if np.isfinite(least):
            found[term.id] = (least, most)
    return found
