"""Results as files: JSON whose bounds are rounded outward, and folders that are written whole or not at all."""

from __future__ import annotations

import json
import math
import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ivsid.errors import IvsidError
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


def write_whole(path: str | Path, data: str | bytes) -> None:
    """Writes a file by renaming a finished one over it, so that no reader sees half of it.

    Raises:
        IvsidError: the path cannot be written.
    """
    path = Path(path)
    content = data.encode() if isinstance(data, str) else data
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise _unwritable(path, error) from None
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except OSError as error:
        Path(name).unlink(missing_ok=True)
        raise _unwritable(path, error) from None


def check_writable(folder: str | Path) -> None:
    """Checks, before any work is done, that an output folder can be written; leaves nothing behind.

    Raises:
        IvsidError: the folder cannot be written.
    """
    folder = Path(folder)
    existing = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not existing.is_dir():
        raise IvsidError(f"output folder {folder} cannot be written ({existing} is a file); choose another with --out")
    try:
        with tempfile.TemporaryFile(dir=existing):
            pass
    except OSError as error:
        raise _unwritable(folder, error) from None


def write_folder(folder: str | Path, files: Mapping[str, str | bytes]) -> None:
    """Writes all files of a result or, where one cannot be written, none.

    Args:
        folder: made where it does not exist.
        files: content by path below the folder.

    Raises:
        IvsidError: the folder or one of its files cannot be written.
    """
    folder = Path(folder)
    check_writable(folder)
    made = next((p for p in reversed((folder, *folder.absolute().parents)) if not p.exists()), None)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(dir=folder, prefix=".ivsid-"))
    except OSError as error:
        raise _unwritable(folder, error) from None
    try:
        for name, data in files.items():
            target = staging / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data.encode() if isinstance(data, str) else data)
        for name in files:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (staging / name).replace(folder / name)
    except OSError as error:
        if made is not None:
            shutil.rmtree(made, ignore_errors=True)
        raise _unwritable(folder, error) from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _unwritable(path: Path, error: OSError) -> IvsidError:
    return IvsidError(f"{path} cannot be written ({error.strerror or error}); choose another folder with --out")
