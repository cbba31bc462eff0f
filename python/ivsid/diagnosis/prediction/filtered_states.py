"""Filtered states of a hypothesis, and how they are carried into the steps of the clock."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.prediction.inside_steps import InsideSteps

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FilteredStates:
    """The states at which a hypothesis is evaluated: first at each sample, then in the middle of each step, of length 2 n.

    Each depends on the past alone: a state at a sample is predicted without its readings, a state in a step is filtered with them.

    Attributes:
        h: the hypothesis under which they are filtered.
        points: the states.
        nudot: the model's accelerations there, shape (3, 2 n).
        ambient: rdot of the ambient moment that the past lets expect at each sample [rad/s^2], shape (n,); a sensor off the origin reads it.
        inside: accelerations inside the steps, where the middle of a step does not stand for all of it.
        rates: whether the log has udot and vdot in the place of specific forces.
    """

    h: Hypothesis
    points: Points
    nudot: Array
    ambient: Array | float = 0.0
    inside: InsideSteps | None = None
    rates: tuple[bool, bool] = (False, False)

    @property
    def over_steps(self) -> Array:
        """The model's mean accelerations over the steps, shape (3, n)."""
        return self.nudot[:, self.points.psi.size // 2 :] if self.inside is None else self.inside.mean

    @cached_property
    def turn(self) -> tuple[Array, Array]:
        """Cosine and sine of the heading over the steps, shape (n,) each; every signature is made at one heading."""
        psi = self.points.psi[self.points.psi.size // 2 :]
        return np.cos(psi), np.sin(psi)

    @cached_property
    def specific(self) -> Array:
        """Specific forces, or udot and vdot [m/s^2] where the log has them, and rdot [rad/s^2] there, shape (3, 2 n)."""
        return as_logged(self.points.nu, self.nudot, self.rates)

    @cached_property
    def over(self) -> Array:
        """Velocity north and east over the steps [m/s], shape (2, n)."""
        return over_ground(self.points, self.turn)

    def under(self, h: Hypothesis) -> FilteredStates:
        """The same states as a start for another hypothesis."""
        return replace(self, h=h)


@dataclass(frozen=True)
class Carried:
    """States that are carried from the start of each step into it.

    Attributes:
        nu: velocities at the start, shape (3, n).
        psi: headings there, shape (n,).
        pushed: ambient accelerations.
        last: states of the pass before, or None.
        early: first moment of accelerations by thrusts that change inside the steps, per step, shape (3, n), or None.
        h: length of a step [s].
    """

    nu: Array
    psi: Array
    pushed: Array | float
    last: FilteredStates | None
    early: Array | None
    h: float

    def velocity(self, place: float) -> Array:
        """Velocities at a place in the steps, shape (3, n).

        The ambient force carries them as the model does: without it, a turning hull at sea has too little u r there.
        """
        by = np.zeros(self.nu.shape)
        if self.last is not None:
            within = self.last.inside
            by += place * self.last.over_steps if within is None else within.until(place)
        return np.asarray(self.nu + self.h * (by + place * self.pushed))

    def mean(self) -> Array:
        """Mean velocities over the steps, which stand for all of each, shape (3, n): an early push carries a hull further than a late one."""
        found = self.velocity(0.5)
        if self.last is not None and self.last.inside is not None:
            return np.asarray(self.nu + self.h * (0.5 * (self.last.over_steps + self.pushed) + self.last.inside.moment))
        if self.last is None or self.early is None:
            return found
        return np.asarray(found + 0.5 * self.h * self.early)

    def heading(self, place: float) -> Array:
        """Headings at a place in the steps, shape (n,)."""
        return np.asarray(self.psi + self.h * place * self.nu[2])


def twice(x: Array) -> Array:
    """The same at samples and over steps."""
    return np.concatenate([x, x], axis=-1)


def as_logged(nu: Array, nudot: Array, rates: tuple[bool, bool]) -> Array:
    """Specific forces udot - v r, vdot + u r [m/s^2] as an accelerometer at the origin reads them, or udot, vdot, and rdot [rad/s^2], shape (3, n)."""
    out = nudot.copy()
    if not rates[0]:
        out[0] -= nu[1] * nu[2]
    if not rates[1]:
        out[1] += nu[0] * nu[2]
    return out


def over_ground(p: Points, turn: tuple[Array, Array]) -> Array:
    """Velocity north and east over the steps [m/s], shape (2, n)."""
    n = p.psi.size // 2
    u, v = p.nu[0, n:], p.nu[1, n:]
    c, s = turn
    return np.stack([u * c - v * s, u * s + v * c])
