"""A log however it is given: checked, by its path, or as a table in memory."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import Protocol, TypeAlias

import numpy as np
import polars as pl
from numpy.typing import ArrayLike, NDArray

from ivsid.errors import IvsidError
from ivsid.files.log_map import LogMap
from ivsid.files.processor import check_rounding
from ivsid.log.long_tables import split
from ivsid.log.reader import read_log, read_source
from ivsid.log.record import Log
from ivsid.log.source import Frame, Source


class Columns(Protocol):
    """A column of a table in memory, such as a series of pandas."""

    def to_numpy(self) -> NDArray[np.generic]:
        """Its cells."""


class TableInMemory(Protocol):
    """A table with named columns, such as a data frame of pandas."""

    @property
    def columns(self) -> Iterable[str]:
        """Names of the columns."""

    def __getitem__(self, name: str, /) -> Columns:
        """A column."""


GivenLog: TypeAlias = Log | str | os.PathLike[str] | pl.DataFrame | TableInMemory | Mapping[str, ArrayLike]


def log_of(given: GivenLog, mapping: LogMap | None = None) -> Log:
    """The checked log.

    Args:
        given: a checked log, the path of one, or a table in memory: a data frame of Polars or pandas, or arrays by name, with the columns that
            a file would have.
        mapping: the section ``[log]`` of a vehicle file; a checked log has been mapped.

    Raises:
        IvsidError: the first fault of the log, in one sentence.
    """
    check_rounding()
    if isinstance(given, Log):
        return given
    if isinstance(given, str | os.PathLike):
        return read_log(Path(given), mapping)
    frame = _frame(given)
    digest: Future[str] = Future()
    digest.set_result(_hash(frame))
    table = Frame(frame, first_row=0)
    return read_source(Source("the table", split(table) or {"": table}, digest), mapping or LogMap())


def _frame(given: object) -> pl.DataFrame:
    """A table in memory as a data frame of Polars."""
    if isinstance(given, pl.DataFrame):
        return given
    if isinstance(given, Mapping):
        columns = {str(name): np.asarray(values) for name, values in given.items()}
    elif hasattr(given, "columns") and hasattr(given, "__getitem__"):
        columns = {str(name): given[name].to_numpy() for name in given.columns}
    else:
        raise IvsidError(
            f"a log is given as {type(given).__name__}; give its path, a data frame of Polars or pandas, or arrays by name"
        )
    sizes = {name: values.shape for name, values in columns.items()}
    if len(set(sizes.values())) > 1 or any(len(s) != 1 for s in sizes.values()):
        shown = ", ".join(f"{n} {s}" for n, s in list(sizes.items())[:6])
        raise IvsidError(
            f"the columns of the table have the shapes {shown}; each needs one dimension, and the same length"
        )
    return pl.DataFrame(columns)


def _hash(frame: pl.DataFrame) -> str:
    """SHA-256 of the names and cells of a table."""
    digest = hashlib.sha256()
    for name in frame.columns:
        digest.update(f"|{name}|{frame[name].dtype}|".encode())
        cells = frame[name].to_numpy()
        digest.update(cells.tobytes() if cells.dtype.kind in "fiubM" else repr(frame[name].to_list()).encode())
    return digest.hexdigest()
