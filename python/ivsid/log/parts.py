"""A file of which only some bytes are needed: those of a file behind a URL are copied to their places in an empty file of the same size."""

from __future__ import annotations

import hashlib
import io
from bisect import bisect_right
from collections.abc import Sequence
from pathlib import Path
from typing import Final, Protocol

from ivsid.errors import IvsidError

# Begins the identity of a log that was read in parts, before the hash of those.
PARTS: Final = "parts:"
# Bytes that are fetched at once.
# Source: resource: 16 MB of memory
AT_ONCE: Final = 1 << 24
# Bytes between two needed ranges that are fetched with them.
# Source: resource: a request takes tens of milliseconds, in which a store sends megabytes
BETWEEN: Final = 1 << 16

Span = tuple[int, int]


class Fetch(Protocol):
    """Bytes of a file elsewhere."""

    def __call__(self, begin: int, end: int, /) -> bytes:
        """Those from ``begin`` up to ``end``."""


class Parts:
    """A file, and the ranges of it that were needed.

    Args:
        path: of the file, or of the one that is filled.
        name: of the log, for messages.
        fetch: of a file elsewhere; None for one that is here.
        size: of the file elsewhere [bytes].
    """

    def __init__(self, path: Path, name: str, fetch: Fetch | None = None, size: int = 0) -> None:
        self.path, self.name, self._fetch = path, name, fetch
        self.moved = 0
        self._needed: list[Span] = []
        self._have: list[Span] = []
        self._whole = False
        if fetch is None:
            self.size = path.stat().st_size
        else:
            self.size = size
            with path.open("wb") as file:
                file.truncate(size)

    def read(self, begin: int, end: int) -> bytes:
        """The bytes of a range; fewer where the file ends before."""
        self.need([(begin, min(end, self.size))])
        return self.peek(begin, end)

    def peek(self, begin: int, end: int) -> bytes:
        """The same, without a part in the identity."""
        end = min(end, self.size)
        self.get([(begin, end)])
        with self.path.open("rb") as file:
            file.seek(begin)
            return file.read(max(0, end - begin))

    def need(self, ranges: Sequence[Span]) -> None:
        """Has these ranges in the file, and among those that the identity stands for.

        Raises:
            IvsidError: they cannot be fetched.
        """
        self._needed = _joined([*self._needed, *ranges])
        self.get(self._needed)

    def all(self) -> None:
        """Has the whole file; its identity is that of all bytes from now on."""
        self._whole = True
        self.get([(0, self.size)])

    @property
    def elsewhere(self) -> bool:
        """Whether the file is fetched."""
        return self._fetch is not None

    def get(self, ranges: Sequence[Span]) -> None:
        """Has these ranges in the file, and leaves its identity as it is."""
        if self._fetch is None:
            return
        missing = _without(_joined(ranges), self._have)
        for begin, end in _joined(missing, BETWEEN):
            for at in range(begin, end, AT_ONCE):
                until = min(at + AT_ONCE, end)
                data = self._fetch(at, until)
                if len(data) != until - at:
                    raise IvsidError(
                        f"{self.name} has {len(data)} bytes from {at:,} on, where {until - at} were asked for; it changed while it was read, or its "
                        "store does not send parts: copy it to a disk"
                    )
                self.moved += len(data)
                with self.path.open("r+b") as file:
                    file.seek(at)
                    file.write(data)
            self._have = _joined([*self._have, (begin, end)])

    def result(self) -> str:
        """The identity of the log: SHA-256 of all bytes, or ``parts:`` and the SHA-256 of the size and of all ranges that were needed."""
        with self.path.open("rb") as file:
            if self._whole:
                return hashlib.file_digest(file, "sha256").hexdigest()
            digest = hashlib.sha256(f"{self.size}\n".encode())
            for begin, end in self._needed:
                digest.update(f"{begin} {end}\n".encode())
                file.seek(begin)
                for at in range(begin, end, AT_ONCE):
                    digest.update(file.read(min(AT_ONCE, end - at)))
        return PARTS + digest.hexdigest()


class Place:
    """The path of a file that is fetched as it is read, for readers that take paths.

    Args:
        parts: the file.
        blocks: ranges that are fetched as a whole, in their order.
    """

    def __init__(self, parts: Parts, blocks: Sequence[Span]) -> None:
        self._parts, self._blocks = parts, blocks
        self.suffix, self.name = parts.path.suffix, parts.path.name

    def __str__(self) -> str:
        return self._parts.name

    def exists(self) -> bool:
        """Whether it is there."""
        return True

    def is_dir(self) -> bool:
        """Whether it is a folder."""
        return False

    def open(self, _mode: str = "rb") -> io.RawIOBase:
        """The file, to be read."""
        return _Reading(self._parts, self._blocks)


class _Reading(io.RawIOBase):
    """A file that is fetched as it is read."""

    def __init__(self, parts: Parts, blocks: Sequence[Span]) -> None:
        self._parts, self._blocks, self._begins = parts, blocks, [b for b, _ in blocks]
        self._file = parts.path.open("rb")

    def read(self, size: int | None = -1, /) -> bytes:
        at = self._file.tell()
        end = self._parts.size if size is None or size < 0 else min(at + size, self._parts.size)
        wanted = [(at, end)]
        k = bisect_right(self._begins, at) - 1
        if k >= 0 and at < self._blocks[k][1]:
            wanted.append(self._blocks[k])
        self._parts.get(wanted)
        return self._file.read(max(0, end - at))

    def seek(self, offset: int, whence: int = 0, /) -> int:
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        return self._file.tell()

    def close(self) -> None:
        self._file.close()
        super().close()


def _joined(ranges: Sequence[Span], apart: int = 0) -> list[Span]:
    """The ranges in their order, those that meet or are ``apart`` bytes from each other as one."""
    found: list[Span] = []
    for begin, end in sorted(r for r in ranges if r[1] > r[0]):
        if found and begin <= found[-1][1] + apart:
            found[-1] = found[-1][0], max(found[-1][1], end)
        else:
            found.append((begin, end))
    return found


def _without(ranges: Sequence[Span], have: Sequence[Span]) -> list[Span]:
    """What the ranges hold and others do not, both in order and apart."""
    left: list[Span] = []
    for begin, end in ranges:
        at = begin
        for a, b in have:
            if b > at and a < end:
                if a > at:
                    left.append((at, a))
                at = max(at, b)
        if at < end:
            left.append((at, end))
    return left
