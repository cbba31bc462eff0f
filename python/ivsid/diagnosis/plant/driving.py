"""What drives a vehicle through a log under a hypothesis: thrusts, angles and known forces, at samples and over steps."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.plant.physics import Hypothesis, still_force
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.effects import Response, Thrust
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# A step of a declared error, in units of its bound.
SMALL: Final = 1e-3
# Hypotheses whose thrusts are remembered: those that are compared with each other.
REMEMBERED: Final = 4


class Driving:
    """Thrusts and angles of a log.

    Attributes:
        propulsion: the thrusters.
        turned: angles of azimuth thrusters [rad], shape (thrusters, 2 n).
        steered: angles of rudders [rad], shape (thrusters, 2 n).
        sent: known X, Y [N], N [N m] beside the thrusters, shape (3, 2 n).
    """

    def __init__(self, vehicle: Vehicle, log: Channels) -> None:
        self.vehicle, self.log = vehicle, log
        self.propulsion = Propulsion(vehicle, log)
        self.turned, self.steered, self.sent = (_over(x, held=log.held) for x in (log.angles, log.rudders, log.force))
        if log.between is not None:
            self.turned = np.concatenate([log.angles, log.between.angles.mean(axis=2)], axis=1)
            self.steered = np.concatenate([log.rudders, log.between.rudders.mean(axis=2)], axis=1)
        self._turn = np.cos(self.turned), np.sin(self.turned)
        self._known: dict[object, tuple[Array, Array, Array | None]] = {}

    def thrusts(self, h: Hypothesis) -> Array:
        """Thrusts of a hypothesis at samples and over steps, shape (thrusters, 2 n)."""
        return self.whole(h)[0]

    def force(self, h: Hypothesis) -> tuple[Array, Array]:
        """The same, and the force that they come to at no speed, shape (3, 2 n)."""
        return self.whole(h)[:2]

    def whole(self, h: Hypothesis) -> tuple[Array, Array, Array | None]:
        """The same, and how much of the force comes early in the steps, shape (3, n); most steps of a fit leave all of it as it is."""
        sizes = [self._sizes(h, k) for k in range(len(self.vehicle.thrusters))]
        acting = [g for g in h.given if isinstance(g.effect.acts, (Thrust, Response))]
        key = (tuple((g.effect.id, g.values, g.thruster) for g in acting), tuple(map(tuple, sizes)))
        found = self._known.get(key)
        if found is None:
            made = self.propulsion.thrusts(h.given, sizes)
            thrusts = np.concatenate([made.now, made.mean], axis=1)
            found = thrusts, still_force(self.vehicle, thrusts, self._turn, self.sent), self._early(made.parts)
            # The oldest goes; a dictionary keeps the order.
            for old in list(self._known)[: 1 - REMEMBERED]:
                self._known.pop(old, None)
            self._known[key] = found
        return found

    def _early(self, parts: Array | None) -> Array | None:
        """The force of thrusts that change inside the steps, weighted by how early it comes."""
        between = self.log.between
        if parts is None or between is None:
            return None
        pushes = (parts * between.lean).reshape(len(parts), -1)
        angles = between.angles.reshape(pushes.shape)
        none = np.zeros((3, pushes.shape[1]))
        total = still_force(self.vehicle, pushes, (np.cos(angles), np.sin(angles)), none)
        return np.asarray(total.reshape(3, self.log.n, -1).sum(axis=2))

    def _sizes(self, h: Hypothesis, k: int) -> list[float]:
        name = self.vehicle.thrusters[k].name
        return [h.declared_errors.get(f"~thrust.{name}.{j}", 0.0) for j in range(len(self.propulsion.errors[k]))]

    def shapes(self, h: Hypothesis, k: int) -> list[Array]:
        """How a thruster's thrust changes with the size of each declared error: at samples, then over steps."""
        sizes = self._sizes(h, k)
        base = self.propulsion.one(k, h.given, sizes)
        found = []
        for j in range(len(sizes)):
            more = [s + (SMALL if i == j else 0.0) for i, s in enumerate(sizes)]
            moved = self.propulsion.one(k, h.given, more)
            found.append(np.concatenate([b - a for a, b in zip(base, moved, strict=True)]) / SMALL)
        return found


def _over(x: Array, *, held: bool) -> Array:
    """What is sent, at samples and in the middle of steps."""
    return (
        np.concatenate([x, x], axis=-1)
        if held
        else np.concatenate([x, 0.5 * (x + np.c_[x[..., 1:], x[..., -1:]])], axis=-1)
    )
