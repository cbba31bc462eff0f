"""Logs as files, and the quality of their channels as a table."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.log import Log, Quality
from ivsid.report import page
from ivsid.report.page import Part
from ivsid.report.series import ALIKE, Line, Panel, series

# Axes of a log's channels, with their units.
MEASURED: Final = (
    ("velocities", "m/s", ("u", "v")),
    ("yaw rate", "rad/s", ("r",)),
    ("accelerations", "m/s²", ("ax", "ay", "udot", "vdot")),
    ("position", "m", ("x", "y")),
    ("heading", "rad", ("psi",)),
)


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


def log_series(log: Log, name: str = "log") -> Part:
    """The channels of a log as measured: demands, velocities, accelerations, or the first ones where it has none of these."""
    groups = [
        ("demands", [c for c in log.columns if c.startswith("demand_")]),
        *((f"{what} [{unit}]", [c for c in names if c in log.columns]) for what, unit, names in MEASURED),
    ]
    groups = [g for g in groups if g[1]] or [("channels", list(log.columns))]
    panels = [
        Panel(title, tuple(Line(c, role, log.columns[c]) for c, role in zip(names, cycle(ALIKE), strict=False)))
        for title, names in groups
    ]
    caption = f"{log.t.size} samples as measured, median step {log.period:.4g} s."
    return series(name, f"The log {log.name}", caption, log.t, panels)


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
