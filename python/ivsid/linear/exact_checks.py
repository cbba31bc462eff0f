"""Exact checks of certificates, in integers and fractions alone; nothing is shared with the core that made the certificates.

Source: docs/theory.md, "Regularity".
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from math import lcm
from typing import Final, TypeAlias

from ivsid.intervals import FloatArray
from ivsid.linear.certificate_kinds import (
    Cells,
    Content,
    Contraction,
    Determinant,
    NullVector,
    OppositeDeterminants,
    PositiveDefinite,
    ScaledContraction,
    SingularMember,
    VertexDeterminants,
)

Rows: TypeAlias = list[list[Fraction]]

# Largest order whose vertex matrices are checked one by one.
# Source: resource: 2^(2n-1) rational determinants, 2048 at this order
VERTEX_LIMIT: Final = 6
# Largest order whose determinant is expanded over sets of columns.
# Source: resource: 2^n minors of rational intervals; the core makes no such certificate of a larger order
DETERMINANT_LIMIT: Final = 10


def rows_of(matrix: FloatArray) -> Rows:
    """The matrix in exact fractions."""
    return [[Fraction(v) for v in row] for row in matrix.tolist()]


def vector_of(values: FloatArray) -> list[Fraction]:
    """The vector in exact fractions."""
    return [Fraction(v) for v in values.tolist()]


def _integers(values: Sequence[Fraction]) -> tuple[list[int], int]:
    """Integers over one common denominator."""
    denominator = lcm(*(v.denominator for v in values))
    return [v.numerator * (denominator // v.denominator) for v in values], denominator


def _contracts(lower: Rows, upper: Rows, inverse: Rows, vector: list[Fraction], norm: Fraction | None = None) -> bool:
    """``|I - R A| v < v`` for every member, and ``v > 0``; with ``v = 1`` also that the norm bounds ``||I - R A||``."""
    n = len(lower)
    if len(vector) != n or len(inverse) != n or any(len(row) != n for row in inverse):
        return False
    r, r_scale = _integers([x for row in inverse for x in row])
    ends, scale = _integers([x for row in (*lower, *upper) for x in row])
    v, _ = _integers(vector)
    one = r_scale * scale
    for i in range(n):
        total = 0
        for j in range(n):
            least = most = one if i == j else 0
            for k in range(n):
                factor = r[i * n + k]
                p, q = factor * ends[k * n + j], factor * ends[(n + k) * n + j]
                least -= max(p, q)
                most -= min(p, q)
            total += max(abs(least), abs(most)) * v[j]
        if not total < one * v[i] or (norm is not None and total > one * norm):
            return False
    return all(x > 0 for x in v)


def _contraction(c: Contraction | ScaledContraction, lower: Rows, upper: Rows) -> bool:
    inverse = rows_of(c["approximate_inverse"])
    if c["kind"] == "scaled_contraction":
        return _contracts(lower, upper, inverse, vector_of(c["vector"]))
    norm = Fraction(c["norm"])
    return norm < 1 and _contracts(lower, upper, inverse, [Fraction(1)] * len(lower), norm)


def _cells(c: Cells, lower: Rows, upper: Rows) -> bool:
    open_cells = [(c["tree"], lower, upper)]
    while open_cells:
        tree, low, high = open_cells.pop()
        if tree[0] == "regular":
            if not _contracts(low, high, rows_of(tree[1]), vector_of(tree[2])):
                return False
            continue
        _, entry, value, below, above = tree
        i, j = divmod(entry, len(lower))
        cut = Fraction(value)
        if not low[i][j] <= cut <= high[i][j]:
            return False
        open_cells.append((below, low, _replaced(high, i, j, cut)))
        open_cells.append((above, _replaced(low, i, j, cut), high))
    return True


def _replaced(rows: Rows, i: int, j: int, value: Fraction) -> Rows:
    changed = [list(row) for row in rows]
    changed[i][j] = value
    return changed


def _determinant_of(rows: Rows) -> Fraction:
    m = [list(row) for row in rows]
    result = Fraction(1)
    for p in range(len(m)):
        pivot = next((i for i in range(p, len(m)) if m[i][p]), None)
        if pivot is None:
            return Fraction(0)
        if pivot != p:
            m[p], m[pivot] = m[pivot], m[p]
            result = -result
        result *= m[p][p]
        for i in range(p + 1, len(m)):
            factor = m[i][p] / m[p][p]
            if factor:
                m[i] = [a - factor * b for a, b in zip(m[i], m[p], strict=True)]
    return result


def _nonnegative_inverse(rows: Rows) -> bool:
    n = len(rows)
    m = [[*row, *(Fraction(int(i == j)) for j in range(n))] for i, row in enumerate(rows)]
    for p in range(n):
        pivot = next((i for i in range(p, n) if m[i][p]), None)
        if pivot is None:
            return False
        m[p], m[pivot] = m[pivot], m[p]
        m[p] = [x / m[p][p] for x in m[p]]
        for i in range(n):
            if i != p and m[i][p]:
                factor = m[i][p]
                m[i] = [a - factor * b for a, b in zip(m[i], m[p], strict=True)]
    return all(x >= 0 for row in m for x in row[n:])


def _nonnegative_inverses(lower: Rows, upper: Rows) -> bool:
    return _nonnegative_inverse(lower) and _nonnegative_inverse(upper)


def _vertex_determinants(c: VertexDeterminants, lower: Rows, upper: Rows) -> bool:
    n = len(lower)
    if n > VERTEX_LIMIT or c["sign"] not in (-1, 1):
        return False
    for y in product((False, True), repeat=n - 1):
        for z in product((False, True), repeat=n):
            signs = (False, *y)
            vertex = [[(upper if signs[i] != z[j] else lower)[i][j] for j in range(n)] for i in range(n)]
            if not _determinant_of(vertex) * c["sign"] > 0:
                return False
    return True


def _times(a: Rows, b: Rows) -> Rows:
    columns = list(zip(*b, strict=True))
    return [[sum((x * y for x, y in zip(row, column, strict=True)), Fraction(0)) for column in columns] for row in a]


def _positive_definite(c: PositiveDefinite, lower: Rows, upper: Rows) -> bool:
    n = len(lower)
    shift, w, x = Fraction(c["shift"]), vector_of(c["vector"]), rows_of(c["congruence"])
    # The certificate's shift leaves room for the rounding of the midpoints, which is checked with those in doubles.
    middle = [
        [Fraction(float((a + b) / 2)) for a, b in zip(p, q, strict=True)] for p, q in zip(lower, upper, strict=True)
    ]
    radius = [
        [max(b - m, m - a) for a, b, m in zip(p, q, r, strict=True)]
        for p, q, r in zip(lower, upper, middle, strict=True)
    ]
    image = _times(list(map(list, zip(*radius, strict=True))), _times(radius, [[v] for v in w]))
    if any(v <= 0 for v in w) or any(y[0] > shift * v for y, v in zip(image, w, strict=True)):
        return False
    gram = _times(list(map(list, zip(*middle, strict=True))), middle)
    for i in range(n):
        gram[i][i] -= shift
    image = _times(_times(x, gram), list(map(list, zip(*x, strict=True))))
    return all(sum(abs(int(i == j) - image[i][j]) for j in range(n)) < 1 for i in range(n))


def _determinant(c: Determinant, lower: Rows, upper: Rows) -> bool:
    """Laplace expansion by rows over sets of columns, in rational intervals."""
    n = len(lower)
    least, most = (Fraction(v) for v in c["determinant"])
    if n > DETERMINANT_LIMIT or not (least <= most and (least > 0 or most < 0)):
        return False
    minors = [(Fraction(1), Fraction(1))] * (1 << n)
    for mask in range(1, 1 << n):
        row = mask.bit_count() - 1
        low = high = Fraction(0)
        for j in (j for j in range(n) if mask >> j & 1):
            parts = [e * m for e in (lower[row][j], upper[row][j]) for m in minors[mask & ~(1 << j)]]
            even = (mask >> (j + 1)).bit_count() % 2 == 0
            low, high = (low + min(parts), high + max(parts)) if even else (low - max(parts), high - min(parts))
        minors[mask] = (low, high)
    low, high = minors[-1]
    return least <= low and high <= most


def _ends(a: list[Fraction], b: list[Fraction], x: list[Fraction]) -> tuple[Fraction, Fraction]:
    """Range of a row's members times x."""
    pairs = [(p * v, q * v) for p, q, v in zip(a, b, x, strict=True)]
    return sum(map(min, pairs), Fraction(0)), sum(map(max, pairs), Fraction(0))


def orthogonal(a: list[Fraction], b: list[Fraction], x: list[Fraction]) -> list[Fraction]:
    """The row between its two extremes whose product with x is 0."""
    down = [p if p * v <= q * v else q for p, q, v in zip(a, b, x, strict=True)]
    up = [q if p * v <= q * v else p for p, q, v in zip(a, b, x, strict=True)]
    least, most = _ends(a, b, x)
    share = Fraction(0) if least == most else -least / (most - least)
    return [p + share * (q - p) for p, q in zip(down, up, strict=True)]


def _null_vector(c: NullVector, lower: Rows, upper: Rows) -> bool:
    x = vector_of(c["vector"])
    if len(x) != len(lower):
        return False
    ranges = [_ends(a, b, x) for a, b in zip(lower, upper, strict=True)]
    return any(x) and all(least <= 0 <= most for least, most in ranges)


def _belongs(member: Rows, lower: Rows, upper: Rows) -> bool:
    return all(
        a <= x <= b for p, q, r in zip(lower, upper, member, strict=True) for a, b, x in zip(p, q, r, strict=True)
    )


def _singular_member(c: SingularMember, lower: Rows, upper: Rows) -> bool:
    member = rows_of(c["member"])
    return _belongs(member, lower, upper) and _determinant_of(member) == 0


def _opposite_determinants(c: OppositeDeterminants, lower: Rows, upper: Rows) -> bool:
    first, second = (rows_of(m) for m in c["members"])
    inside = _belongs(first, lower, upper) and _belongs(second, lower, upper)
    return inside and _determinant_of(first) * _determinant_of(second) < 0


def holds(c: Content, lower: Rows, upper: Rows) -> bool:
    """Whether the certificate proves its statement on every member of the matrix; an unknown kind proves nothing.

    Args:
        c: the certificate.
        lower: bounds of the matrix, shape (n, n).
        upper: the same from above.
    """
    if c["kind"] == "contraction" or c["kind"] == "scaled_contraction":
        return _contraction(c, lower, upper)
    if c["kind"] == "cells":
        return _cells(c, lower, upper)
    if c["kind"] == "positive_definite":
        return _positive_definite(c, lower, upper)
    if c["kind"] == "nonnegative_inverses":
        return _nonnegative_inverses(lower, upper)
    if c["kind"] == "vertex_determinants":
        return _vertex_determinants(c, lower, upper)
    if c["kind"] == "determinant":
        return _determinant(c, lower, upper)
    if c["kind"] == "null_vector":
        return _null_vector(c, lower, upper)
    if c["kind"] == "singular_member":
        return _singular_member(c, lower, upper)
    if c["kind"] == "opposite_determinants":
        return _opposite_determinants(c, lower, upper)
    return False
