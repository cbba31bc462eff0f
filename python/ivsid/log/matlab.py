"""MATLAB v4 and v5 files (SciPy): vectors, structs of vectors, and matrices whose rows or columns are channels."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.log.matlab_structure import check_structure
from ivsid.log.source import Frame, Table

# A matrix with at most this many rows, or columns, is a set of channels; a larger one is a picture.
# Source: resource: bounds the columns of a table
CHANNELS: Final = 512
# Depth to which nested structs are searched for channels.
# Source: resource: bounds the recursion
DEPTH: Final = 4


def matlab_variables(path: Path, name: str) -> dict[str, object]:
    """The variables of a MATLAB v4 or v5 file as SciPy gives them, structs as dictionaries.

    Raises:
        IvsidError: a damaged file, or one of MATLAB 7.3.
    """
    # SciPy's readers are slow to import and needed for this format alone.
    from scipy.io import loadmat, matlab  # noqa: PLC0415

    try:
        if matlab.matfile_version(path)[0] == 1:
            check_structure(path)
        content = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        raise IvsidError(
            f"{name} is a MATLAB 7.3 file; save it with the option -v7, or export the log as CSV"
        ) from None
    except (
        matlab.MatReadError,
        OSError,
        ValueError,
        TypeError,
        KeyError,
        EOFError,
        IndexError,
        ArithmeticError,
        AttributeError,
        MemoryError,
        zlib.error,
    ) as error:
        words = (str(error).splitlines() or ["damaged"])[0]
        raise IvsidError(f"{name} is not a readable MATLAB v4 or v5 file ({words}); save it again with -v7") from None
    return {k: v for k, v in content.items() if not k.startswith("__")}


def open_matlab(path: Path, name: str) -> Mapping[str, Table]:
    """The tables of a MATLAB file.

    Vectors at the top level are one table under their own names. A struct is a table of its fields. A matrix gives a column to each
    of its rows, or of its columns where it is taller than wide, counted from 1: ``data(1)``, ``data(2)``.

    Raises:
        IvsidError: a damaged file, one of MATLAB 7.3, or one without a numeric vector or matrix.
    """
    vectors: dict[str, dict[str, NDArray[Any]]] = {}
    for variable, value in matlab_variables(path, name).items():
        if isinstance(value, dict):
            _fields(vectors.setdefault(variable, {}), "", value, DEPTH)
        else:
            _fields(vectors.setdefault("", {}), "", {variable: value}, 1)
    vectors = {table: columns for table, columns in vectors.items() if columns}
    if not vectors:
        raise IvsidError(
            f"{name} holds no numeric vector or matrix (timetables and other objects are not stored as such); "
            "save plain vectors with -v7, or export the log as CSV"
        )
    tables: dict[str, Table] = {}
    for table, columns in vectors.items():
        # Vectors of another length have another clock: they are a table of their own, which [log] columns reach by their names.
        for length in sorted({v.size for v in columns.values()}, reverse=True):
            frame = pl.DataFrame({c: v for c, v in columns.items() if v.size == length})
            tables[table if table not in tables else f"{table}[{length}]"] = Frame(frame, first_row=1)
    return tables if len(tables) > 1 else {"": next(iter(tables.values()))}


def _fields(into: dict[str, NDArray[Any]], prefix: str, value: Mapping[str, object], depth: int) -> None:
    """Adds every numeric vector and matrix below a struct; scalars and words are no channels."""
    for key, inner in value.items():
        where = f"{prefix}.{key}" if prefix else key
        if isinstance(inner, dict) and depth:
            _fields(into, where, inner, depth - 1)
            continue
        if not isinstance(inner, np.ndarray) or inner.dtype.kind not in "fiub":
            continue
        if inner.ndim == 1 and inner.size > 1:
            into[where] = _plain(inner)
        elif inner.ndim == 2 and min(inner.shape) <= CHANNELS:
            rows = inner if inner.shape[0] <= inner.shape[1] else inner.T
            for k, row in enumerate(rows, start=1):
                into[f"{where}({k})"] = _plain(row)


def _plain(values: NDArray[Any]) -> NDArray[Any]:
    """The values in the machine's byte order; integers stay integers, since doubles are too short for stamps of nanoseconds."""
    if values.dtype.kind in "iu":
        return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))
    return values.astype(np.float64)
