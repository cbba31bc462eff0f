"""Thrust configuration: forces and moment on the hull from the thrusts of all thrusters (paper eq. 19-20)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ivsid.intervals import IntervalArray
from ivsid.vehicle import Thruster, Vehicle


@dataclass(frozen=True)
class GeneralisedForce:
    """X, Y [N] and the moment N [N m] on the hull, each of shape (n,)."""

    X: IntervalArray
    Y: IntervalArray
    N: IntervalArray


def directions(thruster: Thruster) -> tuple[IntervalArray, IntervalArray, IntervalArray]:
    """The column of a thruster in the thrust configuration matrix (Fossen): cos a, sin a and x sin a - y cos a [m]."""
    x, y = (IntervalArray.around(p, np.spacing(abs(p))) for p in thruster.position)
    if thruster.azimuth == 0.0:
        cosine, sine = IntervalArray(1.0), IntervalArray(0.0)
    else:
        cosine, sine = _enclosed(np.cos(thruster.azimuth)), _enclosed(np.sin(thruster.azimuth))
    return cosine, sine, sine * x - cosine * y


def _enclosed(value: float) -> IntervalArray:
    """An enclosed cosine or sine: the C library is off by one unit in the last place, and the azimuth by half of one."""
    return IntervalArray.around(value, 8 * np.spacing(1.0))


def combine(vehicle: Vehicle, thrusts: Mapping[str, IntervalArray]) -> GeneralisedForce:
    """The sum of the thrusts [N] of all thrusters, given by name and each of shape (n,) (paper eq. 19-20)."""
    shape = next(iter(thrusts.values())).shape
    total = [IntervalArray(np.zeros(shape)) for _ in range(3)]
    for thruster in vehicle.thrusters:
        for k, share in enumerate(directions(thruster)):
            total[k] = total[k] + thrusts[thruster.name] * share
    return GeneralisedForce(*total)
