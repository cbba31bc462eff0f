"""Results as text: JSON whose bounds are rounded outward."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np

from ivsid.files.seal import KEY, seal_of
from ivsid.intervals import outward_decimal


class Lower(float):
    """A number printed rounded down."""


class Upper(float):
    """A number printed rounded up."""


def envelope(
    command: str, inputs: Mapping[str, str] | Sequence[tuple[str, str]], seed: int | None = None
) -> dict[str, Any]:
    """The keys that every result.json starts with.

    Args:
        command: the command of ``ivsid``.
        inputs: names of the input files with their SHA-256.
        seed: of the random numbers, where any were drawn.
    """
    pairs = inputs.items() if isinstance(inputs, Mapping) else inputs
    listed = [{"name": name, "sha256": digest} for name, digest in pairs]
    return {"ivsid": version("ivsid"), "command": command, "inputs": listed, "seed": seed}


def with_own_effects(record: Mapping[str, object], files: Sequence[tuple[str, str]]) -> dict[str, object]:
    """The record with the names and SHA-256 of its user's files of effects; a sealed record is sealed again."""
    if not files:
        return dict(record)
    made = {k: v for k, v in record.items() if k != KEY}
    made["own_effects"] = [{"name": name, "sha256": digest} for name, digest in files]
    return sealed(made) if KEY in record else made


def to_json(value: object, indent: int = 0) -> str:
    """JSON text. Infinite and missing numbers become null: an unbounded end is never a large number.

    Args:
        value: mappings, sequences, NumPy arrays, numbers and text; ``Lower`` and ``Upper`` are rounded outward.
        indent: of the first line, in spaces.

    Raises:
        TypeError: a value of another type.
    """
    pad, inner = "\n" + " " * indent, "\n" + " " * (indent + 1)
    if isinstance(value, (Lower, Upper)):
        return outward_decimal(float(value), up=isinstance(value, Upper)) if math.isfinite(value) else "null"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value)) if math.isfinite(value) else "null"
    if value is None or isinstance(value, (str, int, np.integer)):
        return json.dumps(int(value) if isinstance(value, np.integer) else value)
    if isinstance(value, np.ndarray):
        return to_json(value.tolist(), indent)
    if isinstance(value, Mapping):
        entries = [f"{json.dumps(str(k))}: {to_json(v, indent + 1)}" for k, v in value.items()]
        return "{" + inner + f",{inner}".join(entries) + pad + "}" if entries else "{}"
    if isinstance(value, (list, tuple)):
        entries = [to_json(v, indent + 1) for v in value]
        if all(len(e) < 24 and "\n" not in e for e in entries):
            return "[" + ", ".join(entries) + "]"
        return "[" + inner + f",{inner}".join(entries) + pad + "]"
    raise TypeError(f"a value of type {type(value).__name__} has no place in a result")


def sealed(record: Mapping[str, object]) -> dict[str, object]:
    """The record with the seal of its content, which ``ivsid verify`` compares."""
    return {**record, KEY: seal_of(to_json(record))}
