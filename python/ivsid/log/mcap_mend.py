"""An MCAP file without a usable index gets a new one: its records are read from the first to the last, and copied.

Source: the specification of MCAP (https://mcap.dev/spec).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Final

from ivsid.log.mcap_index import (
    BEFORE,
    CHANNEL,
    CHUNK_INDEX,
    CHUNK_RECORD,
    DATA_END,
    FOOTER,
    HEADER,
    INDEX_ENTRY,
    LONG,
    MAGIC,
    MESSAGE,
    MESSAGE_INDEX,
    RECORD,
    SCHEMA,
    SHORT,
    STATISTICS,
    WORD,
    text,
)
from ivsid.log.unpacked import CHUNK

# Unpacks a chunk: its bytes and its stated size.
Unpack = Callable[[bytes, int], bytes]
# The times of a message before its content: channel, number, and the recorder's time at 6.
# Source: definition: the specification of MCAP, "Message"
LOG_TIME: Final = 6
LEAST_MESSAGE: Final = 22


@dataclass
class _Found:
    """What the records of a file say."""

    described: dict[tuple[int, int], bytes] = field(default_factory=dict)
    chunks: list[bytes] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    times: list[int] = field(default_factory=list)
    alone: int = 0

    def keep(self, kind: int, content: bytes) -> None:
        """Keeps a schema or a channel, the first of its number."""
        self.described.setdefault((kind, SHORT.unpack_from(content)[0]), content)

    def at(self, first: int, last: int) -> None:
        """Widens the times of the file."""
        self.times = [min([first, *self.times[:1]]), max([last, *self.times[1:]])]


def mend(path: Path, target: Path, unpackers: dict[str, Unpack]) -> None:
    """Copies the data of a file, and writes the index of what it holds.

    Args:
        path: of the file.
        target: of the copy.
        unpackers: by the name of the packing.

    Raises:
        ValueError: the data themselves are damaged.
    """
    found = _Found()
    with path.open("rb") as file, target.open("wb") as copy:
        if file.read(len(MAGIC)) != MAGIC:
            raise ValueError("it does not begin as an MCAP file")
        copy.write(MAGIC)
        for kind, content in _data(file, path.stat().st_size):
            if kind == CHUNK_RECORD:
                _chunk(content, unpackers, found, copy)
                continue
            if kind in (SCHEMA, CHANNEL):
                found.keep(kind, content)
            elif kind == MESSAGE:
                _message(content, found)
                found.alone += 1
            if kind != MESSAGE_INDEX:
                copy.write(RECORD.pack(kind, len(content)) + content)
        if found.alone and found.chunks:
            raise ValueError("it has messages outside of its chunks")
        _finish(found, copy)


def _data(file: IO[bytes], size: int) -> Iterator[tuple[int, bytes]]:
    """The records up to the end of the data, or of the file where it has no end."""
    first = True
    while head := file.read(BEFORE):
        if len(head) < BEFORE:
            if MAGIC.startswith(head):
                return
            raise ValueError("it breaks off in a record")
        kind, length = RECORD.unpack(head)
        if kind in (DATA_END, FOOTER):
            return
        if (kind == HEADER) != first:
            raise ValueError("its header is damaged")
        first = False
        if length > min(size - file.tell(), CHUNK):
            raise ValueError(f"a record states {length:,} bytes, and the file has {size - file.tell():,} left")
        yield kind, file.read(length)


def _message(content: bytes, found: _Found) -> tuple[int, int]:
    """The channel and the time of a message, which is counted."""
    if len(content) < LEAST_MESSAGE:
        raise ValueError("a message is cut off")
    channel, when = SHORT.unpack_from(content)[0], LONG.unpack_from(content, LOG_TIME)[0]
    found.counts[channel] = found.counts.get(channel, 0) + 1
    found.at(when, when)
    return channel, when


def _chunk(content: bytes, unpackers: dict[str, Unpack], found: _Found, copy: IO[bytes]) -> None:
    """Copies a chunk, with the index of its messages."""
    size = LONG.unpack_from(content, 16)[0]
    packing, at = text(content, 28)
    if packing not in unpackers or size > CHUNK:
        raise ValueError(f"a chunk is packed as {packing!r} in {size:,} bytes")
    packed = content[at + LONG.size : at + LONG.size + LONG.unpack_from(content, at)[0]]
    inner = unpackers[packing](packed, size)
    if len(inner) != size:
        raise ValueError("a chunk has another size than it states")
    entries: dict[int, list[tuple[int, int]]] = {}
    place = 0
    while place < size:
        kind, length = RECORD.unpack_from(inner, place)
        if length > size - place - BEFORE:
            raise ValueError("a record is longer than its chunk")
        record = inner[place + BEFORE : place + BEFORE + length]
        if kind in (SCHEMA, CHANNEL):
            found.keep(kind, record)
        elif kind == MESSAGE:
            channel, when = _message(record, found)
            entries.setdefault(channel, []).append((when, place))
        place += BEFORE + length
    times = [w for many in entries.values() for w, _ in many] or [0]
    begin = copy.tell()
    # The times of the record may be the damage.
    copy.write(RECORD.pack(CHUNK_RECORD, len(content)) + LONG.pack(min(times)) + LONG.pack(max(times)) + content[16:])
    end, offsets = copy.tell(), b""
    for channel, many in entries.items():
        offsets += SHORT.pack(channel) + LONG.pack(copy.tell())
        listed = b"".join(LONG.pack(w) + LONG.pack(o) for w, o in many)
        copy.write(RECORD.pack(MESSAGE_INDEX, 6 + INDEX_ENTRY * len(many)))
        copy.write(SHORT.pack(channel) + WORD.pack(len(listed)) + listed)
    word = packing.encode()
    found.chunks.append(
        b"".join(LONG.pack(x) for x in (min(times), max(times), begin, end - begin))
        + WORD.pack(len(offsets))
        + offsets
        + LONG.pack(copy.tell() - end)
        + WORD.pack(len(word))
        + word
        + LONG.pack(len(packed))
        + LONG.pack(size)
    )


def _finish(found: _Found, copy: IO[bytes]) -> None:
    """Writes the summary and the footer."""
    copy.write(RECORD.pack(DATA_END, WORD.size) + WORD.pack(0))
    begin = copy.tell()
    for (kind, _), content in sorted(found.described.items()):
        copy.write(RECORD.pack(kind, len(content)) + content)
    for content in found.chunks:
        copy.write(RECORD.pack(CHUNK_INDEX, len(content)) + content)
    kinds = [kind for kind, _ in found.described]
    first, last = found.times or [0, 0]
    counts = b"".join(SHORT.pack(c) + LONG.pack(n) for c, n in sorted(found.counts.items()))
    made = LONG.pack(sum(found.counts.values())) + SHORT.pack(kinds.count(SCHEMA) & 0xFFFF)
    made += b"".join(WORD.pack(x) for x in (kinds.count(CHANNEL), 0, 0, len(found.chunks)))
    made += LONG.pack(first) + LONG.pack(last) + WORD.pack(len(counts)) + counts
    copy.write(RECORD.pack(STATISTICS, len(made)) + made)
    copy.write(RECORD.pack(FOOTER, 20) + LONG.pack(begin) + LONG.pack(0) + WORD.pack(0) + MAGIC)
