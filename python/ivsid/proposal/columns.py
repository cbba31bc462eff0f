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
from ivsid.log.headers import label, spelled
from ivsid.log.markers import without_markers
from ivsid.log.stamps import times_of
from ivsid.proposal.found import Found, Stamps
from ivsid.proposal.names import Match, Meaning, Program, known_names, match, plain_name
from ivsid.proposal.places import local
from ivsid.proposal.thrusters import ANGLES, kind_of, named, steered, steps_of

Array = NDArray[np.float64]

_NUMBER = re.compile(r"[+-]?[0-9.]+(e[+-]?[0-9]+)?", re.IGNORECASE)
EARTH = ("velocity_north", "velocity_east")
ATTITUDE = ("qw", "qx", "qy", "qz")


@dataclass(frozen=True)
class Columns:
    """What the names of a log say.

    Attributes:
        channels: by name, without the demands.
        demands: by thruster.
        stamps: by table; a table whose format defines its clock has none.
        program: that names most of the channels.
        angles: of rudders and azimuth thrusters, by their channel, ``rudder_NAME`` or ``azimuth_NAME``.
        loose: columns that look like such angles, and whose thruster is not known.
        unknown: columns that nothing takes.
    """

    channels: Mapping[str, Found]
    demands: Mapping[str, Found]
    stamps: Mapping[str, Stamps]
    program: Program
    angles: Mapping[str, Found]
    loose: tuple[str, ...]
    unknown: tuple[str, ...]


def columns_of(source: Source) -> Columns:
    """The columns of an opened log by their names; their cells are read.

    Raises:
        IvsidError: no column has a known name, or no table has stamps.
    """
    matches = _matches(source)
    pushing = ("demand", *ANGLES)
    if not any(m.meaning.channel not in pushing for m in matches):
        if all(_NUMBER.fullmatch(c) for c in source.columns):
            raise IvsidError(
                f"{source.name} has no header row: it begins with the numbers {', '.join(source.columns[:6])}; write the names of its columns into a first row"
            )
        raise IvsidError(
            f"{source.name} has no column whose name is known; it has {', '.join(source.columns[:16])}: name its velocities u, v, r and its time t, "
            "or write [log] by hand as the user's guide shows"
        )
    votes = Counter(m.program.name for m in matches if m.meaning.channel not in pushing)
    best = max(matches, key=lambda m: (votes[m.program.name], -m.rank)).program
    matches.sort(key=lambda m: (m.program != best, m.rank, m.column))
    taken: dict[str, list[Match]] = {}
    for m in matches:
        if m.meaning.channel not in pushing:
            taken.setdefault(m.meaning.channel, []).append(m)
    _one_velocity(taken)
    pushes = [m for m in matches if m.meaning.channel in pushing]
    cells = _cells(source, [m for several in (*taken.values(), pushes) for m in several])
    stamps: dict[str, Stamps | None] = {}
    channels = {}
    for name, several in taken.items():
        there = [m for m in several if m.column in cells]
        if there:
            found = _found(source, there[0], cells[there[0].column], stamps, best)
            channels[name] = replace(found, others=tuple(m.column for m in there[1:]))
    channels = local(channels)
    there = [m for m in pushes if m.column in cells]
    pushed = [_found(source, m, cells[m.column], stamps, best) for m in there]
    demands = named([f for f in pushed if f.meaning.channel == "demand"])
    angles, loose = steered([f for f in pushed if f.meaning.channel in ANGLES], demands)
    used = {m.column for m in matches} | {s.column for s in stamps.values() if s is not None}
    return Columns(
        channels=channels,
        demands=demands,
        stamps={t: s for t, s in stamps.items() if s is not None},
        program=best,
        angles=angles,
        loose=loose,
        unknown=tuple(c for c in source.columns if c not in used),
    )


def _matches(source: Source) -> list[Match]:
    """Every column with a known name, and those that the words of their name make a demand or an angle of a thruster."""
    found = []
    commanded = set(known_names().demands.commanded)
    for table, content in source.tables.items():
        for column in content.columns:
            full = source.shown(table, column)
            stated = label(table, column)
            bare = column if stated is None else stated.name
            m = match(full, bare)
            # What a controller asks for is no reading of the motion, whatever its message is called.
            if m is not None and (m.meaning.channel in ("demand", *ANGLES) or not steps_of(full) & commanded):
                found.append(m)
            elif m is None and (kind := kind_of(table, bare)) is not None:
                endings = known_names().endings
                unit = plain_name(bare, endings)[1] if kind in ANGLES else None
                found.append(Match(full, known_names().programs[-1], Meaning(channel=kind, unit=unit), 10**6))
    return found


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
    unmarked = {n: without_markers(x)[0] for n, x in read.items()}
    return {n: x for n, x in unmarked.items() if np.isfinite(x).sum() > 1}


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
    unread = ""
    if stated is not None and meaning.channel != "demand" and meaning.unit is None and meaning.scale == 1.0:
        unit = spelled(stated.unit)
        if unit in units.COLUMN:
            meaning = meaning.model_copy(update={"unit": unit})
        else:
            unread = stated.unit
    sure = meaning.unit is not None or meaning.scale != 1.0 or not m.program.plain or bool(unread)
    kept = values if rows is None else values[rows]
    return Found(replace(m, meaning=meaning), table, t, kept, sure, unread=unread)


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
    # Stamps that every table has come first: those of one table alone need not count from the same zero as the others'.
    own = [set(t.columns) for t in source.tables.values() if t.clock is None]
    shared = [c for c in content.columns if all(c in others for others in own)]
    candidates = [(p, cs) for cs in (shared, content.columns) for p in (best, plain, *known_names().programs)]
    for program, columns in candidates:
        for column in columns:
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


def ambiguous(source: Source, taken: Mapping[str, object]) -> dict[str, str]:
    """Channels that several tables hold under their own name and that are not taken: the first of their columns, by name."""
    found = {}
    for name in COLUMNS:
        holders = [t for t, content in source.tables.items() if name in content.columns]
        if len(holders) > 1 and name not in taken:
            found[name] = source.shown(holders[0], name)
    return found
