"""The consistent parameters of a few rows of many logs: proved bounds, and the points that the other rows are tried on.

The rows of a working set are some of all rows, so every bound that they prove holds for the set of all rows, and so does a contradiction
between them. What is left to the search is which rows they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from ivsid.effects import Term
from ivsid.fleets.log_rows import LogRows, of_block, with_rows
from ivsid.identification.certificates import feasible_certificates
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.linear import regression
from ivsid.linear.regression import FeasibleSet
from ivsid.verification.result import Stored

# Half-width of the box in which points are looked for, as a multiple of the values that the rows themselves suggest. The box gives open
# directions a point that can be tried. No bound rests on it.
# Source: definition: far outside of any set that the rows bound, and half of a double's digits are left
BOX: Final = 2.0**20
# Share of a point's size by which it may miss the rows of its basis.
# Source: definition: half of a double's digits; the residual of a basis that is solved is far below, that of a wrong one far above
RESIDUAL: Final = 1e-9


@dataclass(frozen=True)
class Solved:
    """The consistent parameters of a working set.

    Attributes:
        status: ``enclosed``, ``empty``, ``unbounded`` or ``not_applicable``.
        lower: shape (n,); infinite where no bound is proved.
        upper: shape (n,).
        centre: the parameter of least inflation, shape (n,); 0 where no row holds a column.
        inflation: the smallest factor on all radii at which a parameter is consistent; None without one.
        certificates: as in result.json; each row also has the number of its ``log``.
        contradictions: numbers of the blocks that are empty.
        reason: obstacle to a proof, or None.
    """

    status: str
    lower: FloatArray
    upper: FloatArray
    centre: FloatArray
    inflation: float | None
    certificates: tuple[Stored, ...]
    contradictions: tuple[int, ...]
    reason: str | None

    @property
    def empty(self) -> bool:
        """Whether no parameter is consistent."""
        return self.status == "empty"

    @property
    def logs(self) -> tuple[int, ...]:
        """Numbers of the logs whose rows prove the contradiction; of all certificates where there is none."""
        chosen = [
            c
            for c in self.certificates
            if not self.empty or (c["block"] in self.contradictions and c["proves"] in ("empty", "signs"))
        ]
        return tuple(sorted({r["log"] for c in chosen for r in _rows_of(c)}))


def _rows_of(certificate: Stored) -> Iterable[Stored]:
    if "rows" in certificate:
        return list(certificate["rows"])
    return [r for column in certificate["columns"] for r in column["rows"]]


def linked(sets: Iterable[Sequence[int]], columns: int) -> tuple[tuple[int, ...], ...]:
    """The finest blocks of columns that keep each of the given sets together."""
    blocks = [{j} for j in range(columns)]
    for together in sets:
        touched = [b for b in blocks if b & set(together)]
        if len(touched) > 1:
            blocks = [b for b in blocks if b not in touched] + [set().union(*touched)]
    return tuple(sorted(tuple(sorted(b)) for b in blocks))


def _numbered(rows: LogRows, row: Stored) -> dict[str, object]:
    """A row of a certificate with the number of its log in place of its own."""
    return {**{k: v for k, v in row.items() if k != "row"}, "log": int(rows.log[row["row"]])}


def solve(rows: LogRows, terms: Sequence[Term], blocks: Sequence[Sequence[int]]) -> Solved:
    """The proved hull of the consistent parameters of a working set, block by block."""
    n = len(terms)
    lower, upper, centre = np.full(n, -np.inf), np.full(n, np.inf), np.zeros(n)
    statuses: list[str] = []
    certificates: list[Stored] = []
    inflations: list[float | None] = []
    reasons: list[str] = []
    for k, block in enumerate(blocks):
        part = of_block(rows, block, first=k == 0)
        columns = list(block)
        if not part.count:
            statuses.append("unbounded")
            inflations.append(0.0)
            continue
        others = [j for j in range(n) if j not in block]
        if (part.lower[:, others] != 0).any() or (part.upper[:, others] != 0).any():
            # A row that loses a column would prove what is not true.
            raise RuntimeError(f"rows link the parameters of block {k} with others")
        made = part.regression(terms).take(np.arange(part.count), columns)
        found = regression.feasible_set(made.matrix, made.right)
        statuses.append(str(found.status))
        inflations.append(found.inflation)
        if found.reason:
            reasons.append(found.reason)
        if found.value is not None:
            lower[columns], upper[columns] = found.value.lower, found.value.upper
        if found.centre is not None:
            centre[columns] = found.centre
        proofs = with_rows(feasible_certificates(made, found), partial(_numbered, part))
        certificates += [{**c, "block": k} for c in proofs]
    empty = tuple(k for k, s in enumerate(statuses) if s == "empty")
    status = next((s for s in ("empty", "not_applicable", "unbounded") if s in statuses), "enclosed")
    known = [i for i in inflations if i is not None]
    return Solved(
        status,
        lower,
        upper,
        centre,
        max(known) if len(known) == len(inflations) else None,
        tuple(certificates),
        empty,
        "; ".join(dict.fromkeys(reasons)) or None,
    )


def vertices(rows: LogRows, block: Sequence[int], *, first: bool) -> tuple[FloatArray, bool]:
    """The points at which a block's ends are attained by the working set inside a wide box, shape (p, n), and whether these are all ends.

    Open ends are attained on the box, so that rows that would close them are found. A set that is empty, or too open for an answer, has no
    points.
    """
    part = of_block(rows, block, first=first)
    columns = list(block)
    n = len(columns)
    lower, upper = part.lower[:, columns], part.upper[:, columns]
    half = _box(lower, upper, part)
    low, high = np.r_[part.low, -half], np.r_[part.high, half]
    lower, upper = np.vstack([lower, np.eye(n)]), np.vstack([upper, np.eye(n)])
    found = regression.feasible_set(IntervalArray(lower, upper), IntervalArray(low, high))
    points, missing = _attained(found, lower, upper, low, high)
    whole = np.zeros((len(points), rows.lower.shape[1]))
    if points:
        whole[:, columns] = points
    return np.unique(whole, axis=0), found.value is not None and not missing


def _box(lower: FloatArray, upper: FloatArray, part: LogRows) -> FloatArray:
    """Half-widths of the box, powers of two, shape (n,)."""
    largest = np.maximum(np.abs(lower), np.abs(upper)).max(axis=0, initial=0.0)
    ends = np.r_[part.low, part.high]
    right = float(np.abs(ends[np.isfinite(ends)]).max(initial=1.0))
    half: FloatArray = BOX * 2.0 ** np.ceil(np.log2(max(right, 1.0) / np.where(largest > 0, largest, 1.0)))
    return half


def _attained(
    found: FeasibleSet, lower: FloatArray, upper: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[list[FloatArray], int]:
    """The vertex of each bound of each orthant, from the rows and signs of its proof, and the number of ends without one."""
    if found.value is None:
        return [], 0
    points = [] if found.centre is None else [np.asarray(found.centre)]
    missing = 0
    n = lower.shape[1]
    for orthant in found.certificate:
        if orthant["empty"]:
            continue
        signs = np.array(orthant["signs"])
        for bound in orthant["bounds"]:
            if not np.isfinite(bound["bound"]):
                missing += 1
                continue
            matrix, right = np.zeros((0, n)), np.zeros(0)
            for index, lower_side, _ in bound["rows"]:
                # The half-space of a row in an orthant: sup(A x) >= low, or inf(A x) <= high.
                side = (upper, lower) if lower_side else (lower, upper)
                matrix = np.vstack([matrix, np.where(signs >= 0, side[0][index], side[1][index])])
                right = np.r_[right, low[index] if lower_side else high[index]]
            # Unknowns at the border of their sign are 0 exactly.
            free = np.setdiff1d(np.arange(n), [column for column, _ in bound["signs"]])
            point = np.zeros(n)
            point[free] = np.linalg.lstsq(matrix[:, free], right, rcond=None)[0]
            missed = np.abs(matrix @ point - right)
            if np.all(missed <= RESIDUAL * (np.abs(matrix) @ np.abs(point) + np.abs(right))):
                points.append(point)
            else:
                missing += 1
    return points, missing
