"""A result.json of ``ivsid identify``, its decimals as exact numbers, checked for its shape."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeAlias

from ivsid.errors import IvsidError
from ivsid.files.seal import KEY, seal_of
from ivsid.vehicle import Vehicle, parse_vehicle
from ivsid.verification.decimals import decimal

# An object of result.json as it was read: nothing is known of its values before they are checked.
Stored: TypeAlias = Mapping[str, Any]


# What every result of a command has.
SHAPES: Final[Mapping[str, tuple[tuple[str, type], ...]]] = {
    "identify": (
        ("vehicle", str),
        ("inputs", list),
        ("method", str),
        ("status", str),
        ("guaranteed", bool),
        ("parameters", dict),
        ("options", dict),
        ("certificates", list),
        ("contradictions", list),
        ("assumes", list),
    ),
    "fleet": (
        ("vehicle", str),
        ("inputs", list),
        ("logs", dict),
        ("guaranteed", bool),
        ("options", dict),
        ("pooled", dict),
        ("drift", dict),
        ("assumes", list),
    ),
}


class DamagedError(Exception):
    """A result that is not as ``ivsid identify`` writes it."""


@dataclass(frozen=True)
class Result:
    """A result with its vehicle.

    Attributes:
        record: the file, its decimals as fractions.
        vehicle: parsed from the text in the record.
        sealed: whether the seal is that of the content.
    """

    record: Stored
    vehicle: Vehicle
    sealed: bool


def read_result(path: str | Path, command: str = "identify") -> Result:
    """Reads a result: its folder, or its result.json.

    Raises:
        IvsidError: the file is missing, is no JSON, or is the result of another command.
        DamagedError: a part that every result of ``ivsid identify`` has is missing or of another kind.
    """
    path = Path(path)
    file = path / "result.json" if path.is_dir() else path
    try:
        text = file.read_text()
    except OSError as error:
        raise IvsidError(
            f"result {file} cannot be read ({error.strerror}); give the --out folder of ivsid identify"
        ) from None
    except UnicodeDecodeError:
        raise IvsidError(f"result {file} is not a text; give the --out folder of ivsid identify") from None
    return parse_result(text, str(file), command)


def is_fleet(path: str | Path) -> bool:
    """Whether a path leads to a result of ``ivsid fleet``."""
    path = Path(path)
    file = path / "result.json" if path.is_dir() else path
    try:
        record = json.loads(file.read_text())
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(record, dict) and record.get("command") == "fleet"


def parse_result(text: str, source: str, command: str = "identify") -> Result:
    """Reads a result from its text; errors as in ``read_result``."""
    try:
        record = json.loads(text, parse_float=decimal, object_pairs_hook=_unique)
        seal = seal_of(text)
    except (ValueError, RecursionError):
        raise IvsidError(f"result {source} is not JSON; give the --out folder of ivsid identify") from None
    if not isinstance(record, dict) or record.get("command") != command:
        raise IvsidError(f"{source} is not the result of ivsid identify; run that first and give its --out folder")
    for key, kind in SHAPES[command]:
        if not isinstance(record.get(key), kind):
            raise DamagedError(f"'{key}' is missing or of another kind")
    try:
        vehicle = parse_vehicle(record["vehicle"], "the vehicle of the result")
    except IvsidError as error:
        raise DamagedError(str(error)) from None
    return Result(record, vehicle, record.get(KEY) == seal)


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key stands twice")
    for text in (x for pair in pairs for x in pair if isinstance(x, str)):
        # Halves of a character cannot be printed; the error is a ValueError.
        text.encode()
    return found
