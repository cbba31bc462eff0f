"""Channels of several clocks on the rows of one; forces and angles over the steps between those rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.files.log_map import LogMap
from ivsid.log.angles import certain_below, is_angle, unwrapped, wrapped
from ivsid.log.channels import BY_THRUSTER, DEMAND, Channel, Clocked
from ivsid.log.clocks import between, clock_of, held, nearest
from ivsid.log.record import GAP, Clock, Quality, StepRange
from ivsid.log.source import Source
from ivsid.log.stamps import Times
from ivsid.log.step_ranges import Manner, step_range

Array = NDArray[np.float64]

# The first of these channels gives its clock to the rows where none is chosen: accelerations then need no interpolation.
_BASES: Final = ("ax", "udot", "ay", "vdot", "r", "u", "velocity_north", "psi", "x")
FORCES: Final = ("force_X", "force_Y", "moment_N")


@dataclass
class Reading:
    """A log while it is put together.

    Attributes:
        source: the opened file.
        mapping: the section ``[log]``.
        channels: by name.
        times: by clock.
        notes: sentences for the user.
        assumes: sentences that the values rely on.
        quality: by channel.
        over: ranges of forces and angles over the steps between rows.
        by_rate: channels that were interpolated under a stated rate.
        certain: of angles, the reading error [rad] below which whole turns are certain.
    """

    source: Source
    mapping: LogMap
    channels: dict[str, Channel] = field(default_factory=dict)
    times: dict[Clocked, Times] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    assumes: list[str] = field(default_factory=list)
    quality: dict[str, Quality] = field(default_factory=dict)
    over: dict[str, StepRange] = field(default_factory=dict)
    by_rate: list[str] = field(default_factory=list)
    certain: dict[str, float] = field(default_factory=dict)


Columns = dict[str, Array]


def on_one_clock(reading: Reading, stamps: Mapping[Clocked, Array]) -> tuple[Array, Columns, Columns, dict[str, Clock]]:
    """Every channel on the rows of one clock.

    Args:
        reading: the log so far; notes, assumptions and step ranges are added to it.
        stamps: times by clock [s], all from one zero.

    Returns:
        Times of the rows [s], the columns on them, the bounds on their errors, and the clocks of the channels that came from
        another one.

    Raises:
        IvsidError: a base that does not exist, linear demands on several clocks, or a channel without a sample on the rows.
    """
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
    columns: Columns = {}
    rounding: Columns = {}
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


def _rows(reading: Reading, stamps: Mapping[Clocked, Array]) -> tuple[Clocked, Array]:
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
    reading: Reading, name: str, c: Channel, own: Array, base: Clocked, t: Array
) -> tuple[Array, Array, Clock | None]:
    """One channel on the rows: its values, the bounds on their errors, and its own clock where that differs."""
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
        _keep_step_range(reading, name, c, base, t, times, values, off)
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


def _jitter(reading: Reading, *clocks: Clocked) -> float:
    """Bound on the error of a stamp of these clocks beyond the rounding of its decimals [s]."""
    return max(reading.times[k].lost for k in clocks)


def _keep_step_range(
    reading: Reading, name: str, c: Channel, base: Clocked, t: Array, times: Array, values: Array, off: Array
) -> None:
    """Keeps the range of a force or an angle over each step between rows, from every sample of the log there."""
    mapping = reading.mapping
    rate = mapping.rates.get(name)
    if times.size < 2 or (rate is None and times.size == t.size and np.array_equal(times, t)):
        # The log has no sample between the rows.
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
    lower, upper = step_range(
        t,
        np.where(same, t[row], times),
        values,
        off + np.spacing(np.abs(values)),
        manner=manner,
        rate=rate,
        clock_error=mapping.clock_error if c.clock != base else 0.0,
        jitter=jitter,
    )
    reading.over[name] = StepRange(lower, upper, assumes)
