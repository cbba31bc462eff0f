"""Signatures, whitened, as cross-products by block of time: fits, gains and their errors are small linear algebra from there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

Array = NDArray[np.float64]
# Length of a block [s].
BLOCK: Final = 10.0


@dataclass(frozen=True)
class Gram:
    """Cross-products of named columns and of the errors, block by block.

    Attributes:
        names: of the columns.
        x: the columns in unit length, shape (blocks, columns, numbers).
        y: the errors, shape (blocks, numbers).
        blocks: shape (blocks, columns, columns).
        score: columns times errors, shape (blocks, columns).
        energy: squared errors, shape (blocks,).
        rows: numbers in each block.
        prior: precision of each column's coefficient before the data, shape (columns,).
        centre: how far each coefficient is from what was expected of it already, in the columns' units.
        unit: what each column was divided by.
        good: samples that count, shape (n,).
        length: samples in a block.
    """

    names: tuple[str, ...]
    x: Array
    y: Array
    blocks: Array
    score: Array
    energy: Array
    rows: Array
    prior: Array
    centre: Array
    unit: Array
    good: NDArray[np.bool_]
    length: int

    @property
    def index(self) -> dict[str, int]:
        """Column by name."""
        return {n: k for k, n in enumerate(self.names)}

    def at(self, names: Sequence[str]) -> list[int]:
        """Indices of names."""
        index = self.index
        return [index[n] for n in names]

    def of(self, errors: Array) -> Gram:
        """With other whitened errors, shape (rows, n)."""
        y = _blocked(errors[None], self.good, self.length)[:, 0]
        score = (self.x @ y[:, :, None])[:, :, 0]
        return replace(self, y=y, score=score, energy=np.einsum("bi,bi->b", y, y))

    def only(self, columns: Sequence[int]) -> Gram:
        """With some of the columns alone."""
        at = list(columns)
        return replace(
            self,
            names=tuple(self.names[k] for k in at),
            x=self.x[:, at],
            blocks=self.blocks[:, at][:, :, at],
            score=self.score[:, at],
            prior=self.prior[at],
            centre=self.centre[at],
            unit=self.unit[at],
        )

    def extended(self, names: Sequence[str], columns: Array, *, sums: bool = False) -> Gram:
        """With further whitened columns, shape (columns, rows, n); with ``sums`` the columns themselves are not kept."""
        x = _blocked(columns, self.good, self.length)
        unit = np.sqrt(np.maximum(np.einsum("bci,bci->c", x, x), 1e-300))
        x /= unit[:, None]
        cross = self.x @ x.transpose(0, 2, 1)
        old, new = len(self.names), len(names)
        blocks = np.empty((len(x), old + new, old + new))
        blocks[:, :old, :old] = self.blocks
        blocks[:, :old, old:] = cross
        blocks[:, old:, :old] = cross.transpose(0, 2, 1)
        blocks[:, old:, old:] = _squares(x)
        return replace(
            self,
            names=(*self.names, *names),
            x=self.x[:, :0] if sums else np.concatenate([self.x, x], axis=1),
            blocks=blocks,
            score=np.concatenate([self.score, np.einsum("bci,bi->bc", x, self.y)], axis=1),
            prior=np.r_[self.prior, np.zeros(len(names))],
            centre=np.r_[self.centre, np.zeros(len(names))],
            unit=np.r_[self.unit, unit],
        )


def _squares(x: Array) -> Array:
    """Cross-products of all columns within each block; a matrix times its own transpose is half the work."""
    out = np.empty((x.shape[0], x.shape[1], x.shape[1]))
    for one, into in zip(x, out, strict=True):
        np.matmul(one, one.T, out=into)
    return out


def _blocked(x: Array, good: NDArray[np.bool_], length: int) -> Array:
    """Rows of each block side by side, those that do not count left out as zeros, shape (blocks, columns, numbers)."""
    c, m, n = x.shape
    count = n // length
    out = np.empty((count, c, m * length))
    view = out.reshape(count, c, m, length)
    np.multiply(
        x[..., : count * length].reshape(c, m, count, length).transpose(2, 0, 1, 3),
        good[: count * length].reshape(count, 1, 1, length),
        out=view,
    )
    return out


def gram(
    names: Sequence[str],
    columns: Array,
    errors: Array,
    good: NDArray[np.bool_],
    h: float,
    prior: Mapping[str, float],
    centre: Mapping[str, float],
) -> Gram:
    """Cross-products.

    Args:
        names: of the columns.
        columns: whitened signatures, shape (columns, rows, n).
        errors: whitened errors, shape (rows, n).
        good: samples that count, shape (n,).
        h: step [s].
        prior: standard deviation of the coefficients that are known beforehand, by name; infinite for the others.
        centre: how much of each is in the hypothesis already.
    """
    length = max(1, round(BLOCK / h))
    x = _blocked(columns, good, length)
    y = _blocked(errors[None], good, length)[:, 0]
    unit = np.sqrt(np.maximum(np.einsum("bci,bci->c", x, x), 1e-300))
    x /= unit[:, None]
    rows = good[: len(x) * length].reshape(len(x), length).sum(axis=1) * errors.shape[0]
    precision = np.array([1 / (prior[n] * u) ** 2 if n in prior else 0.0 for n, u in zip(names, unit, strict=True)])
    return Gram(
        tuple(names),
        x,
        y,
        _squares(x),
        (x @ y[:, :, None])[:, :, 0],
        np.einsum("bi,bi->b", y, y),
        rows.astype(float),
        precision,
        np.array([centre.get(n, 0.0) for n in names]) * unit,
        unit,
        good,
        length,
    )


class Projection:
    """The fit of a base set of columns, and what further columns gain beyond it."""

    def __init__(self, g: Gram, base: Sequence[int], blocks: NDArray[np.bool_] | None = None) -> None:
        self.g, self.base = g, list(base)
        use = slice(None) if blocks is None else blocks
        self.total = g.blocks[use].sum(axis=0)
        self.score = g.score[use].sum(axis=0) - g.prior * g.centre
        self.energy = float(g.energy[use].sum()) + float(g.prior @ g.centre**2)
        G = self.total[np.ix_(self.base, self.base)] + np.diag(g.prior[self.base] + 1e-9)
        self._factor = cho_factor(G)
        self.coefficients: Array = cho_solve(self._factor, self.score[self.base])
        # What of every column the base leaves, in cross-products.
        self._solved: Array = cho_solve(self._factor, self.total[self.base])
        self.left_score = self.score - self.total[:, self.base] @ self.coefficients
        self.chi2 = self.energy - float(self.score[self.base] @ self.coefficients)

    def left(self, i: Sequence[int], j: Sequence[int]) -> Array:
        """Cross-products of projected columns."""
        return np.asarray(self.total[np.ix_(i, j)] - self.total[np.ix_(i, self.base)] @ self._solved[:, j])

    def information(self, columns: Sequence[int]) -> Array:
        """Of the columns' coefficients with the base free, their own priors included."""
        return self.left(columns, columns) + np.diag(self.g.prior[list(columns)])

    def solve(self, columns: Sequence[int]) -> tuple[Array, float]:
        """Coefficients of further columns (in the Gram's units) and the fall of chi^2."""
        columns = list(columns)
        H = self.information(columns)
        own = np.diag(self.total)[columns]
        # A direction that the base explains to twelve digits is none.
        keep = np.diag(H) > 1e-10 * np.maximum(own, 1e-300)
        theta = np.zeros(len(columns))
        if not keep.any():
            return theta, 0.0
        at = np.flatnonzero(keep)
        s = self.left_score[np.array(columns)[at]]
        d = np.sqrt(np.diag(H)[at])
        values, vectors = np.linalg.eigh(H[np.ix_(at, at)] / np.outer(d, d))
        good = values > 1e-8
        w = (vectors[:, good] / values[good]) @ (vectors[:, good].T @ (s / d))
        theta[at] = w / d
        return theta, float(s @ theta[at])
