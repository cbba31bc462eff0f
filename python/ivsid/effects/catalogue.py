"""The catalogue by id, and the models that are sets of its ids."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

from ivsid.effects import drag, environment, inertia, sensing, thrusters
from ivsid.effects.effect import Effect
from ivsid.effects.terms import Term
from ivsid.errors import IvsidError, choice, meant
from ivsid.vehicle import Vehicle

# Every cause that can be simulated, identified or named: the terms of the plain model and the effects, family by family. Users add
# their own with ``registration.register``.
EFFECTS: Final[dict[str, Effect]] = {
    e.id: e for e in (*inertia.FAMILY, *drag.FAMILY, *environment.FAMILY, *thrusters.FAMILY, *sensing.FAMILY)
}
# Terms that a model may list: linear in one parameter, and made of velocities and accelerations alone.
CATALOGUE: Final[dict[str, Term]] = {t.id: t for t in (*inertia.TERMS, *drag.TERMS)}
# Effects that are linear in several parameters and need the heading. A model lists the effect's id and gets a term a parameter.
WITH_HEADING: Final[dict[str, tuple[Term, ...]]] = {"wind.steady": environment.WIND_TERMS}

PLAIN_TERMS: Final = (
    inertia.MASS_SURGE,
    inertia.MASS_SWAY,
    inertia.INERTIA_YAW,
    drag.SURGE_QUADRATIC,
    drag.SWAY_QUADRATIC,
)
PAPER_TERMS: Final = (inertia.SHARED_MASS, drag.SHARED_QUADRATIC, inertia.INERTIA_YAW)
PAPER_ADDED_MASS_TERMS: Final = (inertia.ADDED_MASS, drag.SHARED_QUADRATIC, inertia.INERTIA_YAW)
ADDED_MASS_TERMS: Final = {"mass.surge": inertia.ADDED_MASS_SURGE, "mass.sway": inertia.ADDED_MASS_SWAY}


def terms_of(vehicle: Vehicle, form: str = "total") -> tuple[Term, ...]:
    """The terms of the vehicle file's model.

    Args:
        vehicle: the vehicle file, whose ``model.terms`` is "paper", a list of ids, or absent (the plain model).
        form: ``total`` (parameters hold the whole mass) or ``added`` (the rigid-body mass is known and left out; the second
            form of the paper's eq. 6).

    Raises:
        IvsidError: an unknown id or form, an empty or repeating list, or a term that needs a length which the file lacks.
    """
    if form not in ("total", "added"):
        raise IvsidError(f"form '{form}' is unknown; {meant(form, ('total', 'added'))}use total or added")
    wanted = vehicle.model.terms
    terms: tuple[Term, ...]
    if wanted == "paper":
        return PAPER_TERMS if form == "total" else PAPER_ADDED_MASS_TERMS
    if wanted is None:
        terms = PLAIN_TERMS
    else:
        for id_ in wanted:
            if id_ not in CATALOGUE and id_ not in WITH_HEADING:
                raise IvsidError(
                    f"model term '{id_}' is unknown or not linear in its parameter; "
                    f"{choice(id_, (*CATALOGUE, *WITH_HEADING))}; one of your own comes with ivsid --own-effects FILE"
                )
        if len(set(wanted)) != len(wanted) or not wanted:
            raise IvsidError("model.terms is empty or repeats an id; list each once")
        terms = tuple(
            term
            for id_ in wanted
            for term in (WITH_HEADING[id_] if id_ in WITH_HEADING else (on_hull(CATALOGUE[id_], vehicle),))
        )
    if form == "added":
        return tuple(ADDED_MASS_TERMS.get(t.id, t) for t in terms)
    return terms


def on_hull(term: Term, vehicle: Vehicle) -> Term:
    """The term with the hull's length filled in if it needs one; else the term itself.

    Raises:
        IvsidError: the vehicle file gives no length.
    """
    if term.of_hull is None:
        return term
    if vehicle.hull.length is None:
        raise IvsidError(f"{term.id} acts along the hull; give the vehicle file hull.length [m]")
    return _along(term, vehicle.hull.length)


@lru_cache(maxsize=256)
def _along(term: Term, length: float) -> Term:
    """One instance for each length, so that hypotheses of two processes have the same terms."""
    assert term.of_hull is not None
    return Term(term.id, term.symbol, term.unit, term.of_hull(length))
