"""The catalogue by id, and the models that are sets of its ids."""

from __future__ import annotations

from typing import Final

from ivsid.effects import drag, inertia
from ivsid.effects.terms import Term
from ivsid.errors import IvsidError
from ivsid.vehicle import Vehicle

CATALOGUE: Final[dict[str, Term]] = {t.id: t for t in (*inertia.FAMILY, *drag.FAMILY)}

# Typical sizes for a vehicle of 50 kg and 1 m at about 1 m/s (EFFECTS.md, section 2): what `simulate --hide` scales.
TYPICAL: Final = {
    "drag.surge.linear": 4.0,
    "drag.surge.sideslip": 30.0,
    "drag.sway.linear": 8.0,
    "drag.sway.yaw_rate": 4.0,
    "drag.yaw.linear": 1.0,
    "drag.yaw.quadratic": 2.0,
    "drag.lift.sway": 10.0,
    "drag.lift.yaw": -3.0,
    "coupling.cg_x": 1.5,
    "coupling.cg_y": 0.5,
    "added_mass.munk": 6.0,
}

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
        vehicle: whose ``model.terms`` is "paper", a list of ids, or absent (the plain model).
        form: ``total`` (parameters hold the whole mass) or ``added`` (the rigid-body mass is known and left out; paper,
            second form of eq. 6).

    Raises:
        IvsidError: an unknown id, naming those that are known.
    """
    if form not in ("total", "added"):
        raise IvsidError(f"form '{form}' is unknown; use total or added")
    wanted = vehicle.model.terms
    terms: tuple[Term, ...]
    if wanted == "paper":
        return PAPER_TERMS if form == "total" else PAPER_ADDED_MASS_TERMS
    if wanted is None:
        terms = PLAIN_TERMS
    else:
        for id_ in wanted:
            if id_ not in CATALOGUE:
                raise IvsidError(
                    f"model term '{id_}' is unknown or not linear in its parameter; this version knows {', '.join(CATALOGUE)}"
                )
        if len(set(wanted)) != len(wanted) or not wanted:
            raise IvsidError("model.terms is empty or repeats an id; list each once")
        terms = tuple(CATALOGUE[id_] for id_ in wanted)
    if form == "added":
        return tuple(ADDED_MASS_TERMS.get(t.id, t) for t in terms)
    return terms
