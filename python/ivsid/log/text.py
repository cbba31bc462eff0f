"""CSV with commas, a header row and decimal points, read column by column: a large file need not fit in memory twice."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.source import MISSING

# Bytes at either end of a file that are examined before it is read.
# Source: resource: bounds the time and memory of the examination
HEAD: Final = 65536
SEPARATORS: Final = (";", "\t", " ")


@dataclass(frozen=True)
class Text:
    """A CSV file with a header row."""

    path: Path
    name: str
    columns: tuple[str, ...]
    clock: TimeColumn | None = None
    first_row: int = 2

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The columns as doubles where every cell is a plain number, as text otherwise."""
        try:
            return self._typed(names, pl.Float64())
        except pl.exceptions.PolarsError:
            # A cell is no number, or padded: text shows which one.
            return self._text(names)

    def exact(self, name: str) -> pl.Series:
        """The column as text."""
        return self._text([name])[name]

    def _text(self, names: Sequence[str]) -> dict[str, pl.Series]:
        try:
            return self._typed(names, pl.String())
        except pl.exceptions.PolarsError as error:
            raise IvsidError(
                f"{self.name} is not a readable CSV table ({self._why(error)}); mend or export it again"
            ) from None

    def _why(self, error: BaseException) -> str:
        """The fault in the words of a log, in place of the reader's words about its schema."""
        first = (str(error).splitlines() or ["damaged"])[0]
        return (
            f"a row has more cells than the {len(self.columns)} of the header" if "schema" in first.lower() else first
        )

    def _typed(self, names: Sequence[str], kind: pl.DataType) -> dict[str, pl.Series]:
        lazy = pl.scan_csv(
            self.path,
            has_header=False,
            skip_rows=1,
            schema={c: kind if c in names else pl.String() for c in self.columns},
            null_values=list(MISSING),
            encoding="utf8-lossy",
            glob=False,
        )
        # Counting the cells of the other columns makes the reader examine them, so that it finds a row with too many cells.
        others = [pl.col(c).null_count() for c in self.columns if c not in names]
        frame = lazy.select(*[pl.col(n) for n in names], *others).collect(engine="streaming")
        return {n: frame[n] for n in names}


def open_text(path: Path, name: str) -> Text:
    """Checks both ends of a file and reads its header.

    Args:
        path: of the file.
        name: of the file, for messages.

    Raises:
        IvsidError: an empty or binary file, a wrong separator, a column that stands twice, or a last row that breaks off.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
        if not head.strip():
            raise IvsidError(f"log {name} is empty; it needs a header row and samples")
        if b"\x00" in head:
            raise _binary(name)
        file.seek(0)
        first, second = file.readline(1 << 24), file.readline(1 << 24)
    encoding = "utf-8-sig"
    try:
        head[: head.rfind(b"\n") + 1].decode(encoding)
    except UnicodeDecodeError:
        encoding = "latin-1"
    try:
        header, sample = first.decode(encoding), second.decode(encoding, "replace")
    except UnicodeDecodeError:
        raise _binary(name) from None
    shown = head[:4096].decode(encoding, "ignore")
    # Beyond Latin-1, characters that are valid UTF-8 are text, whether or not this Unicode has names for them.
    if sum(c.isprintable() or c in "\r\n\t" or c > "\xff" for c in shown) < 0.98 * len(shown):
        raise _binary(name)
    if "," not in header and second and any(s in sample for s in SEPARATORS):
        raise IvsidError(f"{name} has no comma in its header; a log is comma-separated with a header row")
    if "\r" in header.rstrip("\r\n"):
        raise IvsidError(f"{name} ends its lines with carriage returns alone; save it with line feeds")
    try:
        names = [c.strip() for c in next(csv.reader([header.rstrip("\r\n")], strict=True))]
    except csv.Error as error:
        raise IvsidError(f"{name} has a header that cannot be read ({error}); mend its quotation marks") from None
    twice = next((n for n in names if names.count(n) > 1), None)
    if twice is not None:
        raise IvsidError(f"{name} has the column {twice} more than once; each needs its own name")
    _check_end(path, name, len(names))
    return Text(path, name, tuple(names))


def _check_end(path: Path, name: str, columns: int) -> None:
    """Refuses a last row that breaks off: its last cell may be the beginning of another number."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(max(0, size - HEAD))
        lines = file.read().split(b"\n")
    cells = lines[-1].count(b",") + 1
    if lines[-1].strip() and len(lines) > 1 and cells < columns and b'"' not in lines[-1]:
        raise IvsidError(
            f"{name} breaks off in its last row, after {cells} of {columns} cells and without a line end; its last number may be cut: "
            "remove that row, or copy the file again"
        )


def _binary(name: str) -> IvsidError:
    return IvsidError(
        f"{name} is a binary file, not CSV or Parquet; export the log as CSV first, or give it the ending of its own "
        "format (.mat, .bin, .mcap, .db3)"
    )
