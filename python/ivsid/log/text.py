"""Text tables with a header row, read column by column: a large file need not fit in memory twice.

Cells are separated by commas, semicolons, tabs or blanks. Between other separators than commas numbers may have decimal commas.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final

import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.aligned import aligned, copied, filled
from ivsid.log.beginning import MOST_LINES, Beginning, beginning
from ivsid.log.instruments import Header, X, header_of
from ivsid.log.polars_panics import panics_unprinted
from ivsid.log.source import AT_ONCE, MISSING
from ivsid.memory.room import DOUBLE, disk, is_large

# Bytes at either end of a file that are examined before it is read.
# Source: resource: bounds the time and memory of the examination
HEAD: Final = 65536
# Rows that tell whether numbers have decimal commas.
# Source: definition: the rows in the first bytes, at most
SOME: Final = 200
# Column of a copy that stands for all that are not in it.
_OTHERS: Final = "\x00others"
_NUMBER: Final = r"^(\s*[+-]?\d*),(\d+(?:[eE][+-]?\d+)?\s*)$"
# A number with a point where others have a comma: it may be the decimals, or thousands.
_POINT: Final = r"^\s*[+-]?\d*\.\d+(?:[eE][+-]?\d+)?\s*$"
_COMMA: Final = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Text:
    """A text table with a header row.

    Attributes:
        path: of the file.
        name: of the file, for messages.
        columns: names of the columns.
        separator: of the cells.
        decimal_comma: whether numbers have decimal commas.
    """

    path: Path
    name: str
    columns: tuple[str, ...]
    separator: str = ","
    decimal_comma: bool = False
    clock: TimeColumn | None = None
    first_row: int = 2
    """Number of the line that holds the first sample."""
    stack: ExitStack = field(default_factory=ExitStack, repr=False)
    _copies: dict[str, tuple[Path, pl.DataType]] = field(default_factory=dict, repr=False)

    @cached_property
    def rows(self) -> int:
        """The number of rows; of a short file at least that."""
        # A cell may be empty, and has something behind it.
        most = self.path.stat().st_size // len(self.columns)
        if not is_large(most * DOUBLE.itemsize):
            return most
        try:
            return int(self._lazy(()).select(pl.len()).collect(engine="streaming").item())
        except pl.exceptions.PolarsError as error:
            raise self._unreadable(error) from None

    @property
    def dtypes(self) -> Mapping[str, pl.DataType]:
        """Doubles or text, for columns that are prepared."""
        return {n: kind for n, (_, kind) in self._copies.items()}

    def prepare(self, names: Sequence[str]) -> None:
        """Copies columns to a file on a disk, a part of which is read fast: as doubles where every cell of them is a plain number, as text otherwise.

        Raises:
            IvsidError: no table, or no room for the copy.
        """
        try:
            folder = Path(self.stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-", dir=disk())))
            kind = self._copied(names, folder / "columns")
        except pl.exceptions.PolarsError as error:
            raise self._unreadable(error) from None
        except OSError as error:
            raise IvsidError(
                f"{self.name} is long, and its columns cannot be copied ({error.strerror or error}); make room on the disk, or set TMPDIR to a folder "
                "with more"
            ) from None
        self._copies.update(dict.fromkeys(names, (folder / "columns", kind)))

    def _copied(self, names: Sequence[str], target: Path) -> pl.DataType:
        """The type of the cells of a copy, which is written."""
        if not self.decimal_comma:
            try:
                self._copy(names, pl.Float64(), target)
                return pl.Float64()
            except (pl.exceptions.ComputeError, pl.exceptions.SchemaError):
                # A cell is no number, or padded.
                target.unlink(missing_ok=True)
        self._copy(names, pl.String(), target)
        return pl.String()

    def part(self, name: str, rows: slice) -> pl.Series:
        """Some rows of a prepared column."""
        path, kind = self._copies[name]
        chosen = pl.scan_parquet(path, glob=False).select(name).slice(rows.start, rows.stop - rows.start)
        cells = chosen.collect().to_series()
        return self._pointed(cells, rows.start) if kind == pl.String else cells

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The columns as doubles where every cell is a plain number, as text otherwise."""
        if not self.decimal_comma:
            try:
                return self._typed(names, pl.Float64())
            except pl.exceptions.PolarsError:
                # A cell is no number, or padded: text shows which one.
                pass
        return {n: self._pointed(c) for n, c in self._text(names).items()}

    def exact(self, name: str) -> pl.Series:
        """The column as text."""
        return self._pointed(self._text([name])[name])

    def _pointed(self, text: pl.Series, start: int = 0) -> pl.Series:
        """Cells with decimal points; dates keep their commas, which stand before decimals as well.

        Raises:
            IvsidError: a number with a point beside numbers with commas.
        """
        if not self.decimal_comma:
            return text
        if (mixed := text.str.contains(_POINT).arg_true()).len():
            k = int(mixed[0])
            raise IvsidError(
                f"{self.name}: column {text.name} has {text[k].strip()} in row {k + start + self.first_row}, where other numbers have decimal commas; its point may "
                "stand before decimals or thousands: export the log with one kind of number"
            )
        return text.str.replace(_NUMBER, "${1}.${2}")

    def _text(self, names: Sequence[str]) -> dict[str, pl.Series]:
        try:
            return self._typed(names, pl.String())
        except pl.exceptions.PolarsError as error:
            raise self._unreadable(error) from None

    def _unreadable(self, error: BaseException) -> IvsidError:
        return IvsidError(f"{self.name} is not a readable CSV table ({self._why(error)}); mend or export it again")

    def _why(self, error: BaseException) -> str:
        """The fault in the words of a log, in place of the reader's words about its schema."""
        first = (str(error).splitlines() or ["damaged"])[0]
        return (
            f"a row has more cells than the {len(self.columns)} of the header" if "schema" in first.lower() else first
        )

    def _typed(self, names: Sequence[str], kind: pl.DataType) -> dict[str, pl.Series]:
        # Counting the cells of the other columns makes the reader examine them, so that it finds a row with too many cells.
        others = [pl.col(c).null_count() for c in self.columns if c not in names]
        lazy = self._lazy(names, kind).select(*[pl.col(n) for n in names], *others)
        frame = lazy.collect(engine="streaming")
        return {n: frame[n] for n in names}

    def _copy(self, names: Sequence[str], kind: pl.DataType, target: Path) -> None:
        """Writes columns as a Parquet file, a part at a time; the others are examined as ``_typed`` does."""
        others = [pl.col(c).is_null() for c in self.columns if c not in names]
        examined = [pl.any_horizontal(others).alias(_OTHERS)] if others else []
        lazy = self._lazy(names, kind).select(*[pl.col(n) for n in names], *examined)
        with panics_unprinted():
            lazy.sink_parquet(target, compression="lz4", row_group_size=AT_ONCE // 4, maintain_order=True)

    def _lazy(self, names: Sequence[str], kind: pl.DataType | None = None) -> pl.LazyFrame:
        return pl.scan_csv(
            self.path,
            has_header=False,
            skip_lines=self.first_row - 1,
            schema={c: kind if kind is not None and c in names else pl.String() for c in self.columns},
            null_values=list(MISSING),
            separator=self.separator,
            encoding="utf8-lossy",
            glob=False,
        )


def open_text(path: Path, name: str, stack: ExitStack | None = None) -> Text:
    """Checks both ends of a file and reads its header.

    Args:
        path: of the file.
        name: of the file, for messages.
        stack: releases the copies of a long file.

    Raises:
        IvsidError: an empty or binary file, a wrong separator, a column that stands twice, or a last row that breaks off.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
        if not head.strip():
            raise IvsidError(f"log {name} is empty; it needs a header row and samples")
        if b"\x00" in head:
            raise _binary(name)
    if len(head) == HEAD and head.count(b"\n") < 2:
        with path.open("rb") as file:
            head = file.readline(1 << 24) + file.readline(1 << 24)
    encoding = "utf-8-sig"
    try:
        head[: head.rfind(b"\n") + 1].decode(encoding)
    except UnicodeDecodeError:
        encoding = "latin-1"
    shown = head[:4096].decode(encoding, "ignore")
    # Beyond Latin-1, characters that are valid UTF-8 are text, whether or not this Unicode has names for them.
    if sum(c.isprintable() or c in "\r\n\t" or c > "\xff" for c in shown) < 0.98 * len(shown):
        raise _binary(name)
    lines = head.decode(encoding, "replace").split("\n")
    if len(lines) > 1 and len(head) >= HEAD:
        # The last line goes on behind what was read.
        lines.pop()
    rows = [line.removesuffix("\r") for line in lines]
    if any("\r" in line for line in rows[:2]):
        raise IvsidError(f"{name} ends its lines with carriage returns alone; save it with line feeds")
    stack = stack or ExitStack()
    told = header_of(rows[:MOST_LINES], name) or aligned(rows[:MOST_LINES], name)
    if told is not None:
        path = _plainly(path, name, told, stack)
    begun = told or beginning(rows[:MOST_LINES], name)
    twice = next((n for n in begun.names if begun.names.count(n) > 1), None)
    if twice is not None:
        raise IvsidError(f"{name} has the column {twice} more than once; each needs its own name")
    _check_end(path, name, len(begun.names), begun.separator)
    cells = [_parted(row, begun) for row in rows[begun.lines : begun.lines + SOME]]
    comma = begun.separator != "," and any(_COMMA.fullmatch(cell.strip(' "')) for row in cells for cell in row)
    clock = TimeColumn.model_validate({"from": begun.names[0], "unit": "s"}) if begun.names[0].startswith(X) else None
    return Text(path, name, begun.names, begun.separator, comma, clock, first_row=begun.lines + 1, stack=stack)


def _parted(row: str, begun: Beginning | Header) -> list[str]:
    return row.split() if isinstance(begun, Header) and begun.separator == "\t" else row.split(begun.separator)


def _plainly(path: Path, name: str, header: Header, stack: ExitStack) -> Path:
    """The file of an instrument or of aligned columns, or a copy with one separator between two cells and all cells in each row.

    Raises:
        IvsidError: several headers, or no room for the copy.
    """
    try:
        if header.names[0].startswith(X):
            with path.open("rb") as file:
                if sum(line.startswith(X.encode()) for line in file) > 1:
                    raise IvsidError(
                        f"{name} has several headers, one for each of its parts; save each part as a file of its own, or all with one header"
                    )
        elif header.separator != "\t":
            return path
        target = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-"))) / "log"
        return filled(path, target, header) if header.names[0].startswith(X) else copied(path, target)
    except OSError as error:
        raise IvsidError(
            f"{name} cannot be copied ({error.strerror or error}); make room on the disk, or set TMPDIR to a folder with more"
        ) from None


def _check_end(path: Path, name: str, columns: int, separator: str) -> None:
    """Refuses a last row that breaks off: its last cell may be the beginning of another number."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(max(0, size - HEAD))
        lines = file.read().split(b"\n")
    cells = lines[-1].count(separator.encode()) + 1
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
