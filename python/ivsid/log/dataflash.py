"""ArduPilot DataFlash logs (.bin), by the optional package pymavlink. A message type is a table, a field a column."""

from __future__ import annotations

import contextlib
import importlib
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.source import Lossless, Table

CLOCK: Final = "TimeUS"
OWN: Final = TimeColumn.model_validate({"from": CLOCK, "unit": "us"})
# Types of messages that describe the log itself.
DESCRIPTIVE: Final = ("FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG", "FILE", "VER")


@dataclass(frozen=True)
class Messages(Lossless):
    """The messages of one type, of one instance where a vehicle has several of a kind (``IMU[1]``)."""

    reader: Any
    type: str
    instance: tuple[str, int] | None
    name: str
    columns: tuple[str, ...]
    clock: TimeColumn | None = OWN
    first_row: int = 1

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The fields, scaled by the factors of the log."""
        found: dict[str, list[float | int]] = {n: [] for n in names}

        def take(message: object) -> None:
            if self.instance is None or getattr(message, self.instance[0]) == self.instance[1]:
                for n, values in found.items():
                    values.append(getattr(message, n))

        _each(self.reader, self.type, self.name, take)
        return {n: pl.Series(n, v, dtype=pl.UInt64 if n == CLOCK else pl.Float64) for n, v in found.items()}


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
    base = dfreader.DFReader_binary
    # The quicker index of the package is compiled and writes past any silence.
    quiet: Any = type("Quiet", (base,), {"init_arrays_fast": base.init_arrays})
    reader = quiet.__new__(quiet)
    stack.callback(_close, reader)
    try:
        with _silence():
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
        seen: set[int] = set()
        _each(reader, layout.name, name, lambda m, key=key, seen=seen: seen.add(getattr(m, key)))  # type: ignore[misc]
        for each in sorted(seen):
            tables[f"{layout.name}[{each}]"] = Messages(reader, layout.name, (key, each), name, fields)
    if not tables:
        raise IvsidError(f"{name} holds no timed message; give a complete DataFlash log (.bin)")
    return tables


def _close(reader: Any) -> None:
    """Releases the file, also after a fault in the reader's construction."""
    for part in ("data_map", "filehandle"):
        # A view in the reader's index keeps the map open; it goes with the reader.
        with contextlib.suppress(BufferError):
            if hasattr(reader, part):
                getattr(reader, part).close()


def _each(reader: Any, kind: str, name: str, take: Callable[[object], None]) -> None:
    """Calls ``take`` with every message of a type."""
    reader.rewind()
    try:
        with _silence():
            while (message := reader.recv_match(type=kind, strict=True)) is not None:
                take(message)
    except Exception as error:
        raise _damaged(name, error) from None


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """Drops the reader's remarks on skipped bytes: a log that ends in the middle of a message is usual."""
    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        yield


def _damaged(name: str, error: Exception) -> IvsidError:
    words = (str(error).splitlines() or [type(error).__name__])[0]
    return IvsidError(f"{name} is not a readable DataFlash log ({words}); download it from the vehicle again")
