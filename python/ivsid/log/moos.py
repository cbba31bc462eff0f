"""Logs of MOOS-IvP (.alog): a row for each posting, with its time, variable, source and value. A variable of numbers is a table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import polars as pl

from ivsid.errors import IvsidError
from ivsid.files.log_map import TimeColumn
from ivsid.log.source import Frame, Table

ENDING: Final = ".alog"
# The clock counts from the line LOGSTART of the header.
OWN: Final = TimeColumn.model_validate({"from": "time", "unit": "s"})
# Bytes of a log, whose numbers are in memory.
# Source: resource: 4 GB
MOST_BYTES: Final = 1 << 29


def is_moos(path: Path, name: str) -> bool:
    """Whether a file is a log of MOOS: by its ending, or by the line LOGSTART of its header."""
    if name.lower().removesuffix(".gz").endswith(ENDING):
        return True
    with path.open("rb") as file:
        first = [file.readline(4096) for _ in range(8)]
    return (
        first[0].startswith(b"%%")
        and any(line.startswith(b"%% LOGSTART") for line in first)
        and not _synchronous(first)
    )


def _synchronous(lines: list[bytes]) -> bool:
    """Whether the header ends in the names of columns, as that of an .slog does."""
    return any(line.startswith(b"%% TIME ") for line in lines)


def open_moos(path: Path, name: str) -> Mapping[str, Table]:
    """The variables whose values are numbers.

    Raises:
        IvsidError: too large, or without a variable of two numbers.
    """
    if path.stat().st_size > MOST_BYTES:
        raise IvsidError(
            f"{name} holds {path.stat().st_size:,} bytes, and at most {MOST_BYTES:,} of a log of MOOS are read; take the variables that are needed with `aloggrep`"
        )
    posted: dict[str, tuple[list[str], list[str]]] = {}
    words: set[str] = set()
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in file:
            cells = line.split(None, 3)
            if len(cells) < 4 or line.startswith("%"):
                continue
            time, variable, _, value = cells
            if variable in words:
                continue
            if not _is_number(value):
                words.add(variable)
                posted.pop(variable, None)
                continue
            stamps, values = posted.setdefault(variable, ([], []))
            stamps.append(time)
            values.append(value.strip())
    tables = {
        variable: Frame(pl.DataFrame({"time": stamps, variable: values}), OWN, 1)
        for variable, (stamps, values) in posted.items()
        if len(stamps) > 1
    }
    if not tables:
        raise IvsidError(
            f"{name} holds no variable of MOOS with two numbers; its rows are time, variable, source and value, as pLogger writes them"
        )
    return tables


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
