"""ROS bags: ROS 2 (sqlite3 and MCAP) and ROS 1, by the optional package rosbags. A topic is a table, a numeric field a column."""

from __future__ import annotations

import importlib
import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import numpy as np
import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.mcap_index import Index, IndexFaultError, check_chunks, read_index
from ivsid.log.mcap_mend import mend
from ivsid.log.parts import Parts, Place, Span
from ivsid.log.source import Lossless, Table
from ivsid.log.unpacked import bounded_chunks

# The two clocks of a message, in nanoseconds: the sensor's time of measurement, and the recorder's time of arrival.
STAMP: Final = "stamp"
RECEIVED: Final = "received"
OWN: Final = TimeColumn.model_validate({"from": STAMP, "unit": "ns"})
# Longest array whose elements are columns of their own: a covariance has 36; pictures and clouds of points have thousands.
# Source: resource: bounds the columns of a table
LONGEST: Final = 64


# Nanoseconds of a second.
# Source: definition: the prefix of the unit
NANO: Final = 10**9


class MessageError(IvsidError):
    """A message that cannot be read."""


@dataclass(frozen=True)
class Range:
    """Messages of a part of a bag.

    Attributes:
        start: first time of the recorder [ns].
        stop: the time behind the last one [ns].
    """

    start: int | None = None
    stop: int | None = None


@dataclass(frozen=True)
class Indexed:
    """An MCAP file, and the index by which its chunks are chosen."""

    parts: Parts
    index: Index

    def need(self, topic: str, within: Range) -> None:
        """Has the chunks of a topic.

        Raises:
            IndexFaultError: the index is not that of the file.
        """
        chosen = self.chosen([topic], within)
        self.parts.need(chosen)
        check_chunks(self.parts, self.index, chosen)

    def chosen(self, topics: Sequence[str] | None, within: Range) -> list[Span]:
        """Where the messages of some topics, or of all, lie."""
        start = 0 if within.start is None else within.start
        return self.index.ranges(topics, start, 1 << 64 if within.stop is None else within.stop)

    def faulty(self, error: IvsidError) -> IvsidError:
        """The error, or that of an index by which the wrong bytes may have been read."""
        return IndexFaultError(str(error)) if isinstance(error, MessageError) else error


@dataclass(frozen=True)
class Topic(Lossless):
    """The messages of one topic; ``stamp`` is the time of the header, or the recorder's where there is no header."""

    reader: Any
    connections: tuple[Any, ...]
    name: str
    columns: tuple[str, ...]
    within: Range = Range()
    indexed: Indexed | None = None
    clock: TimeColumn | None = OWN
    first_row: int = 1

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The fields of every message; a message without one has a missing sample."""
        if self.indexed is not None:
            self.indexed.need(self.connections[0].topic, self.within)
        found: dict[str, list[float | int | None]] = {n: [] for n in names}
        try:
            for fields in _messages(self.reader, self.connections, self.name, self.within):
                for n, values in found.items():
                    values.append(fields.get(n))
        except IvsidError as error:
            raise (error if self.indexed is None else self.indexed.faulty(error)) from None
        stamps = (STAMP, RECEIVED)
        return {n: pl.Series(n, v, dtype=pl.Int64 if n in stamps else pl.Float64) for n, v in found.items()}


def open_bag(
    path: Path,
    name: str,
    stack: ExitStack,
    span: tuple[float, float] | None = None,
    parts: Parts | None = None,
    *,
    mended: bool = False,
) -> Mapping[str, Table]:
    """The topics of a bag.

    Args:
        path: of the bag.
        name: of the bag, for messages.
        stack: what has to be released.
        span: seconds since the first message by the recorder's clock, from and to which messages are read; None for all.
        parts: an MCAP file, of which the chunks that are needed are read alone; None for other bags.
        mended: whether the file is read as a whole, and its index made anew.

    Raises:
        IvsidError: a damaged bag, one without numeric fields, or a missing reader.
    """
    try:
        highlevel = importlib.import_module("rosbags.highlevel")
        typesys = importlib.import_module("rosbags.typesys")
    except ImportError:
        raise IvsidError(
            f"{name} is a ROS bag; reading it needs the package rosbags: pip install 'ivsid[ros]'"
        ) from None
    bounded_chunks()
    indexed: Indexed | None = None
    try:
        opened: Path | Place = path
        if parts is not None:
            indexed, opened = _indexed(parts, span, stack, mended=mended)
        # Bags of older recorders carry no definitions: the standard messages of a release stand in for them.
        default = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        reader = stack.enter_context(highlevel.AnyReader([opened], default_typestore=default))
        within = Range() if span is None else _within(reader.start_time, span)
        tables: dict[str, Table] = {}
        for topic in sorted({c.topic for c in reader.connections}):
            connections = tuple(c for c in reader.connections if c.topic == topic)
            first = next(_messages(reader, connections, name, within), None)
            if first is not None and len(first) > 2:  # more than its two stamps
                tables[topic] = Topic(reader, connections, name, tuple(first), within, indexed)
    except IvsidError as error:
        raise (error if indexed is None else indexed.faulty(error)) from None
    except Exception as error:
        # The reader passes on whatever SQLite, YAML, LZ4 and its own parsers raise.
        words = (str(error).splitlines() or [type(error).__name__])[0]
        fault = IvsidError if indexed is None else IndexFaultError
        raise fault(f"{name} is not a readable ROS bag ({words}); record or convert it again") from None
    if not tables:
        when = "" if span is None else f" from {span[0]:g} to {span[1]:g} s, the span of [log]"
        raise IvsidError(f"{name} holds no topic with a numeric field{when}; give a bag with the vehicle's sensors")
    return tables


def _indexed(
    parts: Parts, span: tuple[float, float] | None, stack: ExitStack, *, mended: bool
) -> tuple[Indexed | None, Path | Place]:
    """The index of an MCAP file, and what its reader opens: a copy with a new index where the file has none that can be used."""
    if not mended:
        try:
            found = Indexed(parts, read_index(parts))
            if not found.index.chunks:
                parts.all()
                return None, parts.path
            if not parts.elsewhere:
                within = Range() if span is None else _within(found.index.starts, span)
                check_chunks(parts, found.index, found.chosen(None, within))
                return found, parts.path
            return found, Place(parts, found.index.ranges(None, 0, 1 << 64))
        except IndexFaultError:
            pass
    parts.all()
    copy = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-"))) / "log.mcap"
    mend(parts.path, copy, importlib.import_module("rosbags.rosbag2.storage_mcap").DECOMPRESSORS)
    return None, copy


def _within(start: int, span: tuple[float, float]) -> Range:
    """The range of a span [s] after the first time [ns]."""
    # Decimals as they were written: 20.4 is no double.
    begin, end = (Fraction(repr(x)) * NANO for x in span)
    return Range(start + math.ceil(begin), start + math.floor(end) + 1)


def _messages(reader: Any, connections: Sequence[Any], name: str, within: Range) -> Iterator[dict[str, float | int]]:
    try:
        for connection, received, data in reader.messages(connections, within.start, within.stop):
            message = reader.deserialize(data, connection.msgtype)
            fields: dict[str, float | int] = {STAMP: received, RECEIVED: received}
            _flatten(fields, "", message)
            header = getattr(message, "header", None)
            stamp = 0 if header is None else int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)
            # Some drivers leave the header's stamp at zero: then only the recorder knows a time.
            fields[STAMP] = stamp or received
            yield fields
    except IvsidError:
        # A store that does not send.
        raise
    except Exception as error:
        words = (str(error).splitlines() or [type(error).__name__])[0]
        raise MessageError(
            f"{name} has a message that cannot be read ({words}); record or convert the bag again"
        ) from None


def _flatten(into: dict[str, float | int], prefix: str, value: object) -> None:
    """Numbers below a message by their dotted path; elements of a short array by their place, from 0."""
    if isinstance(value, (bool, int, float, np.number, np.bool_)):
        into[prefix] = float(value)
    elif isinstance(value, (np.ndarray, list, tuple)):
        if len(value) <= LONGEST:
            for k, element in enumerate(value):
                _flatten(into, f"{prefix}[{k}]", element)
    elif hasattr(value, "__dataclass_fields__"):
        for key in value.__dataclass_fields__:
            if not key.startswith("__"):
                _flatten(into, f"{prefix}.{key}" if prefix else key, getattr(value, key))
