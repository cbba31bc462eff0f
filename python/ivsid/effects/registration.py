"""User effects: checked when they join the catalogue, and read from a Python file for the command line."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from ivsid.effects.catalogue import CATALOGUE, EFFECTS, WITH_HEADING
from ivsid.effects.effect import Effect, Force, Terms
from ivsid.effects.forms import Grid
from ivsid.effects.scaling import froude_power
from ivsid.effects.terms import CHANNELS, Place, State
from ivsid.errors import IvsidError
from ivsid.vehicle import Thruster

_ID: Final = re.compile(r"[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)+")
_SHIPPED: Final = frozenset(EFFECTS)
# Name and SHA-256 of each file by the ids of its effects.
_FILES: Final[dict[tuple[str, ...], tuple[str, str]]] = {}
# u, v, r and their rates at which a new force or column is tried.
# Source: physics: a state without zeros and symmetries, so that a column that is not 0 everywhere is not 0 there.
_MOVING: Final = (0.7, -0.2, 0.3, 0.05, -0.04, 0.02)


def register(*effects: Effect) -> None:
    """Adds effects to the catalogue, for this process: all of them or none.

    Effects that are linear in their parameters (``Terms``) may then also stand in ``model.terms``.

    Raises:
        IvsidError: an id that is taken or malformed, an unknown unit, or physics that fails in a trial evaluation.
    """
    for k, effect in enumerate(effects):
        _check(effect, [*EFFECTS, *(e.id for e in effects[:k])])
    for effect in effects:
        EFFECTS[effect.id] = effect
        if isinstance(effect.acts, Terms):
            terms = effect.acts.terms
            if len(terms) == 1 and not _needs_place(effect.acts):
                CATALOGUE[effect.id] = terms[0]
            else:
                WITH_HEADING[effect.id] = terms


def unregister(id_: str) -> None:
    """Removes a user effect from the catalogue; an unknown id is ignored."""
    for table in (EFFECTS, CATALOGUE, WITH_HEADING):
        table.pop(id_, None)
    for ids in [q for q in _FILES if id_ in q]:
        del _FILES[ids]


def read_effects(path: str | Path) -> None:
    """Runs a Python file and registers the effects in its list ``EFFECTS``.

    The file is a program and may do anything that Python can. Therefore no file is read unless the user names it.

    Raises:
        IvsidError: a file that cannot be read, fails, or has no such list; nothing is registered then.
    """
    where = Path(path)
    try:
        content = where.read_bytes()
        code = compile(content, str(where), "exec")
    except OSError as error:
        raise IvsidError(f"effects {where} cannot be read ({error.strerror}); give the path of a Python file") from None
    except (SyntaxError, ValueError) as error:
        raise IvsidError(f"{where} is not Python: {error}; mend that line") from None
    names: dict[str, object] = {"__name__": "ivsid_effects", "__file__": str(where)}
    try:
        exec(code, names)
    except Exception as error:
        raise IvsidError(f"{where} fails with {type(error).__name__}: {error}; mend it") from None
    found = names.get("EFFECTS")
    if (
        not isinstance(found, Sequence)
        or isinstance(found, str)
        or not found
        or not all(isinstance(e, Effect) for e in found)
    ):
        raise IvsidError(
            f"{where} has no list EFFECTS of ivsid.effects.Effect; write EFFECTS = [Effect(...)] at its end"
        )
    register(*found)
    _FILES[tuple(e.id for e in found)] = (where.name, hashlib.sha256(content).hexdigest())


def own_ids() -> frozenset[str]:
    """Ids of the user effects in the catalogue."""
    return frozenset(EFFECTS) - _SHIPPED


def own_digest() -> str | None:
    """Digests of the files of all user effects, for the key of a cache; None where an effect came from no file."""
    files = {i: digest for ids, (_, digest) in _FILES.items() for i in ids}
    if own_ids() - set(files):
        return None
    return " ".join(sorted({files[i] for i in own_ids()}))


def own_files() -> tuple[tuple[str, str], ...]:
    """Names and SHA-256 of the files whose effects are in the catalogue, for the inputs of a result."""
    return tuple(file for ids, file in _FILES.items() if all(i in EFFECTS for i in ids))


def _check(effect: Effect, taken: Sequence[str]) -> None:
    if not _ID.fullmatch(effect.id):
        raise IvsidError(
            f"effect id '{effect.id}' is not usable; write words in small letters with dots, as drag.surge.turning"
        )
    if effect.id in taken:
        raise IvsidError(f"effect {effect.id} is in the catalogue already; give another id")
    for other in taken:
        if effect.id.rpartition(".")[0] == other or other.rpartition(".")[0] == effect.id:
            raise IvsidError(f"effect {effect.id} reads like a part of {other}; give another id")
    if not effect.cause.strip() or not effect.parameters:
        raise IvsidError(f"effect {effect.id} needs a cause in a sentence and a parameter; give both")
    if len(set(effect.parts)) != len(effect.parts):
        raise IvsidError(f"effect {effect.id} names a part twice; each parameter needs a part of its own")
    for name, p in zip(effect.parts, effect.parameters, strict=True):
        froude_power(p.unit)
        if not math.isfinite(p.typical) or (p.draw == "size" and p.typical == p.none):
            raise IvsidError(f"{name} needs a typical size that does something; {p.typical:g} does not")
    if effect.equivalent_odds and len(effect.equivalent_odds) != len(effect.equivalents):
        raise IvsidError(
            f"effect {effect.id} has {len(effect.equivalent_odds)} equivalent_odds and {len(effect.equivalents)} equivalents; give each "
            "equivalent its odds, or none"
        )
    if isinstance(effect.acts, Terms) and tuple(t.id for t in effect.acts.terms) != effect.parts:
        raise IvsidError(
            f"effect {effect.id} has the terms {', '.join(t.id for t in effect.acts.terms)}; its parameters ask for {', '.join(effect.parts)}"
        )
    _check_declarations(effect)
    _try(effect)


def _check_declarations(effect: Effect) -> None:
    """Form, key and measured form against the parameters and the physics."""
    if (asked := effect.form.asks(effect.draws, [p.part for p in effect.parameters])) is not None:
        raise IvsidError(f"effect {effect.id} is searched as {type(effect.form).__name__}; that form asks for {asked}")
    if isinstance(effect.form, Grid) and effect.form.of != "seconds" and not effect.acts.at_thruster:
        raise IvsidError(
            f"effect {effect.id} is searched in {effect.form.of}s, and acts at no thruster; give its values in seconds, or no form"
        )
    if effect.per_thruster and not (effect.acts.at_thruster and len(effect.parameters) == 1):
        raise IvsidError(
            f"effect {effect.id} is one of single thrusters, and takes {len(effect.parameters)} numbers or acts at no thruster; give it one number "
            "and physics at a thruster, or no per_thruster"
        )
    if effect.key is not None and effect.key.name not in Thruster.model_fields:
        raise IvsidError(f"effect {effect.id} has the key {effect.key.name}, which no thruster has; leave it out")
    if effect.measured is not None and effect.measured.id != effect.id:
        raise IvsidError(f"effect {effect.id} has a measured form of the id {effect.measured.id}; give both the same")


def _try(effect: Effect) -> None:
    """Evaluates a force or the columns of terms once, so that a fault is reported here and not in the middle of a run."""
    place = Place(0.4, 2.0, -3.0, 5.0, 1.0, -2.0)
    state = State(*_MOVING, place=place)
    try:
        if isinstance(effect.acts, Force):
            made = [effect.acts.function(state, tuple(p.typical for p in effect.parameters))]
        elif isinstance(effect.acts, Terms):
            # A term along the hull has columns only once its length is known.
            made = [(t.of_hull(1.0) if t.of_hull else t.columns)(state) for t in effect.acts.terms]
        else:
            return
        good = all(c in CHANNELS and math.isfinite(float(x)) for columns in made for c, x in columns.items())
    except Exception as error:
        raise IvsidError(
            f"effect {effect.id} fails where it is tried ({type(error).__name__}: {error}); a force is made with operators and "
            "ivsid.effects.functions"
        ) from None
    if not good or not all(made):
        raise IvsidError(
            f"effect {effect.id} gives {made}; it must give a finite number by channel: {', '.join(CHANNELS)}"
        )


def _needs_place(terms: Terms) -> bool:
    """Whether a column depends on pose, time or wind."""
    try:
        for t in terms.terms:
            (t.of_hull(1.0) if t.of_hull else t.columns)(State(*_MOVING))
    except Exception:
        return True
    return False
