"""The catalogue of effects: the physics of every cause, once, for models, simulation, identification and diagnosis.

A model is a set of ids; an effect is an id that the model lacks. A term that is linear in one parameter gives the parameter's column
on the left-hand side of the three equations of motion (Fossen), and the known forces stand on the right:

    sum over terms of parameter * column = known force, in surge, sway and yaw.

Other effects are forces, currents, and changes of parameters, thrusts or readings.

- ``effect``: the definition of an effect, its parameters, and the classes of physics; ``terms``: states, terms and their columns.
- ``inertia``, ``drag``, ``environment``, ``thrusters``, ``sensing``: the effects, one file a family.
- ``forms``: how a diagnosis searches for the numbers of an effect; ``applicability``: what a vehicle lacks for an effect.
- ``catalogue``: all of them by id, and the models that are sets of ids.
- ``values``: effects with values, from numbers by id; ``fitted``: those that a vehicle file's model has.
- ``registration``: effects of a user, from a Python file or from code.
- ``rigid_body``: the left-hand side that the vehicle file knows.
- ``functions``, ``quantity``: the functions that columns are made of, for floats, arrays, intervals and symbols alike;
  ``cross_flow``: the integrals along a hull, enclosed over boxes.
- ``scaling``: typical sizes for vehicles of another size.

The chapter may use ``vehicle`` and the chapters below it. It knows no log, no rows and no noise.
"""

from ivsid.effects.applicability import lacking
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
    Key,
    Parameter,
    Reading,
    Response,
    Terms,
    Thrust,
)
from ivsid.effects.fitted import causes, fitted, needed_terms, with_terms
from ivsid.effects.forms import Anchored, Form, Grid, Harmonic, Hump, Linear, Step
from ivsid.effects.registration import own_digest, own_files, own_ids, read_effects, register, unregister
from ivsid.effects.rigid_body import rigid_body
from ivsid.effects.terms import CHANNELS, Columns, Place, State, Term
from ivsid.effects.values import Given, acting, for_thruster, of_kind, sort_given, spread, with_stated

__all__ = [
    "ADDED_MASS_TERMS",
    "CATALOGUE",
    "CHANNELS",
    "EFFECTS",
    "PAPER_ADDED_MASS_TERMS",
    "PAPER_TERMS",
    "PLAIN_TERMS",
    "WITH_HEADING",
    "Anchored",
    "Change",
    "Columns",
    "Current",
    "Drive",
    "Effect",
    "Force",
    "Form",
    "Given",
    "Grid",
    "Harmonic",
    "Hump",
    "Inflow",
    "Key",
    "Linear",
    "Parameter",
    "Place",
    "Reading",
    "Response",
    "State",
    "Step",
    "Term",
    "Terms",
    "Thrust",
    "acting",
    "causes",
    "fitted",
    "for_thruster",
    "lacking",
    "needed_terms",
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
    "with_stated",
    "with_terms",
]
