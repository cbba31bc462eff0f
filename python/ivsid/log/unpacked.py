"""Stated limits of what a packed log may become: a file of a few kilobytes can hold a disk full of zeros.

A log compresses to a third, or to a thirtieth where most of it stands still. A file that grows by more than a hundred, beyond a size that every computer has, is no log.
"""

from __future__ import annotations

import bz2
import importlib
import os
from collections.abc import Callable
from types import SimpleNamespace
from typing import IO, Final, Protocol, Self

from ivsid.errors import IvsidError

# Bytes that any packed file may become, and growth beyond which a larger one is refused.
# Source: resource: bounds the disk that a file of a few kilobytes fills
SMALL: Final = 1 << 30
GROWTH: Final = 100
# Bytes of an unpacked chunk of a bag; recorders make chunks of about a megabyte, and hold one in memory.
# Source: resource: bounds the memory of a chunk
CHUNK: Final = 1 << 28
# Rows of a Parquet table, whose encodings keep a constant column of any length in some bytes.
# Source: resource: 4 GiB a column
MOST_ROWS: Final = 1 << 29


def most_unpacked(packed: int) -> int:
    """Bytes that a file of ``packed`` bytes may become."""
    return max(SMALL, GROWTH * packed)


def too_large(name: str, most: int) -> IvsidError:
    """The sentence on a file that grows beyond its limit."""
    return IvsidError(
        f"{name} unpacks to more than {most:,} bytes, which no log of its size does; unpack it yourself if it is one"
    )


class ChunkError(ValueError):
    """A part of a bag that is larger than it may be."""

    def __init__(self, most: int) -> None:
        super().__init__(f"a part of it unpacks to more than {most:,} bytes")


def bounded_chunks() -> None:
    """Gives the readers of bags unpackers that stop at the limit of a chunk; theirs unpack first, and compare the size then."""
    mcap = importlib.import_module("rosbags.rosbag2.storage_mcap")
    lz4, zstd = importlib.import_module("lz4.frame"), mcap.zstd
    of_lz4, of_zstd = _bounded(lz4.LZ4FrameDecompressor), _bounded(zstd.ZstdDecompressor)
    mcap.DECOMPRESSORS.update(lz4=lambda data, _: of_lz4(data), zstd=lambda data, _: of_zstd(data))
    reader = importlib.import_module("rosbags.rosbag2.reader")
    # Messages that are packed one by one, and bags that are packed as a file.
    vars(reader)["zstd"] = SimpleNamespace(
        decompress=of_zstd, open=lambda file, mode: _Limited(zstd.open(file, mode), file)
    )
    ros_1 = importlib.import_module("rosbags.rosbag1.reader")
    ros_1.decompressors.update(bz2=_bounded(bz2.BZ2Decompressor), lz4=of_lz4)


class _Unpacker(Protocol):
    """A streaming unpacker, as those of bz2, lz4 and zstd are."""

    @property
    def eof(self) -> bool:
        """Whether the packed stream is at its end."""

    @property
    def unused_data(self) -> bytes | None:
        """Bytes behind that end."""

    def decompress(self, data: bytes, max_length: int, /) -> bytes:
        """At most so many bytes."""


class _Limited:
    """A packed file that is read up to the limit of its size."""

    def __init__(self, file: IO[bytes], packed: IO[bytes]) -> None:
        self._file, self._most = file, most_unpacked(os.fstat(packed.fileno()).st_size)
        self._left = self._most

    def read(self, size: int = -1) -> bytes:
        """The next bytes, as of a file."""
        data: bytes = self._file.read(size)
        self._left -= len(data)
        if self._left < 0:
            raise ChunkError(self._most)
        return data

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def _bounded(decompressor: Callable[[], _Unpacker]) -> Callable[[bytes], bytes]:
    """An unpacker that makes at most one byte more than a chunk has, from the packer's own streaming one."""

    def unpacked(data: bytes) -> bytes:
        parts, rest, size = [], data, 0
        while rest:
            one = decompressor()
            part = one.decompress(rest, CHUNK - size + 1)
            size += len(part)
            if size > CHUNK:
                raise ChunkError(CHUNK)
            if not one.eof:
                raise ValueError("a chunk is cut off")
            parts.append(part)
            # Frames may follow each other.
            rest = one.unused_data or b""
        return b"".join(parts)

    return unpacked
