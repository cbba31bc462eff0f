"""Columns of thrusters by the words of their names: demands, and the angles of rudders and azimuth thrusters."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from ivsid.log.headers import label
from ivsid.proposal.found import Found
from ivsid.proposal.names import known_names

# Kinds of angles, which are the beginnings of their columns.
ANGLES: Final = ("rudder", "azimuth")
# Demands that stand for a thruster at rest: zero, and the neutral pulse [us].
# Source: definition: the midpoint of pulses of 1000 to 2000 us
RESTING: Final = (0.0, 1500.0)


def steps_of(name: str) -> set[str]:
    """The words of a name in small letters, without digits."""
    parted = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return set(re.split(r"[^a-z]+", parted.lower())) - {""}


def kind_of(table: str, column: str) -> Literal["demand", "rudder", "azimuth"] | None:
    """What a column is by its words; those of its table count where its own are general, as ``data`` is.

    Args:
        table: of the column, a topic maybe.
        column: without its unit.
    """
    words = known_names().demands
    own = steps_of(column)
    steps = own | steps_of(table) if own <= set(words.general) else own
    for kind, names in (("rudder", words.rudders), ("azimuth", words.azimuths)):
        if steps & set(names):
            if kind == "azimuth" and steps & set(words.pushes) and not steps & set(words.turns):
                continue
            return None if steps & (set(words.not_) - set(words.measured)) else kind  # type: ignore[return-value]
    if steps & set(words.not_):
        return None
    return "demand" if steps & set(words.words) else None


def named(found: Sequence[Found]) -> dict[str, Found]:
    """Demands by the names of their thrusters: those that change, or else those that hold a thrust."""
    levels = [(f, np.unique(f.values[np.isfinite(f.values)])) for f in found]
    chosen = [f for f, x in levels if x.size > 1] or [f for f, x in levels if x.size == 1 and x[0] not in RESTING]
    made: dict[str, Found] = {}
    several = [thruster(f).split("_") for f in chosen]
    # Words that all names have tell no thruster from another: that of the vessel, maybe.
    common = set.intersection(*map(set, several)) if len(several) > 1 else set()
    apart = ["_".join(w for w in words if w not in common) or "_".join(words) for words in several]
    for f, name in zip(chosen, apart, strict=True):
        made[name if name not in made else f"{name}_{len(made) + 1}"] = f
    return made


def thruster(found: Found) -> str:
    """The name of a thruster: the last step of a known path, or the words of a name that are not general."""
    column = found.match.column.removeprefix(f"{found.table}/")
    stated = label(found.table, column)
    bare = column if stated is None else stated.name
    if not found.program.plain:
        words = _words(re.split(r"[/.:]", bare)[-1])
        said = {*known_names().demands.general, *known_names().demands.commanded}
        apart = [w for w in words if w.lower() not in said]
        words = words if all(w.isdigit() for w in apart) else apart
    else:
        general = {*known_names().demands.general, *known_names().demands.rudders, *known_names().demands.azimuths}
        own, its_table = ([w for w in _words(p) if w.lower() not in general] for p in (bare, found.table))
        telling = [w for w in (own, its_table) if not all(x.isdigit() for x in w)]
        numbered = ["thruster", *own] if own else _words(bare)
        words = telling[0] if telling else numbered
    return "_".join(words) or "thruster"


def _words(name: str) -> list[str]:
    return [w for w in re.split(r"[^A-Za-z0-9]+", name) if w]


def steered(angles: Sequence[Found], demands: Mapping[str, Found]) -> tuple[dict[str, Found], tuple[str, ...]]:
    """The angle of each thruster, by its channel, and the columns whose thruster is not known.

    A measured angle is taken before a demanded one. An azimuth whose name has no thruster turns all of them, and a rudder without
    one stands with the first.
    """
    made: dict[str, Found] = {}
    loose = []
    commanded = set(known_names().demands.commanded)
    for f in sorted(angles, key=lambda f: bool(steps_of(f.match.column) & commanded)):
        kind = f.meaning.channel
        owners = [n for n in demands if n.lower() == thruster(f).lower() or _side(n) & _side(f.match.column)]
        if not owners and not _side(f.match.column):
            owners = list(demands)[: 1 if kind == "rudder" else None]
        free = [n for n in owners if f"{kind}_{n}" not in made]
        if not owners:
            loose.append(f.match.column)
        for n in free:
            made[f"{kind}_{n}"] = f
        for n in set(owners) - set(free):
            known = made[f"{kind}_{n}"]
            made[f"{kind}_{n}"] = replace(known, others=(*known.others, f.match.column))
    return made, tuple(loose)


def _side(name: str) -> set[str]:
    """The side of the vessel that a name has."""
    return {side for side in ("port", "starboard") if word(name, side)}


def word(name: str, side: str) -> bool:
    """Whether a name has the word of a side."""
    words = {"port": ("port", "left"), "starboard": ("starboard", "stbd", "right")}[side]
    return bool(steps_of(name) & set(words))
