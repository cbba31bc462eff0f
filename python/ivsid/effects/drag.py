"""Drag, lift and friction. A positive drag opposes the motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from ivsid.effects.effect import Effect, Force, Numbers, Parameter, term_effect
from ivsid.effects.forms import Hump
from ivsid.effects.functions import (
    astern_square,
    cross_flow_force,
    cross_flow_moment,
    cube,
    signed_square,
    square,
    tanh,
)
from ivsid.effects.terms import Columns, State, Term
from ivsid.errors import IvsidError

# The speed [m/s] at which dry friction has reached tanh(1) = 76 % of its size: the sign of u, made smooth for the integration.
# Source: definition: the term friction.coulomb of the catalogue.
FRICTION_SPEED: Final = 0.02

SURGE_QUADRATIC: Final = Term("drag.surge.quadratic", "-X_|u|u", "kg/m", lambda s: {"surge": signed_square(s.u)})
SWAY_QUADRATIC: Final = Term("drag.sway.quadratic", "-Y_|v|v", "kg/m", lambda s: {"sway": signed_square(s.v)})

# Paper eq. 6: one drag coefficient for surge and sway. On a real hull they differ (docs/theory.md, "The paper's equations, as
# corrected").
SHARED_QUADRATIC: Final = Term(
    "drag.surge.quadratic", "-X_|u|u", "kg/m", lambda s: {"surge": signed_square(s.u), "sway": signed_square(s.v)}
)


def _cross_flow(length: float) -> Callable[[State], Columns]:
    half = 0.5 * length
    return lambda s: {"sway": cross_flow_force(s.v, s.r, half), "yaw": cross_flow_moment(s.v, s.r, half)}


def _without_length(_state: State) -> Columns:
    raise IvsidError("drag.cross_flow acts along the hull; give the vehicle file hull.length [m]")


def _hump(state: State, p: Numbers) -> Columns:
    height, speed, width = p
    # Ahead minus the square of the hyperbolic secant about the speed, astern plus the same: odd and smooth, so that none is left at rest.
    ahead, astern = tanh((state.u - speed) / width), tanh((state.u + speed) / width)
    return {"surge": (square(ahead) - square(astern)) * height}


SURGE_LINEAR: Final = Term("drag.surge.linear", "-X_u", "kg/s", lambda s: {"surge": s.u})
SURGE_CUBIC: Final = Term("drag.surge.cubic", "-X_uuu", "kg s/m^2", lambda s: {"surge": cube(s.u)})
COULOMB: Final = Term("friction.coulomb", "F_c", "N", lambda s: {"surge": tanh(s.u * (1 / FRICTION_SPEED))})
ASTERN: Final = Term("drag.surge.astern", "X_a", "kg/m", lambda s: {"surge": astern_square(s.u)})
SIDESLIP: Final = Term("drag.surge.sideslip", "-X_vv", "kg/m", lambda s: {"surge": square(s.v)})
SWAY_LINEAR: Final = Term("drag.sway.linear", "-Y_v", "kg/s", lambda s: {"sway": s.v})
SWAY_CUBIC: Final = Term("drag.sway.cubic", "-Y_vvv", "kg s/m^2", lambda s: {"sway": cube(s.v)})
SWAY_YAW_RATE: Final = Term("drag.sway.yaw_rate", "-Y_r", "kg m/s", lambda s: {"sway": s.r})
YAW_LINEAR: Final = Term("drag.yaw.linear", "-N_r", "N m s", lambda s: {"yaw": s.r})
YAW_QUADRATIC: Final = Term("drag.yaw.quadratic", "-N_|r|r", "N m s^2", lambda s: {"yaw": signed_square(s.r)})
YAW_CUBIC: Final = Term("drag.yaw.cubic", "-N_rrr", "N m s^3", lambda s: {"yaw": cube(s.r)})
CROSS_FLOW: Final = Term("drag.cross_flow", "rho C_d T / 2", "kg/m^2", _without_length, _cross_flow)
LIFT_SWAY: Final = Term("drag.lift.sway", "-Y_|u|v", "kg/m", lambda s: {"sway": abs(s.u) * s.v})
LIFT_YAW: Final = Term("drag.lift.yaw", "-N_uv", "kg", lambda s: {"yaw": s.u * s.v})

FAMILY: Final[tuple[Effect, ...]] = (
    term_effect(
        SURGE_QUADRATIC,
        28.0,
        "form drag in surge",
        plain=True,
        equivalents=("thruster.gain",),
        separate="coast to rest, or tow at a known force",
    ),
    term_effect(
        SWAY_QUADRATIC,
        150.0,
        "form drag in sway",
        plain=True,
        shares=SURGE_QUADRATIC.id,
        confusable=("drag.cross_flow",),
        turning=True,
        separate="drift sideways without turning, then turn on the spot",
    ),
    term_effect(
        SURGE_LINEAR,
        4.0,
        "laminar skin friction at a low Reynolds number",
        confusable=("friction.coulomb", "thruster.advance_loss", "thruster.curve"),
        separate="coast from full speed to rest; a zigzag tells it from advance loss",
    ),
    term_effect(
        SURGE_CUBIC,
        8.0,
        "drag in surge that grows with the cube of the speed, as where waves or a squatting stern add to the form drag",
        confusable=("thruster.advance_loss", "thruster.curve", "drag.surge.linear"),
        separate="speed steps from a creep to full speed, and a zigzag",
    ),
    Effect(
        "drag.surge.hump",
        "a hump of the wave resistance: about one speed bow and stern waves add up, and the drag stands above that of its neighbours",
        (
            Parameter("height", "", "N", 8.0, lowest=0.0),
            Parameter("speed", "", "m/s", 0.9, draw="fixed", lowest=0.0, exclusive=True),
            Parameter("width", "", "m/s", 0.3, draw="fixed", lowest=0.0, exclusive=True),
        ),
        Force(_hump),
        confusable=("drag.surge.cubic", "drag.surge.linear", "thruster.advance_loss", "thruster.curve"),
        searched=Hump(),
        separate="speed steps of a tenth of full speed each, up to full speed, ahead and astern",
    ),
    term_effect(
        COULOMB,
        1.0,
        "dry friction of a tether drum, a seal or ice, of constant size against the motion",
        confusable=("drag.surge.linear", "thruster.advance_loss"),
        separate="coast through zero speed and reverse",
    ),
    term_effect(
        ASTERN,
        10.0,
        "a hull that is blunter astern than ahead",
        confusable=("thruster.reverse_loss",),
        separate="coast astern with the thrusters off",
    ),
    term_effect(
        SIDESLIP,
        30.0,
        "induced drag of sideslip in turns",
        confusable=("coupling.cg_x", "drag.surge.linear"),
        turning=True,
        separate="vary sideslip against yaw rate: a zigzag, then a slow turn on the spot",
    ),
    term_effect(
        SWAY_LINEAR,
        8.0,
        "linear damping of sideways motion",
        confusable=("drag.lift.sway",),
        turning=True,
        separate="circles at two speeds",
    ),
    term_effect(
        SWAY_CUBIC,
        300.0,
        "drag in sway that grows with the cube of the sideways velocity",
        confusable=("drag.sway.linear", "drag.cross_flow"),
        turning=True,
        separate="drift sideways at several speeds",
    ),
    term_effect(
        SWAY_YAW_RATE,
        4.0,
        "a stern appendage or lateral area off the centre pushes sideways in a turn",
        signed=True,
        confusable=("sensor.velocity.lever_arm", "coupling.cg_x"),
        turning=True,
        separate="measure the sideways acceleration in a zigzag: the kinematic residual stays clean for a force",
    ),
    term_effect(
        YAW_LINEAR,
        1.0,
        "linear damping of turning",
        confusable=("drag.yaw.quadratic", "coupling.cg_x", "added_mass.munk"),
        turning=True,
        separate="zigzags of two amplitudes",
    ),
    term_effect(
        YAW_QUADRATIC,
        2.0,
        "quadratic damping of turning",
        confusable=("drag.yaw.linear", "drag.cross_flow", "coupling.cg_x"),
        turning=True,
        separate="turns whose rates span a factor of four",
    ),
    term_effect(
        YAW_CUBIC,
        4.0,
        "damping of turning that grows with the cube of the yaw rate",
        confusable=("drag.yaw.quadratic", "drag.yaw.linear", "drag.cross_flow"),
        turning=True,
        separate="turns whose rates span a factor of four",
    ),
    term_effect(
        CROSS_FLOW,
        25.0,
        "cross-flow drag along the hull's length, in sway and yaw at once",
        confusable=("drag.yaw.quadratic", "drag.yaw.linear", "drag.sway.quadratic"),
        turning=True,
        separate="circles and turns on the spot: one coefficient must explain both force and moment",
    ),
    term_effect(
        LIFT_SWAY,
        10.0,
        "lift of the hull or a keel in sideslip",
        confusable=("drag.sway.linear",),
        turning=True,
        separate="circles at several speeds",
    ),
    term_effect(
        LIFT_YAW,
        -3.0,
        "lift that acts off the origin: an aft skeg steadies (negative), a bow area turns further",
        signed=True,
        equivalents=("added_mass.munk",),
        equivalent_odds=(1.0,),
        confusable=("coupling.cg_x",),
        turning=True,
        separate="sideways accelerations strong enough to give m_v: the Munk coefficient must equal m_v - m_u; a chirp in yaw",
    ),
)
TERMS: Final[tuple[Term, ...]] = (
    SURGE_QUADRATIC,
    SWAY_QUADRATIC,
    SURGE_LINEAR,
    SURGE_CUBIC,
    COULOMB,
    ASTERN,
    SIDESLIP,
    SWAY_LINEAR,
    SWAY_CUBIC,
    SWAY_YAW_RATE,
    YAW_LINEAR,
    YAW_QUADRATIC,
    YAW_CUBIC,
    CROSS_FLOW,
    LIFT_SWAY,
    LIFT_YAW,
)
