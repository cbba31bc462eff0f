"""ArduPilot DataFlash logs (.bin), by the optional package pymavlink. A message type is a table, a field a column."""

from __future__ import annotations

import contextlib
import importlib
import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import polars as pl

from ivsid.errors import IvsidError
from ivsid.log.source import Table
from ivsid.log_map import TimeColumn

CLOCK: Final = "TimeUS"
OWN: Final = TimeColumn.model_validate({"from": CLOCK, "unit": "us"})
# What describes the log itself.
DESCRIPTIVE: Final = ("FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG", "FILE", "VER")


@dataclass(frozen=True)
class Messages:
    """The messages of one type, of one instance where a vehicle has several of a kind (``IMU[1]``)."""

    reader: Any
    type: str
    instance: tuple[str, int] | None
    name: str
    columns: tuple[str, ...]
    clock: TimeColumn | None = OWN
    first_row: int = 1

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The fields, scaled as the log itself says."""
        found: dict[str, list[Any]] = {n: [] for n in names}
        for message in _of_type(self.reader, self.type, self.name):
            if self.instance is not None and getattr(message, self.instance[0]) != self.instance[1]:
                continue
            for n, values in found.items():
                values.append(getattr(message, n))
        return {n: pl.Series(n, v, dtype=pl.Int64 if n == CLOCK else pl.Float64) for n, v in found.items()}

    def exact(self, name: str) -> pl.Series:
        """One field; the clock as integers."""
        return self.read([name])[name]


def open_dataflash(path: Path, name: str, stack: ExitStack) -> Mapping[str, Table]:
    """The message types of a DataFlash log.

    Raises:
        IvsidError: a damaged log, one without timed messages, or a missing reader.
    """
    try:
        dfreader = importlib.import_module("pymavlink.DFReader")
    except ImportError:
        raise IvsidError(
            f"{name} is a DataFlash log; reading it needs the package pymavlink: pip install 'ivsid[ardupilot]'"
        ) from None
    reader = dfreader.DFReader_binary.__new__(dfreader.DFReader_binary)
    stack.callback(_close, reader)
    try:
        # The reader reports what it skips on the terminal; a log that ends in the middle of a message is usual.
        with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
            reader.__init__(str(path))
    except Exception as error:
        raise _damaged(name, error) from None
    tables: dict[str, Table] = {}
    for number, layout in sorted(reader.formats.items()):
        fields = tuple(c for c, kind in zip(layout.columns, layout.msg_types, strict=False) if kind in (int, float))
        if layout.name in DESCRIPTIVE or CLOCK not in fields or not reader.counts[number]:
            continue
        if layout.instance_field is None:
            tables[layout.name] = Messages(reader, layout.name, None, name, fields)
            continue
        key = layout.instance_field
        for each in sorted({getattr(m, key) for m in _of_type(reader, layout.name, name)}):
            tables[f"{layout.name}[{each}]"] = Messages(reader, layout.name, (key, each), name, fields)
    if not tables:
        raise IvsidError(f"{name} holds no timed message; give a complete DataFlash log (.bin)")
    return tables


def _close(reader: Any) -> None:
    """Releases the file, also where the reader gave up half-way."""
    for part in ("data_map", "filehandle"):
        # A view that the reader's index still holds keeps the map open; it goes with the reader.
        with contextlib.suppress(BufferError):
            if hasattr(reader, part):
                getattr(reader, part).close()


def _of_type(reader: Any, kind: str, name: str) -> Iterator[Any]:
    silence = io.StringIO()
    reader.rewind()
    while True:
        try:
            with contextlib.redirect_stderr(silence), contextlib.redirect_stdout(silence):
                message = reader.recv_match(type=kind, strict=True)
        except Exception as error:
            raise _damaged(name, error) from None
        if message is None:
            return
        yield message


def _damaged(name: str, error: Exception) -> IvsidError:
    words = (str(error).splitlines() or [type(error).__name__])[0]
    return IvsidError(f"{name} is not a readable DataFlash log ({words}); download it from the vehicle again")
