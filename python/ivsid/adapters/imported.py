"""The content of a data set: logs, thrust tables, facts and notes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.errors import IvsidError

Array = NDArray[np.float64]
Content = TypeVar("Content")


@dataclass(frozen=True)
class Part:
    """A log of a data set.

    Attributes:
        t: times [s], shape (n,).
        columns: channels by ivsid's names, shape (n,) each; NaN is a missing sample.
        notes: samples that were left out, and why.
    """

    t: Array
    columns: Mapping[str, Array]
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The log as CSV; the decimals read back as the same doubles, and a missing sample is an empty cell."""
        frame = pl.DataFrame({"t": self.t, **self.columns})
        return frame.with_columns(pl.all().fill_nan(None)).write_csv()


@dataclass(frozen=True)
class Table:
    """A bollard-pull table.

    Attributes:
        demand: shape (n,).
        thrust: mean over the run of each demand [N], shape (n,).
        demand_name: header of its column.
        notes: points that were left out, and why.
    """

    demand: Array
    thrust: Array
    demand_name: str = "demand"
    notes: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The table as CSV, for ``ivsid thrust``."""
        return pl.DataFrame({self.demand_name: self.demand, "thrust (N)": self.thrust}).write_csv()


@dataclass(frozen=True)
class Imported:
    """The content of a data set.

    Attributes:
        title: of the set.
        logs: by file name without ending.
        tables: bollard pulls, likewise.
        others: further CSV tables: columns by name.
        vehicle: name of its vehicle file in the package; None where the set has no vehicle.
        facts: numbers read off the set, for result.json; none of them is a bound.
        notes: facts that a user has to know before using the files.
        inputs: name and SHA-256 of every file that was read.
    """

    title: str
    logs: Mapping[str, Part] = field(default_factory=dict)
    tables: Mapping[str, Table] = field(default_factory=dict)
    others: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    vehicle: str | None = None
    facts: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    inputs: tuple[tuple[str, str], ...] = ()


def files_in(folder: Path, patterns: Sequence[str], title: str, origin: str) -> list[list[Path]]:
    """The files of a folder by pattern, at least one for each.

    Args:
        folder: given by the user.
        patterns: of file names below it.
        title: of the set, for messages.
        origin: source of the set, for messages.

    Raises:
        IvsidError: the folder or a kind of file is missing.
    """
    if not folder.is_dir():
        raise IvsidError(f"{folder} is not a folder; give the folder of {title}, which can be had from {origin}")
    found = [sorted(folder.glob(p)) for p in patterns]
    for pattern, files in zip(patterns, found, strict=True):
        if not files:
            raise IvsidError(f"{folder} has no {pattern}; give the folder of {title}, which can be had from {origin}")
    return found


def files_below(folder: Path, endings: Sequence[str], title: str, origin: str) -> tuple[list[list[Path]], list[str]]:
    """The files at any depth of a folder by ending, each content once, and a note for every copy.

    Args:
        folder: given by the user.
        endings: of file names, as ".mat", in small letters.
        title: of the set, for messages.
        origin: source of the set, for messages.

    Raises:
        IvsidError: the folder is missing.
    """
    if not folder.is_dir():
        raise IvsidError(f"{folder} is not a folder; give the folder of {title}, which can be had from {origin}")
    first: dict[str, Path] = {}
    found: list[list[Path]] = [[] for _ in endings]
    notes = []
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and p.suffix.lower() in endings):
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        if digest in first:
            notes.append(
                f"{path.relative_to(folder).as_posix()} has the content of {first[digest].relative_to(folder).as_posix()}: read once"
            )
        else:
            first[digest] = path
            found[list(endings).index(path.suffix.lower())].append(path)
    return found, notes


def readable(
    folder: Path, files: Sequence[Path], read: Callable[[Path], Content]
) -> tuple[dict[Path, Content], list[str]]:
    """The content of each file that can be read, and a note for each that cannot.

    Args:
        folder: given by the user; notes name files below it.
        files: to read.
        read: raises IvsidError for a file that is damaged or is none of the set.
    """
    content, notes = {}, []
    for path in files:
        try:
            content[path] = read(path)
        except IvsidError as error:
            reason = str(error).replace(str(path), path.relative_to(folder).as_posix())
            notes.append(f"left out: {reason}")
    return content, notes


def digests(folder: Path, files: Sequence[Path]) -> tuple[tuple[str, str], ...]:
    """Name below the folder and SHA-256 of each file."""
    return tuple((p.relative_to(folder).as_posix(), hashlib.sha256(p.read_bytes()).hexdigest()) for p in files)


def runs(flags: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Lengths of the stretches of true values."""
    edges = np.flatnonzero(np.diff(np.r_[0, flags.astype(np.int8), 0]))
    return np.asarray(edges[1::2] - edges[::2], dtype=np.int64)
