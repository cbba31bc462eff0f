"""Names that other programs give to columns: the table ``data/known_names.toml``, and the meaning of a name by it."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Annotated, Final, Literal

from pydantic import BeforeValidator, Field

from ivsid.files.section import Finite, Section

# Letters of a name at the end of a path; u, x or ve stand in paths of many meanings.
# Source: definition: one more than the two letters of such names
SHORTEST: Final = 3


class Meaning(Section):
    """The channel that a field holds; ``demand`` is one of the thrusters' demands.

    Attributes:
        channel: of the guide's table, or ``demand``.
        unit: of a cell; None for SI, or for what its name or its range says.
        scale: factor of a cell, beside the unit.
        offset: added in SI units, after the scale.
        gravity: whether an acceleration holds gravity.
    """

    channel: str
    unit: str | None = None
    scale: Finite = 1.0
    offset: Finite = 0.0
    gravity: bool = False


Field_ = Annotated[Meaning, BeforeValidator(lambda given: {"channel": given} if isinstance(given, str) else given)]


class Program(Section):
    """The names of one program.

    Attributes:
        name: of the program.
        frame: of its body and earth axes.
        own: its columns of stamps, with their unit; an empty unit is seconds, or what the size of an epoch says.
        messages: fields by message; those of "" end any path.
        whole: whether the fields are whole names.
        plain: whether the names are anybody's, so that they state no frame.
        question: about what its names leave open, for the user.
    """

    name: str
    frame: Literal["frd", "flu"]
    own: dict[str, str] = Field(default_factory=dict)
    messages: dict[str, dict[str, Field_]]
    whole: bool = False
    plain: bool = False
    question: str = ""


class DemandWords(Section):
    """Words of names that tell demands and angles of thrusters from readings.

    Attributes:
        words: that make a column a demand.
        not_: that make it none; the key of the file is ``not``.
        measured: of those, the ones that an angle may have.
        commanded: of what a controller asks for.
        general: that name no thruster.
        rudders: that make a column the angle of a rudder.
        azimuths: that make it the direction of an azimuth thruster.
        pushes: that make it the demand of an azimuth thruster all the same.
        turns: that make it an angle, whatever it pushes.
    """

    words: tuple[str, ...]
    not_: tuple[str, ...] = Field(alias="not")
    measured: tuple[str, ...]
    commanded: tuple[str, ...]
    general: tuple[str, ...]
    rudders: tuple[str, ...]
    azimuths: tuple[str, ...]
    pushes: tuple[str, ...]
    turns: tuple[str, ...]


class KnownNames(Section):
    """The whole table; endings of plain names state units, and words of ``around`` belong to what moves around the vessel."""

    around: tuple[str, ...]
    programs: tuple[Program, ...]
    endings: dict[str, str]
    time_endings: dict[str, str]
    demands: DemandWords


@dataclass(frozen=True)
class Match:
    """A column that a program's table knows.

    Attributes:
        column: its full name in the log.
        program: that names columns so.
        meaning: its channel and unit.
        rank: place in the table; the smallest is the best column for its channel.
    """

    column: str
    program: Program
    meaning: Meaning
    rank: int


@cache
def known_names() -> KnownNames:
    """The table of the package."""
    return KnownNames.model_validate(tomllib.loads((files("ivsid") / "data" / "known_names.toml").read_text()))


def plain_name(name: str, endings: dict[str, str]) -> tuple[str, str | None]:
    """A name in small letters and with ``_`` between its words, without the ending that states a unit; and that unit."""
    bare = re.sub(r"[\s\-]+", "_", name.strip().lower())
    for ending, unit in sorted(endings.items(), key=lambda e: -len(e[0])):
        if bare.endswith(f"_{ending}"):
            return bare.removesuffix(f"_{ending}"), unit
    return bare, None


def match(full: str, bare: str) -> Match | None:
    """What a column is by its name: by the first program whose table has it, or None.

    Args:
        full: its name with that of its table.
        bare: its name alone, without the unit that a header states.
    """
    table = known_names()
    for rank, (program, message, field, meaning) in enumerate(_entries()):
        if program.plain:
            name, unit = plain_name(bare, table.endings)
            if field in _endings_of(name):
                stated = meaning.model_copy(update={"unit": unit}) if unit else meaning
                return Match(full, program, stated, rank)
        elif program.whole:
            if _whole(field).fullmatch(bare):
                return Match(full, program, meaning, rank)
        elif _pattern(message, field).search(full):
            return Match(full, program, meaning, rank)
    return None


def _endings_of(name: str) -> tuple[str, ...]:
    """A plain name, and what stands at the end of a path: ``nav.gyro.z`` ends with ``gyro_z``; shorter names than that say too little."""
    steps = [step for step in re.split(r"[./:]", name) if step]
    if len(steps) < 2 or set(re.split(r"[^a-z]+", name)) & set(known_names().around):
        return (name,)
    ends = ("_".join(steps[k:]) for k in range(len(steps)))
    return (name, *(end for end in ends if len(end) >= SHORTEST))


@cache
def _entries() -> tuple[tuple[Program, str, str, Meaning], ...]:
    return tuple(_listed())


def _listed() -> Iterator[tuple[Program, str, str, Meaning]]:
    for program in known_names().programs:
        for message, fields in program.messages.items():
            for field, meaning in fields.items():
                yield program, message, field, meaning


@cache
def _whole(field: str) -> re.Pattern[str]:
    return re.compile(re.escape(field).replace(r"\#", r"\d+"))


@cache
def _pattern(message: str, field: str) -> re.Pattern[str]:
    """A message with words before it and an instance behind it, and a field whose steps any of . / _ : part."""
    steps = r"[./_:]".join(re.escape(step) for step in field.split("."))
    ending = steps.replace(r"\#", r"\d+") + "$"
    if not message:
        return re.compile(rf"(^|[./_:]){ending}")
    return re.compile(rf"(^|[^A-Za-z0-9]){re.escape(message)}(_\d+|\[\d+\])?[./_:]{ending}")
