"""Numbers that a vehicle file's model has from a log, as effects with values, and the terms that effects add to a model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ivsid.effects.catalogue import PAPER_TERMS, PLAIN_TERMS, on_hull, terms_of
from ivsid.effects.inertia import MASS_SWAY, SHARED_MASS, SHARED_MUNK
from ivsid.effects.terms import Term
from ivsid.effects.values import Given, sort_given
from ivsid.errors import IvsidError
from ivsid.vehicle import Vehicle


def fitted(vehicle: Vehicle) -> tuple[Given, ...]:
    """All effects with numbers in ``[model.fitted]``, terms of the model among them, in the catalogue's order.

    Raises:
        IvsidError: an unknown id, a missing part or an impossible value.
    """
    try:
        return sort_given(vehicle.model.numbers, [t.name for t in vehicle.thrusters])
    except IvsidError as error:
        raise IvsidError(
            f"{vehicle.source or vehicle.name}: [model.fitted]: {error}; an effect of your own comes with ivsid --own-effects FILE"
        ) from None


def causes(vehicle: Vehicle) -> tuple[Given, ...]:
    """The effects with numbers in ``[model.fitted]`` that ``model.terms`` does not list.

    Raises:
        IvsidError: as ``fitted``, or an unusable list of terms.
    """
    if not vehicle.model.numbers:
        return ()
    ids = {t.id for t in terms_of(vehicle)}
    return tuple(g for g in fitted(vehicle) if not ids.issuperset(g.named))


def with_terms(vehicle: Vehicle, wanted: Sequence[Term], given: Iterable[Given]) -> tuple[Term, ...]:
    """The terms of a model and those that effects add to it.

    A separate value for sway ends the sharing of a column of the paper's model.

    Args:
        vehicle: whose hull and model these are.
        wanted: terms of its model.
        given: effects with values.

    Raises:
        IvsidError: a term along the hull, and no length of it.
    """
    shared = vehicle.model.terms == "paper"
    terms = {t.id: t for t in wanted}
    plain = {t.id: t for t in PLAIN_TERMS}
    given = tuple(given)
    for g in given:
        if shared and g.effect.shares:
            terms[g.effect.shares] = plain[g.effect.shares]
    for g in given:
        for term in g.effect.terms:
            if term.id not in terms:
                own = SHARED_MUNK if term.id == SHARED_MUNK.id and _one_mass(terms) else term
                terms[term.id] = on_hull(own, vehicle)
    return tuple(terms.values())


def needed_terms(vehicle: Vehicle, terms: Sequence[Term]) -> tuple[Term, ...]:
    """The terms that need a value: the shared ones of the paper's model, also where values of their own replace them."""
    return PAPER_TERMS if vehicle.model.terms == "paper" else tuple(terms)


def _one_mass(terms: Mapping[str, Term]) -> bool:
    return MASS_SWAY.id not in terms and terms.get(SHARED_MASS.id) is SHARED_MASS
