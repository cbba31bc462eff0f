"""The index of an MCAP file: which bytes hold which topics and times. It is held against the file before anyone relies on it.

Source: the specification of MCAP (https://mcap.dev/spec).
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from struct import Struct, error
from typing import Final

from ivsid.errors import IvsidError
from ivsid.log.parts import Parts, Span
from ivsid.log.unpacked import CHUNK

MAGIC: Final = b"\x89MCAP0\r\n"
# Kinds of records.
# Source: definition: the specification of MCAP, "Records"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK_RECORD, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, DATA_END = (
    *(0x01, 0x02, 0x03, 0x04, 0x05),
    *(0x06, 0x07, 0x08, 0x0B, 0x0F),
)
# Bytes before a record's content: its kind and its length. Those of a footer with both, and with the mark behind it.
# Source: definition: the specification of MCAP, "Records"
BEFORE: Final = 9
FOOTER_SIZE: Final = 29
TAIL: Final = 37
# Bytes of a message index without and for a message.
# Source: definition: the specification of MCAP, "Message Index"
INDEX_SIZE: Final = 15
INDEX_ENTRY: Final = 16
RECORD: Final = Struct("<BQ")
SHORT, LONG, WORD = Struct("<H"), Struct("<Q"), Struct("<I")
_FOOT: Final = Struct("<QQI")
_FOUR: Final = Struct("<QQQQ")
_ENTRY: Final = Struct("<HQ")
_STATISTICS: Final = Struct("<QHIIIIQQ")


class IndexFaultError(IvsidError):
    """An index that is not that of its file: the file has to be read as a whole."""


@dataclass(frozen=True)
class Chunk:
    """Messages that are packed together.

    Attributes:
        begin: of the record in the file.
        end: of the record.
        behind: end of the message indexes behind it.
        first: time of the first message [ns].
        last: time of the last message [ns].
        channels: of its messages.
        head: the first bytes of the record, but for the four of its checksum from 33 on.
        messages: number of its messages.
    """

    begin: int
    end: int
    behind: int
    first: int
    last: int
    channels: frozenset[int]
    head: bytes
    messages: int


@dataclass(frozen=True)
class Index:
    """The index of a file.

    Attributes:
        chunks: in the order of the file.
        topics: names by channel.
        starts: the first time of all [ns].
    """

    chunks: tuple[Chunk, ...]
    topics: Mapping[int, str]
    starts: int

    def ranges(self, topics: Sequence[str] | None, start: int, stop: int) -> list[Span]:
        """Where the messages of some topics, or of all, lie from one time up to another, the second excluded [ns]."""
        wanted = {c for c, t in self.topics.items() if topics is None or t in topics}
        return [
            (c.begin, c.end)
            for c in self.chunks
            if start <= c.last and c.first < stop and not wanted.isdisjoint(c.channels)
        ]


def read_index(parts: Parts) -> Index:
    """The index of a file.

    Raises:
        IndexFaultError: it is missing, damaged, or not that of the file.
    """
    try:
        return _index(parts)
    except (error, IndexError, UnicodeDecodeError, ValueError) as fault:
        raise IndexFaultError(f"{parts.name} has no usable index ({fault})") from None


def check_chunks(parts: Parts, index: Index, ranges: Sequence[Span]) -> None:
    """Holds the chunks of the file at these ranges against its index.

    Raises:
        IndexFaultError: another record lies there.
    """
    wanted = {*ranges}
    for c in index.chunks:
        if (c.begin, c.end) in wanted:
            found = parts.peek(c.begin, c.begin + len(c.head) + WORD.size)
            if found[:33] + found[37:] != c.head:
                raise IndexFaultError(
                    f"{parts.name} has an index that is not that of its chunks; record or convert it again"
                )


def _index(parts: Parts) -> Index:
    size = parts.size
    if size < len(MAGIC) + BEFORE + TAIL:
        raise ValueError("the file is too short")
    head = parts.read(0, len(MAGIC) + BEFORE)
    kind, length = RECORD.unpack_from(head, len(MAGIC))
    begin = len(MAGIC) + BEFORE + length
    if not head.startswith(MAGIC) or kind != HEADER or begin > size - TAIL or length > CHUNK:
        raise ValueError("its header is damaged")
    parts.need([(0, begin)])
    foot = parts.read(size - TAIL, size)
    if not foot.endswith(MAGIC) or RECORD.unpack_from(foot) != (FOOTER, FOOTER_SIZE - BEFORE):
        raise ValueError("its end is missing")
    summary, _, checksum = _FOOT.unpack_from(foot, BEFORE)
    if not begin <= summary <= size - TAIL or size - summary > CHUNK:
        raise ValueError("it lies outside of the file")
    section = parts.read(summary, size - TAIL)
    if checksum and zlib.crc32(foot[: FOOTER_SIZE - WORD.size], zlib.crc32(section)) != checksum:
        raise ValueError("its checksum is wrong")
    return _of_section(section, begin, summary)


def _of_section(section: bytes, begin: int, end: int) -> Index:
    """The index from the records of the summary."""
    chunks: list[Chunk] = []
    topics: dict[int, str] = {}
    stated: tuple[int, ...] | None = None
    schemas = 0
    for kind, content in records(section):
        if kind == SCHEMA:
            schemas += 1
        elif kind == CHANNEL:
            topics[SHORT.unpack_from(content)[0]] = text(content, 4)[0]
        elif kind == CHUNK_INDEX:
            chunks.append(_chunk(content))
        elif kind == STATISTICS:
            stated = _STATISTICS.unpack_from(content)
    chunks.sort(key=lambda c: c.begin)
    at = begin
    for c in chunks:
        if c.begin < at or c.behind > end:
            raise ValueError("its chunks overlap, or lie outside of the file")
        at = c.behind
        if not c.channels <= topics.keys():
            raise ValueError("a chunk has a channel that is not described")
    if not topics or not schemas:
        raise ValueError("its channels are not described")
    if chunks and stated is not None and (stated[0], stated[5]) != (sum(c.messages for c in chunks), len(chunks)):
        raise ValueError("it leaves messages out")
    starts = stated[6] if stated is not None else min((c.first for c in chunks), default=0)
    return Index(tuple(chunks), topics, starts)


def _chunk(content: bytes) -> Chunk:
    first, last, begin, length = _FOUR.unpack_from(content)
    (size,) = WORD.unpack_from(content, 32)
    entries = list(_ENTRY.iter_unpack(_exactly(content, 36, size)))
    (behind,) = LONG.unpack_from(content, 36 + size)
    packing, at = text(content, 44 + size)
    packed, unpacked = LONG.unpack_from(content, at)[0], LONG.unpack_from(content, at + 8)[0]
    word = packing.encode()
    inside = 3 * LONG.size + 2 * WORD.size + len(word) + LONG.size + packed
    if length != BEFORE + inside or unpacked > CHUNK or first > last:
        raise ValueError("the sizes of a chunk contradict each other")
    end = begin + length
    if any(not end <= offset <= end + behind - INDEX_SIZE for _, offset in entries) or (unpacked and not entries):
        raise ValueError("the messages of a chunk are not indexed")
    left = behind - INDEX_SIZE * len(entries)
    if left < 0 or left % INDEX_ENTRY or len({c for c, _ in entries}) != len(entries):
        raise ValueError("the messages of a chunk are not indexed")
    head = RECORD.pack(CHUNK_RECORD, inside) + LONG.pack(first) + LONG.pack(last) + LONG.pack(unpacked)
    head += WORD.pack(len(word)) + word + LONG.pack(packed)
    return Chunk(begin, end, end + behind, first, last, frozenset(c for c, _ in entries), head, left // INDEX_ENTRY)


def records(section: bytes) -> list[tuple[int, bytes]]:
    """Kinds and contents of records that lie behind each other.

    Raises:
        ValueError: one that is longer than what is left.
    """
    found, at = [], 0
    while at < len(section):
        kind, length = RECORD.unpack_from(section, at)
        found.append((kind, _exactly(section, at + BEFORE, length)))
        at += BEFORE + length
    return found


def text(content: bytes, at: int) -> tuple[str, int]:
    """A text that begins with its length, and where it ends."""
    (length,) = WORD.unpack_from(content, at)
    return _exactly(content, at + WORD.size, length).decode(), at + WORD.size + length


def _exactly(content: bytes, at: int, length: int) -> bytes:
    if length > len(content) - at:
        raise ValueError("a record is longer than what is left")
    return content[at : at + length]
