"""A log from any file that holds one: opened, mapped, turned, brought to one clock, and examined."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.log.angles import certain_below, is_angle, unwrapped, wrapped
from ivsid.log.channels import (
    BY_THRUSTER,
    DEMAND,
    Channel,
    Clocked,
    Rule,
    converted,
    row_clock,
    rules_of,
    turned,
    with_heading,
)
from ivsid.log.clocks import Times, between, clock_of, held, loses_digits, nearest, times_of, together
from ivsid.log.formats import open_source
from ivsid.log.quality import Steps, examine, gaps, without_held
from ivsid.log.record import GAP, Clock, Log, Quality, Sweep
from ivsid.log.source import Source, numbers
from ivsid.log.sweep import Manner, swept
from ivsid.log_map import LogMap

Array = NDArray[np.float64]

# Whose clock becomes the rows' where nothing is said: where accelerations stand, rows need no interpolation of them.
_BASES: Final = ("ax", "udot", "ay", "vdot", "r", "u", "velocity_north", "psi", "x")
EARTH: Final = ("velocity_north", "velocity_east")
FORCES: Final = ("force_X", "force_Y", "moment_N")


@dataclass
class _Reading:
    """A log while it is put together."""

    source: Source
    mapping: LogMap
    channels: dict[str, Channel] = field(default_factory=dict)
    times: dict[Clocked, Times] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    assumes: list[str] = field(default_factory=list)
    quality: dict[str, Quality] = field(default_factory=dict)
    over: dict[str, Sweep] = field(default_factory=dict)
    by_rate: list[str] = field(default_factory=list)
    certain: dict[str, float] = field(default_factory=dict)


def read_log(path: str | Path, mapping: LogMap | None = None) -> Log:
    """Reads a log: CSV or Parquet (plain or gzip), MATLAB v4 or v5, a ROS bag, DataFlash, or a folder of CSV and Parquet files.

    Args:
        path: of the file or folder.
        mapping: the ``[log]`` section of a vehicle file.

    Returns:
        The contract's channels on one clock. A channel of another clock is missing between its own samples unless
        ``mapping.rates`` bounds how fast it moves; then it is interpolated and its ``rounding`` holds what that can miss.

    Raises:
        IvsidError: what is wrong with the file, in one sentence.
    """
    mapping = mapping or LogMap()
    with open_source(path) as source:
        rules, ignored = rules_of(source, mapping)
        reading = _Reading(source, mapping)
        _collect(reading, rules)
        if mapping.frame == "flu":
            reading.channels = turned(reading.channels)
        reading.channels, words = with_heading(reading.channels, source.name)
        reading.notes += words
        reading.times = together(reading.times, source.name)
        stamps = {clock: x.t for clock, x in reading.times.items()}
        _examine(reading, stamps)
        t, columns, rounding, clocks = _on_one_clock(reading, stamps)
        derived = _body_velocities(columns, rounding, reading)
        lost = max(x.lost for x in reading.times.values()) * (2 if len(reading.times) > 1 else 1)
        return Log(
            name=Path(path).name,
            sha256=source.sha256,
            t=t,
            columns=columns,
            ignored=ignored,
            notes=tuple(dict.fromkeys([*reading.notes, *gaps(t)])),
            rounding=rounding,
            time_rounding=lost,
            assumes=tuple(reading.assumes),
            derived=derived,
            clocks=clocks,
            quality=reading.quality,
            over=reading.over,
            by_rate=tuple(reading.by_rate),
            certain=reading.certain,
        )


def _collect(reading: _Reading, rules: Mapping[str, Rule]) -> None:
    """Reads every table once: its stamps, and the columns that a rule asks for."""
    source = reading.source
    tables = {rule.table for rule in rules.values()} or {next(iter(source.tables))}
    for table in sorted(tables):
        content = source.tables[table]
        mine = {wanted: rule for wanted, rule in rules.items() if rule.table == table}
        wanted_clocks = {rule.clock: rule.stamps for rule in mine.values()}
        row, of_rows = None, None
        if not wanted_clocks or any(rule.column.time is None for rule in mine.values()):
            row, of_rows = row_clock(source, reading.mapping, table)
            wanted_clocks[of_rows] = row
        names = [*(c[1] for c in wanted_clocks), *(rule.name for rule in mine.values())]
        series = content.read(list(dict.fromkeys(names)))
        for clock, stamps in wanted_clocks.items():
            column = series[clock[1]]
            shown, own = source.shown(*clock), clock != of_rows
            if loses_digits(column, stamps.unit):
                column = content.exact(clock[1])
            reading.times[clock] = times_of(column, stamps.unit, source.name, shown, content.first_row, own=own)
        arrays: dict[str, Array] = {}
        for wanted, rule in mine.items():
            if rule.name not in arrays:
                shown = source.shown(table, rule.name)
                arrays[rule.name] = numbers(series[rule.name], shown, source.name, content.first_row)
            rows = reading.times[rule.clock].rows
            values = arrays[rule.name] if rows is None else arrays[rule.name][rows]
            made = converted(values, rule.column, rule.clock)
            if np.isinf(made.values).any():
                raise IvsidError(
                    f"{source.name}: column {rule.name} times its scale, plus its offset, is no finite number for {wanted}; "
                    "look at scale and offset under [log] columns"
                )
            reading.channels[wanted] = made


def _examine(reading: _Reading, stamps: Mapping[Clocked, Array]) -> None:
    """Takes held repeats out and notes what every channel is worth, each on its own clock."""
    steps = {clock: Steps.of(t) for clock, t in stamps.items()}
    for name, channel in list(reading.channels.items()):
        values, repeats, note = without_held(name, channel.values)
        if note:
            reading.notes.append(note)
            reading.assumes.append(f"the first of equal values of {name} is a measurement at its row")
            reading.channels[name] = replace(channel, values=values)
        found, words = examine(name, stamps[channel.clock], values, repeats, reading.source.name, steps[channel.clock])
        reading.quality[name] = found
        reading.notes += words


_Columns = dict[str, Array]


def _on_one_clock(
    reading: _Reading, stamps: Mapping[Clocked, Array]
) -> tuple[Array, _Columns, _Columns, dict[str, Clock]]:
    """Rows, columns, what each value may be off, and the clocks of the channels that were brought to the rows."""
    mapping, channels = reading.mapping, reading.channels
    if len(reading.times) == 1 and mapping.base is None and not mapping.rates:
        t = next(iter(stamps.values()))
        lost = {n: c.lost for n, c in channels.items() if c.lost is not None}
        return t, {n: c.values for n, c in channels.items()}, lost, {}
    if mapping.demand == "linear":
        raise IvsidError(
            f'{reading.source.name} is brought to one clock (several clocks, base or rates), where demand = "linear" is not '
            'available; use demand = "hold", or log everything on one clock'
        )
    base, t = _rows(reading, stamps)
    columns: _Columns = {}
    rounding: _Columns = {}
    clocks: dict[str, Clock] = {}
    for name, c in channels.items():
        values, off, clock = _brought(reading, name, c, stamps[c.clock], base, t)
        columns[name], rounding[name] = values, off
        if clock is not None:
            clocks[name] = clock
    for name, values in columns.items():
        if np.isnan(values).all():
            raise IvsidError(
                f"{reading.source.name}: no sample of {name} stands on the clock of the rows; state under [log] rates how fast it can "
                "change, so that it can be brought there, or choose another base"
            )
    if len(reading.times) > 1:
        apart = f"to within {mapping.clock_error!r} s" if mapping.clock_error else "exactly"
        names = ", ".join(reading.source.shown(*c) for c in sorted(reading.times))
        reading.assumes.append(f"the clocks {names} agree {apart}")
    return t, columns, rounding, clocks


def _rows(reading: _Reading, stamps: Mapping[Clocked, Array]) -> tuple[Clocked, Array]:
    """The clock whose stamps become the rows, and those stamps."""
    wanted, channels = reading.mapping.base, reading.channels
    if wanted in channels:
        c = channels[wanted]
        return c.clock, stamps[c.clock][~np.isnan(c.values)]
    tables = [c for c in stamps if c[0] == wanted]
    if wanted is not None and not tables:
        raise IvsidError(
            f"[log] base = '{wanted}' is neither a channel nor a table of {reading.source.name}; "
            f"it has the channels {', '.join(channels)}"
        )
    if tables:
        return tables[0], stamps[tables[0]]
    first = next((n for n in _BASES if n in channels), None)
    clock = channels[first].clock if first else next(iter(stamps))
    reading.notes.append(
        f"the rows are the samples of {reading.source.shown(*clock)}; [log] base chooses another clock"
    )
    return clock, stamps[clock]


def _brought(
    reading: _Reading, name: str, c: Channel, own: Array, base: Clocked, t: Array
) -> tuple[Array, Array, Clock | None]:
    """One channel on the rows."""
    mapping = reading.mapping
    lost = np.zeros(c.values.shape) if c.lost is None else c.lost
    apart = rounded = 0.0
    if c.clock != base:
        rounded = sum(reading.times[k].lost for k in (c.clock, base)) + 4 * float(np.spacing(t[-1]))
        apart = mapping.clock_error + rounded
    if name.startswith(DEMAND):
        # Stamps that differ by rounding alone are one moment.
        row, same = nearest(own, t, rounded)
        values, off = held(t, np.where(same, t[row], own), c.values, mapping.clock_error if c.clock != base else 0.0)
        away = np.isnan(values) & (t >= own[0])
        if c.clock != base and away.any() and not np.isnan(c.values).any():
            reading.notes.append(
                f"{name} is missing in {int(away.sum())} of {t.size} rows, which reach into a hole of its samples; where it was held "
                "there, log it again at its usual step"
            )
        if off.any():
            reading.notes.append(
                f"{name} changes within {int((off > 0).sum())} of {t.size} rows; there it is an interval"
            )
        return values, off + lost.max(), None
    there = ~np.isnan(c.values)
    times, values, off = own[there], c.values[there], lost[there]
    rate = mapping.rates.get(name)
    if is_angle(name):
        values, more = unwrapped(values)
        off = off + more
    if name in FORCES or name.startswith(BY_THRUSTER[1:]):
        _sweep(reading, name, c, base, t, times, values, off)
    if times.size < 2 or rate is None:
        # Clocks that may disagree have no common moment; between clocks that agree only rounding can stand.
        place, same = nearest(t, times, -1.0 if c.clock != base and mapping.clock_error else apart)
        if c.clock != base and not same.all():
            reading.notes.append(
                f"{name} stands on another clock than the rows and is missing on {int((~same).sum())} of {t.size}; "
                "[log] rates bounds how fast it changes, and brings it there"
            )
        # Fewer rows than samples: the noise of each is still that of the sensor's own step.
        clock = None if own.size == t.size and np.array_equal(own, t) else clock_of(own)
        values, off = c.values[there], lost[there]
        return np.where(same, values[place], np.nan), np.where(same, off[place], 0.0), clock
    jitter = _jitter(reading, c.clock, base)
    made, reach = between(t, times, values, off, rate, apart, jitter)
    if is_angle(name):
        # Gaps are not bridged, so whole turns in them do not matter.
        steps = np.diff(times)
        longest = GAP * float(np.median(steps))
        most = float(steps[steps <= longest].max())
        if rate * most >= np.pi:
            raise IvsidError(
                f"[log] rates {name} = {rate:g} lets it turn by half a circle between two of its samples, "
                f"{most:.3g} s apart; state a smaller rate or leave it out"
            )
        reading.certain[name] = certain_below(values, times, rate, longest, jitter + float(np.spacing(times[-1])))
        made, more = wrapped(made)
        reach = reach + more
    reading.by_rate.append(name)
    moved = int((~nearest(t, times, 0.0)[1] & ~np.isnan(made)).sum())
    if moved:
        reading.assumes.append(
            f"between its samples {name} never changes faster than {rate!r} a second, and its sensor's scale is the same at "
            f"both (used at {moved} rows, where it adds at most {np.nanmax(reach):.3g})"
        )
    fast = int((np.abs(np.diff(values)) > rate * np.diff(times)).sum())
    if fast:
        reading.notes.append(
            f"{name} changes faster than the stated {rate:g} a second between {fast} of {times.size - 1} pairs of samples: noise, or the rate is too small"
        )
    return made, reach, clock_of(times)


def _jitter(reading: _Reading, *clocks: Clocked) -> float:
    """How far a stamp of these clocks may be off beyond the rounding of its decimals [s]."""
    return max(reading.times[k].lost for k in clocks)


def _sweep(
    reading: _Reading, name: str, c: Channel, base: Clocked, t: Array, times: Array, values: Array, off: Array
) -> None:
    """Keeps between which values a force or an angle stood over each step, from every sample that the log has there."""
    mapping = reading.mapping
    rate = mapping.rates.get(name)
    if times.size < 2 or (rate is None and times.size == t.size and np.array_equal(times, t)):
        # Nothing stands between the rows.
        return
    manner: Manner = "between" if name in FORCES else "hold"
    if rate is not None:
        assumes = f"{name} never changes faster than {rate!r} a second"
    elif manner == "hold":
        assumes = f"{name} holds from each of its samples to the next"
    else:
        assumes = f"{name} lies between the values of neighbouring samples"
    # Stamps that differ by rounding alone are one moment.
    jitter = _jitter(reading, c.clock, base)
    row, same = nearest(times, t, 2 * jitter + 4 * float(np.spacing(t[-1])) if c.clock != base else 0.0)
    lower, upper = swept(
        t,
        np.where(same, t[row], times),
        values,
        off + np.spacing(np.abs(values)),
        manner=manner,
        rate=rate,
        clock_error=mapping.clock_error if c.clock != base else 0.0,
        jitter=jitter,
    )
    reading.over[name] = Sweep(lower, upper, assumes)


def _body_velocities(columns: _Columns, rounding: _Columns, reading: _Reading) -> dict[str, tuple[str, ...]]:
    """Adds u and v from the velocity in earth axes, where only that is there. Their bounds are made from the parts."""
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
