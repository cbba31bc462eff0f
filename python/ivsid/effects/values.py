"""Effects with values for their parameters, from numbers by id as scenarios and the command line give them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from ivsid.effects.catalogue import EFFECTS
from ivsid.effects.effect import Change, Current, Effect, Force, Inflow, Numbers, Physics, Reading, Response, Thrust
from ivsid.errors import IvsidError, choice, meant
from ivsid.vehicle import Thruster

Kind = TypeVar("Kind", Force, Change, Current, Thrust, Inflow, Response, Reading)


@dataclass(frozen=True)
class Given:
    """An effect with values.

    Attributes:
        effect: the effect, or the form of it that the values belong to.
        values: one for each parameter, in the effect's order and units.
        thruster: the name of the only thruster that it acts on; None for all.
    """

    effect: Effect
    values: tuple[float, ...]
    thruster: str | None = None

    @property
    def start(self) -> float | None:
        """The time from which on it acts [s], if it starts at one."""
        draws = self.effect.draws
        return self.values[draws.index("time")] if "time" in draws else None

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the values: id, id.part, or id.NAME for one thruster."""
        return self.effect.parts if self.thruster is None else (f"{self.effect.id}.{self.thruster}",)

    @property
    def named(self) -> dict[str, float]:
        """The values by name."""
        return dict(zip(self.parts, self.values, strict=True))


def sort_given(values: Mapping[str, float], thrusters: Sequence[str] = ()) -> tuple[Given, ...]:
    """Sorts numbers by id into effects with values, in the catalogue's order.

    Args:
        values: by id, id.part, or id.NAME for one thruster.
        thrusters: names, in the vehicle file's order.

    Raises:
        IvsidError: an unknown id, a missing part, an impossible value, or an unknown thruster.
    """
    found: dict[tuple[str, str | None], dict[str, float]] = {}
    for key, value in values.items():
        id_, part = _split(key)
        effect = EFFECTS[id_]
        name = None
        if part and not any(part == p.part for e in _forms(effect) for p in e.parameters):
            if not effect.per_thruster or part not in thrusters:
                raise IvsidError(_unknown_part(effect, part, thrusters))
            name, part = part, ""
        found.setdefault((id_, name), {})[part] = value
    given = [_complete(EFFECTS[id_], name, parts) for (id_, name), parts in found.items()]
    order = list(EFFECTS)
    return tuple(sorted(given, key=lambda g: (order.index(g.effect.id), g.thruster or "")))


def spread(id_: str, values: Sequence[float], *, measured: bool = False) -> dict[str, float]:
    """Numbers by id and part, from the order in which ``--effect ID=A,B`` gives them.

    Args:
        id_: an effect; or id.part or id.NAME, which take one number.
        values: in the order of the effect's parameters.
        measured: whether they belong to the form for a measured cause (wind columns).

    Raises:
        IvsidError: more or fewer numbers than parameters.
    """
    if id_ not in EFFECTS:
        if len(values) != 1:
            raise IvsidError(f"{id_} takes one number, {len(values)} are given")
        return {id_: float(values[0])}
    effect = EFFECTS[id_]
    if measured and effect.measured is not None:
        effect = effect.measured
    if len(values) != len(effect.parameters):
        raise IvsidError(
            f"{id_} takes {len(effect.parameters)} number{'s' * (len(effect.parameters) > 1)} "
            f"({', '.join(f'{n} [{p.unit}]' for n, p in zip(effect.parts, effect.parameters, strict=True))}), {len(values)} "
            f"{'are' if len(values) != 1 else 'is'} given"
        )
    return dict(zip(effect.parts, map(float, values), strict=True))


def _split(key: str) -> tuple[str, str]:
    if key in EFFECTS:
        return key, ""
    id_, _, part = key.rpartition(".")
    if id_ in EFFECTS:
        return id_, part
    raise IvsidError(f"'{key}' is not simulated: the catalogue has no such id; {choice(key, EFFECTS)}")


def _forms(effect: Effect) -> tuple[Effect, ...]:
    return (effect,) if effect.measured is None else (effect, effect.measured)


def _unknown_part(effect: Effect, part: str, thrusters: Sequence[str]) -> str:
    if effect.per_thruster:
        return f"{effect.id}.{part}: the vehicle has no thruster {part}; {meant(part, thrusters)}it has {', '.join(thrusters) or 'none'}"
    parts = [p.part for e in _forms(effect) for p in e.parameters if p.part]
    allowed = f"{meant(part, parts)}its parts are {', '.join(parts)}" if parts else "it is a single number"
    return f"{effect.id} has no part {part}; {allowed}"


def _complete(effect: Effect, thruster: str | None, parts: Mapping[str, float]) -> Given:
    for form in _forms(effect):
        wanted = [p.part for p in form.parameters]
        if set(wanted) == set(parts):
            values = tuple(parts[w] for w in wanted)
            _check(form, values)
            return Given(form, values, thruster)
    wanted = [p.part for p in effect.parameters]
    missing = [w for w in wanted if w not in parts] or [w for w in parts if w not in wanted]
    raise IvsidError(
        f"{effect.id} needs {' and '.join(n for n in effect.parts)}; {', '.join(m or 'the number itself' for m in missing)} "
        f"{'is' if len(missing) == 1 else 'are'} missing or from its other form"
    )


def _check(effect: Effect, values: tuple[float, ...]) -> None:
    for name, parameter, value in zip(effect.parts, effect.parameters, values, strict=True):
        if (fault := parameter.fault(value)) is not None:
            raise IvsidError(f"{name} = {value:g} is not usable; {fault}")


def of_kind(given: Iterable[Given], *kinds: type[Physics]) -> list[Given]:
    """Effects whose physics is of one of some classes, such as ``Thrust``."""
    return [g for g in given if isinstance(g.effect.acts, kinds)]


def acting(given: Iterable[Given], kind: type[Kind]) -> list[tuple[Kind, Numbers]]:
    """The physics of one class among effects, each with its numbers, in their order."""
    return [(g.effect.acts, g.values) for g in given if isinstance(g.effect.acts, kind)]


def for_thruster(given: Iterable[Given], kind: type[Physics], thruster: str) -> list[Given]:
    """Effects of one class that act on a thruster, in the catalogue's order.

    An effect that names the thruster replaces the same effect for all thrusters.
    """
    found = [g for g in of_kind(given, kind) if g.thruster in (None, thruster)]
    own = {g.effect.id for g in found if g.thruster is not None}
    return [g for g in found if g.thruster is not None or g.effect.id not in own]


def with_stated(given: Iterable[Given], kind: type[Physics], thruster: Thruster) -> list[Given]:
    """Effects of one class on a thruster, with those that its keys in the vehicle file state, in the catalogue's order.

    An effect replaces the key that states the same.
    """
    found = for_thruster(given, kind, thruster.name)
    taken = {g.effect.key for g in found}
    for effect in EFFECTS.values():
        if effect.key is None or effect.key in taken or not isinstance(effect.acts, kind):
            continue
        taken.add(effect.key)
        value = getattr(thruster, effect.key.name)
        if value is not None and effect.key(value) != effect.parameters[0].none:
            found.append(Given(effect, (effect.key(value),)))
    if len(found) < 2:
        return found
    order = list(EFFECTS)
    return sorted(found, key=lambda g: order.index(g.effect.id))
