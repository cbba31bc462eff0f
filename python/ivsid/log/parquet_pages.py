"""Sizes that a Parquet file states in its footer and in the headers of its pages, held against each other before Polars reads it.

Polars takes memory for a page by the size that its header states, and ends the process where that cannot be had. A damaged header is caught here: what a
page states has to agree with its column, its row group and the file. Only headers are read, some bytes of each page.

Source: the format of Parquet (https://github.com/apache/parquet-format, parquet.thrift).
"""

from __future__ import annotations

import mmap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ivsid.log.thrift import PageError, Struct, structure

# Bytes at the end of a file: the length of its footer, and its mark.
# Source: definition: the format of Parquet
TAIL: Final = 8
# Bytes of a page that are never too many, whatever its column states: pages of a megabyte are usual.
# Source: resource: every computer has them, and no sound file is refused for a total that its writer counted otherwise
ALWAYS: Final = 1 << 24
# Repetition of a field that has several values in a row.
# Source: definition: parquet.thrift, FieldRepetitionType
REPEATED: Final = 2
# Bits in a byte, the least that a value of a dictionary takes being one of them.
# Source: definition: the format of Parquet
BITS: Final = 8


@dataclass(frozen=True)
class Group:
    """A row group.

    Attributes:
        rows: number of its rows.
        columns: description and number of values of each column that has values.
    """

    rows: int
    columns: tuple[tuple[Struct, int], ...]


@dataclass(frozen=True)
class Layout:
    """Where the columns of a file lie.

    Attributes:
        groups: in the order of the rows.
        names: for each column that has values, the place of the name that stands above it.
        end: of the columns: the begin of the footer.
    """

    groups: tuple[Group, ...]
    names: tuple[int, ...]
    end: int

    def ranges(self, names: Sequence[int], rows: slice | None = None) -> list[tuple[int, int]]:
        """Where columns lie, by the places of their names, in the row groups that hold some rows."""
        return [_place(c) for _, c, _ in self._chosen(names, rows)]

    def check(self, path: Path, names: Sequence[int], rows: slice | None = None) -> None:
        """Holds the sizes of the pages of columns against those of the columns; arguments as in ``ranges``.

        Raises:
            PageError: sizes that no sound file states.
        """
        with _mapped(path) as data:
            for _, column, values in self._chosen(names, rows):
                _chunk(data, column, values)

    def _chosen(self, names: Sequence[int], rows: slice | None) -> Iterator[tuple[int, Struct, int]]:
        at, wanted = 0, {*names}
        for group in self.groups:
            if rows is None or (at < rows.stop and at + group.rows > rows.start):
                for name, (column, values) in zip(self.names, group.columns, strict=True):
                    if name in wanted:
                        yield name, column, values
            at += group.rows


@contextmanager
def _mapped(path: Path) -> Iterator[mmap.mmap]:
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        try:
            yield data
        except IndexError:
            raise PageError("a header is cut off") from None


def footer_begin(size: int, tail: bytes) -> int:
    """Where the footer begins, from the last eight bytes of a file.

    Raises:
        PageError: a file that is cut off, or whose footer is longer than itself.
    """
    if size < 2 * TAIL or tail[-4:] != b"PAR1":
        raise PageError("its end is missing")
    begin = size - TAIL - int.from_bytes(tail[:4], "little")
    if begin < 4:
        raise PageError("its footer is longer than the file")
    return begin


def layout_of(path: Path) -> Layout:
    """Where the columns of a file lie, from its footer alone.

    Raises:
        PageError: sizes that no sound file states.
        OSError: an unreadable file.
    """
    with _mapped(path) as data:
        return _layout(data)


def check_pages(path: Path) -> Layout:
    """Holds the sizes of all pages of a Parquet file against those of its columns.

    Raises:
        PageError: sizes that no sound file states.
        OSError: an unreadable file.
    """
    with _mapped(path) as data:
        found = _layout(data)
        for group in found.groups:
            for column, values in group.columns:
                _chunk(data, column, values)
    return found


def _layout(data: mmap.mmap) -> Layout:
    size = len(data)
    begin = footer_begin(size, data[-TAIL:])
    footer, _ = structure(data, begin, size - TAIL)
    leaves = _flat(_structs(footer, 2))
    total = 0
    groups: list[Group] = []
    for group in _structs(footer, 4):
        rows = _count(group, 3)
        total += rows
        chunks = _structs(group, 1)
        if len(chunks) != len(leaves):
            raise PageError("a row group has other columns than the file")
        columns: list[tuple[Struct, int]] = []
        for chunk, (single, _) in zip(chunks, leaves, strict=True):
            column = chunk.get(3)
            if not isinstance(column, dict):
                raise PageError("a column is not described")
            values = _count(column, 5)
            if values < rows or (single and values > rows):
                raise PageError(f"a column states {values:,} values in {rows:,} rows")
            at, last = _place(column)
            if at < 4 or last > begin:
                raise PageError("a column lies outside of the file")
            columns.append((column, values))
        groups.append(Group(rows, tuple(columns)))
    if total != _count(footer, 3):
        raise PageError(f"it states {_count(footer, 3):,} rows, and its row groups {total:,}")
    return Layout(tuple(groups), tuple(name for _, name in leaves), begin)


def _place(column: Struct) -> tuple[int, int]:
    """Where a column of a row group begins and ends."""
    at = _count(column, 11) if column.get(11) else _count(column, 9)
    return at, at + _count(column, 7)


def _flat(schema: list[Struct]) -> list[tuple[bool, int]]:
    """For each column that has values, whether it has one in each row, and the place of the name that stands above it."""
    found: list[tuple[bool, int]] = []
    names = -1
    # Fields that are still to come at each depth, and whether the field above is one of several values.
    open_: list[tuple[int, bool]] = []
    for k, element in enumerate(schema):
        many = k > 0 and (element.get(3) == REPEATED or bool(open_ and open_[-1][1]))
        children = _count(element, 5) if 5 in element else 0
        names += len(open_) == 1
        if open_:
            open_[-1] = (open_[-1][0] - 1, open_[-1][1])
        elif k > 0:
            raise PageError("its columns are described twice")
        if children:
            open_.append((children, many))
        elif k > 0:
            found.append((not many, names))
        while open_ and not open_[-1][0]:
            open_.pop()
    return found


def _chunk(data: mmap.mmap, column: Struct, values: int) -> None:
    """The pages of a column in a row group."""
    most, left = _count(column, 6), values
    at, last = _place(column)
    while left and at < last:
        header, at = structure(data, at, last)
        unpacked, packed = _count(header, 2), _count(header, 3)
        if packed > last - at:
            raise PageError(f"a page states {packed:,} bytes, and its column has {last - at:,} left")
        if unpacked > max(most, ALWAYS) or (not column.get(4) and unpacked > max(packed, ALWAYS)):
            raise PageError(f"a page states {unpacked:,} unpacked bytes, and its column {most:,}")
        at += packed
        page = header.get(5, header.get(8))
        if isinstance(page, dict):
            count = _count(page, 1)
            if count > left:
                raise PageError(f"a page states {count:,} values, and its column has {left:,} left")
            left -= count
            if 8 in header and _count(page, 5) + _count(page, 6) > packed:
                raise PageError("a page states more bytes of levels than it has")
        elif isinstance(words := header.get(7), dict) and _count(words, 1) > BITS * unpacked:
            raise PageError(f"a dictionary states {_count(words, 1):,} values in {unpacked:,} bytes")


def _count(of: Struct, field: int) -> int:
    """A size or number, which is there and not below zero."""
    found = of.get(field)
    if not isinstance(found, int) or found < 0:
        raise PageError("a size is missing or below zero")
    return found


def _structs(of: Struct, field: int) -> list[Struct]:
    found = of.get(field)
    if not isinstance(found, list):
        raise PageError("a list is missing")
    structs = [s for s in found if isinstance(s, dict)]
    if len(structs) != len(found):
        raise PageError("a list holds something else")
    return structs
