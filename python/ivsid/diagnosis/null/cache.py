"""Strengths of null logs on disk, by the content that they follow from: in the user's cache, whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import fields
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.null.calibration import NullTest
from ivsid.effects import own_digest
from ivsid.errors import IvsidError
from ivsid.files.records import sealed, to_json, write_whole
from ivsid.files.seal import KEY, seal_of
from ivsid.vehicle import Vehicle

FOLDER: Final = "null_logs"


def cache_folder() -> Path:
    """Where null logs are kept: ``ivsid/null_logs`` in ``XDG_CACHE_HOME``, or in ``~/.cache``."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "ivsid" / FOLDER


def key_of(vehicle: Vehicle, log: Channels, seed: int, level: float, tested: frozenset[str], threshold: float) -> str:
    """A name that changes with everything that null logs depend on: the vehicle file, the log's content, the seed, the test, the files of own effects, the version."""
    digest = hashlib.sha256()
    said = [version("ivsid"), vehicle.text, seed, level.hex(), sorted(tested), threshold.hex(), own_digest()]
    digest.update(json.dumps(said).encode())
    for field in fields(Channels):
        value = getattr(log, field.name)
        # The name of a log is none of its content.
        if field.name not in ("name", "notes"):
            _feed(digest, field.name, value)
    return digest.hexdigest()


def _feed(digest: Any, name: str, value: Any) -> None:
    if isinstance(value, tuple):
        for k, one in enumerate(value):
            _feed(digest, f"{name}.{k}", one)
        return
    digest.update(f"|{name}|".encode())
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype.str}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    else:
        digest.update(repr(value).encode())


def kept(folder: Path, key: str, level: float) -> NullTest | None:
    """The null logs of a key; None where there are none, or where the file is not as it was written."""
    try:
        record = json.loads((folder / f"{key}.json").read_text())
        seal = record.pop(KEY)
        if seal != seal_of(to_json(record)) or record["key"] != key:
            return None
        strengths = np.array([np.nan if s is None else float.fromhex(s) for s in record["strengths"]])
        passed = np.array(record["passed"], dtype=bool)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return NullTest(strengths, passed, level) if strengths.shape == passed.shape else None


def keep(folder: Path, key: str, test: NullTest) -> None:
    """Writes null logs; a cache that cannot be written is none."""
    strengths = [float(s).hex() if np.isfinite(s) else None for s in test.strengths]
    record = sealed({"key": key, "strengths": strengths, "passed": [bool(p) for p in test.passed]})
    try:
        write_whole(folder / f"{key}.json", to_json(record) + "\n")
    except IvsidError:
        return
