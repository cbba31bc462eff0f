"""Logs in JSON: one value, or a value a line. Decimals stay text, so that an epoch keeps its digits."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.files.parsed import DEEPEST, TOO_DEEP
from ivsid.log.json_tables import tables_of
from ivsid.log.source import Table

# Bytes of a JSON log: its values are in memory, with thirty times their text.
# Source: resource: 8 GB
MOST_JSON: Final = 1 << 28
# Blanks in front of a value that are looked through.
# Source: definition: a file begins with its value
BEGINNING: Final = 4096
ENDINGS: Final = (".json", ".jsonl", ".ndjson")


def is_json(path: Path, name: str) -> bool:
    """Whether a file holds JSON: its first value is a table, or a list whose first item is one, a list or a number."""
    with path.open("rb") as file:
        first = file.read(BEGINNING).removeprefix(b"\xef\xbb\xbf").lstrip()
    if not first.startswith((b"{", b"[")):
        return False
    if name.lower().removesuffix(".gz").endswith(ENDINGS) or first.startswith(b"{"):
        return True
    # A header such as [s],[m/s] begins with a bracket, too.
    inside = first[1:].lstrip()
    return inside.startswith((b"{", b"[", b'"'))


def open_json(path: Path, name: str) -> Mapping[str, Table]:
    """The tables of a JSON log.

    Raises:
        IvsidError: too large, damaged or nested too deeply, or no samples.
    """
    if path.stat().st_size > MOST_JSON:
        raise IvsidError(
            f"{name} holds {path.stat().st_size:,} bytes of JSON, and at most {MOST_JSON:,} are read; turn it into CSV or Parquet first"
        )
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise IvsidError(f"{name} is no text in UTF-8, as JSON is; export it again") from None
    try:
        values = list(_lines(text, name)) if _by_line(text) else [_value(text)]
    except RecursionError:
        raise IvsidError(f"{name}: {TOO_DEEP}") from None
    except ValueError as error:
        if isinstance(error, IvsidError):
            raise
        raise IvsidError(
            f"{name} is no readable JSON ({error}); if it breaks off there, copy the file again, or end it behind its last whole value"
        ) from None
    if any(_deep(v) for v in values):
        raise IvsidError(f"{name}: {TOO_DEEP}")
    return tables_of(values if len(values) > 1 else values[0], name)


def _value(text: str) -> object:
    value: object = json.loads(text, parse_float=str, parse_constant=str)
    return value


def _by_line(text: str) -> bool:
    """Whether the first line is a whole value, and another follows."""
    first, _, rest = text.strip().partition("\n")
    if not rest.strip():
        return False
    try:
        return isinstance(_value(first), dict | list)
    except ValueError:
        return False


def _lines(text: str, name: str) -> Iterator[object]:
    """The value of every line.

    Raises:
        IvsidError: a line that is none.
    """
    for number, line in enumerate(text.split("\n"), 1):
        if line.strip():
            try:
                yield _value(line)
            except ValueError as error:
                raise IvsidError(
                    f"{name}: line {number} is no readable JSON ({error}); mend or remove that line: the last one of a log may be cut off"
                ) from None


def _deep(value: object) -> bool:
    """Whether tables and lists stand in each other too deeply."""
    level = [value]
    for _ in range(DEEPEST):
        level = [x for v in level for x in (v.values() if isinstance(v, dict) else v if isinstance(v, list) else ())]
        level = [x for x in level if isinstance(x, dict | list)]
        if not level:
            return False
    return True
