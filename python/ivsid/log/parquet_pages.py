"""Sizes that a Parquet file states in its footer and in the headers of its pages, held against each other before Polars reads it.

Polars takes memory for a page by the size that its header states, and ends the process where that cannot be had. A damaged header is caught here: what a
page states has to agree with its column, its row group and the file. Only headers are read, some bytes of each page.

Source: the format of Parquet (https://github.com/apache/parquet-format, parquet.thrift) in the compact protocol of Thrift.
"""

from __future__ import annotations

import mmap
from pathlib import Path
from typing import Final, TypeAlias

# Numbers are read as they are, binaries as their lengths.
Value: TypeAlias = "int | list[Value] | Struct"
Struct: TypeAlias = "dict[int, Value]"

# Kinds of a field in the compact protocol.
# Source: definition: the compact protocol of Thrift, "Struct encoding"
TRUE, FALSE, BYTE, DOUBLE, BINARY, LIST, SET, STRUCT = 1, 2, 3, 7, 8, 9, 10, 12
# Bits of a varint in a byte, and of the longest one.
# Source: definition: the compact protocol of Thrift, "Integer encoding"
SEVEN: Final = 7
LONGEST: Final = 63
# Structures in each other; those of Parquet are at most six deep.
# Source: resource: the stack of the interpreter
DEEPEST: Final = 20
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


class PageError(ValueError):
    """Sizes that contradict each other, in words for a sentence."""


def check_pages(path: Path) -> None:
    """Holds the sizes of all pages of a Parquet file against those of its columns.

    Raises:
        PageError: sizes that no sound file states.
        OSError: an unreadable file.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        try:
            _file(data)
        except IndexError:
            raise PageError("a header is cut off") from None


def _file(data: mmap.mmap) -> None:
    size = len(data)
    if size < 2 * TAIL or data[-4:] != b"PAR1":
        raise PageError("its end is missing")
    begin = size - TAIL - int.from_bytes(data[-TAIL:-4], "little")
    if begin < 4:
        raise PageError("its footer is longer than the file")
    footer, _ = _struct(data, begin, size - TAIL)
    flat = _flat(_structs(footer, 2))
    total = 0
    for group in _structs(footer, 4):
        rows = _count(group, 3)
        total += rows
        chunks = _structs(group, 1)
        if len(chunks) != len(flat):
            raise PageError("a row group has other columns than the file")
        for chunk, single in zip(chunks, flat, strict=True):
            column = chunk.get(3)
            if not isinstance(column, dict):
                raise PageError("a column is not described")
            values = _count(column, 5)
            if values < rows or (single and values > rows):
                raise PageError(f"a column states {values:,} values in {rows:,} rows")
            _chunk(data, column, values, begin)
    if total != _count(footer, 3):
        raise PageError(f"it states {_count(footer, 3):,} rows, and its row groups {total:,}")


def _flat(schema: list[Struct]) -> list[bool]:
    """For each column that has values, whether it has one in each row."""
    found: list[bool] = []
    # Fields that are still to come at each depth, and whether the field above is one of several values.
    open_: list[tuple[int, bool]] = []
    for k, element in enumerate(schema):
        many = k > 0 and (element.get(3) == REPEATED or bool(open_ and open_[-1][1]))
        children = _count(element, 5) if 5 in element else 0
        if open_:
            open_[-1] = (open_[-1][0] - 1, open_[-1][1])
        elif k > 0:
            raise PageError("its columns are described twice")
        if children:
            open_.append((children, many))
        elif k > 0:
            found.append(not many)
        while open_ and not open_[-1][0]:
            open_.pop()
    return found


def _chunk(data: mmap.mmap, column: Struct, values: int, end: int) -> None:
    """The pages of a column in a row group."""
    most, length = _count(column, 6), _count(column, 7)
    at = _count(column, 11) if column.get(11) else _count(column, 9)
    if at < 4 or at + length > end:
        raise PageError("a column lies outside of the file")
    last, left = at + length, values
    while left and at < last:
        header, at = _struct(data, at, last)
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


def _varint(data: mmap.mmap, at: int) -> tuple[int, int]:
    found = shift = 0
    while True:
        byte = data[at]
        at += 1
        found |= (byte & 0x7F) << shift
        if byte < 0x80:
            return found, at
        shift += SEVEN
        if shift > LONGEST:
            raise PageError("a number has more than 64 bits")


def _struct(data: mmap.mmap, at: int, end: int, depth: int = 0) -> tuple[Struct, int]:
    """The fields of a structure by their numbers, and where it ends."""
    if depth > DEEPEST:
        raise PageError("its headers are nested too deeply")
    fields: Struct = {}
    field = 0
    while True:
        if at >= end:
            raise PageError("a header is cut off")
        head = data[at]
        at += 1
        if not head:
            return fields, at
        step, kind = head >> 4, head & 15
        if step:
            field += step
        else:
            number, at = _varint(data, at)
            field = (number >> 1) ^ -(number & 1)
        if BYTE < kind < DOUBLE:
            # Most fields are small integers: this is the line that the time goes to.
            number = data[at]
            at += 1
            if number >= 0x80:
                number, at = _varint(data, at - 1)
            fields[field] = (number >> 1) ^ -(number & 1)
        elif kind in (TRUE, FALSE):
            fields[field] = kind == TRUE
        else:
            fields[field], at = _value(data, at, end, kind, depth)


def _value(data: mmap.mmap, at: int, end: int, kind: int, depth: int) -> tuple[Value, int]:
    if BYTE < kind < DOUBLE:
        number, at = _varint(data, at)
        return (number >> 1) ^ -(number & 1), at
    if kind == STRUCT:
        return _struct(data, at, end, depth + 1)
    if kind == BINARY:
        number, at = _varint(data, at)
        if number > end - at:
            raise PageError("a text is longer than its header")
        return number, at + number
    if kind in (LIST, SET):
        head = data[at]
        number, at = (head >> 4, at + 1) if head < 0xF0 else _varint(data, at + 1)
        if number > end - at:
            raise PageError("a list is longer than its header")
        within = head & 15
        found: list[Value] = []
        for _ in range(number):
            value, at = (data[at], at + 1) if within in (TRUE, FALSE) else _value(data, at, end, within, depth + 1)
            found.append(value)
        return found, at
    if kind in (BYTE, DOUBLE):
        return 0, at + (1 if kind == BYTE else 8)
    raise PageError("a header has a field of an unknown kind")
