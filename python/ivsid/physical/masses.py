"""Masses: the mass of a body with the water that it moves, along each axis, and the moment of inertia."""

from __future__ import annotations

from typing import Final

import numpy as np

from ivsid.effects import CHANNELS
from ivsid.physical.bound import Box, Inequalities, Subject

KINDS: Final = ("physical.least", "physical.most")
# Least total mass, in the hull's. The water that moves along adds to the dry mass, and half allows for a hull mass that is stated badly.
# Source: Newman, *Marine Hydrodynamics*, 1977, section 4.13 (an added mass is the kinetic energy of the water: it is not negative)
LEAST: Final = 0.5
# Largest total mass, in the hull's. A body that floats displaces its own mass of water, and a flat one moves several times that along.
# Source: Newman, *Marine Hydrodynamics*, 1977, table 4.3 (added mass of bodies); Brennen, NCEL CR 82.010, 1982, of open frames
MOST: Final = 10.0
# Largest variance of positions along a hull of length 1: half of the mass at either end.
# Source: theorem: Popoviciu 1935, the variance of numbers on a segment
VARIANCE: Final = 0.25
# Relative slack of the limits: decimals of the file, their products and differences take fewer than ten roundings of 2^-53.
# Source: theorem: standard model of floating-point arithmetic, Higham 2002, section 2.2
ROUNDING: Final = 2.0**-48


def sentence(subject: Subject) -> str:
    """The bound as an assumption."""
    mass = subject.vehicle.hull.mass
    words = f"each total mass is between {LEAST:g} and {MOST:g} times the hull's {mass:g} kg"
    most = largest_inertia(subject)
    return f"{words}, and the moment of inertia is not negative" + (
        "" if most is None else f" and at most {most:.6g} kg m^2 ({MOST:g} m (L^2 / 4 + |r_G|^2))"
    )


def largest_inertia(subject: Subject) -> float | None:
    """Largest moment of inertia about the origin [kg m^2], with the water: of the largest mass at the ends of the hull; None without a length."""
    hull = subject.vehicle.hull
    if hull.length is None:
        return None
    x_g, y_g = hull.centre_of_gravity
    return MOST * hull.mass * (VARIANCE * hull.length**2 + x_g**2 + y_g**2)


def inequalities(subject: Subject, _box: Box | None = None) -> tuple[Inequalities, ...]:
    """The least and the largest diagonal entry of the inertia matrix, for each equation that has a mass."""
    known, units = subject.inertia()
    _, enclosed = subject.enclosed_inertia()
    mass, largest = subject.vehicle.hull.mass, largest_inertia(subject)
    ends = [(LEAST * mass, MOST * mass)] * 2 + [(0.0, np.inf if largest is None else largest)]
    own = [k for k in range(3) if units[:, k, k].any()]
    made = []
    for kind, sign, place in zip(KINDS, (1.0, -1.0), (0, 1), strict=True):
        at = [k for k in own if np.isfinite(ends[k][place])]
        matrix = enclosed[:, at, at].T * sign
        limits = [ends[k][place] for k in at]
        least = np.array([sign * (limit - known[k, k]) for k, limit in zip(at, limits, strict=True)])
        size = np.array([abs(limit) + abs(float(known[k, k])) for k, limit in zip(at, limits, strict=True)])
        least = least - ROUNDING * size
        offset = [float(known[k, k]) for k in at]

        def words(row: int, reached: float, at=at, sign=sign, limits=limits, offset=offset) -> str:  # type: ignore[no-untyped-def]
            side, beyond = ("at most", "less than") if sign > 0 else ("at least", "more than")
            value, unit = sign * reached + offset[row], "kg m^2" if at[row] == 2 else "kg"
            name = "moment of inertia" if at[row] == 2 else f"total mass in {CHANNELS[at[row]]}"
            limit = f"{limits[row]:.6g} {unit}"
            why = "a hull of this mass and length has" if at[row] == 2 else f"a hull of {mass:g} kg has"
            return f"the {name} is {side} {value:.6g} {unit}, {beyond} the {limit} that {why}"

        zero = np.full(len(at), float(subject.time[0]) if subject.time.size else 0.0)
        made.append(Inequalities(kind, matrix, least, np.array(at, dtype=np.int64), zero, words))
    return tuple(made)
