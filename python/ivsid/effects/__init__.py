"""The catalogue of EFFECTS.md: the physics of every term, once, for regression, simulation and diagnosis.

A model is a set of ids. This version holds the terms that are linear in one parameter; a term gives its column on the
left-hand side of the three equations of motion, and the known forces stand on the right:

    sum over terms of parameter * column = known force, in surge, sway and yaw.
"""

from ivsid.effects.catalogue import (
    ADDED_MASS_TERMS,
    CATALOGUE,
    PAPER_ADDED_MASS_TERMS,
    PAPER_TERMS,
    PLAIN_TERMS,
    TYPICAL,
    terms_of,
)
from ivsid.effects.rigid_body import rigid_body
from ivsid.effects.terms import CHANNELS, Columns, State, Term

__all__ = [
    "ADDED_MASS_TERMS",
    "CATALOGUE",
    "CHANNELS",
    "PAPER_ADDED_MASS_TERMS",
    "PAPER_TERMS",
    "PLAIN_TERMS",
    "TYPICAL",
    "Columns",
    "State",
    "Term",
    "rigid_body",
    "terms_of",
]
