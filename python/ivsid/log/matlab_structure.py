"""The structure of a MATLAB v5 file, checked before SciPy reads it.

SciPy's reader follows damaged tags and sizes out of memory. An element of the format is a tag of type and size, and the bytes of that
size; a variable is an element of elements (MathWorks, MAT-File Format).
"""

from __future__ import annotations

import math
import mmap
import struct
import zlib
from pathlib import Path
from typing import Final

from ivsid.log.unpacked import most_unpacked

# Types of elements, and the bytes of one number of each.
# Source: definition: MathWorks, MAT-File Format
_BYTES: Final = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
# Types of elements with a part of their own in a variable.
# Source: definition: MathWorks, MAT-File Format
_INT8, _INT32, _UINT32, _MATRIX, _COMPRESSED = 1, 5, 6, 14, 15
# Types of elements that may hold characters.
# Source: definition: MathWorks, MAT-File Format
_TEXT: Final = (1, 2, 3, 4, 16, 17, 18)
# Classes of variables.
# Source: definition: MathWorks, MAT-File Format
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 5, 16, 17
# Classes of numeric variables.
# Source: definition: MathWorks, MAT-File Format
_NUMERIC: Final = range(6, 16)
# The flag of a variable with an imaginary part.
# Source: definition: MathWorks, MAT-File Format
_COMPLEX: Final = 0x800
# Depth of nested structs and cells beyond which a file is refused.
# Source: resource: bounds the recursion
DEPTH: Final = 64
# Bytes before the first element.
# Source: definition: MathWorks, MAT-File Format
HEADER: Final = 128


class StructureError(ValueError):
    """A fault of the structure, in a few words."""


class _Elements:
    """Elements one after the other between two places of a buffer."""

    def __init__(self, data: bytes | mmap.mmap, order: str, at: int, end: int) -> None:
        self.data, self.order, self.at, self.end = data, order, at, end

    def next(self) -> tuple[int, int, int]:
        """Type of the next element, and the places where its bytes begin and end."""
        if self.at + 8 > self.end:
            raise StructureError("an element is cut off")
        kind, size = struct.unpack_from(f"{self.order}II", self.data, self.at)
        begin = self.at + 8
        if kind >> 16:
            # Up to four bytes stand in the tag itself.
            kind, size, begin = kind & 0xFFFF, kind >> 16, self.at + 4
            if size > 4:
                raise StructureError("an element of the short form is too long")
            self.at += 8
        else:
            padded = size if kind == _COMPRESSED else -(-size // 8) * 8
            self.at = min(begin + padded, self.end)
        if begin + size > self.end:
            raise StructureError("an element is longer than the file")
        return kind, begin, begin + size

    def wanted(self, *kinds: int) -> tuple[int, int, int]:
        """The next element, which must be of one of these types."""
        kind, begin, end = self.next()
        if kind not in kinds:
            raise StructureError(f"an element has the type {kind}")
        return kind, begin, end


def check_structure(path: Path) -> None:
    """Walks through all elements of a v5 file.

    Raises:
        StructureError: the first fault.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        if len(data) < HEADER or data[126:128] not in (b"IM", b"MI"):
            raise StructureError("its header is cut off")
        order = "<" if data[126:128] == b"IM" else ">"
        _variables(_Elements(data, order, HEADER, len(data)))


def _variables(elements: _Elements) -> None:
    while elements.at < elements.end:
        kind, begin, end = elements.wanted(_MATRIX, _COMPRESSED)
        if kind == _MATRIX:
            _matrix(_Elements(elements.data, elements.order, begin, end), 0)
            continue
        try:
            plain = _unpacked(elements.data[begin:end])
        except zlib.error as error:
            raise StructureError(f"a variable cannot be unpacked: {error}") from None
        inside = _Elements(plain, elements.order, 0, len(plain))
        _, begin, end = inside.wanted(_MATRIX)
        _matrix(_Elements(plain, elements.order, begin, end), 0)


def _unpacked(packed: bytes) -> bytes:
    """A variable unpacked, inside the limit of ``unpacked``: SciPy has none."""
    most = most_unpacked(len(packed))
    one = zlib.decompressobj()
    plain = one.decompress(packed, most + 1)
    if len(plain) > most:
        raise StructureError(f"a variable unpacks to more than {most:,} bytes")
    if not one.eof:
        raise zlib.error("it is cut off")
    return plain


def _matrix(elements: _Elements, depth: int) -> None:
    if elements.at == elements.end:
        return
    if depth > DEPTH:
        raise StructureError("its structs are nested too deeply")
    _, begin, end = elements.wanted(_UINT32)
    if end - begin != 8:
        raise StructureError("a variable has no flags")
    flags = struct.unpack_from(f"{elements.order}I", elements.data, begin)[0]
    sort = flags & 0xFF
    if sort == _OPAQUE:
        for _ in range(3):
            elements.wanted(_INT8)
        _inner(elements, 1, depth)
        return
    _, begin, end = elements.wanted(_INT32)
    count = (end - begin) // 4
    if not 2 <= count <= 32 or (end - begin) % 4:
        raise StructureError("a variable has no dimensions")
    shape = struct.unpack_from(f"{elements.order}{count}i", elements.data, begin)
    if min(shape) < 0:
        raise StructureError("a dimension is negative")
    elements.wanted(_INT8)
    _content(elements, sort, shape, depth, complex_=bool(flags & _COMPLEX))


def _content(elements: _Elements, sort: int, shape: tuple[int, ...], depth: int, *, complex_: bool) -> None:
    """Checks the elements after the name of a variable, by its class."""
    size = math.prod(shape)
    if sort in _NUMERIC:
        for _ in range(2 if complex_ else 1):
            _numbers(elements, size)
    elif sort == _CHAR:
        elements.wanted(*_TEXT)
    elif sort == _CELL:
        _inner(elements, size, depth)
    elif sort in (_STRUCT, _OBJECT):
        if sort == _OBJECT:
            elements.wanted(_INT8)
        _inner(elements, size * _fields(elements), depth)
    elif sort == _SPARSE:
        _sparse(elements, shape, complex_=complex_)
    elif sort == _FUNCTION:
        _inner(elements, 1, depth)
    else:
        raise StructureError(f"a variable is of the class {sort}")


def _inner(elements: _Elements, count: int, depth: int) -> None:
    if count * 8 > elements.end - elements.at:
        raise StructureError("a struct or cell has more parts than bytes")
    for _ in range(count):
        _, begin, end = elements.wanted(_MATRIX)
        _matrix(_Elements(elements.data, elements.order, begin, end), depth + 1)


def _numbers(elements: _Elements, size: int) -> None:
    kind, begin, end = elements.wanted(*_BYTES)
    if end - begin != size * _BYTES[kind]:
        raise StructureError(f"a variable of {size} numbers has {(end - begin) // _BYTES[kind]}")


def _fields(elements: _Elements) -> int:
    """The number of fields of a struct."""
    _, begin, end = elements.wanted(_INT32)
    if end - begin != 4:
        raise StructureError("a struct has no length of names")
    length: int = struct.unpack_from(f"{elements.order}i", elements.data, begin)[0]
    _, begin, end = elements.wanted(_INT8)
    if length < 1 or (end - begin) % length:
        raise StructureError("a struct's names do not fit their length")
    return (end - begin) // length


def _sparse(elements: _Elements, shape: tuple[int, ...], *, complex_: bool) -> None:
    """Checks rows, starts of columns and values: all places must lie inside the matrix."""
    order, data = elements.order, elements.data
    _, begin, end = elements.wanted(_INT32)
    rows = struct.unpack_from(f"{order}{(end - begin) // 4}i", data, begin)
    _, begin, end = elements.wanted(_INT32)
    starts = struct.unpack_from(f"{order}{(end - begin) // 4}i", data, begin)
    kind, begin, end = elements.wanted(*_BYTES)
    values = (end - begin) // _BYTES[kind]
    inside = len(shape) == 2 and len(starts) == shape[1] + 1 and starts[0] == 0 and list(starts) == sorted(starts)
    used = rows[: starts[-1]] if starts else ()
    if not inside or starts[-1] > min(len(rows), values) or any(not 0 <= r < shape[0] for r in used):
        raise StructureError("a sparse matrix points outside itself")
    if complex_:
        _numbers(elements, values)
