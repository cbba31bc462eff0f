"""Thin door to the core's filters: recursions of many outputs at once, and causal whitening. Estimates, and no bounds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ivsid import _core

Array = NDArray[np.float64]


def respond(inputs: Sequence[Array], numerators: Array, denominators: Array) -> Array:
    """Outputs of rational filters that are at rest before the first sample, shape (rows, n).

    Args:
        inputs: signals, each of shape (n,).
        numerators: polynomials in the delay, shape (rows, inputs, taps); at most 4 taps.
        denominators: shape (rows, taps), the first of each row 1.

    Raises:
        ValueError: shapes that do not fit each other.
    """
    return _core.respond([np.ascontiguousarray(x) for x in inputs], numerators, denominators)


def decaying(x: Array, decay: float) -> Array:
    """y_t = x_t + decay y_(t-1), at rest before the first sample, shape (..., n)."""
    rows = x.reshape(-1, x.shape[-1])
    top, below = np.array([[[1.0, 0.0]]]), np.array([[1.0, -decay]])
    return np.array([respond([row], top, below)[0] for row in rows], dtype=np.float64).reshape(x.shape)


def whiten(
    columns: Sequence[Array],
    groups: Sequence[Sequence[int]],
    taps: Sequence[Array],
    length: int,
    weight: Array | None = None,
    *,
    unit: bool = False,
) -> tuple[Array, Array]:
    """A causal filter of groups of rows, in blocks of time: shape (columns, blocks, rows length), and the divisor of each column.

    Args:
        columns: signals, each of shape (rows, n).
        groups: rows that are filtered together.
        taps: by group, shape (lags + 1, rows, rows).
        length: samples in a block; samples beyond the last whole block are left out.
        weight: factor of each sample, shape (n,).
        unit: whether each column is divided by its length.

    Raises:
        ValueError: shapes that do not fit each other, or no column.
    """
    found, lengths = _core.whiten(
        [np.ascontiguousarray(c) for c in columns],
        [list(g) for g in groups],
        [np.ascontiguousarray(t) for t in taps],
        length,
        weight,
        unit,
    )
    return found, np.array(lengths)
