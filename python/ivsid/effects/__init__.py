"""The catalogue of EFFECTS.md: the physics of every cause, once, for models, simulation, identification and diagnosis.

A model is a set of ids, an effect is an id that the model lacks. Terms that are linear in one parameter give its column on the
left-hand side of the three equations of motion, and the known forces stand on the right:

    sum over terms of parameter * column = known force, in surge, sway and yaw.

Other effects are forces, currents, changes of parameters, of thrusts or of readings (``effect``). One file a family: ``inertia``,
``drag``, ``environment``, ``thrusters``, ``sensing``.
"""

from ivsid.effects.catalogue import (
    ADDED_MASS_TERMS,
    CATALOGUE,
    EFFECTS,
    PAPER_ADDED_MASS_TERMS,
    PAPER_TERMS,
    PLAIN_TERMS,
    WITH_HEADING,
    on_hull,
    terms_of,
)
from ivsid.effects.effect import (
    Change,
    Current,
    Drive,
    Effect,
    Force,
    Inflow,
    Parameter,
    Reading,
    Response,
    Terms,
    Thrust,
)
from ivsid.effects.given import Given, for_thruster, of_kind, sort_given, spread
from ivsid.effects.own import own_digest, own_files, own_ids, read_effects, register, unregister
from ivsid.effects.rigid_body import rigid_body
from ivsid.effects.terms import CHANNELS, Columns, Place, State, Term

__all__ = [
    "ADDED_MASS_TERMS",
    "CATALOGUE",
    "CHANNELS",
    "EFFECTS",
    "PAPER_ADDED_MASS_TERMS",
    "PAPER_TERMS",
    "PLAIN_TERMS",
    "WITH_HEADING",
    "Change",
    "Columns",
    "Current",
    "Drive",
    "Effect",
    "Force",
    "Given",
    "Inflow",
    "Parameter",
    "Place",
    "Reading",
    "Response",
    "State",
    "Term",
    "Terms",
    "Thrust",
    "for_thruster",
    "of_kind",
    "on_hull",
    "own_digest",
    "own_files",
    "own_ids",
    "read_effects",
    "register",
    "rigid_body",
    "sort_given",
    "spread",
    "terms_of",
    "unregister",
]
