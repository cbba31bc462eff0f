"""Kinds of certificates, as the core states them: one record a kind, told apart by ``kind``.

Source: docs/theory.md, "Regularity".
"""

from __future__ import annotations

from typing import Literal, TypeAlias, TypedDict

from ivsid.intervals import FloatArray


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
