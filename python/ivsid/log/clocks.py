"""Clocks: stamps to seconds without losing digits, and channels of several clocks brought to one, with a stated bound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.log.record import GAP, Clock
from ivsid.log.source import numbers, stamp_unit

Array = NDArray[np.float64]

EPOCH: Final = 1e6
# Decimals kept of a large stamp: 23 digits are left before the point.
DECIMALS: Final = 15
# Half units that rounding twice can lose: one, and another to the nearest double of an integer that is 1e9 times as large.
TWICE: Final = 2.25
_SECONDS: Final = {u: Decimal(repr(f)) for u, f in units.TIME.items()}


@dataclass(frozen=True)
class Times:
    """Stamps in seconds; ``rows`` of the table that they stand for (None: all), what was lost, and the first stamp exactly."""

    t: Array
    lost: float
    first: Decimal
    counted: bool
    rows: NDArray[np.intp] | None = None


def times_of(series: pl.Series, unit: str, source: str, name: str, first_row: int, *, own: bool) -> Times:
    """Checks and converts one column of stamps. Large stamps (epochs) count from their first one: a double has too few digits.

    Args:
        series: the stamps with every digit.
        unit: of the stamps; a column of dates knows its own.
        source: what messages call the file.
        name: of the column.
        first_row: what messages call the first sample.
        own: a sensor's own stamps beside the rows: a repeated or missing one marks a row without a new sample.

    Raises:
        IvsidError: a missing stamp, one that is no number, or time that does not increase.
    """
    if series.dtype == pl.Boolean:
        raise IvsidError(
            f"{source}: column {name} holds true and false, not times; map the column of stamps under [log] time"
        )
    if series.dtype == pl.Date:
        series = series.cast(pl.Datetime("us"))
    unit = stamp_unit(series) or unit
    if series.dtype.is_temporal():
        series = series.to_physical()
    scale = units.factor(unit, units.TIME, f"column {name}")
    stamps = numbers(series, name, source, first_row)
    rows = None
    if own:
        new = np.isfinite(stamps)
        known = np.flatnonzero(new)
        new[known[1:]] = stamps[known[1:]] != stamps[known[:-1]]
        rows = np.flatnonzero(new)
        stamps, series = stamps[rows], series.gather(rows)
    if stamps.size < 2:
        what = "stamp" if own else "row"
        raise IvsidError(f"{source} has {stamps.size} {what}{'s' * (stamps.size != 1)}; at least 2 samples are needed")
    if np.isnan(stamps).any():
        row = int(np.argmax(np.isnan(stamps)))
        raise IvsidError(f"{source}: the time is missing in row {row + first_row}; every row needs one")
    first = _decimal(series[0]) * _SECONDS[unit]
    counted = bool(abs(stamps[0]) > EPOCH or scale != 1.0)
    t, lost = _since_first(series, stamps, scale) if counted else (stamps, _own_rounding(series, stamps))
    steps = np.diff(t)
    if (steps <= 0).any():
        k = int(np.argmax(steps <= 0))
        row = (k + 1 if rows is None else int(rows[k + 1])) + first_row
        raise IvsidError(
            f"{source}: time goes from {t[k]:.6g} s to {t[k + 1]:.6g} s at row {row}; it must increase strictly: "
            "sort the log or drop repeated rows"
        )
    return Times(t, lost, first, counted, rows)


def loses_digits(series: pl.Series, unit: str) -> bool:
    """Whether doubles are too short for these stamps, so that they have to be read again with every digit."""
    if not series.dtype.is_float():
        return False
    largest = series.abs().max()
    return isinstance(largest, float) and (largest > EPOCH or unit != "s")


def _decimal(stamp: object) -> Decimal:
    return Decimal(stamp.strip()) if isinstance(stamp, str) else Decimal(str(stamp))


def _since_first(series: pl.Series, stamps: Array, scale: float) -> tuple[Array, float]:
    """Seconds since the first stamp, and how far each may be off: from decimals and integers exactly, from doubles as they are."""
    if series.dtype.is_float():
        # A double is a rounded instant, this one and the first; integers of nanoseconds that were divided have been rounded twice.
        difference, lost = stamps - stamps[0], 2 * TWICE * _half_unit(series, stamps)
    else:
        kind = pl.Decimal(38, DECIMALS)
        try:
            exact = series.str.strip_chars().cast(kind) if series.dtype == pl.String else series.cast(kind)
            difference, lost = (exact - exact[0]).cast(pl.Float64).to_numpy(), 2 * 10.0**-DECIMALS
        except pl.exceptions.PolarsError:
            difference, lost = stamps - stamps[0], 2 * _half_unit(series, stamps)
    t = np.asarray(difference * scale, dtype=np.float64)
    # The difference is rounded at most twice, the unit and the product once each.
    return t, scale * lost * (1 + 1e-12) + 4 * float(np.spacing(np.abs(t).max()))


def _half_unit(series: pl.Series, stamps: Array) -> float:
    """Half a unit in the last place of the largest stamp, in the type that it is stored in."""
    largest = np.abs(stamps).max()
    return 0.5 * float(np.spacing(np.float32(largest) if series.dtype == pl.Float32 else largest))


def _own_rounding(series: pl.Series, stamps: Array) -> float:
    """What short floats lost of stamps in seconds; the rounding of doubles is ``Log.time_error``'s own part."""
    return _half_unit(series, stamps) if series.dtype == pl.Float32 else 0.0


def together(times: Mapping[tuple[str, str], Times], source: str) -> dict[tuple[str, str], Times]:
    """All clocks from one common zero: that of the files, or the earliest stamp where any counts from its first.

    Raises:
        IvsidError: clocks that never run at the same time, so that they cannot count from the same zero.
    """
    shifted = dict(times)
    if len(times) > 1 and any(x.counted for x in times.values()):
        origin = min(x.first for x in times.values())
        shifted = {key: _shifted(x, float(x.first - origin)) for key, x in times.items()}
    last, first = max(shifted, key=lambda k: shifted[k].t[0]), min(shifted, key=lambda k: shifted[k].t[-1])
    if shifted[last].t[0] > shifted[first].t[-1]:
        spans = [
            f"{'/'.join(k).lstrip('/')} from {shifted[k].t[0]:.6g} to {shifted[k].t[-1]:.6g} s" for k in (first, last)
        ]
        raise IvsidError(
            f"{source}: the clocks {spans[0]} and {spans[1]} never run at the same time; they count from different zeros, "
            "or in other units than [log] time says: bring them to one zero first"
        )
    return shifted


def _shifted(x: Times, by: float) -> Times:
    if x.counted:
        since, lost = x.t, x.lost
    else:
        # Stamps in plain seconds are rounded decimals, this one and the first, and so is their difference.
        since = x.t - x.t[0]
        lost = x.lost + float(np.spacing(np.abs(x.t).max()) + np.spacing(since[-1]))
    t = since + by
    return replace(x, t=t, lost=lost + float(np.spacing(abs(by)) + np.spacing(np.abs(t).max())))


def held(rows: Array, t: Array, values: Array, clock_error: float) -> tuple[Array, Array]:
    """A demand on the rows: between which values it stood from each row to the next, as middle and half-width.

    Missing before the first sample, after the last one, and in rows that reach into a hole of the samples: there it may have changed.
    """
    until = np.r_[rows[1:], rows[-1]]
    first = np.searchsorted(t, rows - clock_error, side="right") - 1
    last = np.maximum(np.searchsorted(t, until + clock_error, side="left") - 1, first)
    last[-1] = max(int(np.searchsorted(t, rows[-1] + clock_error, side="right")) - 1, int(first[-1]))
    padded = np.r_[values, np.nan]
    begin = np.maximum(first, 0)
    pairs = np.c_[begin, np.maximum(last, begin) + 1].ravel()
    low = np.minimum.reduceat(padded, pairs)[::2]
    high = np.maximum.reduceat(padded, pairs)[::2]
    begins, ends = next_hole(rows, t)
    # Where a row's end lies in a hole, the next row is missing.
    away = (first < 0) | (begins < rows) | ((begins < until) & (ends <= until))
    middle = np.where(away, np.nan, low + 0.5 * (high - low))
    return middle, np.where(high > low, np.nextafter(0.5 * (high - low), np.inf) + 2 * np.spacing(np.abs(middle)), 0.0)


def next_hole(moments: Array, t: Array) -> tuple[Array, Array]:
    """The first hole of the samples that ends after each moment: from when a sample is as old as a gap is long until the next one comes."""
    longest = GAP * np.median(np.diff(t))
    long = np.r_[np.diff(t) > longest, True]
    begins, ends = t[long] + longest, np.r_[t[1:], np.inf][long]
    place = np.searchsorted(ends, moments, side="right")
    return begins[place], ends[place]


def nearest(rows: Array, t: Array, within: float) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The sample next to each row, and whether it stands at the same moment, to within what rounding may have moved it [s]."""
    after = np.clip(np.searchsorted(t, rows), 0, t.size - 1)
    before = np.maximum(after - 1, 0)
    place = np.where(np.abs(t[before] - rows) < np.abs(t[after] - rows), before, after)
    return place, np.abs(t[place] - rows) <= within


def between(
    rows: Array, t: Array, values: Array, lost: Array, rate: float, clock_error: float, jitter: float = 0.0
) -> tuple[Array, Array]:
    """A channel on other times: linear between its two neighbours, with a bound on how far the truth can be from that.

    A quantity that moves at most ``rate`` a second is, a time a after one sample and b before the next, at most
    2 rate a b / (a + b) from the straight line between them. Missing outside the samples and inside gaps.

    Args:
        rows: times wanted [s], shape (n,).
        t: times of the samples [s], shape (m,).
        values: samples, shape (m,), none missing.
        lost: what each may already be off, shape (m,).
        rate: bound on the rate of change.
        clock_error: how far the two clocks may disagree, reading included [s].
        jitter: how far each time may be off beyond the rounding of its decimals [s].

    Returns:
        Values and half-widths, shape (n,); NaN is missing.
    """
    j = np.clip(np.searchsorted(t, rows, side="right") - 1, 0, t.size - 2)
    a, b = rows - t[j], t[j + 1] - rows
    span = t[j + 1] - t[j]
    usable = (a >= 0) & (b >= 0) & (span <= GAP * np.median(np.diff(t)))
    change = values[j + 1] - values[j]
    line = values[j] + change * (a / span)
    # a and b are off by two stamps each: that moves the bound by at most 4 rate, the line by 4 |change| / span for each of them.
    stamps = 4 * (jitter + max(float(np.spacing(np.abs(x).max())) for x in (rows, t)))
    reach = (
        2 * rate * np.maximum(a, 0) * np.maximum(b, 0) / span
        + rate * (clock_error + stamps)
        + stamps * np.abs(change) / span
    )
    size = np.maximum(np.abs(values[j]), np.abs(values[j + 1]))
    off = reach * (1 + 1e-12) + np.maximum(lost[j], lost[j + 1]) + 8 * np.spacing(size)
    exact = (a == 0) | (b == 0)
    line = np.where(a == 0, values[j], np.where(b == 0, values[j + 1], line))
    own = np.where(a == 0, lost[j], lost[j + 1]) + rate * clock_error
    return np.where(usable | exact, line, np.nan), np.where(exact, own, off)


def clock_of(t: Array) -> Clock:
    """How many samples a channel has, and how close they stand."""
    return Clock(t.size, float(np.diff(t).min()) if t.size > 1 else 0.0)
