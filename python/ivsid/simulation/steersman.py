"""A helm that follows a programme: demands by the signs of each thruster's force, angles within their rates."""

from __future__ import annotations

import numpy as np

from ivsid.programme.manoeuvres import Command, Programme
from ivsid.simulation.equations import axis
from ivsid.simulation.integrate import Pose
from ivsid.simulation.true_thrust import TrueThrust
from ivsid.vehicle import Thruster, Vehicle


class Steersman:
    """A helm that follows a programme within the ranges and rates of the thrusters."""

    def __init__(self, vehicle: Vehicle, curves: list[TrueThrust], programme: Programme, step: float) -> None:
        self._curves, self._pilot = curves, programme.pilot()
        self._shares = [_shares(t) for t in vehicle.thrusters]
        self._kinds = [("rudder" if t.rudder is not None else t.steering) for t in vehicle.thrusters]
        self._steers = any(k != "fixed" for k in self._kinds)
        rates = [t.rudder.rate if t.rudder is not None else t.steering_rate for t in vehicle.thrusters]
        self._most = [float("inf") if q is None else q * step for q in rates]
        self._angles = [0.0 for _ in vehicle.thrusters]

    def __call__(self, k: int, state: Pose) -> tuple[list[float], list[float]]:
        """Demands of the thrusters and angles [rad] of rudders and azimuth thrusters from sample k on."""
        asked = self._pilot.command(k, state)
        surge, sway, turn = asked[:3]
        demands = [
            c.clip(a * surge + b * sway + t * turn) for c, (a, b, t) in zip(self._curves, self._shares, strict=True)
        ]
        if self._steers:
            # The motion keeps the list, so that it must be a new one.
            self._angles = [self._turned(j, asked) if kind != "fixed" else 0.0 for j, kind in enumerate(self._kinds)]
        return demands, self._angles

    def _turned(self, j: int, asked: Command) -> float:
        wanted = asked.rudder if self._kinds[j] == "rudder" else asked.azimuth
        now = self._angles[j]
        return now + min(max(wanted - now, -self._most[j]), self._most[j])


def _shares(thruster: Thruster) -> tuple[float, float, float]:
    """Signs of a thruster's force ahead and to starboard, and of its moment to starboard."""
    c, s = axis(0.0 if thruster.steering == "azimuth" else thruster.azimuth)
    x, y = thruster.position
    moment = x * s - y * c
    return tuple(0.0 if abs(q) <= 1e-12 else float(np.sign(q)) for q in (c, s, moment))  # type: ignore[return-value]
