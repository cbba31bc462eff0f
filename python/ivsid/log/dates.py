"""Stamps that are words: dates and times of day as text, to whole nanoseconds."""

from __future__ import annotations

from typing import Final

import polars as pl

from ivsid.errors import IvsidError

_TIME: Final = (
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2})(?:[.,](?P<fraction>\d+))?(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
)
_ZONE: Final = r"\s*(?:Z|UTC|GMT|(?P<zone>[+-]\d{2}:?\d{2}))?"
# Year first with hyphens or strokes (ISO 8601), day first with points.
_FORMS: Final = (
    rf"^(?P<year>\d{{4}})[-/](?P<month>\d{{1,2}})[-/](?P<day>\d{{1,2}})[T _]+{_TIME}{_ZONE}$",
    rf"^(?P<day>\d{{1,2}})\.(?P<month>\d{{1,2}})\.(?P<year>\d{{4}})[T _]+{_TIME}{_ZONE}$",
    rf"^{_TIME}{_ZONE}$",
)
# Day and month stand in an order that one number beyond 12 settles; without one they cannot be told apart.
_EITHER: Final = rf"^(?P<one>\d{{1,2}})[-/](?P<other>\d{{1,2}})[-/](?P<year>\d{{4}})[T ,_]+{_TIME}{_ZONE}$"
_UNCLEAR: Final = r"^\d{1,2}[/-]\d{1,2}[/-]\d{2,4}[T ,_]"
# Months of a year.
# Source: definition
MONTHS: Final = 12
# Decimals of a second that are read.
# Source: definition: nanoseconds
DECIMALS: Final = 9


def is_date(text: str) -> bool:
    """Whether a stamp is meant as a date or a time of day."""
    shown = pl.Series([text.strip()])
    return any(bool(shown.str.contains(form)[0]) for form in (*_FORMS, _UNCLEAR))


def is_time_of_day(text: str) -> bool:
    """Whether a stamp is a time of day without a date."""
    return bool(pl.Series([text.strip()]).str.contains(_FORMS[-1])[0])


def nanoseconds(series: pl.Series, name: str, source: str, first_row: int) -> pl.Series:
    """Stamps as nanoseconds, integers; null where a cell is empty.

    Args:
        series: dates with times of day (ISO 8601; year first, or day first with points), with or without a zone; or times of day.
        name: of the column, for messages.
        source: name of the file, for messages.
        first_row: number of the first sample, for messages.

    Raises:
        IvsidError: dates whose day and month cannot be told apart, a cell of another form, or more than nine decimals.
    """
    text = series.str.strip_chars()
    text = text.set((text == "").fill_null(False), None)
    first = next((t for t in text if t is not None), "")
    form = next((f for f in (*_FORMS, _EITHER) if pl.Series([first]).str.contains(f)[0]), None)
    if form == _EITHER:
        form = _settled(text)
    if form is None:
        raise IvsidError(
            f"{source}: column {name} begins with the date '{first}', whose day and month cannot be told apart; "
            "write dates as 2024-05-31 12:00:00.125"
        )
    part = text.str.extract_groups(form).struct
    parts = {f: part.field(f) for f in part.fields}
    # Times of day count from the midnight of some day.
    words = [parts.get(f, pl.Series([d] * len(text))) for f, d in (("year", "1970"), ("month", "01"), ("day", "01"))]
    words += [_hours(parts["hour"], parts["half"]), parts["minute"], parts["second"]]
    joined = pl.DataFrame([w.str.zfill(2).alias(str(k)) for k, w in enumerate(words)]).select(
        pl.concat_str(pl.all(), separator=" ")
    )
    made = joined.to_series().str.to_datetime("%Y %m %d %H %M %S", time_unit="us", strict=False).dt.epoch("us") * 1000
    fraction = parts["fraction"].fill_null("")
    bad = (made.is_null() & text.is_not_null()).arg_true()
    if len(bad):
        row = int(bad[0])
        raise IvsidError(
            f"{source}: column {name} holds '{text[row]}' in row {row + first_row}, which is no time like '{first}'"
        )
    long = (fraction.str.len_chars() > DECIMALS).arg_true()
    if len(long):
        row = int(long[0])
        raise IvsidError(
            f"{source}: column {name} holds '{text[row]}' in row {row + first_row}; at most {DECIMALS} decimals of a second are read"
        )
    made = made + fraction.str.pad_end(DECIMALS, "0").cast(pl.Int64)
    if "zone" in parts:
        sign = pl.when(pl.col("z").str.starts_with("-")).then(-1).otherwise(1)
        hours, minutes = (pl.col("z").str.replace(":", "").str.slice(k, 2).cast(pl.Int64) for k in (1, 3))
        zone = pl.DataFrame({"z": parts["zone"]}).select((sign * (hours * 60 + minutes) * 60_000_000_000).fill_null(0))
        made = made - zone.to_series()
    return made


def _settled(text: pl.Series) -> str | None:
    """The form of dates with the year last whose day is beyond 12 in some cell; None where none is, or where both numbers are."""
    part = text.str.extract_groups(_EITHER).struct
    beyond = [bool((part.field(f).cast(pl.Int64) > MONTHS).any()) for f in ("one", "other")]
    if beyond[0] == beyond[1]:
        return None
    day, month = ("one", "other") if beyond[0] else ("other", "one")
    return _EITHER.replace(f"<{day}>", "<day>").replace(f"<{month}>", "<month>")


def _hours(hour: pl.Series, half: pl.Series) -> pl.Series:
    """Hours of a day, from those of twelve where a half of the day is stated."""
    table = pl.DataFrame({"hour": hour, "half": half.str.to_lowercase()})
    late = pl.when(pl.col("half") == "p").then(12).otherwise(0)
    twelve = pl.col("hour").cast(pl.Int64) % 12 + late
    known = pl.col("half").is_not_null() & pl.col("hour").cast(pl.Int64).is_between(1, 12)
    # An hour that a clock of twelve does not show is no time.
    given = pl.when(pl.col("half").is_null()).then(pl.col("hour")).otherwise(pl.lit("99"))
    return table.select(pl.when(known).then(twelve.cast(pl.String)).otherwise(given)).to_series()
