"""The equations of motion forward in time, M nudot = tau - f(nu), from the same terms as the regression rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, State, Term, rigid_body
from ivsid.errors import IvsidError

Velocity: TypeAlias = tuple[Any, Any, Any]
# Largest condition number of a mass matrix: beyond it fewer than four digits of an acceleration are right.
# Source: theorem: perturbation of linear systems, Higham 2002, chapter 7
MOST_ILL_CONDITIONED: Final = 1e12


class Dynamics:
    """A 3-DOF model with numbers for its parameters.

    Args:
        terms: the model.
        values: a number for each id.
        mx: known m x_G [kg m].
        my: known m y_G [kg m].
        mass: known rigid-body mass, where the parameters leave it out [kg].

    Raises:
        IvsidError: a parameter without a value, or a singular mass matrix.

    Velocities are tuples (u, v, r) of floats, or of arrays of equal shape for many runs at once.
    """

    def __init__(
        self, terms: Sequence[Term], values: Mapping[str, float], mx: float, my: float, mass: float = 0.0
    ) -> None:
        missing = [t.id for t in terms if t.id not in values]
        if missing:
            raise IvsidError(f"no value is known for {', '.join(missing)}; the model cannot be simulated")
        self._terms = [(t, float(values[t.id])) for t in terms]
        self._known = (mx, my, mass)
        inertia = np.zeros((3, 3))
        for j in range(3):
            accelerations = [1.0 if k == j else 0.0 for k in range(3)]
            inertia[:, j] = self._left(State(0.0, 0.0, 0.0, *accelerations))
        if not np.isfinite(inertia).all() or np.linalg.cond(inertia) > MOST_ILL_CONDITIONED:
            raise IvsidError("the mass matrix of the model is singular; masses and inertia must be positive")
        self._inverse: list[list[float]] = np.linalg.inv(inertia).tolist()

    def _left(self, state: State) -> list[Any]:
        total: dict[str, Any] = rigid_body(state, *self._known)
        for term, value in self._terms:
            for channel, column in term.columns(state).items():
                total[channel] = total.get(channel, 0.0) + value * column
        return [total.get(c, 0.0) for c in CHANNELS]

    def acceleration(self, nu: Velocity, force: Velocity) -> Velocity:
        """The accelerations (udot, vdot, rdot) [m/s^2, rad/s^2] under a force (X, Y, N) [N, N m]."""
        free = self._left(State(*nu, 0.0, 0.0, 0.0))
        x, y, n = (f - q for f, q in zip(force, free, strict=True))
        a = self._inverse
        return (
            a[0][0] * x + a[0][1] * y + a[0][2] * n,
            a[1][0] * x + a[1][1] * y + a[1][2] * n,
            a[2][0] * x + a[2][1] * y + a[2][2] * n,
        )

    def step(self, nu: Velocity, force: Velocity, h: Any) -> Velocity:
        """The velocities after one step of length ``h`` [s] of the classical Runge-Kutta method, under a constant force."""
        k1 = self.acceleration(nu, force)
        k2 = self.acceleration(_moved(nu, k1, 0.5 * h), force)
        k3 = self.acceleration(_moved(nu, k2, 0.5 * h), force)
        k4 = self.acceleration(_moved(nu, k3, h), force)
        u, v, r = (x + h / 6.0 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(nu, k1, k2, k3, k4, strict=True))
        return u, v, r

    def runs(
        self, starts: NDArray[np.float64], forces: NDArray[np.float64], steps: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The velocities of k runs at once.

        Args:
            starts: velocities at the start, shape (k, 3).
            forces: constant over each step, shape (k, steps, 3).
            steps: lengths [s], shape (k, steps).

        Returns:
            Velocities, shape (k, steps + 1, 3).
        """
        out = np.empty((starts.shape[0], steps.shape[1] + 1, 3))
        out[:, 0] = starts
        nu: Velocity = (starts[:, 0], starts[:, 1], starts[:, 2])
        for i in range(steps.shape[1]):
            force = (forces[:, i, 0], forces[:, i, 1], forces[:, i, 2])
            nu = self.step(nu, force, steps[:, i])
            out[:, i + 1] = np.stack(nu, axis=1)
        return out


def _moved(nu: Velocity, rate: Velocity, h: Any) -> Velocity:
    return nu[0] + h * rate[0], nu[1] + h * rate[1], nu[2] + h * rate[2]
