"""What the vehicle file already knows of the rigid body: the coupling m x_G, m y_G, and in the added-mass form its mass."""

from __future__ import annotations

from ivsid.effects.terms import Columns, State, square


def rigid_body(state: State, mx: float, my: float, mass: float = 0.0) -> Columns:
    """Known left-hand side: m (udot - v r) and so on, with the coupling of a centre of gravity off the origin.

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


def _plus(a: object, b: object) -> object:
    return b if a is None else a + b  # type: ignore[operator]
