"""Proofs by multipliers of rows, in fractions: a bound of a parameter, or that no parameter is consistent.

For a consistent x in a cell of known signs, a row with coefficients in [a, b] and a right-hand side in [c, d] gives
``sum of least a_j x_j <= d`` and ``sum of most a_j x_j >= c``. Multipliers l >= 0 of such half-spaces g x <= h with
``x_j (e_j + sum l_i g_ij) >= 0`` for every j and every x of the cell prove ``e x >= -sum l_i h_i``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from typing import Final, TypeAlias

# The exact zero, made once.
# Source: definition: the neutral element of addition
ZERO: Final = Fraction(0)
# A sum of rounded products that is smaller than this share of the largest may be 0 with exact multipliers. The multipliers that follow
# are checked, so that a wrong guess costs time only.
# Source: resource: time of the exact search that a good guess saves
NEARLY: Final = 1e-9
Vector: TypeAlias = list[Fraction]


@dataclass(frozen=True)
class HalfSpace:
    """``g x <= h`` where x_j >= 0 has the coefficient ``positive[j]`` and x_j <= 0 ``negative[j]``."""

    positive: Vector
    negative: Vector
    height: Fraction


def half_space(lower: Vector, upper: Vector, right: tuple[Fraction, Fraction], *, lower_side: bool) -> HalfSpace:
    """The half-space of an interval row with one end of its right-hand side."""
    if lower_side:
        return HalfSpace([-b for b in upper], [-a for a in lower], -right[0])
    return HalfSpace(list(lower), list(upper), right[1])


def least(
    objective: Vector, rows: Sequence[HalfSpace], signs: Sequence[int], slack: set[int]
) -> tuple[Fraction, set[int]] | None:
    """The largest lower bound of ``objective x`` that the rows prove in the cell, and the rows that it needs; None without a bound.

    Args:
        objective: e, shape (n,).
        rows: half-spaces.
        signs: of the cell, 1 or -1, 0 for both.
        slack: columns whose sign is in the basis; a proposal, since the multipliers are checked.
    """
    # One condition for each sign that an unknown may have: s (e_j + sum l_i g_ij) >= 0.
    conditions = [(j, s) for j, sign in enumerate(signs) for s in (1, -1) if sign in (0, s)]
    tight = [j for j in range(len(signs)) if j not in slack]
    matrix = [[_coefficient(row, j, signs[j] or 1) for row in rows] for j in tight]
    found = solve(matrix, [-objective[j] for j in tight])
    if found is not None and len(found) == len(rows) and _holds(objective, rows, conditions, found):
        return -_height(rows, found), _used(found)
    return _best(objective, rows, conditions)


def multipliers_of(
    objective: Vector, rows: Sequence[HalfSpace], decided: Sequence[int], home: Sequence[int], slack: set[int]
) -> Vector | None:
    """Multipliers that bound ``objective x`` from rows made with the signs ``home``, of which only those ``decided`` hold.

    None where the basis gives no such multipliers; ``slack`` holds the decided signs that are in the basis.
    """
    tight = [j for j in range(len(home)) if j not in slack]
    matrix = [[_coefficient(row, j, home[j] or 1) for row in rows] for j in tight]
    found = solve(matrix, [-objective[j] for j in tight])
    if found is None or len(found) != len(rows) or any(m < 0 for m in found):
        return None
    for j, sign in enumerate(home):
        if sign == 0 and any(row.positive[j] != row.negative[j] for row in rows):
            return None
        left = objective[j] + sum(
            (m * _coefficient(row, j, sign or 1) for m, row in zip(found, rows, strict=True)), ZERO
        )
        if left != 0 and (decided[j] == 0 or decided[j] != sign or left * sign < 0):
            return None
    return found


def contradict(rows: Sequence[HalfSpace], signs: Sequence[int], near: Sequence[float] = ()) -> set[int] | None:
    """The rows of a Farkas certificate, multipliers that give 0 <= a negative number in the cell; None without one.

    Args:
        rows: half-spaces.
        signs: of the cell, 1 or -1, 0 for both.
        near: rounded multipliers, a proposal; the multipliers that are found are checked.
    """
    n = len(signs)
    conditions = [(j, s) for j, sign in enumerate(signs) for s in (1, -1) if sign in (0, s)]
    exact = _from_near(rows, signs, near)
    if exact is not None and _holds([ZERO] * n, rows, conditions, exact) and _height(rows, exact) < 0:
        return _used(exact)
    equations = _equations([ZERO] * n, rows, conditions)
    heights = [row.height for row in rows]
    equations.append(([*heights, *([ZERO] * len(conditions))], Fraction(-1)))
    found = _simplex(equations, [ZERO] * (len(rows) + len(conditions)))
    return None if found is None else _used(found[1][: len(rows)])


def _from_near(rows: Sequence[HalfSpace], signs: Sequence[int], near: Sequence[float]) -> Vector | None:
    """Exact multipliers, the largest 1, that make 0 the columns that the rounded multipliers nearly make 0."""
    if len(near) != len(rows) or not all(isfinite(m) and m >= 0 for m in near) or not any(near):
        return None
    first = max(range(len(rows)), key=lambda i: near[i])
    others = [i for i, m in enumerate(near) if m and i != first]
    tight = []
    for j, sign in enumerate(signs):
        parts = [m * float(_coefficient(row, j, sign or 1)) for m, row in zip(near, rows, strict=True)]
        if abs(sum(parts)) <= NEARLY * max(abs(p) for p in parts):
            tight.append(j)
    matrix = [[_coefficient(rows[i], j, signs[j] or 1) for i in others] for j in tight]
    found = solve(matrix, [-_coefficient(rows[first], j, signs[j] or 1) for j in tight]) if others else []
    if found is None or len(found) != len(others):
        return None
    whole = [ZERO] * len(rows)
    whole[first] = Fraction(1)
    for i, m in zip(others, found, strict=True):
        whole[i] = m
    return whole


def _height(rows: Sequence[HalfSpace], multipliers: Vector) -> Fraction:
    return sum((m * row.height for m, row in zip(multipliers, rows, strict=True)), ZERO)


def _used(multipliers: Vector) -> set[int]:
    return {i for i, m in enumerate(multipliers) if m}


def _coefficient(row: HalfSpace, j: int, sign: int) -> Fraction:
    return row.positive[j] if sign > 0 else row.negative[j]


def _holds(e: Vector, rows: Sequence[HalfSpace], conditions: list[tuple[int, int]], multipliers: Vector) -> bool:
    if any(m < 0 for m in multipliers):
        return False
    return all(
        s * (e[j] + sum((m * _coefficient(row, j, s) for m, row in zip(multipliers, rows, strict=True)), ZERO)) >= 0
        for j, s in conditions
    )


def _equations(
    e: Vector, rows: Sequence[HalfSpace], conditions: list[tuple[int, int]]
) -> list[tuple[Vector, Fraction]]:
    """``sum l_i s g_ij - w_k = -s e_j`` with l, w >= 0."""
    made = []
    for k, (j, s) in enumerate(conditions):
        slacks = [Fraction(-(i == k)) for i in range(len(conditions))]
        made.append(([*(s * _coefficient(row, j, s) for row in rows), *slacks], -s * e[j]))
    return made


def _best(e: Vector, rows: Sequence[HalfSpace], conditions: list[tuple[int, int]]) -> tuple[Fraction, set[int]] | None:
    cost = [*(row.height for row in rows), *([ZERO] * len(conditions))]
    smallest = _simplex(_equations(e, rows, conditions), cost)
    return None if smallest is None else (-smallest[0], _used(smallest[1][: len(rows)]))


def solve(matrix: list[Vector], right: Vector) -> Vector | None:
    """The only solution of a system with at least as many equations as unknowns; None without a solution or with several."""
    n = len(matrix[0]) if matrix else 0
    table = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    for k in range(n):
        pivot = next((i for i in range(k, len(table)) if table[i][k]), None)
        if pivot is None:
            return None
        table[k], table[pivot] = table[pivot], table[k]
        table[k] = [x / table[k][k] for x in table[k]]
        for i in range(len(table)):
            if i != k and table[i][k]:
                factor = table[i][k]
                table[i] = [a - factor * b for a, b in zip(table[i], table[k], strict=True)]
    return None if any(row[n] for row in table[n:]) else [table[k][n] for k in range(n)]


def _simplex(equations: list[tuple[Vector, Fraction]], cost: Vector) -> tuple[Fraction, Vector] | None:
    """The least cost of x >= 0 under equations, with an x; None without an x or a least cost (two phases, Bland 1977)."""
    n, m = len(cost), len(equations)
    table: list[Vector] = []
    for k, (row, b) in enumerate(equations):
        sign = -1 if b < 0 else 1
        table.append([*(sign * a for a in row), *(Fraction(i == k) for i in range(m)), sign * b])
    basis = list(range(n, n + m))
    first = [-sum((row[j] for row in table), ZERO) for j in range(n)] + [ZERO] * m
    first.append(-sum((row[-1] for row in table), ZERO))
    if not _descend(table, basis, first, n + m) or first[-1] != 0:
        return None
    for i in range(m):
        # An artificial unknown that is left in the basis is 0: any other can take its place.
        if basis[i] >= n and (j := next((j for j in range(n) if table[i][j]), None)) is not None:
            _pivot(table, basis, first, i, j)
    kept = [i for i in range(m) if basis[i] < n]
    table, basis = [table[i] for i in kept], [basis[i] for i in kept]
    second = [*cost, *([ZERO] * m), ZERO]
    for i, j in enumerate(basis):
        factor = second[j]
        second = [a - factor * x for a, x in zip(second, table[i], strict=True)]
    if not _descend(table, basis, second, n):
        return None
    x = [ZERO] * n
    for row, j in zip(table, basis, strict=True):
        x[j] = row[-1]
    return -second[-1], x


def _descend(table: list[Vector], basis: list[int], cost: Vector, n: int) -> bool:
    """Pivots until no cost is negative; False where the cost falls for ever."""
    while (j := next((j for j in range(n) if cost[j] < 0), None)) is not None:
        ratios = [(row[-1] / row[j], basis[i], i) for i, row in enumerate(table) if row[j] > 0]
        if not ratios:
            return False
        _pivot(table, basis, cost, min(ratios)[2], j)
    return True


def _pivot(table: list[Vector], basis: list[int], cost: Vector, i: int, j: int) -> None:
    table[i] = [x / table[i][j] for x in table[i]]
    for other in (*(row for k, row in enumerate(table) if k != i), cost):
        if other[j]:
            part = other[j]
            other[:] = [a - part * b for a, b in zip(other, table[i], strict=True)]
    basis[i] = j
