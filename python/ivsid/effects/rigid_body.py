"""The known rigid body of the vehicle file: the coupling m x_G, m y_G, and in the added-mass form its mass."""

from __future__ import annotations

from ivsid.effects.functions import square
from ivsid.effects.quantity import Quantity
from ivsid.effects.terms import Columns, State


def rigid_body(state: State, mx: float, my: float, mass: float = 0.0) -> Columns:
    """The known part of the left-hand side: X, Y [N] and N [N m] by channel; channels without a known part are left out.

    Fossen's rigid body in the plane with its centre of gravity off the origin: m (udot - v r - x_G r^2 - y_G rdot) in surge,
    m (vdot + u r + x_G rdot - y_G r^2) in sway, m (x_G (vdot + u r) - y_G (udot - v r)) in yaw.

    Args:
        state: velocities and accelerations.
        mx: m x_G [kg m].
        my: m y_G [kg m].
        mass: rigid-body mass [kg] that the parameters leave out; 0 where they hold the total mass.
    """
    surge = sway = yaw = None
    if mass:
        surge, sway = state.ax * mass, state.ay * mass
    if mx:
        surge = _plus(surge, -(square(state.r) * mx))
        sway = _plus(sway, state.rdot * mx)
        yaw = _plus(yaw, state.ay * mx)
    if my:
        surge = _plus(surge, -(state.rdot * my))
        sway = _plus(sway, -(square(state.r) * my))
        yaw = _plus(yaw, -(state.ax * my))
    return {k: c for k, c in (("surge", surge), ("sway", sway), ("yaw", yaw)) if c is not None}


def _plus(a: Quantity, b: Quantity) -> Quantity:
    return b if a is None else a + b
