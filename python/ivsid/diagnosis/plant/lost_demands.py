"""What demands in lost rows may move the velocities by: jumps that no row of the log shows.

Source: docs/theory.md, "Lost rows".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.driving import Driving
from ivsid.propulsion.foil import rudder_force

Array = NDArray[np.float64]


def lost_impulses(driving: Driving) -> Array:
    """Impulses along X, Y [N s] and about the vertical [N m s] by which forces over lost rows may be off, by the sample before each loss, shape (3, n).

    Args:
        driving: thrusts of the log.
    """
    log = driving.log
    out = np.zeros((3, log.n))
    if log.lost is None:
        return out
    forces = _forces(driving)
    for force, time in zip(forces, log.lost.jump, strict=True):
        off = np.abs(force[:, log.lost.after] - force[:, log.lost.before]) * time
        for axis, one in zip(out, off, strict=True):
            np.add.at(axis, log.lost.before, one)
    return out


def _forces(driving: Driving) -> list[Array]:
    """X, Y [N], N [N m] of each thruster with its rudder, at the velocities that are read, shape (3, n) each."""
    log, vehicle = driving.log, driving.vehicle
    out = []
    for k, thruster in enumerate(vehicle.thrusters):
        thrust = driving.propulsion.curves[k].value(log.demands[k])
        angle, (x, y) = log.angles[k], thruster.position
        along, across = thrust * np.cos(angle), thrust * np.sin(angle)
        force = np.stack([along, across, x * across - y * along])
        if thruster.rudder is not None:
            force = force + np.stack(rudder_force(thruster.rudder, log.rudders[k], thrust, *log.nu))
        out.append(force)
    return out
