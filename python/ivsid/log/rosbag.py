"""ROS bags: ROS 2 (sqlite3 and MCAP) and ROS 1, by the optional package rosbags. A topic is a table, a numeric field a column."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.source import Lossless, Table
from ivsid.log.unpacked import bounded_chunks

# The two clocks of a message, in nanoseconds: the sensor's time of measurement, and the recorder's time of arrival.
STAMP: Final = "stamp"
RECEIVED: Final = "received"
OWN: Final = TimeColumn.model_validate({"from": STAMP, "unit": "ns"})
# Longest array whose elements are columns of their own: a covariance has 36; pictures and clouds of points have thousands.
# Source: resource: bounds the columns of a table
LONGEST: Final = 64


@dataclass(frozen=True)
class Topic(Lossless):
    """The messages of one topic; ``stamp`` is the time of the header, or the recorder's where there is no header."""

    reader: Any
    connections: tuple[Any, ...]
    name: str
    columns: tuple[str, ...]
    clock: TimeColumn | None = OWN
    first_row: int = 1

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The fields of every message; a message without one has a missing sample."""
        found: dict[str, list[float | int | None]] = {n: [] for n in names}
        for fields in _messages(self.reader, self.connections, self.name):
            for n, values in found.items():
                values.append(fields.get(n))
        stamps = (STAMP, RECEIVED)
        return {n: pl.Series(n, v, dtype=pl.Int64 if n in stamps else pl.Float64) for n, v in found.items()}


def open_bag(path: Path, name: str, stack: ExitStack) -> Mapping[str, Table]:
    """The topics of a bag.

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
    try:
        # Bags of older recorders carry no definitions: the standard messages of a release stand in for them.
        default = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        reader = stack.enter_context(highlevel.AnyReader([path], default_typestore=default))
        tables: dict[str, Table] = {}
        for topic in sorted({c.topic for c in reader.connections}):
            connections = tuple(c for c in reader.connections if c.topic == topic)
            first = next(_messages(reader, connections, name), None)
            if first is not None and len(first) > 2:  # more than its two stamps
                tables[topic] = Topic(reader, connections, name, tuple(first))
    except IvsidError:
        raise
    except Exception as error:
        # The reader passes on whatever SQLite, YAML, LZ4 and its own parsers raise.
        words = (str(error).splitlines() or [type(error).__name__])[0]
        raise IvsidError(f"{name} is not a readable ROS bag ({words}); record or convert it again") from None
    if not tables:
        raise IvsidError(f"{name} holds no topic with a numeric field; give a bag with the vehicle's sensors")
    return tables


def _messages(reader: Any, connections: Sequence[Any], name: str) -> Iterator[dict[str, float | int]]:
    try:
        for connection, received, data in reader.messages(connections=connections):
            message = reader.deserialize(data, connection.msgtype)
            fields: dict[str, float | int] = {STAMP: received, RECEIVED: received}
            _flatten(fields, "", message)
            header = getattr(message, "header", None)
            stamp = 0 if header is None else int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)
            # Some drivers leave the header's stamp at zero: then only the recorder knows a time.
            fields[STAMP] = stamp or received
            yield fields
    except Exception as error:
        words = (str(error).splitlines() or [type(error).__name__])[0]
        raise IvsidError(
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
