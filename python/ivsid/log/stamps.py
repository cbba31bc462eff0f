"""Stamps to seconds without losing digits: numbers, dates, seconds and nanoseconds in two columns, and stamps out of order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.log.dates import is_date, is_time_of_day, nanoseconds
from ivsid.log.disorder import in_order
from ivsid.log.midnight import begun_anew, is_clock_face, past_midnight
from ivsid.log.record import steps_in
from ivsid.log.serial_days import Days, coarse, days_of
from ivsid.log.source import numbers, stamp_unit
from ivsid.memory.pieces import any_piece, array_pieces, pieces

Array = NDArray[np.float64]

# Stamps beyond this [s] count from their first one: a double there has a last place of 1.2e-10 s or more.
# Source: definition: 53 bits of a double
EPOCH: Final = 1e6
# Decimals kept of a large stamp; 23 digits are left before the point.
# Source: definition: the 38 digits of a 128-bit decimal
DECIMALS: Final = 15
# Half units in the last place that two roundings can lose: one for the quotient, and up to 2^30 / 1e9 = 1.07 for the double of the
# integer of nanoseconds.
# Source: theorem: standard model of floating-point arithmetic, Higham 2002, section 2.2
TWICE: Final = 2.25
# Stamps beyond this are no seconds: they are an epoch in a smaller unit, or a clock of a computer.
# Source: definition: 1e11 s are 3,171 years
LARGEST: Final = 1e11
# Years of an epoch whose unit is not stated, in seconds since 1970: 1990 to 2100. Those of two units do not meet.
# Source: definition: days of those years, times 86,400 s
YEARS: Final = (631152000.0, 4102444800.0)
# Step [s] between two samples where the unit of an epoch is not stated.
# Source: definition: from 100 kHz to one sample in a minute and a half
STEPS: Final = (1e-5, 100.0)
# Whole seconds whose nanoseconds are integers of 64 bits.
# Source: definition: 2^63 ns are 292 years
MOST_SECONDS: Final = 9.2e9
_SECONDS: Final = {u: Decimal(repr(f)) for u, f in units.TIME.items()}


@dataclass(frozen=True)
class Times:
    """Stamps in seconds.

    Attributes:
        t: times [s], shape (n,).
        lost: bound on the error of each conversion [s].
        first: the first stamp [s], exactly.
        counted: whether the times count from the first stamp.
        rows: rows of the table with these stamps; None for all.
        notes: sentences for the user.
        assumes: sentences that the times rely on.
    """

    t: Array
    lost: float
    first: Decimal
    counted: bool
    rows: NDArray[np.intp] | None = None
    notes: tuple[str, ...] = ()
    assumes: tuple[str, ...] = ()


def times_of(
    series: pl.Series,
    unit: str | None,
    source: str,
    name: str,
    first_row: int,
    *,
    own: bool,
    cells: Array | None = None,
) -> Times:
    """Checks and converts one column of stamps. Large stamps (epochs) count from their first one: a double has too few digits for them.

    Rows whose stamps are out of order or missing, if they are few, are left out as gaps (``disorder``).

    Args:
        series: the stamps with every digit.
        unit: of the stamps; None for seconds, or for what the size of an epoch says. A column of dates knows its own.
        source: name of the file, for messages.
        name: of the column.
        first_row: number of the first sample, for messages.
        cells: the stamps as doubles, where ``series`` holds the first of them alone: a float for each row, none left out by ``own``.
        own: these are a sensor's own stamps beside those of the rows; a repeated or missing one marks a row without a new sample.

    Raises:
        IvsidError: a stamp that is no number, or too many that are missing or do not increase.
    """
    series, unit, notes, assumes = _counted(series, unit, source, name, first_row)
    stamps = numbers(series, name, source, first_row) if cells is None else cells
    if unit is None and is_clock_face(stamps):
        raise IvsidError(
            f"{source}: column {name} holds the digits of a clock (hhmmss), which are no seconds: they leap at each full minute; write them as hh:mm:ss, "
            "with colons, or as seconds"
        )
    days = days_of(stamps, YEARS) if unit in (None, "d") else None
    if unit is None:
        unit, told = _unit_of(stamps, days, source, name)
        notes += told[:1]
        assumes += told[1:]
    scale = units.factor(unit, units.TIME, f"column {name}")
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
    rounds, length, anew = begun_anew(stamps, scale) if unit == "s" else (np.zeros(0), 0.0, [])
    # Whole rounds are added in doubles: what a short float had lost before stays lost, of this stamp and of the first.
    short = 2 * _own_rounding(series, stamps) if anew else 0.0
    if anew:
        series = _with_rounds(series if cells is None else pl.Series(stamps), stamps, rounds, length)
        stamps, cells = stamps + rounds * length, None
        places = _places(anew if rows is None else rows[anew].tolist(), first_row)
        notes.append(f"the clock {name} begins anew at row {places}: {length:g} s are added from there on")
        assumes.append(f"the clock {name} goes on where it begins anew, after {length:g} s")
    if not _increasing(stamps):
        order = in_order(stamps)
        if order is None:
            raise _disorder(stamps, rows, scale, source, first_row, coarse(stamps, source, name) if unit == "d" else "")
        at = order.wrong if rows is None else rows[order.wrong]
        notes.append(
            f"stamps {name} repeat, go back, jump or are missing at row{'s' * (at.size > 1)} {_places(at.tolist(), first_row)}: {at.size + order.beside} of "
            f"{stamps.size} rows are left out, as gaps"
        )
        assumes.append(f"stamps {name} are right where they increase beside those that do not")
        rows = order.kept if rows is None else rows[order.kept]
        stamps, series = stamps[order.kept], series.gather(order.kept) if cells is None else series
    first = _decimal(series[0] if cells is None else float(stamps[0])) * _SECONDS[unit]
    if days is not None:
        first -= days.seconds
    counted = bool(abs(stamps[0]) > EPOCH or scale != 1.0 or anew)
    t, lost = _since_first(series, stamps, scale) if counted else (stamps, _own_rounding(series, stamps))
    if not _increasing(t):
        # Stamps that differ may be one double after their conversion.
        raise _disorder(t, rows, 1.0, source, first_row)
    return Times(t, lost + short, first, counted, rows, tuple(notes), tuple(assumes))


def _counted(
    series: pl.Series, unit: str | None, source: str, name: str, first_row: int
) -> tuple[pl.Series, str | None, list[str], list[str]]:
    """Stamps as numbers or texts of numbers, their unit, notes and assumptions; dates and times of day count nanoseconds.

    Raises:
        IvsidError: a column of no stamps, or a date that cannot be read.
    """
    if series.dtype == pl.Boolean:
        raise IvsidError(
            f"{source}: column {name} holds true and false, not times; map the column of stamps under [log] time"
        )
    if series.dtype == pl.Date:
        series = series.cast(pl.Datetime("us"))
    unit = stamp_unit(series) or unit
    of_day = series.dtype == pl.Time
    if series.dtype.is_temporal():
        series = series.to_physical()
    first = next((c for c in series if c is not None and c.strip()), "") if series.dtype == pl.String else ""
    if is_date(first):
        of_day = is_time_of_day(first)
        series, unit = nanoseconds(series, name, source, first_row), "ns"
    midnights: list[int] = []
    if of_day:
        series, midnights = past_midnight(series)
    if not midnights:
        return series, unit, [], []
    note = f"times of day {name} pass midnight at row {_places(midnights, first_row)}: a day is added from there on"
    return series, unit, [note], [f"no gap of the stamps {name} lasts longer than half a day"]


def _places(positions: Sequence[int], first_row: int) -> str:
    """The rows of the first few positions, in words."""
    return ", ".join(str(k + first_row) for k in positions[:3]) + (", ..." if len(positions) > 3 else "")


def _with_rounds(series: pl.Series, stamps: Array, rounds: Array, length: float) -> pl.Series:
    """Stamps with whole rounds added, with every digit where they are decimals."""
    if series.dtype.is_float():
        return pl.Series(stamps + rounds * length)
    try:
        return _exact(series) + pl.Series(rounds * length).cast(pl.Decimal(38, DECIMALS))
    except pl.exceptions.PolarsError:
        return pl.Series(stamps + rounds * length)


def _unit_of(stamps: Array, days: Days | None, source: str, name: str) -> tuple[str, list[str]]:
    """The unit of stamps whose unit is not stated: seconds, days, or that of an epoch which makes a date and a step that a log can have.

    A note and an assumption stand beside all but seconds.

    Raises:
        IvsidError: stamps too large for seconds that are no epoch in any unit.
    """
    if days is not None:
        note = f"{name} counts days, as {days.program} does, by the size of its stamps and their steps"
        return "d", [note, f"stamps {name} count days, as their size and their steps say"]
    known = stamps[np.isfinite(stamps)] if _largest(stamps) > LARGEST else stamps[:0]
    if known.size < 2:
        return "s", []
    middle, step = float(np.median(known)), float(np.median(np.abs(np.diff(known))))
    for unit in ("ms", "us", "ns"):
        second = float(_SECONDS[unit])
        if YEARS[0] <= middle * second <= YEARS[1] and STEPS[0] <= step * second <= STEPS[1]:
            note = f"{name} counts {unit} since 1970, by the size of its stamps"
            return unit, [note, f"stamps {name} count {unit}, as their size says"]
    raise IvsidError(
        f"{source}: column {name} goes up to {float(known.max()):.6g} in steps of {step:.6g}, which are neither seconds nor ms, us or ns since 1970; "
        f'state their unit: time = {{ from = "{name}", unit = "ns" }} under [log]'
    )


def _increasing(stamps: Array) -> bool:
    """Whether each stamp is larger than the one before it."""
    return not any_piece(stamps.size - 1, lambda part: not (steps_in(stamps, part) > 0).all())


def _largest(stamps: Array) -> float:
    """The largest magnitude of the stamps that are there; 0 without one."""
    parts = (np.abs(stamps[p]) for p in pieces(stamps.size))
    return max(float(np.max(x, where=~np.isnan(x), initial=0.0)) for x in parts)


def _disorder(
    stamps: Array, rows: NDArray[np.intp] | None, scale: float, source: str, first_row: int, why: str = ""
) -> IvsidError:
    """The sentence for stamps that are out of order or missing, or the one that says why."""
    if why:
        return IvsidError(why)

    def row(k: int) -> int:
        return (k if rows is None else int(rows[k])) + first_row

    missing = np.isnan(stamps)
    if missing.any():
        return IvsidError(f"{source}: the time is missing in row {row(int(np.argmax(missing)))}; every row needs one")
    k = int(np.argmax(np.diff(stamps) <= 0))
    a, b = stamps[k] * scale, stamps[k + 1] * scale
    return IvsidError(
        f"{source}: time goes from {a:.6g} s to {b:.6g} s at row {row(k + 1)}; it must increase strictly: "
        "sort the log, split it where it begins anew, or drop repeated rows"
    )


def of_two_columns(
    seconds: pl.Series, nanos: pl.Series, names: tuple[str, str], source: str, first_row: int
) -> pl.Series:
    """Stamps in nanoseconds, integers, from whole seconds and nanoseconds in two columns.

    Args:
        seconds: with every digit.
        nanos: nanoseconds beside them, with every digit.
        names: of both columns, for messages.
        source: name of the file, for messages.
        first_row: number of the first sample, for messages.

    Raises:
        IvsidError: a cell that is no whole number, seconds beyond 292 years, or nanoseconds outside [0, 1e9).
    """
    whole = []
    for series, name in zip((seconds, nanos), names, strict=True):
        values = numbers(series, name, source, first_row)
        bad = np.flatnonzero((values != np.floor(values)) | (np.abs(values) >= 2**53))
        if bad.size:
            raise IvsidError(
                f"{source}: column {name} has {values[bad[0]]:g} in row {int(bad[0]) + first_row}, and a stamp of two columns needs whole "
                "numbers; leave nanoseconds out under [log] time if the seconds have decimals"
            )
        if name == names[0] and (np.abs(values) >= MOST_SECONDS).any():
            raise IvsidError(
                f"{source}: column {name} goes up to {float(np.nanmax(np.abs(values))):.6g}, which are no seconds beside nanoseconds in {names[1]}; "
                "map the column of whole seconds under [log] time"
            )
        whole.append(pl.Series(values, nan_to_null=True).cast(pl.Int64))
    if not nanos.is_empty() and (outside := ((whole[1] < 0) | (whole[1] >= 10**9)).arg_true()).len():
        raise IvsidError(
            f"{source}: column {names[1]} has {whole[1][int(outside[0])]} in row {int(outside[0]) + first_row}, which are no nanoseconds of a second"
        )
    return whole[0] * 10**9 + whole[1]


def loses_digits(series: pl.Series, unit: str | None) -> bool:
    """Whether doubles are too short for these stamps, so that they have to be read again with every digit."""
    if not series.dtype.is_float():
        return False
    largest = series.abs().max()
    return isinstance(largest, float) and (largest > EPOCH or unit not in (None, "s"))


def digits_lost(stamps: Array, unit: str | None) -> bool:
    """The same of stamps that are doubles, NaN where one is missing."""
    return unit not in (None, "s") or _largest(stamps) > EPOCH


def _decimal(stamp: object) -> Decimal:
    return Decimal(stamp.strip()) if isinstance(stamp, str) else Decimal(str(stamp))


def _since_first(series: pl.Series, stamps: Array, scale: float) -> tuple[Array, float]:
    """Seconds since the first stamp, and the bound on their error: decimals and integers are subtracted exactly, doubles are rounded already."""
    if series.dtype.is_float():
        # A double is a rounded instant, this one and the first; integers of nanoseconds that were divided have been rounded twice.
        t, lost = _elapsed(stamps, scale), 2 * TWICE * _half_unit(series, stamps)
    else:
        try:
            first = _exact(series[:1])[0]

            def difference(part: slice) -> Array:
                exact = _exact(series[part]) - first
                return np.asarray(exact.cast(pl.Float64).to_numpy() * scale, dtype=np.float64)

            t, lost = array_pieces(stamps.size, difference), 2 * 10.0**-DECIMALS
        except pl.exceptions.PolarsError:
            t, lost = _elapsed(stamps, scale), 2 * _half_unit(series, stamps)
    # The difference is rounded at most twice, the unit and the product once each.
    return t, scale * lost * (1 + 1e-12) + 4 * float(np.spacing(_largest(t)))


def _exact(series: pl.Series) -> pl.Series:
    """Stamps as decimals."""
    kind = pl.Decimal(38, DECIMALS)
    return series.str.strip_chars().cast(kind) if series.dtype == pl.String else series.cast(kind)


def _elapsed(stamps: Array, scale: float) -> Array:
    """Differences of doubles from the first of them [s]."""
    return array_pieces(stamps.size, lambda part: (stamps[part] - stamps[0]) * scale)


def _half_unit(series: pl.Series, stamps: Array) -> float:
    """Half a unit in the last place of the largest stamp, in the type that it is stored in."""
    largest = _largest(stamps)
    return 0.5 * float(np.spacing(np.float32(largest) if series.dtype == pl.Float32 else largest))


def _own_rounding(series: pl.Series, stamps: Array) -> float:
    """Rounding of stamps stored as short floats [s]; ``Log.time_error`` adds the rounding of doubles itself."""
    return _half_unit(series, stamps) if series.dtype == pl.Float32 else 0.0
