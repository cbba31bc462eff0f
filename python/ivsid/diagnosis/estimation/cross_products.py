"""Cross-products of whitened signatures and errors by block of time, with the normal matrix of a base.

Fits, falls of chi-squared and their errors are small linear algebra from there (``projection``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.noise import Noise
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.memory.pieces import over_pieces, pieces, processors

Array = NDArray[np.float64]
# Products from which a second thread takes less time to start than it saves.
# Source: resource: a tenth of a millisecond's work
WORTH_TWO: Final = 1 << 22
# Pieces of the blocks for each processor: another process may have one of them.
# Source: resource: each starts a product of its own, some microseconds
TURNS: Final = 4
# Length of a block [s].
# Source: geometry: longer than the memory of a filter (3.3 s at most) and of the whitening, so that the errors of two blocks are nearly independent
BLOCK: Final = 10.0
# Blocks that are summed for the scatter of coefficients.
# Source: geometry: half a minute, longer than the ambient force and the memory of the filters last
HALF_MINUTE: Final = 3
# Precision that every coefficient of a base has beforehand, in its column's unit length.
# Source: geometry: a billionth of a column that nothing else explains; keeps the normal matrix regular where columns are dependent
RIDGE: Final = 1e-9


@dataclass(frozen=True)
class Gram:
    """Cross-products of named columns and of the errors, block by block.

    Attributes:
        names: of the columns.
        parts: the columns in unit length, in the order of the names, each part of shape (columns, blocks, numbers); empty if only sums are kept.
        y: the errors, shape (blocks, numbers).
        blocks: shape (blocks, columns, columns).
        score: columns times errors, shape (blocks, columns).
        energy: squared errors, shape (blocks,).
        rows: numbers in each block.
        prior: precision of each column's coefficient before the data, shape (columns,).
        centre: the part of each coefficient that the hypothesis holds already, in the columns' units, shape (columns,).
        unit: length of each column before it was brought to unit length, shape (columns,).
        good: samples that count, shape (n,).
        length: samples in a block.
        white: the whitening of columns and errors.
    """

    names: tuple[str, ...]
    parts: tuple[Array, ...]
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
    white: Whitening

    @cached_property
    def index(self) -> dict[str, int]:
        """Column by name."""
        return {n: k for k, n in enumerate(self.names)}

    @cached_property
    def total(self) -> Array:
        """Cross-products over the whole log, shape (columns, columns)."""
        return np.asarray(self.blocks.sum(axis=0))

    @cached_property
    def halves(self) -> tuple[Array, Array]:
        """Cross-products and scores of half-minutes, shapes (half-minutes, columns, columns) and (half-minutes, columns)."""
        count = len(self.blocks) // HALF_MINUTE
        blocks, score = self.blocks[: count * HALF_MINUTE], self.score[: count * HALF_MINUTE]
        return (
            blocks.reshape(count, HALF_MINUTE, *blocks.shape[1:]).sum(axis=1),
            score.reshape(count, HALF_MINUTE, -1).sum(axis=1),
        )

    def normal(self, base: Sequence[int]) -> Array:
        """The normal matrix of a base, priors included, shape (base, base)."""
        return np.asarray(self.total[np.ix_(base, base)] + np.diag(self.prior[base] + RIDGE))

    def regression(self, columns: Sequence[int], base: Sequence[int]) -> Array:
        """Coefficients of columns in a base by least squares, shape (base, columns)."""
        return np.asarray(np.linalg.solve(self.normal(base), self.total[np.ix_(base, columns)]), dtype=np.float64)

    def at(self, names: Sequence[str]) -> list[int]:
        """Indices of names."""
        index = self.index
        return [index[n] for n in names]

    def columns(self, at: Sequence[int]) -> Array:
        """Columns in unit length, shape (columns, blocks, numbers)."""
        rows = [row for part in self.parts for row in part]
        return np.stack([rows[k] for k in at]) if at else np.zeros((0, *self.y.shape))

    def explained(self, at: Sequence[int], theta: Array) -> Array:
        """Sums of columns with coefficients of shape (columns, ...), shape (..., blocks, numbers)."""
        weight = np.zeros((len(self.names), *theta.shape[1:]))
        weight[list(at)] = theta
        out: Array | None = None
        first = 0
        for part in self.parts:
            here = weight[first : first + len(part)]
            first += len(part)
            if here.any():
                # A sum of its own would take as much memory again, and longer than its products.
                more = here.T @ part.reshape(len(part), part.shape[1] * part.shape[2])
                out = more if out is None else np.add(out, more, out=out)
        return (
            np.zeros((*theta.shape[1:], *self.y.shape)) if out is None else out.reshape(*theta.shape[1:], *self.y.shape)
        )

    def left(self, at: Sequence[int], theta: Array) -> Array:
        """Whitened errors that columns with coefficients leave, by row of the log, shape (rows, n)."""
        x = self.y - self.explained(at, theta)
        rows = sum(len(group) for group in self.white.groups)
        return x.reshape(-1, rows, self.length).transpose(1, 0, 2).reshape(rows, -1)

    def of(self, errors: Array) -> Gram:
        """The same columns with other errors, shape (rows, n)."""
        y = self.white.blocks([errors], self.good, self.length, unit=False)[0].reshape(self.y.shape)
        score = np.concatenate([_times(part, y) for part in self.parts], axis=1)
        return replace(self, y=y, score=score, energy=np.einsum("bi,bi->b", y, y))

    def only(self, columns: Sequence[int]) -> Gram:
        """Some of the columns alone, by index."""
        at = list(columns)
        # Leading columns need no copy.
        leading = at == list(range(len(at))) and len(at) <= len(self.parts[0])
        return replace(
            self,
            names=tuple(self.names[k] for k in at),
            parts=(self.parts[0][: len(at)] if leading else self.columns(at),),
            blocks=self.blocks[:, at][:, :, at],
            score=self.score[:, at],
            prior=self.prior[at],
            centre=self.centre[at],
            unit=self.unit[at],
        )

    def extended(self, names: Sequence[str], columns: Sequence[Array], *, sums: bool = False) -> Gram:
        """With further columns, each of shape (rows, n); with ``sums`` the columns themselves are not kept."""
        x, unit = self.white.blocks(columns, self.good, self.length)
        return self.joined(names, x, unit, sums=sums)

    def whole(self) -> Gram:
        """The whole log as one block: all that a fit needs."""
        return replace(
            self,
            parts=tuple(part.reshape(len(part), 1, part.shape[1] * part.shape[2]) for part in self.parts),
            y=self.y.reshape(1, -1),
            blocks=self.blocks.sum(axis=0, keepdims=True),
            score=self.score.sum(axis=0, keepdims=True),
            energy=self.energy.sum(keepdims=True),
            rows=self.rows.sum(keepdims=True),
        )

    def joined(
        self, names: Sequence[str], x: Array, unit: Array, *, sums: bool = False, known: Array | None = None
    ) -> Gram:
        """With further columns that are whitened and in unit length.

        Args:
            names: theirs.
            x: they, shape (columns, blocks, numbers); blocks of another length are taken for these.
            unit: their lengths.
            sums: whether the columns themselves are not kept.
            known: their products with the first columns, where these are known, shape (blocks, first columns, columns).
        """
        old, new = len(self.names), len(names)
        x = x.reshape(new, *self.y.shape)
        blocks = np.empty((len(self.y), old + new, old + new))
        blocks[:, :old, :old] = self.blocks
        first = 0
        for part in self.parts:
            cross = known if known is not None and first == 0 else _products(part, x)
            blocks[:, first : first + len(part), old:] = cross
            blocks[:, old:, first : first + len(part)] = cross.transpose(0, 2, 1)
            first += len(part)
        blocks[:, old:, old:] = _products(x, x)
        return replace(
            self,
            names=(*self.names, *names),
            parts=() if sums else (*self.parts, x),
            blocks=blocks,
            score=np.concatenate([self.score, _times(x, self.y)], axis=1),
            prior=np.r_[self.prior, np.zeros(new)],
            centre=np.r_[self.centre, np.zeros(new)],
            unit=np.r_[self.unit, unit],
        )


def _times(x: Array, y: Array) -> Array:
    """Columns times errors, shape (blocks, columns)."""
    return np.asarray((x.transpose(1, 0, 2) @ y[:, :, None])[:, :, 0])


def _products(x: Array, y: Array) -> Array:
    """Products of columns with others, or with each other, within each block, shape (blocks, columns, others)."""
    out = np.empty((x.shape[1], len(x), len(y)))
    if len(out) == 1 and len(x) * len(y) * x.shape[2] >= WORTH_TWO:
        _of_one_block(x[:, 0], y[:, 0], out[0], square=y is x)
        return out

    def work(part: slice) -> None:
        for b in range(part.start, part.stop):
            # A matrix times its own transpose is half the work.
            left = x[:, b]
            out[b] = left @ (left if y is x else y[:, b]).T

    over_pieces(pieces(len(out), -(-len(out) // (TURNS * processors()))), work)
    return out


def _of_one_block(x: Array, y: Array, out: Array, *, square: bool) -> None:
    """Products over the whole log in two halves of the columns, which two threads share; the halves are the same for one thread."""
    half = len(x) // 2
    one, other = slice(half), slice(half, None)

    def work(part: slice) -> None:
        if not square:
            side = (one, other)[part.start]
            out[side] = x[side] @ y.T
        elif part.start == 0:
            out[one, other] = x[one] @ x[other].T
        else:
            # Two squares of half the columns are as much work as the rectangle beside them.
            out[one, one], out[other, other] = x[one] @ x[one].T, x[other] @ x[other].T

    over_pieces(pieces(2, 1), work)
    if square:
        out[other, one] = out[one, other].T


def gram(columns: Columns, errors: Array, noise: Noise, h: Hypothesis) -> Gram:
    """Cross-products of signatures and errors, whitened.

    Args:
        columns: signatures, with the standard deviations of the coefficients that are known beforehand.
        errors: of the log, shape (rows, n).
        noise: of the log.
        h: the hypothesis, which holds a part of each declared error already.
    """
    names, prior, white, good = columns.names, columns.prior, noise.whitening, noise.good
    length = max(1, round(BLOCK / noise.predictor.log.h))
    y = white.blocks([errors], good, length, unit=False)[0][0]
    x, unit = white.blocks(columns.arrays, good, length) if names else (np.zeros((0, *y.shape)), np.zeros(0))
    rows = good[: len(y) * length].reshape(len(y), length).sum(axis=1) * errors.shape[0]
    precision = np.array([1 / (prior[n] * u) ** 2 if n in prior else 0.0 for n, u in zip(names, unit, strict=True)])
    return Gram(
        tuple(names),
        (x,),
        y,
        _products(x, x),
        _times(x, y),
        np.einsum("bi,bi->b", y, y),
        rows.astype(float),
        precision,
        np.array([h.declared_errors.get(n, 0.0) for n in names]) * unit,
        unit,
        good,
        length,
        white,
    )
