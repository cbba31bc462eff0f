"""Scores of null logs in the user's cache, under a digest of everything that they depend on; a file is written whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import fields
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Final, Protocol

import numpy as np

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.null.tail import NullTest
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import own_digest
from ivsid.errors import IvsidError
from ivsid.files.records import sealed, to_json
from ivsid.files.seal import KEY, seal_of
from ivsid.files.whole import write_whole
from ivsid.vehicle import Vehicle

FOLDER: Final = "null_logs"


class _Digest(Protocol):
    """A hash that takes bytes."""

    def update(self, data: bytes, /) -> None:
        """Adds bytes."""


def cache_folder() -> Path:
    """Folder of the scores of null logs: ``ivsid/null_logs`` in ``XDG_CACHE_HOME``, or in ``~/.cache``."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "ivsid" / FOLDER


def rules_digest(package: str = "ivsid") -> str:
    """SHA-256 of the Python sources of a package and of its compiled module.

    A rule that changes between two releases changes results; the version does not tell the two apart.

    Args:
        package: its name.
    """
    digest = hashlib.sha256()
    folders = [files(package)]
    while folders:
        for one in sorted(folders.pop().iterdir(), key=lambda f: f.name):
            if one.is_dir():
                folders.append(one)
            elif one.name.endswith((".py", ".so", ".pyd")):
                digest.update(f"|{one.name}|".encode() + one.read_bytes())
    return digest.hexdigest()


def key_of(
    vehicle: Vehicle,
    log: Channels,
    seed: int,
    level: float,
    tested: frozenset[str],
    threshold: float,
    model: Hypothesis | None = None,
) -> str:
    """Digest of everything that null logs depend on, 64 hexadecimal digits.

    Args:
        vehicle: whose file counts by its text.
        log: which counts by its content, without its name.
        seed: of the draws.
        level: probability of a false finding.
        tested: ids of the families under test.
        threshold: of the chance by theory.
        model: whose structure is under test, with its causes; None for the plain model under the test of the families.

    The version of the package, its rules (``rules_digest``) and the files of own effects count as well.
    """
    digest = hashlib.sha256()
    said = [
        version("ivsid"),
        rules_digest(),
        vehicle.text,
        seed,
        level.hex(),
        sorted(tested),
        threshold.hex(),
        own_digest(),
    ]
    if model is not None:
        # Causes and all other numbers, as the null logs are simulated from them.
        said += [sorted((i, float(v).hex()) for i, v in model.values.items())]
        said += [[g.effect.id, g.thruster, [float(v).hex() for v in g.values]] for g in model.given]
    digest.update(json.dumps(said).encode())
    for field in fields(Channels):
        value = getattr(log, field.name)
        # The name of a log and its notes are no content.
        if field.name not in ("name", "notes"):
            _feed(digest, field.name, value)
    return digest.hexdigest()


def _feed(digest: _Digest, name: str, value: object) -> None:
    """Adds a named value to a digest: arrays by type, shape and bytes, tuples member by member, other values by their text."""
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
    """Scores of the null logs under a key, or None if there is no file or its seal is broken.

    Args:
        folder: of the cache.
        key: by ``key_of``.
        level: probability of a false finding.
    """
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
    """Writes the scores of null logs under a key. A folder that cannot be written is no error."""
    strengths = [float(s).hex() if np.isfinite(s) else None for s in test.strengths]
    record = sealed({"key": key, "strengths": strengths, "passed": [bool(p) for p in test.passed]})
    try:
        write_whole(folder / f"{key}.json", to_json(record) + "\n")
    except IvsidError:
        return
