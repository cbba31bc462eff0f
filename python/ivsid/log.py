"""Logs: CSV or Parquet, plain or gzip, as checked columns in SI units (INTERFACE.md)."""

from __future__ import annotations

import gzip
import hashlib
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid import units
from ivsid.errors import IvsidError
from ivsid.vehicle import Column, LogMap

COLUMNS: Final = (
    *("u", "v", "r", "udot", "vdot", "rdot", "ax", "ay", "psi", "x", "y"),
    *("force_X", "force_Y", "moment_N", "wind_speed", "wind_direction"),
    *("qw", "qx", "qy", "qz", "velocity_north", "velocity_east", "depth", "voltage"),
)
# What a turn of the body axes from forward-left-up to forward-right-down does; earth axes are handled apart.
_FLU_FLIPPED: Final = ("v", "r", "vdot", "rdot", "ay", "force_Y", "moment_N")
MISSING: Final = ("", "nan", "NaN", "NAN", "null")
# A needed channel may be slow or drop out, but not be away for most of the log.
LIMIT_MISSING: Final = 0.5
EPOCH: Final = 1e6
# Decimals kept of a large stamp: 23 digits are left before the point.
DECIMALS: Final = 15


@dataclass(frozen=True)
class Log:
    """A checked log.

    Attributes:
        name: of the file.
        sha256: hash of its bytes.
        t: times [s], strictly increasing, shape (n,); from the first row where the file's are epochs or not in seconds.
        columns: the contract's columns, shape (n,) each; NaN is a missing sample.
        ignored: names of columns that were not understood.
        notes: sentences about what is missing, held or uneven; never silently mended.
        rounding: what a conversion of a column may have lost, shape (n,), beside the reading of its decimals.
        time_rounding: the same for the times [s].
    """

    name: str
    sha256: str
    t: NDArray[np.float64]
    columns: Mapping[str, NDArray[np.float64]]
    ignored: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=())
    rounding: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    time_rounding: float = 0.0

    @property
    def period(self) -> float:
        """The median step of time [s]."""
        return float(np.median(np.diff(self.t)))

    @property
    def time_error(self) -> float:
        """How far a time may be from what its decimals say [s]."""
        return float(np.spacing(np.abs(self.t).max())) + self.time_rounding

    def error(self, name: str) -> NDArray[np.float64]:
        """How far each value of a column may be from what its decimals say; 0 where it is missing."""
        values = np.nan_to_num(self.columns[name])
        lost: NDArray[np.float64] = np.spacing(np.abs(values)) + self.rounding.get(name, 0.0)
        return lost

    def column(self, name: str, why: str) -> NDArray[np.float64]:
        """A column that is needed, or one sentence that says so."""
        if name not in self.columns:
            has = ", ".join(self.columns) or "none that is known"
            raise IvsidError(
                f"{self.name} has no column {name}, which is needed {why}; it has {has}: "
                "add it, or map it under [log] in the vehicle file"
            )
        values = self.columns[name]
        longest, at = _longest_run(np.isnan(values))
        if longest > LIMIT_MISSING * values.size:
            raise IvsidError(
                f"{self.name}: column {name} misses {longest} samples in a row from t = {self.t[at]:.6g} s, more than half of the "
                f"log, and is needed {why}; cut the log to the part that has it, or give another log"
            )
        return values


def read_table(path: str | Path) -> tuple[pl.DataFrame, str]:
    """Any CSV or Parquet file (plain or gzip) and the SHA-256 of its bytes; cells stay as they are.

    Raises:
        IvsidError: an unreadable, empty, binary or ragged file.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise IvsidError(
            f"log {path} cannot be read ({error.strerror}); give the path of a CSV or Parquet file"
        ) from None
    digest = hashlib.sha256(data).hexdigest()
    if data[:2] == b"\x1f\x8b":
        try:
            data = gzip.decompress(data)
        except (OSError, EOFError):
            raise IvsidError(f"{path} is a damaged gzip file; copy it again") from None
    if not data.strip():
        raise IvsidError(f"log {path} is empty; it needs a header row and samples")
    try:
        if data[:4] == b"PAR1":
            return pl.read_parquet(io.BytesIO(data)), digest
        text = _text(data, path)
        if "," not in text.split("\n", 1)[0] and text.count("\n") > 0 and not _single_column(text):
            raise IvsidError(f"{path} has no comma in its header; a log is comma-separated with a header row")
        frame = pl.read_csv(
            io.StringIO(text), infer_schema=False, null_values=list(MISSING), truncate_ragged_lines=False
        )
    except pl.exceptions.PolarsError as error:
        first = str(error).splitlines()[0]
        raise IvsidError(f"{path} is not a readable CSV or Parquet table ({first}); mend or export it again") from None
    names = [c.strip() for c in frame.columns]
    twice = next((n for n in names if names.count(n) > 1 or re.search(r"_duplicated_\d+$", n)), None)
    if twice is not None:
        raise IvsidError(
            f"{path} has the column {re.sub(r'_duplicated_[0-9]+$', '', twice)} more than once; each needs its own name"
        )
    return frame.rename(dict(zip(frame.columns, names, strict=True))), digest


def _text(data: bytes, path: Path) -> str:
    if b"\x00" in data[:65536]:
        raise IvsidError(f"{path} is a binary file, not CSV or Parquet; export the log as CSV first")
    for encoding in ("utf-8-sig", "latin-1"):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        printable = sum(c.isprintable() or c in "\r\n\t" for c in text[:4096])
        if printable >= 0.98 * min(len(text), 4096):
            return text
    raise IvsidError(f"{path} is a binary file, not CSV or Parquet; export the log as CSV first")


def _single_column(text: str) -> bool:
    second = text.split("\n", 2)[1]
    return not any(separator in second for separator in (";", "\t", " "))


def numeric(frame: pl.DataFrame, name: str, source: str) -> NDArray[np.float64]:
    """A column as float64 with NaN for missing cells, or a sentence about the first cell that is no number."""
    series = frame[name]
    if series.dtype == pl.String:
        series = series.str.strip_chars()
        series = series.set(series.is_in(list(MISSING)).fill_null(False), None)
        parsed = series.cast(pl.Float64, strict=False)
        bad = (parsed.is_null() & series.is_not_null()).arg_true()
        if len(bad):
            row = int(bad[0])
            raise IvsidError(f"{source}: column {name} holds '{series[row]}' in row {row + 2}, which is no number")
        series = parsed
    try:
        values = series.cast(pl.Float64).to_numpy().astype(np.float64)
    except pl.exceptions.PolarsError:
        raise IvsidError(f"{source}: column {name} is of type {series.dtype}, not numbers") from None
    if np.isinf(values).any():
        row = int(np.argmax(np.isinf(values)))
        raise IvsidError(f"{source}: column {name} is infinite in row {row + 2}; leave missing samples empty")
    return values


def read_log(path: str | Path, mapping: LogMap | None = None) -> Log:
    """Reads a log; ``mapping`` is the ``[log]`` section of a vehicle file.

    Raises:
        IvsidError: what is wrong with the file, in one sentence.
    """
    mapping = mapping or LogMap()
    if isinstance(mapping.columns.get("t"), Column):
        raise IvsidError(
            '[log] columns maps t with a table; write time = { from = "...", unit = "..." } under [log] instead'
        )
    frame, digest = read_table(path)
    source = str(path)
    time = mapping.time.from_ if mapping.time else _name_of(mapping, "t")
    if time not in frame.columns:
        raise IvsidError(f"{source} has no column {time} for the time; it has {', '.join(frame.columns[:12])}")
    scale = units.factor(mapping.time.unit, units.TIME, "the time column") if mapping.time else 1.0
    t, time_rounding = _since_start(frame, time, source, scale)
    _check_clock(t, source)
    columns: dict[str, NDArray[np.float64]] = {}
    rounding: dict[str, NDArray[np.float64]] = {}
    used = {time}
    for wanted in _wanted(frame, mapping):
        rule = mapping.columns.get(wanted, wanted)
        column = rule if isinstance(rule, Column) else Column.model_validate({"from": rule})
        if column.from_ not in frame.columns:
            if wanted in mapping.columns:
                raise IvsidError(f"{source} has no column {column.from_}, which [log] maps to {wanted}")
            continue
        used.add(column.from_)
        values = numeric(frame, column.from_, source)
        if column.factor != 1.0 or column.offset != 0.0:
            scaled = values * column.factor
            values = scaled + column.offset
            # Three roundings (factor, product, sum), each of half a unit of the larger operand.
            rounding[wanted] = 4 * np.spacing(np.abs(np.nan_to_num(scaled)) + abs(column.offset))
        columns[wanted] = values
    if mapping.frame == "flu":
        columns = _turned(columns)
    columns, notes = _without_held(columns)
    notes += _missing(columns, t, source)
    ignored = tuple(c for c in frame.columns if c not in used)
    return Log(Path(path).name, digest, t, columns, ignored, tuple(notes), rounding, time_rounding)


def _name_of(mapping: LogMap, column: str) -> str:
    rule = mapping.columns.get(column, column)
    return rule.from_ if isinstance(rule, Column) else rule


def _wanted(frame: pl.DataFrame, mapping: LogMap) -> list[str]:
    known = [c for c in COLUMNS if c in frame.columns or c in mapping.columns]
    demands = [c for c in (*frame.columns, *mapping.columns) if c.startswith("demand_")]
    unknown = [c for c in mapping.columns if c not in COLUMNS and c != "t" and not c.startswith("demand_")]
    if unknown:
        raise IvsidError(f"[log] columns maps '{unknown[0]}', which is no column of a log; see the table of columns")
    return list(dict.fromkeys([*known, *demands]))


def _since_start(frame: pl.DataFrame, name: str, source: str, scale: float) -> tuple[NDArray[np.float64], float]:
    """Times [s] and what was lost. Large stamps (epochs) have too few digits left in a double: they count from the first row."""
    stamps = numeric(frame, name, source)
    if stamps.size == 0 or not (abs(stamps[0]) > EPOCH or scale != 1.0):
        return stamps, 0.0
    series = frame[name]
    kind = pl.Decimal(38, DECIMALS)
    try:
        exact = series.str.strip_chars().cast(kind) if series.dtype == pl.String else series.cast(kind)
        difference, lost = (exact - exact[0]).cast(pl.Float64).to_numpy(), 2 * 10.0**-DECIMALS
    except pl.exceptions.PolarsError:
        difference, lost = stamps - stamps[0], 2 * float(np.spacing(np.nanmax(np.abs(stamps))))
    t = np.asarray(difference * scale, dtype=np.float64)
    return t, scale * lost + 2 * float(np.spacing(np.nanmax(np.abs(t))))


def _check_clock(t: NDArray[np.float64], source: str) -> None:
    if t.size < 2:
        raise IvsidError(f"{source} has {t.size} row{'s' * (t.size != 1)}; at least 2 samples are needed")
    if np.isnan(t).any():
        row = int(np.argmax(np.isnan(t)))
        raise IvsidError(f"{source}: the time is missing in row {row + 2}; every row needs one")
    steps = np.diff(t)
    if (steps <= 0).any():
        row = int(np.argmax(steps <= 0))
        raise IvsidError(
            f"{source}: time goes from {t[row]:.6g} s to {t[row + 1]:.6g} s at row {row + 3}; it must increase strictly: "
            "sort the log or drop repeated rows"
        )


def _turned(columns: dict[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Forward-left-up body and east-north-up earth axes (REP 103) to forward-right-down and north-east-down."""
    turned = {k: (-c if k in _FLU_FLIPPED else c) for k, c in columns.items()}
    if "psi" in columns:
        turned["psi"] = np.pi / 2 - columns["psi"]
    if "x" in columns and "y" in columns:
        turned["x"], turned["y"] = columns["y"], columns["x"]
    return turned


def _without_held(columns: dict[str, NDArray[np.float64]]) -> tuple[dict[str, NDArray[np.float64]], list[str]]:
    """Held values are not measurements: where a channel repeats each value as a rule, repeats become missing samples."""
    notes, kept = [], dict(columns)
    for name in ("u", "v", "r", "udot", "vdot", "rdot", "ax", "ay", "x", "y"):
        values = columns.get(name)
        if values is None:
            continue
        there = np.flatnonzero(np.isfinite(values))
        repeated = np.zeros(values.shape, dtype=bool)
        repeated[there[1:]] = values[there[1:]] == values[there[:-1]]
        runs = np.diff(np.flatnonzero(~repeated[there]))
        if not _held(runs):
            continue
        kept[name] = np.where(repeated, np.nan, values)
        if np.median(runs) >= 2:
            notes.append(
                f"{name} holds each value over {runs.mean():.3g} rows; only the first of each run is a measurement"
            )
        else:
            notes.append(f"{name} repeats its value in {int(repeated.sum())} rows, which are not taken as measurements")
    return kept, notes


def _held(runs: NDArray[np.int64]) -> bool:
    """Whether runs of equal values are those of a slower sensor: long as a rule, or of two neighbouring lengths only.

    A coarse but live channel repeats by chance, with runs of any length; one value for ever is a vehicle at rest.
    """
    if runs.size < 4 or runs.max() < 2:
        return False
    return bool(np.median(runs) >= 2 or runs[1:].max() - runs[1:].min() <= 1)


def _longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Length and start of the longest stretch of true values; (0, 0) where there is none."""
    edges = np.flatnonzero(np.diff(np.r_[0, flags.astype(int), 0]))
    if not edges.size:
        return 0, 0
    lengths = edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(lengths[longest]), int(edges[2 * longest])


def _missing(columns: dict[str, NDArray[np.float64]], t: NDArray[np.float64], source: str) -> list[str]:
    notes = []
    for name, values in columns.items():
        gone = np.isnan(values)
        if gone.all():
            raise IvsidError(f"{source}: column {name} has no sample at all; fill it or leave the column out")
        if gone.any():
            notes.append(
                f"{name} misses {int(gone.sum())} of {gone.size} samples, at most {_longest_run(gone)[0]} in a row"
            )
    steps = np.diff(t)
    gaps = steps > 2.5 * np.median(steps)
    if gaps.any():
        notes.append(f"{int(gaps.sum())} gaps in time, the longest {steps.max():.3g} s; nothing is filled in")
    return notes
