"""Blocks of parameters that share rows: each is solved on its own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Term
from ivsid.identification.certificates import WrongRows, feasible_certificates, wrong_rows
from ivsid.identification.result import Parameter
from ivsid.intervals import FloatArray
from ivsid.linear import regression
from ivsid.memory.pieces import array_pieces, over_pieces, pieces
from ivsid.memory.room import room
from ivsid.rows import RegressionRows


@dataclass(frozen=True)
class Block:
    """Parameters that share rows, and the result of a method for them.

    Attributes:
        columns: indices of the k parameters.
        status: of the method.
        lower: shape (k,), or None without a bound.
        upper: shape (k,), or None without a bound.
        centre: the parameter of least inflation, shape (k,), or None.
        inflation: the smallest factor on all row radii at which a parameter is consistent, or None.
        improper: entries of published inverses with reversed bounds.
        reason: obstacle to a proved result, or None.
        directions: in which the set is unbounded, shape (k,) each.
        certificates: of ``feasible``.
        outliers: rows that must be wrong, where wrong rows are allowed.
    """

    columns: tuple[int, ...]
    status: str
    lower: FloatArray | None
    upper: FloatArray | None
    centre: FloatArray | None
    inflation: float | None
    improper: int
    reason: str | None
    directions: tuple[FloatArray, ...]
    certificates: tuple[dict[str, Any], ...]
    outliers: WrongRows | None = None


def nonzero(rows: RegressionRows) -> list[NDArray[np.bool_]]:
    """The rows with a nonzero entry in each column, shape (m,) each."""
    m, n = rows.matrix.shape
    used = [room(m, np.dtype(np.bool_)) for _ in range(n)]

    def fill(part: slice) -> None:
        held = (rows.matrix.lower[part] != 0) | (rows.matrix.upper[part] != 0)
        for j in range(n):
            used[j][part] = held[:, j]

    over_pieces(pieces(m), fill)
    return used


def _any(used: Sequence[NDArray[np.bool_]], columns: Iterable[int]) -> NDArray[np.bool_]:
    """The rows with a nonzero entry in any of some columns."""
    wanted = list(columns)
    return array_pieces(used[wanted[0]].size, lambda rows: np.logical_or.reduce([used[j][rows] for j in wanted]))


def _meet(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> bool:
    return any((a[p] & b[p]).any() for p in pieces(a.size))


def linked(used: Sequence[NDArray[np.bool_]]) -> list[tuple[int, ...]]:
    """Sets of columns that are linked by common rows; each set can be solved on its own."""
    remaining, blocks = set(range(len(used))), []
    while remaining:
        group = {min(remaining)}
        while True:
            touched = _any(used, group)
            grown = group | {j for j in remaining - group if _meet(used[j], touched)}
            if grown == group:
                break
            group = grown
        remaining -= group
        blocks.append(tuple(sorted(group)))
    return blocks


def solve(
    rows: RegressionRows,
    used: Sequence[NDArray[np.bool_]],
    columns: tuple[int, ...],
    method: str,
    partitions: int,
    allowed: int = 0,
) -> Block:
    """The result of a method for one block.

    Args:
        rows: of the whole model, m of them.
        used: for each column, the rows with a nonzero entry, shape (m,) each.
        columns: of the block.
        method: its name.
        partitions: for inverses that partition.
        allowed: number of rows that may be wrong, for ``feasible``.
    """
    # The first block keeps the rows without any parameter: such a row can falsify the model.
    mine = _any(used, columns)
    if columns[0] == 0:
        mine |= ~_any(used, range(len(used)))
    part = rows.take(mine, columns)
    ids = [t.id for t in part.terms]
    if not part.time.size:
        n = len(columns)
        reason = f"no row holds {', '.join(ids)}"
        if method != "feasible":
            return Block(columns, "not_applicable", None, None, None, None, 0, reason, (), ())
        free = tuple(np.eye(n))
        return Block(columns, "unbounded", np.full(n, -np.inf), np.full(n, np.inf), None, 0.0, 0, reason, free, ())
    if method == "feasible":
        found = regression.feasible_set(part.matrix, part.right, outliers=allowed)
        lower, upper = (found.value.lower, found.value.upper) if found.value is not None else (None, None)
        certificates = feasible_certificates(part, found)
        directions = tuple(found.directions) if found.status == "unbounded" else ()
        return Block(
            columns,
            found.status,
            lower,
            upper,
            found.centre,
            found.inflation,
            0,
            found.reason,
            directions,
            certificates,
            None if not allowed else wrong_rows(part, found),
        )
    if method in regression.LEAST_SQUARES_METHODS:
        solved = regression.least_squares(part.matrix, part.right, method)
        lower, upper = (solved.value.lower, solved.value.upper) if solved.value is not None else (None, None)
        status = solved.status if solved.value is not None else "not_applicable"
        why = f"{', '.join(ids)}: {solved.reason}" if solved.reason else None
        return Block(columns, status, lower, upper, None, None, 0, why, (), ())
    fit = regression.normal_equations(part.matrix, part.right, method, partitions)
    lower, upper = (fit.value.lower, fit.value.upper) if fit.value is not None else (None, None)
    why = f"{', '.join(ids)}: {fit.inverse.reason}" if fit.inverse.reason else None
    return Block(columns, fit.status, lower, upper, None, None, fit.improper, why, (), ())


def parameters_of(terms: Sequence[Term], blocks: Sequence[Block]) -> tuple[dict[str, Parameter], dict[str, float]]:
    """Parameter intervals and the point estimate by id, in the order of the model."""
    parameters: dict[str, Parameter] = {}
    estimate: dict[str, float] = {}
    for j, term in enumerate(terms):
        block = next(b for b in blocks if j in b.columns)
        k = block.columns.index(j)
        if block.lower is not None and block.upper is not None:
            parameters[term.id] = Parameter(float(block.lower[k]), float(block.upper[k]), term.unit, term.symbol)
        if block.status == "enclosed" or block.centre is None:
            if term.id in parameters and np.isfinite(parameters[term.id].midpoint):
                estimate[term.id] = parameters[term.id].midpoint
        else:
            estimate[term.id] = float(block.centre[k])
    return parameters, estimate


def outlier_notes(terms: Sequence[Term], blocks: Sequence[Block]) -> list[str]:
    """Sentences about the rows of each block that must be wrong."""
    notes = []
    for b in blocks:
        if b.outliers is None or not b.outliers["fewest"]:
            continue
        few, sets = b.outliers["fewest"], b.outliers["sets"]
        rows = " and ".join(f"the {r['channel']} row at t = {r['time']:.6g} s" for r in sets[0])
        others = f", or {len(sets) - 1} other choices" if len(sets) > 1 else ""
        notes.append(
            f"at least {few} row{'s' * (few > 1)} of {', '.join(terms[c].id for c in b.columns)} must be wrong; without {rows}{others}, no "
            "contradiction was found"
        )
    return notes


def overall(statuses: Sequence[str]) -> str:
    """The status of all blocks together: ``empty`` where one is empty, since that falsifies the model, else the weakest."""
    for status in ("empty", "not_applicable", "singular", "not_proved", "unbounded"):
        if status in statuses:
            return "not_applicable" if status == "singular" else status
    return "enclosed"
