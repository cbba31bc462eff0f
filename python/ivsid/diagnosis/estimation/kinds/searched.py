"""Causes whose columns are found by a search."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.kinds.candidate import Candidate, Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.effects import Effect

Array = NDArray[np.float64]
# Values of a search that get exact columns.
# Source: resource: a period costs four columns, an anchor two
PEAKS: Final = 3


@dataclass(frozen=True)
class SearchedCandidate(Candidate):
    """A cause whose columns are found by a search: it looks for a few values, and each of them gets exact columns."""

    searched: ClassVar[bool] = True

    @classmethod
    def made(cls, _s: Signatures, effect: Effect, _out: Columns) -> Sequence[Self]:
        """The candidate, without columns."""
        return [cls(effect)]

    def score(self, _p: Projection, _s: Signatures) -> Scored | None:
        """Nothing before the search."""
        return None

    @abstractmethod
    def search(self, s: Signatures, white: Whitening, back: Array) -> tuple[list[tuple[float, ...]], float]:
        """The values at which it would explain most, and the number of independent ones.

        Args:
            s: signatures of the fit.
            white: whitening of the errors.
            back: accelerations that would explain the errors, shape (3, n).
        """

    @abstractmethod
    def exact(self, s: Signatures, value: tuple[float, ...]) -> list[Array]:
        """Columns at a value."""

    @abstractmethod
    def numbers(self, value: tuple[float, ...], theta: tuple[float, ...]) -> tuple[float, ...]:
        """The effect's numbers from a value and the coefficients of its columns."""

    def possible(self, _theta: tuple[float, ...]) -> bool:
        """Whether the coefficients are ones that the cause can have."""
        return True

    def best(
        self, p: Projection, tried: Sequence[tuple[tuple[float, ...], tuple[int, ...]]], looks: float
    ) -> Scored | None:
        """The best of some values.

        Args:
            p: least squares beside which it is scored.
            tried: values, with the indices of their columns.
            looks: number of independent values that were searched.
        """
        best: Scored | None = None
        # A far anchor is a wind: the numbers that were searched are paid for, too.
        count = len(self.effect.parameters)
        for value, columns in tried:
            theta, fall = p.solve(columns)
            real = tuple((theta / p.g.unit[list(columns)]).tolist())
            ok = self.possible(real)
            # A value that pushes where the cause pulls hides no weaker one that pulls.
            own = fall if ok else 0.0
            if best is None or own > best.fall:
                best = Scored(self, own, count, looks, columns, real, self.numbers(value, real), ok)
        return best


def beside(rows: Array, base: tuple[Array, ...]) -> Array:
    """What least squares on a base leaves of rows, shape (rows, m)."""
    q, _ = np.linalg.qr(np.stack(base, axis=1))
    return np.asarray(rows - (rows @ q) @ q.T)
