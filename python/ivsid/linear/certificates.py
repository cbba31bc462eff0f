"""Certificates of regular and of singular interval matrices, and their exact checks.

The checks compute with integers and fractions alone and share nothing with the compiled core that made the certificates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import lcm
from typing import Any, Final, Literal, TypeAlias, TypedDict, cast

import numpy as np

from ivsid.intervals import FloatArray

Rows = list[list[Fraction]]

VERTEX_LIMIT: Final = 6
"""Vertex matrices of larger orders are too many to check one by one."""


class Contraction(TypedDict):
    """``||I - R A|| <= norm < 1``."""

    kind: Literal["contraction"]
    approximate_inverse: FloatArray
    norm: float


class ScaledContraction(TypedDict):
    """``|I - R A| v < v`` for a positive v."""

    kind: Literal["scaled_contraction"]
    approximate_inverse: FloatArray
    vector: FloatArray


class PositiveDefinite(TypedDict):
    """``m'm - s I`` is positive definite, and s bounds the squared spectral norm of the radii."""

    kind: Literal["positive_definite"]
    shift: float
    vector: FloatArray
    congruence: FloatArray


Tree: TypeAlias = "tuple[Literal['regular'], FloatArray, FloatArray] | tuple[Literal['halved'], int, float, Tree, Tree]"
"""A cell that contracts with R and v, or one that is halved: entry, value, the half below and the half above."""


class Cells(TypedDict):
    """A scaled contraction in every cell of a partition."""

    kind: Literal["cells"]
    tree: Tree


class NonnegativeInverses(TypedDict):
    """The two extreme members have non-negative inverses."""

    kind: Literal["nonnegative_inverses"]


class VertexDeterminants(TypedDict):
    """The determinants of all vertex matrices have this sign."""

    kind: Literal["vertex_determinants"]
    sign: int


class Determinant(TypedDict):
    """Bounds of the interval determinant, which leave 0 out."""

    kind: Literal["determinant"]
    determinant: tuple[float, float]


class NullVector(TypedDict):
    """Every row of ``A x`` holds 0."""

    kind: Literal["null_vector"]
    vector: FloatArray


class SingularMember(TypedDict):
    """A member whose determinant is 0."""

    kind: Literal["singular_member"]
    member: FloatArray


class OppositeDeterminants(TypedDict):
    """Two members whose determinants have opposite signs."""

    kind: Literal["opposite_determinants"]
    members: tuple[FloatArray, FloatArray]


Content: TypeAlias = (
    Contraction
    | ScaledContraction
    | PositiveDefinite
    | Cells
    | NonnegativeInverses
    | VertexDeterminants
    | Determinant
    | NullVector
    | SingularMember
    | OppositeDeterminants
)


class Certificate(Mapping[str, Any]):
    """Why a matrix is regular, or why it is not: ``kind`` and the numbers that prove it.

    Kinds, and what ``verify`` checks of them over all members of the matrix:
        contraction, scaled_contraction: ``|I - R A| v < v`` for a positive v (METHODS 4.1).
        positive_definite: ``m'm - s I`` is positive definite, the radii have a spectral norm of at most the root of s (Rex, Rohn 1998).
        cells: a scaled contraction in every cell of a partition.
        nonnegative_inverses: those of the two extreme members (Kuttler 1971).
        vertex_determinants: all have one sign (Baumann 1984).
        determinant: the interval determinant by expansion does not hold 0.
        null_vector: every row of ``A x`` holds 0.
        singular_member, opposite_determinants: members with a determinant of 0, or of opposite signs.
    """

    def __init__(self, content: Mapping[str, object], lower: FloatArray, upper: FloatArray) -> None:
        self._content = dict(content)
        self._lower = lower
        self._upper = upper

    def __getitem__(self, key: str) -> Any:
        return self._content[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._content)

    def __len__(self) -> int:
        return len(self._content)

    @property
    def content(self) -> Content:
        """The same by kind; a certificate that does not come from the core may lack what its kind has."""
        return cast(Content, self._content)

    def __repr__(self) -> str:
        return f"Certificate({self._content!r})"

    def verify(self) -> bool:
        """Whether the certificate proves what it says of its matrix, shape (n, n), in exact arithmetic."""
        if not (np.isfinite(self._lower).all() and np.isfinite(self._upper).all()):
            return False
        lower, upper = _rows(self._lower), _rows(self._upper)
        if any(a > b for p, q in zip(lower, upper, strict=True) for a, b in zip(p, q, strict=True)):
            return False
        try:
            return _holds(self.content, lower, upper)
        except (ArithmeticError, AttributeError, IndexError, KeyError, TypeError, ValueError):
            # Numbers that are missing, infinite or of the wrong shape prove nothing.
            return False

    def member(self) -> Rows:
        """A singular member as exact fractions, for a certificate by a null vector.

        Raises:
            ValueError: the certificate is of another kind or does not hold.
        """
        content = self.content
        if content["kind"] != "null_vector" or not self.verify():
            raise ValueError("only a null vector that holds names a singular member")
        x = _vector(content["vector"])
        return [_orthogonal(a, b, x) for a, b in zip(_rows(self._lower), _rows(self._upper), strict=True)]


def _rows(matrix: FloatArray) -> Rows:
    return [[Fraction(v) for v in row] for row in matrix.tolist()]


def _vector(values: FloatArray) -> list[Fraction]:
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
    inverse = _rows(c["approximate_inverse"])
    if c["kind"] == "scaled_contraction":
        return _contracts(lower, upper, inverse, _vector(c["vector"]))
    norm = Fraction(c["norm"])
    return norm < 1 and _contracts(lower, upper, inverse, [Fraction(1)] * len(lower), norm)


def _cells(c: Cells, lower: Rows, upper: Rows) -> bool:
    open_cells = [(c["tree"], lower, upper)]
    while open_cells:
        tree, low, high = open_cells.pop()
        if tree[0] == "regular":
            if not _contracts(low, high, _rows(tree[1]), _vector(tree[2])):
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
    shift, w, x = Fraction(c["shift"]), _vector(c["vector"]), _rows(c["congruence"])
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
    if n > 10 or not (least <= most and (least > 0 or most < 0)):
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


def _orthogonal(a: list[Fraction], b: list[Fraction], x: list[Fraction]) -> list[Fraction]:
    """The row between its two extremes whose product with x is 0."""
    down = [p if p * v <= q * v else q for p, q, v in zip(a, b, x, strict=True)]
    up = [q if p * v <= q * v else p for p, q, v in zip(a, b, x, strict=True)]
    least, most = _ends(a, b, x)
    share = Fraction(0) if least == most else -least / (most - least)
    return [p + share * (q - p) for p, q in zip(down, up, strict=True)]


def _null_vector(c: NullVector, lower: Rows, upper: Rows) -> bool:
    x = _vector(c["vector"])
    if len(x) != len(lower):
        return False
    ranges = [_ends(a, b, x) for a, b in zip(lower, upper, strict=True)]
    return any(x) and all(least <= 0 <= most for least, most in ranges)


def _belongs(member: Rows, lower: Rows, upper: Rows) -> bool:
    return all(
        a <= x <= b for p, q, r in zip(lower, upper, member, strict=True) for a, b, x in zip(p, q, r, strict=True)
    )


def _singular_member(c: SingularMember, lower: Rows, upper: Rows) -> bool:
    member = _rows(c["member"])
    return _belongs(member, lower, upper) and _determinant_of(member) == 0


def _opposite_determinants(c: OppositeDeterminants, lower: Rows, upper: Rows) -> bool:
    first, second = (_rows(m) for m in c["members"])
    inside = _belongs(first, lower, upper) and _belongs(second, lower, upper)
    return inside and _determinant_of(first) * _determinant_of(second) < 0


def _holds(c: Content, lower: Rows, upper: Rows) -> bool:
    """The check of the certificate's kind; a kind that is none proves nothing."""
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
