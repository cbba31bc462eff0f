"""Logs as files, and the quality of their channels as a table."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.log import Quality
from ivsid.report import page
from ivsid.report.page import Part


def distinct_names(paths: Sequence[str | Path]) -> list[str]:
    """Names of files: the last part of each path, with as many folders before it as tell the files apart.

    One file that is given twice has one name.
    """
    parts = [Path(p).resolve().parts for p in paths]
    different = set(parts)
    count = next(k for k in range(1, max(map(len, parts)) + 1) if len({p[-k:] for p in different}) == len(different))
    return ["/".join(p[-count:]).replace("//", "/") for p in parts]


def csv(t: NDArray[np.float64], columns: dict[str, NDArray[np.float64]]) -> str:
    """A log as CSV text; the decimals read back as the same doubles."""
    return pl.DataFrame({"t": t, **columns}).write_csv()


def parquet(t: NDArray[np.float64], columns: dict[str, NDArray[np.float64]]) -> bytes:
    """A log as a Parquet file; missing samples are NaN."""
    buffer = io.BytesIO()
    pl.DataFrame({"t": t, **columns}).write_parquet(buffer)
    return buffer.getvalue()


def quality_table(quality: Mapping[str, Quality]) -> Part:
    """Quality of each channel of a log as measured: rates, missing samples, outliers."""
    rows = [
        [n, q.samples, q.rate, q.missing, q.longest, q.held, q.outliers, q.lower, q.upper] for n, q in quality.items()
    ]
    header = [
        "channel",
        "measurements",
        "usual rate [Hz]",
        "rows without",
        "longest wait [s]",
        "held repeats",
        "outliers",
        "smallest",
        "largest",
    ]
    return page.table(header, rows, "Nothing is filled in, and no outlier is taken out.")
