"""Forces of thrusters and of the rudders behind them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.points import Points
from ivsid.effects import Given, Inflow, acting, with_stated
from ivsid.propulsion.foil import rudder_force
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# u, v, r relative to the water.
Relative: TypeAlias = tuple[Array, Array, Array]


def blade_force(vehicle: Vehicle, k: int, p: Points, push: Array, relative: Relative) -> Array:
    """X, Y [N], N [N m] of the rudder behind a thruster, shape (3, n); zero without one.

    Args:
        vehicle: of the thruster.
        k: its index.
        p: states.
        push: its thrust [N], shape (n,).
        relative: u, v [m/s] and r [rad/s] relative to the water, shape (n,) each.
    """
    rudder = vehicle.thrusters[k].rudder
    if rudder is None or p.rudders is None:
        return np.zeros_like(p.nu)
    return np.stack(rudder_force(rudder, p.rudders[k], push, *relative))


def thruster_force(
    vehicle: Vehicle,
    given: Sequence[Given],
    p: Points,
    relative: Relative,
    declared_errors: Mapping[str, float] | None = None,
) -> Array:
    """X, Y [N], N [N m] of all thrusters and rudders, shape (3, n).

    Args:
        vehicle: with its thrusters.
        given: effects of a hypothesis, of which losses by inflow act here.
        p: states and thrusts.
        relative: u, v [m/s] and r [rad/s] relative to the water, shape (n,) each.
        declared_errors: sizes of declared errors, of which those of rudders act here.
    """
    return ThrusterForces(vehicle, given, declared_errors).at(p, relative)


class ThrusterForces:
    """Forces of all thrusters and rudders under some effects.

    Args:
        vehicle: with its thrusters.
        given: effects of a hypothesis, of which losses by inflow act here.
        declared_errors: sizes of declared errors, of which those of rudders act here.
    """

    def __init__(
        self, vehicle: Vehicle, given: Sequence[Given], declared_errors: Mapping[str, float] | None = None
    ) -> None:
        self.vehicle, self._errors = vehicle, declared_errors or {}
        self._lost = [acting(with_stated(given, Inflow, thruster), Inflow) for thruster in vehicle.thrusters]
        self._at_no_speed = not any(self._lost) and all(t.rudder is None for t in vehicle.thrusters)

    def at(self, p: Points, relative: Relative) -> Array:
        """X, Y [N], N [N m], shape (3, n).

        Args:
            p: states and thrusts.
            relative: u, v [m/s] and r [rad/s] relative to the water, shape (n,) each.
        """
        if p.bollard is not None and self._at_no_speed:
            return p.bollard.copy()
        u, v, r = relative
        total = np.zeros_like(p.nu)
        along, across = p.swing or (np.cos(p.angles), np.sin(p.angles))
        for k, thruster in enumerate(self.vehicle.thrusters):
            c, s = along[k], across[k]
            x, y = thruster.position
            push = p.thrusts[k]
            for loss, numbers in self._lost[k]:
                push = loss.function(push, (u - r * y) * c + (v + r * x) * s, numbers)
            total[0] += push * c
            total[1] += push * s
            total[2] += push * (s * x - c * y)
            if thruster.rudder is not None:
                off = self._errors.get(f"~rudder.{thruster.name}", 0.0)
                total += (1.0 + off) * blade_force(self.vehicle, k, p, push, relative)
        return total


def bollard_force(vehicle: Vehicle, thrusts: Array, turn: tuple[Array, Array]) -> Array:
    """X, Y [N], N [N m] of thrusts at no speed, without rudders, shape (3, n).

    Args:
        vehicle: with its thrusters.
        thrusts: [N], shape (thrusters, n).
        turn: cosines and sines of their angles, shape (thrusters, n) each.
    """
    total = np.zeros((3, *thrusts.shape[1:]))
    for thruster, push, c, s in zip(vehicle.thrusters, thrusts, *turn, strict=True):
        x, y = thruster.position
        total[0] += push * c
        total[1] += push * s
        total[2] += push * (s * x - c * y)
    return total
