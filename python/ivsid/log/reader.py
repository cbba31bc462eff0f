"""A log from any file that holds one: opened, mapped, turned, brought to one clock, and examined."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.files.log_map import LogMap, TimeColumn
from ivsid.files.processor import check_rounding
from ivsid.log.channels import Clocked, converted, turned, with_heading
from ivsid.log.clocks import together, within
from ivsid.log.formats import open_source
from ivsid.log.markers import without_markers
from ivsid.log.mcap_index import IndexFaultError
from ivsid.log.one_clock import Columns, Reading, on_one_clock
from ivsid.log.parquet import Parquet
from ivsid.log.parts import Parts
from ivsid.log.quality import Steps, examine, gaps, without_held
from ivsid.log.record import Log
from ivsid.log.rules import BY_HEADER, Rule, row_clock, rules_of
from ivsid.log.source import Lossless, Source, Table, is_long, long_numbers, numbers
from ivsid.log.stamps import YEARS, digits_lost, loses_digits, of_two_columns, times_of
from ivsid.memory.pieces import any_piece

Array = NDArray[np.float64]

EARTH: Final = ("velocity_north", "velocity_east")


def read_log(path: str | Path | Parts, mapping: LogMap | None = None, *, parts: bool = False) -> Log:
    """Reads a log (plain or gzip): CSV, Parquet, JSON, MATLAB v4 or v5, a ROS bag, DataFlash, or a folder of tables.

    Args:
        path: of the file or folder; or a file elsewhere, which is fetched in parts.
        mapping: the section ``[log]`` of a vehicle file.
        parts: whether the identity of an MCAP or Parquet file is that of the parts that are needed, as of a file elsewhere.

    Returns:
        The channels on one clock, in SI units and the axes of the equations of motion. A channel of another clock is missing between
        its own samples unless ``mapping.rates`` bounds its rate of change. Then it is interpolated, and its ``rounding`` holds the
        bound on the error of that.

    Raises:
        IvsidError: the first fault of the file, in one sentence.
    """
    check_rounding()
    wanted = mapping or LogMap()
    try:
        with open_source(path, wanted.span, parts=parts) as source:
            log = read_source(source, wanted)
    except IndexFaultError:
        with open_source(path, wanted.span, mended=True) as source:
            log = read_source(source, wanted)
    # A reader of others may have changed the mode.
    check_rounding()
    return log


def read_source(source: Source, mapping: LogMap) -> Log:
    """A log from an opened source, under the map of a vehicle file.

    Raises:
        IvsidError: the first fault of the source, in one sentence.
    """
    rules, ignored = rules_of(source, mapping)
    reading = Reading(source, mapping)
    _collect(reading, rules)
    if mapping.frame == "flu":
        reading.channels = turned(reading.channels)
    reading.notes += source.notes
    reading.channels, words = with_heading(reading.channels, source.name)
    reading.notes += words
    stamps = {clock: x.t for clock, x in reading.times.items()}
    _examine(reading, stamps)
    t, columns, rounding, clocks = on_one_clock(reading, stamps)
    derived = _body_velocities(columns, rounding, reading)
    lost = max(x.lost for x in reading.times.values()) * (2 if len(reading.times) > 1 else 1)
    return Log(
        name=Path(source.name).name,
        sha256=source.sha256,
        t=t,
        columns=columns,
        ignored=ignored,
        notes=_told(dict.fromkeys([*reading.notes, *gaps(t)])),
        rounding=rounding,
        time_rounding=lost,
        assumes=tuple(reading.assumes),
        derived=derived,
        clocks=clocks,
        quality=reading.quality,
        over=reading.over,
        by_rate=tuple(reading.by_rate),
        certain=reading.certain,
        began=_began(reading),
    )


def _told(notes: Iterable[str]) -> tuple[str, ...]:
    """The notes, in which one sentence names all columns whose headers state their units."""
    given = list(notes)
    units = [n.removesuffix(BY_HEADER) for n in given if n.endswith(BY_HEADER)]
    if len(units) < 2:
        return tuple(given)
    pairs = "; ".join(u.replace(" is read in ", " in ") for u in units)
    return (
        f"columns are read in the units that their headers say: {pairs}",
        *(n for n in given if not n.endswith(BY_HEADER)),
    )


def _began(reading: Reading) -> float | None:
    """The first of all stamps in seconds since 1970; None where it is no date."""
    first = float(min(x.first for x in reading.times.values()))
    return first if YEARS[0] <= first <= YEARS[1] else None


@dataclass(frozen=True)
class _Wanted:
    """What is read of a table: its stamps, and the channels of its columns.

    Attributes:
        content: the table.
        channels: rules by channel.
        clocks: how the stamps of each clock are read.
        rows: the clock of the rows, or None.
    """

    content: Table
    channels: Mapping[str, Rule]
    clocks: Mapping[Clocked, TimeColumn]
    rows: Clocked | None


def _wanted(reading: Reading, rules: Mapping[str, Rule]) -> Iterator[_Wanted]:
    source = reading.source
    for table in sorted({rule.table for rule in rules.values()} or {next(iter(source.tables))}):
        mine = {wanted: rule for wanted, rule in rules.items() if rule.table == table}
        clocks, of_rows = {rule.clock: rule.stamps for rule in mine.values()}, None
        if not clocks or any(rule.column.time is None for rule in mine.values()):
            stamps, of_rows = row_clock(source, reading.mapping, table)
            clocks[of_rows] = stamps
        yield _Wanted(source.tables[table], mine, clocks, of_rows)


def _collect(reading: Reading, rules: Mapping[str, Rule]) -> None:
    """Reads every table once: its stamps, and the columns that a rule asks for."""
    span = None if reading.source.spanned else reading.mapping.span
    tables = list(_wanted(reading, rules))
    if span is None:
        for wanted in tables:
            columns = [n for rule in wanted.channels.values() for n in rule.names]
            _stamps(reading, wanted, series := _cells(wanted, columns))
            _channels(reading, wanted, series, slice(0, None))
        reading.times = together(reading.times, reading.source.name)
        return
    for wanted in tables:
        _stamps(reading, wanted, _cells(wanted, []))
    reading.times = within(together(reading.times, reading.source.name), span, reading.source.name)
    for wanted in tables:
        chosen = [reading.times[c].rows for c in wanted.clocks]
        rows = slice(
            min(int(r[0]) for r in chosen if r is not None), 1 + max(int(r[-1]) for r in chosen if r is not None)
        )
        columns = list(dict.fromkeys(n for r in wanted.channels.values() for n in r.names))
        if isinstance(wanted.content, Parquet) or is_long(wanted.content):
            wanted.content.prepare(columns)
            series = {n: wanted.content.part(n, rows) for n in columns}
        else:
            series = {n: c[rows] for n, c in wanted.content.read(columns).items()}
        _channels(reading, wanted, series, rows)


def _cells(wanted: _Wanted, columns: Sequence[str]) -> dict[str, pl.Series] | None:
    """The columns of stamps and others of a table; None where they are read a part at a time."""
    names = list(dict.fromkeys([*(c[1] for c in wanted.clocks), *columns]))
    if is_long(wanted.content):
        wanted.content.prepare(names)
        return None
    return wanted.content.read(names)


def _stamps(reading: Reading, wanted: _Wanted, series: Mapping[str, pl.Series] | None) -> None:
    """Reads the stamps of a table."""
    source, content = reading.source, wanted.content
    long = content if is_long(content) else None
    for clock, stamps in wanted.clocks.items():
        shown, own = source.shown(*clock), clock != wanted.rows
        unit, cells = stamps.unit, None
        if series is not None:
            column = series[clock[1]]
        elif long is not None and long.dtypes[clock[1]].is_float() and not own:
            # The first stamp stands for their type.
            column = long.part(clock[1], slice(0, 1))
            cells = long_numbers(long, clock[1], shown, source.name, content.first_row)
            if not isinstance(content, Lossless) and digits_lost(cells, unit):
                column, cells = content.exact(clock[1]), None
        else:
            column = content.exact(clock[1])
        if stamps.nanoseconds is not None:
            column, unit, cells = _of_two(source, content, clock, stamps.nanoseconds), "ns", None
        elif series is not None and loses_digits(column, unit):
            column = content.exact(clock[1])
        times = times_of(column, unit, source.name, shown, content.first_row, own=own, cells=cells)
        reading.times[clock] = times
        reading.notes += times.notes
        reading.assumes += times.assumes


def _channels(reading: Reading, wanted: _Wanted, series: Mapping[str, pl.Series] | None, part: slice) -> None:
    """Reads the channels of a table, from some of its rows."""
    source, content = reading.source, wanted.content
    long = content if is_long(content) else None
    arrays: dict[str, Array] = {}
    for channel, rule in wanted.channels.items():
        for name in set(rule.names) - arrays.keys():
            shown = source.shown(rule.table, name)
            if series is not None:
                arrays[name] = numbers(series[name], shown, source.name, content.first_row + part.start)
            elif long is not None:
                arrays[name] = long_numbers(long, name, shown, source.name, content.first_row)
            if rule.column.missing is None:
                arrays[name] = _unmarked(reading, shown, arrays[name])
        rows = reading.times[rule.clock].rows
        chosen = {n: arrays[n] if rows is None else arrays[n][rows - part.start] for n in rule.names}
        values, lost = rule.values(chosen)
        made = converted(values, rule.column, rule.clock, lost)
        if rule.note:
            reading.notes.append(rule.note)
        if _infinite(made.values):
            raise IvsidError(
                f"{source.name}: column {rule.name} times its scale, plus its offset, is no finite number for {channel}; "
                "look at scale and offset under [log] columns"
            )
        reading.channels[channel] = made


def _unmarked(reading: Reading, shown: str, values: Array) -> Array:
    """A column without cells that mark missing samples; each marker is noted and assumed."""
    kept, markers = without_markers(values)
    for marker, count in markers:
        reading.notes.append(
            f"{shown} holds {marker:.10g} in {count} cell{'s' * (count > 1)}, a usual marker of missing samples far beyond all others: they are no samples"
        )
        reading.assumes.append(f"cells of {shown} that hold {marker:.10g} are missing samples")
    return kept


def _infinite(values: Array) -> bool:
    return any_piece(values.size, lambda part: bool(np.isinf(values[part]).any()))


def _of_two(source: Source, content: Table, clock: Clocked, name: str) -> pl.Series:
    """Stamps of whole seconds and nanoseconds in two columns."""
    table, seconds = clock
    bare = name.removeprefix(f"{table}/") if table else name
    if bare not in content.columns:
        raise IvsidError(
            f"{source.name} has no column {name}, the nanoseconds of [log] time; it has {', '.join(list(content.columns)[:12])}"
        )
    shown = source.shown(table, seconds), source.shown(table, bare)
    return of_two_columns(content.exact(seconds), content.exact(bare), shown, source.name, content.first_row)


def _examine(reading: Reading, stamps: Mapping[Clocked, Array]) -> None:
    """Removes the repeats of held values, and records the quality of every channel on its own clock."""
    steps = {clock: Steps.of(t) for clock, t in stamps.items()}
    for name, channel in list(reading.channels.items()):
        values, repeats, note = without_held(name, channel.values)
        if note:
            reading.notes.append(note)
            if repeats:
                reading.assumes.append(f"the first of equal values of {name} is a measurement at its row")
            else:
                reading.assumes.append(
                    f"equal values of {name}, which changes by one step of its scale at any time, are measurements at their rows"
                )
            reading.channels[name] = replace(channel, values=values)
        found, words = examine(name, stamps[channel.clock], values, repeats, reading.source.name, steps[channel.clock])
        reading.quality[name] = found
        reading.notes += words


def _body_velocities(columns: Columns, rounding: Columns, reading: Reading) -> dict[str, tuple[str, ...]]:
    """Adds u and v from the velocity in earth axes, where a log has that alone; returns the channels behind each.

    Their bounds follow later from those of the parts.
    """
    north, east = EARTH
    if "u" in columns or "v" in columns or not all(c in columns for c in EARTH):
        return {}
    if "psi" not in columns:
        raise IvsidError(
            f"{reading.source.name} has velocity_north and velocity_east but no psi (or qw, qx, qy, qz); "
            "body velocities need the heading: add it, or log u and v"
        )
    c, s = np.cos(columns["psi"]), np.sin(columns["psi"])
    columns["u"] = columns[north] * c + columns[east] * s
    columns["v"] = columns[east] * c - columns[north] * s
    for name in ("u", "v"):
        if np.isnan(columns[name]).all():
            raise IvsidError(
                f"{reading.source.name}: velocity_north, velocity_east and psi are never there in the same row; "
                "bring them to one clock with [log] rates"
            )
    reading.notes.append("u and v follow from velocity_north, velocity_east and psi")
    return {"u": (*EARTH, "psi"), "v": (*EARTH, "psi")}
