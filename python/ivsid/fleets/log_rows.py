"""Interval rows that know their log, as they travel between processes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, Term
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.rows import ROW_KINDS, RegressionRows
from ivsid.verification.result import Stored


@dataclass(frozen=True)
class LogRows:
    """Rows of one or several logs, m of them in n parameters.

    Attributes:
        log: number of the log of each row, shape (m,).
        lower: least coefficients, shape (m, n).
        upper: largest coefficients, shape (m, n).
        low: least right-hand sides, shape (m,) [N or N m].
        high: largest right-hand sides, shape (m,).
        channel: index into ``CHANNELS``, shape (m,).
        kind: index into ``ROW_KINDS``, shape (m,).
        time: start of each row [s], shape (m,).
        duration: length of the window of each row [s], shape (m,).
    """

    log: NDArray[np.int64]
    lower: FloatArray
    upper: FloatArray
    low: FloatArray
    high: FloatArray
    channel: NDArray[np.int64]
    kind: NDArray[np.int64]
    time: FloatArray
    duration: FloatArray

    @property
    def count(self) -> int:
        """The number of rows."""
        return int(self.log.size)

    @property
    def nbytes(self) -> int:
        """Size of all arrays in bytes."""
        return sum(int(getattr(self, f.name).nbytes) for f in fields(self))

    def take(self, rows: NDArray[np.bool_] | NDArray[np.int64]) -> LogRows:
        """Some of the rows, by flags or indices."""
        return LogRows(*(getattr(self, f.name)[rows] for f in fields(self)))

    def names(self) -> list[tuple[int, int, int, float, float]]:
        """Log, kind, channel, start and length of each row, which name it."""
        columns = (self.log, self.kind, self.channel, self.time, self.duration)
        return list(zip(*(c.tolist() for c in columns), strict=True))

    def regression(self, terms: Sequence[Term]) -> RegressionRows:
        """The rows as those of a regression."""
        return RegressionRows(
            tuple(terms),
            IntervalArray(self.lower, self.upper),
            IntervalArray(self.low, self.high),
            self.channel,
            self.time,
            self.duration,
            self.kind,
            (),
        )


def of_regression(rows: RegressionRows, log: int) -> LogRows:
    """The rows of one log."""
    return LogRows(
        np.full(rows.time.size, log, dtype=np.int64),
        np.ascontiguousarray(rows.matrix.lower),
        np.ascontiguousarray(rows.matrix.upper),
        np.ascontiguousarray(rows.right.lower),
        np.ascontiguousarray(rows.right.upper),
        rows.channel,
        rows.kind,
        rows.time,
        rows.duration,
    )


def empty(columns: int) -> LogRows:
    """No rows."""
    whole, number = np.zeros(0, dtype=np.int64), np.zeros(0)
    return LogRows(whole, np.zeros((0, columns)), np.zeros((0, columns)), number, number, whole, whole, number, number)


def joined(parts: Sequence[LogRows]) -> LogRows:
    """The rows of all parts in their order; at least one part is needed."""
    return LogRows(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(LogRows)))


def distinct(rows: LogRows) -> LogRows:
    """Each row once, at the place where it stands first."""
    first: dict[tuple[int, int, int, float, float], int] = {}
    for k, name in enumerate(rows.names()):
        first.setdefault(name, k)
    return rows if len(first) == rows.count else rows.take(np.array(list(first.values()), dtype=np.int64))


def of_block(rows: LogRows, columns: Sequence[int], *, first: bool) -> LogRows:
    """The rows that hold a column of a block; the first block also has the rows without any parameter."""
    held = (rows.lower != 0) | (rows.upper != 0)
    mine = held[:, list(columns)].any(axis=1)
    if first:
        mine |= ~held.any(axis=1)
    return rows if mine.all() else rows.take(mine)


def with_rows(certificates: Sequence[Stored], row: Callable[[Stored], dict[str, object]]) -> list[dict[str, object]]:
    """Certificates as records, each row of which is replaced."""
    made = []
    for c in certificates:
        each = dict(c)
        if "rows" in c:
            each["rows"] = [row(r) for r in c["rows"]]
        else:
            each["columns"] = [{**column, "rows": [row(r) for r in column["rows"]]} for column in c["columns"]]
        made.append(each)
    return made


def of_certificates(certificates: Sequence[Stored], ids: Sequence[str], log: int) -> LogRows:
    """The rows of a log's certificates.

    Args:
        certificates: as in result.json of an identification.
        ids: of the parameters, in the order of the columns.
        log: number of the log.
    """
    place = {id_: j for j, id_ in enumerate(ids)}
    found: dict[tuple[object, ...], tuple[Stored, list[int]]] = {}
    for c in certificates:
        columns = [place[i] for i in c["orthant"]]
        listed = c["rows"] if "rows" in c else [r for column in c["columns"] for r in column["rows"]]
        for r in listed:
            found.setdefault((r["kind"], r["channel"], r["time"], r["duration"]), (r, columns))
    if not found:
        return empty(len(ids))
    m = len(found)
    lower, upper, right = np.zeros((m, len(ids))), np.zeros((m, len(ids))), np.zeros((2, m))
    for k, (r, columns) in enumerate(found.values()):
        lower[k, columns] = [float.fromhex(x) for x in r["lower"]]
        upper[k, columns] = [float.fromhex(x) for x in r["upper"]]
        right[:, k] = [float.fromhex(x) for x in r["right"]]
    rows = [r for r, _ in found.values()]
    return LogRows(
        np.full(m, log, dtype=np.int64),
        lower,
        upper,
        right[0],
        right[1],
        np.array([CHANNELS.index(r["channel"]) for r in rows], dtype=np.int64),
        np.array([ROW_KINDS.index(r["kind"]) for r in rows], dtype=np.int64),
        np.array([float(r["time"]) for r in rows]),
        np.array([float(r["duration"]) for r in rows]),
    )
