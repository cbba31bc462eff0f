"""Certificates of regular and of singular interval matrices.

Their checks compute with integers and fractions alone (``exact_checks``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, cast

import numpy as np

from ivsid.intervals import FloatArray
from ivsid.linear.certificate_kinds import Content
from ivsid.linear.exact_checks import Rows, holds, orthogonal, rows_of, vector_of


class Certificate(Mapping[str, Any]):
    """Proof that a matrix is regular or singular: ``kind`` and the numbers of the proof.

    Kinds, and the statement on all members of the matrix that ``verify`` checks (docs/theory.md, "Regularity"):
        contraction, scaled_contraction: ``|I - R A| v < v`` for a positive v (Beeck 1975; Rump 2013).
        positive_definite: ``m'm - s I`` is positive definite, the radii have a spectral norm of at most the root of s (Rex and Rohn 1998).
        cells: a scaled contraction in every cell of a partition.
        nonnegative_inverses: those of the two extreme members (Kuttler 1971).
        vertex_determinants: all have one sign (Baumann 1984).
        determinant: the interval determinant by expansion does not hold 0.
        null_vector: every row of ``A x`` holds 0 (Oettli and Prager 1964).
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
        """The same by kind; a certificate from elsewhere than the core may lack entries of its kind."""
        return cast(Content, self._content)

    def __repr__(self) -> str:
        return f"Certificate({self._content!r})"

    def verify(self) -> bool:
        """Whether the certificate proves its statement on its matrix, shape (n, n), in exact arithmetic."""
        if not (np.isfinite(self._lower).all() and np.isfinite(self._upper).all()):
            return False
        lower, upper = rows_of(self._lower), rows_of(self._upper)
        if any(a > b for p, q in zip(lower, upper, strict=True) for a, b in zip(p, q, strict=True)):
            return False
        try:
            return holds(self.content, lower, upper)
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
        x = vector_of(content["vector"])
        return [orthogonal(a, b, x) for a, b in zip(rows_of(self._lower), rows_of(self._upper), strict=True)]
