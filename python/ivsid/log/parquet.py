"""Parquet files: a column is read by itself, and of a file elsewhere only the columns and row groups that are needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.parquet_pages import TAIL, Layout, check_pages, footer_begin, layout_of
from ivsid.log.parts import Parts
from ivsid.log.polars_panics import panics_unprinted
from ivsid.log.source import Lossless
from ivsid.log.thrift import PageError
from ivsid.log.unpacked import MOST_ROWS


@dataclass(frozen=True)
class Parquet(Lossless):
    """A Parquet file.

    Attributes:
        path: of the file.
        name: of the log, for messages.
        names: of its columns, by those without blanks around them.
        dtypes: types of the columns.
        rows: number of rows.
        parts: of a file that is read in parts; None for one that was checked as a whole.
        layout: where its columns lie.
    """

    path: Path
    name: str
    names: dict[str, str]
    dtypes: Mapping[str, pl.DataType]
    rows: int
    layout: Layout
    parts: Parts | None = None
    clock: TimeColumn | None = None
    first_row: int = 1

    @property
    def columns(self) -> list[str]:
        """Its names, without blanks around them."""
        return list(self.names)

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The columns as they are."""
        try:
            self._need(names, None)
            with panics_unprinted():
                frame = pl.read_parquet(self.path, columns=[self.names[n] for n in names], glob=False)
        except (PageError, pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
            raise unusable(self.name, error) from None
        return {n: frame[self.names[n]] for n in names}

    def prepare(self, names: Sequence[str]) -> None:
        """Nothing: a column is read by itself."""

    def part(self, name: str, rows: slice) -> pl.Series:
        """Some rows of a column: only the row groups that hold them are read."""
        wanted = pl.scan_parquet(self.path, glob=False).select(self.names[name])
        try:
            self._need([name], rows)
            with panics_unprinted():
                return wanted.slice(rows.start, rows.stop - rows.start).collect().to_series()
        except (PageError, pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
            raise unusable(self.name, error) from None

    def _need(self, names: Sequence[str], rows: slice | None) -> None:
        """Has the columns of a file that is read in parts, and checks their pages."""
        if self.parts is not None:
            order = list(self.names)
            places = [order.index(n) for n in names]
            self.parts.need(self.layout.ranges(places, rows))
            self.layout.check(self.path, places, rows)


def unusable(name: str, error: BaseException) -> IvsidError:
    """The sentence on a table that cannot be read."""
    words = "" if isinstance(error, pl.exceptions.PanicException) else str(error)
    first = (words.splitlines() or ["damaged"])[0]
    return IvsidError(f"{name} is not a readable CSV or Parquet table ({first}); mend or export it again")


def open_parquet(path: Path, name: str, parts: Parts | None = None) -> Parquet:
    """Reads the footer of a Parquet file.

    Args:
        path: of the file.
        name: of the log, for messages.
        parts: the file, if it is read in parts.

    Raises:
        IvsidError: a damaged or too long file, or a column that stands twice.
    """
    try:
        if parts is None:
            layout = check_pages(path)
        else:
            begin = footer_begin(parts.size, parts.read(parts.size - TAIL, parts.size))
            parts.need([(0, 4), (begin, parts.size)])
            layout = layout_of(path)
        with panics_unprinted():
            schema = pl.read_parquet_schema(path)
            rows = int(pl.scan_parquet(path, glob=False).select(pl.len()).collect().item())
    except (PageError, pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        raise unusable(name, error) from None
    if rows > MOST_ROWS:
        raise IvsidError(f"{name} has {rows:,} rows; logs of up to {MOST_ROWS:,} are read, so cut it into parts")
    stripped = [c.strip() for c in schema]
    twice = next((n for n in stripped if stripped.count(n) > 1), None)
    if twice is not None:
        raise IvsidError(f"{name} has the column {twice} more than once; each needs its own name")
    return Parquet(
        path,
        name,
        dict(zip(stripped, schema, strict=True)),
        dict(zip(stripped, schema.values(), strict=True)),
        rows,
        layout,
        parts,
    )
