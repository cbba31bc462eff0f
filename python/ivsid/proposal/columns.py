"""The columns of a log that hold its channels, its demands and its stamps, by their names."""

from __future__ import annotations

import contextlib
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.log import COLUMNS, Source
from ivsid.log.headers import label
from ivsid.log.stamps import times_of
from ivsid.proposal.names import Match, Meaning, Program, known_names, match, plain_name

Array = NDArray[np.float64]

EARTH = ("velocity_north", "velocity_east")
ATTITUDE = ("qw", "qx", "qy", "qz")


@dataclass(frozen=True)
class Stamps:
    """The stamps of a table: their column and its unit (None for what the size of an epoch or a date says), and the times [s]."""

    column: str
    unit: str | None
    nanoseconds: str | None
    t: Array
    rows: NDArray[np.intp] | None


@dataclass(frozen=True)
class Found:
    """A column that is taken for a channel.

    Attributes:
        match: the column and its meaning.
        table: that holds it.
        t: times of its samples [s], shape (n,).
        values: cells as they are, shape (n,); NaN is a missing sample.
        stated: whether the unit stands in the name, in the header, or in the program's table.
        others: further columns that hold the same channel, which are not taken.
    """

    match: Match
    table: str
    t: Array
    values: Array
    stated: bool
    others: tuple[str, ...] = ()

    @property
    def program(self) -> Program:
        """The program that names columns so."""
        return self.match.program

    @property
    def meaning(self) -> Meaning:
        """Channel, unit and scale."""
        return self.match.meaning

    def with_meaning(self, **changes: object) -> Found:
        """The column with another unit or scale."""
        meaning = self.meaning.model_copy(update=changes)
        return replace(self, match=replace(self.match, meaning=meaning))

    @property
    def factor(self) -> float:
        """From a cell to SI units."""
        return self.meaning.scale * units.COLUMN.get(self.meaning.unit or "1", 1.0)


@dataclass(frozen=True)
class Columns:
    """What the names of a log say.

    Attributes:
        channels: by name, without the demands.
        demands: by thruster.
        stamps: by table; a table whose format defines its clock has none.
        program: that names most of the channels.
        angles: columns that look like the angle of a rudder or an azimuth thruster.
        unknown: columns that nothing takes.
    """

    channels: Mapping[str, Found]
    demands: Mapping[str, Found]
    stamps: Mapping[str, Stamps]
    program: Program
    angles: tuple[str, ...]
    unknown: tuple[str, ...]


def columns_of(source: Source) -> Columns:
    """The columns of an opened log by their names; their cells are read.

    Raises:
        IvsidError: no column has a known name, or no table has stamps.
    """
    matches, angles = _matches(source)
    if not any(m.meaning.channel != "demand" for m in matches):
        if {"topic", "value"} <= {c.rpartition("/")[2] for c in source.columns}:
            raise IvsidError(
                f"{source.name} has a row for each message (columns topic and value); export it with a column for each signal, or give the bag itself"
            )
        raise IvsidError(
            f"{source.name} has no column whose name is known; it has {', '.join(source.columns[:16])}: name its velocities u, v, r and its time t, "
            "or write [log] by hand as the user's guide shows"
        )
    votes = Counter(m.program.name for m in matches if m.meaning.channel != "demand")
    best = max(matches, key=lambda m: (votes[m.program.name], -m.rank)).program
    matches.sort(key=lambda m: (m.program != best, m.rank, m.column))
    taken: dict[str, list[Match]] = {}
    for m in matches:
        if m.meaning.channel != "demand":
            taken.setdefault(m.meaning.channel, []).append(m)
    _one_velocity(taken)
    demands = [m for m in matches if m.meaning.channel == "demand"]
    cells = _cells(source, [m for several in (*taken.values(), demands) for m in several])
    stamps: dict[str, Stamps | None] = {}
    channels = {}
    for name, several in taken.items():
        there = [m for m in several if m.column in cells]
        if there:
            found = _found(source, there[0], cells[there[0].column], stamps, best)
            channels[name] = replace(found, others=tuple(m.column for m in there[1:]))
    moving = [
        _found(source, m, cells[m.column], stamps, best)
        for m in demands
        if m.column in cells and np.unique(cells[m.column][np.isfinite(cells[m.column])]).size > 1
    ]
    used = {m.column for m in matches} | {s.column for s in stamps.values() if s is not None}
    return Columns(
        channels=channels,
        demands=_named(moving),
        stamps={t: s for t, s in stamps.items() if s is not None},
        program=best,
        angles=tuple(angles),
        unknown=tuple(c for c in source.columns if c not in used and c not in angles),
    )


def _matches(source: Source) -> tuple[list[Match], list[str]]:
    """Every column with a known name, and those that look like angles of thrusters."""
    found, angles = [], []
    words = known_names().demands
    for table, content in source.tables.items():
        for column in content.columns:
            full = source.shown(table, column)
            stated = label(table, column)
            bare = column if stated is None else stated.name
            m = match(full, bare)
            if m is not None:
                found.append(m)
                continue
            steps = set(re.split(r"[^a-z]+", plain_name(bare, {})[0]))
            if steps & set(words.not_):
                continue
            if steps & set(words.angles):
                angles.append(full)
            elif steps & set(words.words):
                plain = known_names().programs[-1]
                found.append(Match(full, plain, Meaning(channel="demand"), 10**6))
    return found, angles


def _one_velocity(taken: dict[str, list[Match]]) -> None:
    """Velocities in body axes rather than in earth axes, and the heading as an angle rather than as a quaternion."""
    if "u" in taken and "v" in taken:
        for name in EARTH:
            taken.pop(name, None)
    elif all(n in taken for n in EARTH):
        for name in ("u", "v"):
            taken.pop(name, None)
    if not all(q in taken for q in ATTITUDE) or ("psi" in taken and "roll" in taken):
        for name in ATTITUDE:
            taken.pop(name, None)


def _cells(source: Source, matches: Sequence[Match]) -> dict[str, Array]:
    """Cells by column, without columns of words or with fewer than two samples; all are read at once where that works."""
    names = list(dict.fromkeys(m.column for m in matches))
    try:
        read = source.numeric(names)
    except IvsidError:
        read = {}
        for name in names:
            with contextlib.suppress(IvsidError):
                read |= source.numeric([name])
    return {n: x for n, x in read.items() if np.isfinite(x).sum() > 1}


def _found(source: Source, m: Match, values: Array, stamps: dict[str, Stamps | None], best: Program) -> Found:
    """A column with its times.

    Raises:
        IvsidError: its table has no stamps whose name is known.
    """
    place = source.find(m.column)
    table, column = place if place is not None else ("", m.column)
    if table not in stamps:
        stamps[table] = _stamps(source, table, best)
    clock = source.tables[table].clock
    own = stamps[table]
    if own is not None:
        t, rows = own.t, own.rows
    elif clock is not None:
        made = times_of(source.tables[table].exact(clock.from_), clock.unit, source.name, clock.from_, 1, own=False)
        t, rows = made.t, made.rows
    else:
        raise IvsidError(
            f"{source.name} has no column of stamps whose name is known beside {m.column}; name it t, or write [log] time by hand as the user's guide shows"
        )
    stated = label(table, column)
    meaning = m.meaning
    if stated is not None and meaning.channel != "demand" and meaning.unit is None and meaning.scale == 1.0:
        meaning = meaning.model_copy(update={"unit": stated.known(units.COLUMN, source.name)})
    sure = meaning.unit is not None or meaning.scale != 1.0 or not m.program.plain
    return Found(replace(m, meaning=meaning), table, t, values if rows is None else values[rows], sure)


def _stamps(source: Source, table: str, best: Program) -> Stamps | None:
    """The column of stamps of a table; None where its format defines its clock.

    Raises:
        IvsidError: stamps that are out of order or missing.
    """
    content = source.tables[table]
    if content.clock is not None:
        return None
    endings = known_names().time_endings
    plain = known_names().programs[-1]
    for program in (best, plain, *known_names().programs):
        for column in content.columns:
            stated = label(table, column)
            bare = column if stated is None else stated.name
            unit: str | None = program.own.get(bare)
            if program is plain:
                name, ending = plain_name(bare, endings)
                unit = (ending or "") if name in plain.own else None
            if unit is None:
                continue
            if stated is not None:
                unit = stated.known(units.TIME, source.name)
            times = times_of(content.exact(column), unit or None, source.name, column, content.first_row, own=False)
            return Stamps(column, unit or None, None, times.t, times.rows)
    return _two_columns(source, table)


def _two_columns(source: Source, table: str) -> Stamps | None:
    """Stamps of ROS in whole seconds and nanoseconds."""
    content = source.tables[table]
    for column in content.columns:
        if column.endswith(("stamp.sec", "stamp/sec", "stamp_sec")):
            nanos = column.removesuffix("sec") + "nanosec"
            if nanos in content.columns:
                seconds = source.numeric([source.shown(table, column)])
                rest = source.numeric([source.shown(table, nanos)])
                whole, part = next(iter(seconds.values())), next(iter(rest.values()))
                return Stamps(column, None, nanos, (whole - whole[0]) + 1e-9 * part, None)
    return None


def _named(found: Sequence[Found]) -> dict[str, Found]:
    """Demands by the names of their thrusters: the words of their columns that tell them apart."""
    made: dict[str, Found] = {}
    for f in found:
        name = _thruster(f)
        made[name if name not in made else f"{name}_{len(made) + 1}"] = f
    return made


def _thruster(found: Found) -> str:
    """The name of a thruster: the last step of a known path, or the words of a plain name that are not general."""
    column = found.match.column.removeprefix(f"{found.table}/")
    stated = label(found.table, column)
    bare = column if stated is None else stated.name
    if not found.program.plain:
        words = [w for w in re.split(r"[^A-Za-z0-9]+", re.split(r"[/.:]", bare)[-1]) if w]
    else:
        every = [w for w in re.split(r"[^A-Za-z0-9]+", bare) if w]
        words = [w for w in every if w.lower() not in known_names().demands.general] or every
    return "_".join(words) or "thruster"


def ambiguous(source: Source, taken: Mapping[str, object]) -> dict[str, str]:
    """Channels that several tables hold under their own name and that are not taken: the first of their columns, by name."""
    found = {}
    for name in COLUMNS:
        holders = [t for t, content in source.tables.items() if name in content.columns]
        if len(holders) > 1 and name not in taken:
            found[name] = source.shown(holders[0], name)
    return found
