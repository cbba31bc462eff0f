"""Opened files of samples: tables whose columns are read on demand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Protocol, TypeGuard, runtime_checkable

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.errors import IvsidError, meant
from ivsid.files.log_map import TimeColumn
from ivsid.memory.room import DOUBLE, is_large, room

# Cells of text that are no samples: empty ones, and what loggers, spreadsheets and data bases write in their place.
MISSING: Final = (
    *(
        "",
        "nan",
        "NaN",
        "NAN",
        "null",
        "NULL",
        "Null",
        "None",
        "none",
        "NA",
        "na",
        "N/A",
        "n/a",
        "NaT",
        "<NA>",
        "nil",
        r"\N",
    ),
    *(
        "#N/A",
        "#NA",
        "#NV",
        "#N/A N/A",
        "#VALUE!",
        "#NUM!",
        "#DIV/0!",
        "-",
        "--",
        "---",
        "----",
        "*",
        "**",
        "***",
        "****",
        "?",
    ),
    *("1.#QNAN", "-1.#IND", "missing", "invalid"),
)
# Separates a table from its column in the name of a foreign column, where a file holds several tables.
SEPARATOR: Final = "/"
# Rows of a column that are read at once.
# Source: resource: 8 MB
AT_ONCE: Final = 1 << 20
_UNIT: Final = {"ns": "ns", "us": "us", "ms": "ms"}


def head(path: Path) -> bytes:
    """The first bytes of a file."""
    with path.open("rb") as file:
        return file.read(64)


class Table(Protocol):
    """Columns of equal length on one clock."""

    @property
    def columns(self) -> Sequence[str]:
        """The names of the columns."""

    @property
    def clock(self) -> TimeColumn | None:
        """The column of stamps that the format itself defines; None where the format defines none."""

    @property
    def first_row(self) -> int:
        """The number of the first sample, for messages."""

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The columns as they are, or as numbers; a missing cell is null or NaN."""

    def exact(self, name: str) -> pl.Series:
        """One column with every digit: text, integers or doubles."""


@runtime_checkable
class Divided(Protocol):
    """A table that is read a part at a time, because its columns together would fill the memory."""

    @property
    def rows(self) -> int:
        """The number of rows."""

    @property
    def dtypes(self) -> Mapping[str, pl.DataType]:
        """The type of each column."""

    def prepare(self, names: Sequence[str]) -> None:
        """Tells which columns are read together, before any part of them is."""

    def part(self, name: str, rows: slice) -> pl.Series:
        """Some rows of a column."""


class Lossless:
    """A table whose ``read`` keeps every digit."""

    def exact(self: Table, name: str) -> pl.Series:
        """One column with every digit."""
        return self.read([name])[name]


@dataclass(frozen=True)
class Frame(Lossless):
    """A table that is in memory."""

    frame: pl.DataFrame
    clock: TimeColumn | None = None
    first_row: int = 2

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return self.frame.columns

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The columns as they are."""
        return {n: self.frame[n] for n in names}


class Digest(Protocol):
    """A hash that is being made."""

    def result(self) -> str:
        """The hash, as soon as it is there."""


@dataclass(frozen=True)
class Source:
    """An opened file or folder.

    Attributes:
        name: as the user gave it, for messages.
        tables: by name; a file that is one table has the name "".
        digest: the running hash of its bytes, or what gives it in the end.
        spanned: whether its tables hold the span of ``[log]`` alone.
        notes: sentences on what was left aside.
    """

    name: str
    tables: Mapping[str, Table]
    digest: Digest = field(repr=False)
    spanned: bool = False
    notes: tuple[str, ...] = ()

    @property
    def sha256(self) -> str:
        """Hash of the bytes of the file, or of all files of the folder in order; of a file that is read in parts, the identity of those."""
        return self.digest.result()

    @property
    def columns(self) -> list[str]:
        """Every column's name; ``TABLE/column`` where there are several tables."""
        return [f"{t}{SEPARATOR}{c}" if t else c for t, table in self.tables.items() for c in table.columns]

    def find(self, name: str) -> tuple[str, str] | None:
        """Table and column of a name, which may leave out the table where only one has the column; None where there is none.

        Raises:
            IvsidError: several tables have the column.
        """
        for table, content in self.tables.items():
            if table and name.startswith(table + SEPARATOR) and name[len(table) + 1 :] in content.columns:
                return table, name[len(table) + 1 :]
        holders = [t for t, content in self.tables.items() if name in content.columns]
        if len(holders) > 1:
            raise IvsidError(
                f"{self.name}: column {name} stands in {', '.join(holders)}; map the one that is meant, "
                f'as "{holders[0]}{SEPARATOR}{name}" under [log] columns'
            )
        return (holders[0], name) if holders else None

    def shown(self, table: str, column: str) -> str:
        """The column's full name, for messages."""
        return f"{table}{SEPARATOR}{column}" if table else column

    def numeric(self, names: Iterable[str]) -> dict[str, NDArray[np.float64]]:
        """Columns by their full names as float64, shape (n,) each; NaN is a missing cell.

        Raises:
            IvsidError: an unknown column, or a cell that is no finite number.
        """
        places: dict[str, tuple[str, str]] = {}
        for name in names:
            place = self.find(name)
            if place is None:
                raise IvsidError(
                    f"{self.name} has no column {name}; {meant(name, self.columns)}it has {', '.join(self.columns[:16])}"
                )
            places[name] = place
        cells = {
            table: self.tables[table].read(list(dict.fromkeys(c for t, c in places.values() if t == table)))
            for table in {t for t, _ in places.values()}
        }
        return {
            name: numbers(cells[t][c], name, self.name, self.tables[t].first_row) for name, (t, c) in places.items()
        }


def is_long(table: Table) -> TypeGuard[Divided]:
    """Whether the columns of a table are read a part at a time."""
    return isinstance(table, Divided) and is_large(table.rows * DOUBLE.itemsize)


def long_numbers(table: Divided, name: str, shown: str, source: str, first_row: int) -> NDArray[np.float64]:
    """A column of a long table as float64, shape (n,); NaN is a missing cell. Arguments and errors as in ``numbers``."""
    made = room(table.rows, DOUBLE)
    for start in range(0, table.rows, AT_ONCE):
        rows = slice(start, min(start + AT_ONCE, table.rows))
        made[rows] = numbers(table.part(name, rows), shown, source, first_row + start)
    return made


def numbers(series: pl.Series, name: str, source: str, first_row: int) -> NDArray[np.float64]:
    """A column as float64, shape (n,); NaN is a missing cell.

    Args:
        series: numbers, or their text.
        name: of the column, for messages.
        source: name of the file, for messages.
        first_row: number of the first cell, for messages.

    Raises:
        IvsidError: a cell that is no finite number.
    """
    if series.dtype == pl.String:
        text = series.str.strip_chars()
        text = text.set(text.is_in(list(MISSING)).fill_null(False), None)
        series = text.cast(pl.Float64, strict=False)
        bad = (series.is_null() & text.is_not_null()).arg_true()
        if len(bad):
            row = int(bad[0])
            raise IvsidError(
                f"{source}: column {name} holds '{text[row]}' in row {row + first_row}, which is no number"
            )
    if series.dtype.is_temporal() or not (series.dtype.is_numeric() or series.dtype in (pl.Boolean, pl.Null)):
        raise IvsidError(
            f"{source}: column {name} is of type {series.dtype}, not numbers; leave it out or export numbers"
        )
    values = series.cast(pl.Float64).to_numpy().astype(np.float64, copy=False)
    if np.isinf(values).any():
        row = int(np.argmax(np.isinf(values)))
        raise IvsidError(f"{source}: column {name} is infinite in row {row + first_row}; leave missing samples empty")
    return values


def stamp_unit(series: pl.Series) -> str | None:
    """The unit of a column of dates, times of day or durations; None for other columns."""
    if series.dtype == pl.Time:
        return "ns"
    if series.dtype in (pl.Datetime, pl.Duration):
        return _UNIT[str(series.dtype.time_unit)]  # type: ignore[attr-defined]
    return None
