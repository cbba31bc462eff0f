"""Structures in the compact protocol of Thrift, as far as the footer and the pages of a Parquet file need it.

Source: the compact protocol of Thrift (https://github.com/apache/thrift, thrift-compact-protocol.md).
"""

from __future__ import annotations

import mmap
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


class PageError(ValueError):
    """Sizes that contradict each other, in words for a sentence."""


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


def structure(data: mmap.mmap, at: int, end: int, depth: int = 0) -> tuple[Struct, int]:
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
        return structure(data, at, end, depth + 1)
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
