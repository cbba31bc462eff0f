"""One pass over the rows of some logs: for each point the rows that it violates most.

A scan proposes and proves nothing: a row that it misses leaves a bound wider. It may therefore use plain floats. Products are added
column by column, so that the same rows come back from every machine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.fleets.log_rows import LogRows, empty, joined, of_block
from ivsid.intervals import FloatArray

# Relative size below which a violation counts as rounding.
# Source: definition: the tolerance of the core's own search, crates/interval-core/src/linear_program/pricing.rs
VIOLATION: Final = 1e-13
# Rows that are tried on all points at once.
# Source: resource: the products of a block and forty points stay in the second cache
BLOCK: Final = 2048
# Rows that one point may add from one part of the logs in one pass.
# Source: resource: few, so that the working set stays small
TAKEN: Final = 3


@dataclass(frozen=True)
class Question:
    """Points that are tried on the rows of some logs.

    Attributes:
        points: shape (p, n); one entry serves all logs, or each log has its own.
        logs: numbers of the logs; None for all.
        block: columns of parameters that share rows, and whether they are the first block; the points are tried on its rows. None for all
            rows.
    """

    points: FloatArray | Mapping[int, FloatArray]
    logs: frozenset[int] | None = None
    block: tuple[tuple[int, ...], bool] | None = None

    def of(self, log: int) -> FloatArray | None:
        """The points that are tried on a log; None if it is not asked."""
        if self.logs is not None and log not in self.logs:
            return None
        return self.points[log] if isinstance(self.points, Mapping) else self.points


@dataclass(frozen=True)
class Violated:
    """The rows that the points of one question violate.

    Attributes:
        rows: each once, the largest violations of each point.
        amount: the largest violation that a point has of each row, relative to the terms of the row, shape (m,).
        point: number of that point, shape (m,).
    """

    rows: LogRows
    amount: FloatArray
    point: FloatArray


def scan(parts: Sequence[LogRows], questions: Sequence[Question]) -> list[Violated]:
    """The rows that the points of each question violate most, in some logs.

    Args:
        parts: rows of one log each.
        questions: with the points.
    """
    return [_answer(parts, q) for q in questions]


def _answer(parts: Sequence[LogRows], question: Question) -> Violated:
    found: list[tuple[LogRows, FloatArray, FloatArray]] = []
    for whole in parts:
        points = question.of(int(whole.log[0])) if whole.count else None
        if points is None or not len(points):
            continue
        rows = whole if question.block is None else of_block(whole, question.block[0], first=question.block[1])
        best = _most(rows, points)
        for p, (where, amounts) in enumerate(best):
            if where.size:
                found.append((rows.take(where), amounts, np.full(where.size, float(p))))
    return merged(found, parts[0].lower.shape[1] if parts else 0)


def merged(found: Sequence[tuple[LogRows, FloatArray, FloatArray]], columns: int, taken: int = TAKEN) -> Violated:
    """The largest violations of each point, each row once; rows in the order of their logs and times."""
    if not found:
        return Violated(empty(columns), np.zeros(0), np.zeros(0))
    rows = joined([f[0] for f in found])
    amount, point = np.concatenate([f[1] for f in found]), np.concatenate([f[2] for f in found])
    order = np.lexsort((rows.channel, rows.kind, rows.duration, rows.time, rows.log, -amount, point))
    # The rank of a row among those of its point.
    sorted_points = point[order]
    starts = np.r_[0, np.flatnonzero(np.diff(sorted_points)) + 1]
    rank = np.arange(order.size) - np.repeat(starts, np.diff(np.r_[starts, order.size]))
    kept = order[rank < taken]
    first: dict[tuple[int, int, int, float, float], int] = {}
    names = rows.take(kept).names()
    for k, name in sorted(zip(kept.tolist(), names, strict=True), key=lambda kn: (-amount[kn[0]], kn[1])):
        first.setdefault(name, k)
    chosen = np.array([first[n] for n in sorted(first)], dtype=np.int64)
    return Violated(rows.take(chosen), amount[chosen], point[chosen])


def together(answers: Sequence[Violated], columns: int) -> Violated:
    """Answers of several parts to one question, as one."""
    return merged([(a.rows, a.amount, a.point) for a in answers if a.rows.count], columns, 2 * TAKEN)


def _most(rows: LogRows, points: FloatArray) -> list[tuple[NDArray[np.int64], FloatArray]]:
    """For each point the most violated row of each piece, at most ``TAKEN`` rows, and by how much."""
    p = len(points)
    best: list[list[tuple[float, int]]] = [[] for _ in range(p)]
    for start in range(0, rows.count, BLOCK):
        amount = excess(rows, points, slice(start, start + BLOCK))
        worst = np.argmax(amount, axis=0)
        for k in range(p):
            most = float(amount[worst[k], k])
            if most > VIOLATION:
                best[k].append((-most, start + int(worst[k])))
    out = []
    for each in best:
        each.sort()
        out.append((np.array([i for _, i in each[:TAKEN]], dtype=np.int64), np.array([-a for a, _ in each[:TAKEN]])))
    return out


def excess(rows: LogRows, points: FloatArray, part: slice = slice(None)) -> FloatArray:
    """By how much each point violates each row, relative to the magnitudes of the row's terms, shape (m, p); at most 0 where it holds."""
    lower, upper, low, high = rows.lower[part], rows.upper[part], rows.low[part], rows.high[part]
    m, (p, n) = low.size, points.shape
    middle, radius, size = np.zeros((m, p)), np.zeros((m, p)), np.zeros((m, p))
    for j in range(n):
        c, d = 0.5 * lower[:, j] + 0.5 * upper[:, j], 0.5 * upper[:, j] - 0.5 * lower[:, j]
        x = points[:, j]
        a = np.abs(x)
        middle += c[:, None] * x[None, :]
        radius += d[:, None] * a[None, :]
        size += (np.abs(c) + d)[:, None] * a[None, :]
    above, below = (middle - radius) - high[:, None], low[:, None] - (middle + radius)
    ends = np.maximum(np.where(np.isfinite(low), np.abs(low), 0.0), np.where(np.isfinite(high), np.abs(high), 0.0))
    worst: FloatArray = np.maximum(above, below) / np.maximum(size + ends[:, None], np.finfo(float).tiny)
    return worst
