"""Inertia: masses, the moment of inertia, the coupling between channels, and a payload."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from ivsid.effects.effect import Change, Effect, Numbers, Parameter, term_effect
from ivsid.effects.functions import after, square
from ivsid.effects.quantity import Quantity
from ivsid.effects.terms import Term

MASS_SURGE: Final = Term("mass.surge", "m - X_udot", "kg", lambda s: {"surge": s.udot, "sway": s.u * s.r})
MASS_SWAY: Final = Term("mass.sway", "m - Y_vdot", "kg", lambda s: {"surge": -(s.v * s.r), "sway": s.vdot})
INERTIA_YAW: Final = Term("inertia.yaw", "I_z - N_rdot", "kg m^2", lambda s: {"yaw": s.rdot})

# Paper eq. 3-6: one mass for surge and sway. If the rigid-body mass is known, the same columns belong to the added mass.
SHARED_MASS: Final = Term("mass.surge", "m - X_udot", "kg", lambda s: {"surge": s.ax, "sway": s.ay})
ADDED_MASS: Final = Term("added_mass.surge", "-X_udot", "kg", lambda s: {"surge": s.ax, "sway": s.ay})
ADDED_MASS_SURGE: Final = Term("added_mass.surge", "-X_udot", "kg", MASS_SURGE.columns)
ADDED_MASS_SWAY: Final = Term("added_mass.sway", "-Y_vdot", "kg", MASS_SWAY.columns)

COUPLING_CG_X: Final = Term(
    "coupling.cg_x", "m x_G - Y_rdot", "kg m", lambda s: {"surge": -square(s.r), "sway": s.rdot, "yaw": s.ay}
)
COUPLING_CG_Y: Final = Term(
    "coupling.cg_y", "m y_G", "kg m", lambda s: {"surge": -s.rdot, "sway": -square(s.r), "yaw": -s.ax}
)
MUNK: Final = Term("added_mass.munk", "X_udot - Y_vdot", "kg", lambda s: {"yaw": s.u * s.v})
# In a model with one mass for surge and sway the coefficient is also the sway mass beyond the shared one.
SHARED_MUNK: Final = Term(
    "added_mass.munk", "X_udot - Y_vdot", "kg", lambda s: {"surge": -(s.v * s.r), "sway": s.vdot, "yaw": s.u * s.v}
)


# Least and most sum of dry and added mass, in the dry mass. The water that moves along with a sphere is half of its mass, with a disc across
# the flow up to twice that of a blunt hull; flat sides take three times the mass along. Half allows for a mass that is stated badly.
# Source: Newman, *Marine Hydrodynamics*, 1977, table 4.3 (added mass of bodies)
SURGE_OF_HULL: Final = (0.5, 3.0)
SWAY_OF_HULL: Final = (0.5, 6.0)
# Least and most moment of inertia with its added part, in mass times squared length; a uniform rod has 1/12, two weights at its ends 1/4.
# Source: geometry: no part of a hull lies farther out than half its length, and water at most trebles that
YAW_OF_HULL: Final = (0.01, 1.0)


def _payload(plain: Mapping[str, Quantity], p: Numbers, t: Quantity) -> dict[str, Quantity]:
    extra = p[0] * after(t, p[1])
    return {id_: plain[id_] + extra for id_ in (MASS_SURGE.id, MASS_SWAY.id) if id_ in plain}


FAMILY: Final[tuple[Effect, ...]] = (
    term_effect(
        MASS_SURGE,
        58.0,
        "mass and added mass in surge",
        plain=True,
        needed=True,
        equivalents=("thruster.gain",),
        of_hull=SURGE_OF_HULL,
        separate="weigh the vehicle, or tow it at a known acceleration",
    ),
    term_effect(
        MASS_SWAY,
        75.0,
        "mass and added mass in sway",
        plain=True,
        of_hull=SWAY_OF_HULL,
        shares=MASS_SURGE.id,
        separate="sideways accelerations, or turns at speed",
    ),
    term_effect(
        INERTIA_YAW,
        9.0,
        "moment of inertia and its added part",
        plain=True,
        needed=True,
        equivalents=("thruster.gain",),
        of_hull=YAW_OF_HULL,
        separate="a known arm of the thrusters, or a swing test",
    ),
    term_effect(
        COUPLING_CG_X,
        1.5,
        "the centre of gravity lies ahead of where the file says, or the hull is not symmetric fore and aft",
        signed=True,
        confusable=("added_mass.munk", "drag.yaw.linear"),
        turning=True,
        separate="yaw-rate steps at rest: turning acceleration without speed",
    ),
    term_effect(
        COUPLING_CG_Y,
        0.5,
        "the centre of gravity lies off the centre line",
        signed=True,
        confusable=("thruster.asymmetry",),
        turning=True,
        separate="surge steps followed by steady runs: this one follows acceleration, asymmetry follows thrust",
    ),
    term_effect(
        MUNK,
        6.0,
        "the moment of potential flow on a slender hull in sideslip, which turns it across the stream",
        equivalents=("drag.lift.yaw",),
        equivalent_odds=(1.0,),
        confusable=("coupling.cg_x", "drag.yaw.linear"),
        turning=True,
        separate="sideways accelerations strong enough to give m_v: this coefficient must equal m_v - m_u; a chirp in yaw",
    ),
    Effect(
        "payload.step",
        "the mass changes at a time: a payload taken or dropped, a compartment flooded",
        (
            Parameter("mass", "", "kg", 5.0, signed=True),
            Parameter("time", "", "s", 0.0, draw="time"),
        ),
        Change(_payload),
        confusable=("fouling.drift", "thruster.voltage_sag"),
        separate="the same accelerations before and after",
    ),
)
TERMS: Final[tuple[Term, ...]] = (MASS_SURGE, MASS_SWAY, INERTIA_YAW, COUPLING_CG_X, COUPLING_CG_Y, MUNK)
