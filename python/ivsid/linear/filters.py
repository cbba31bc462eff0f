"""Thin door to the core's filters: recursions of many outputs at once, causal whitening, and thrusts of many demands. Estimates, and no bounds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid import _core

Array = NDArray[np.float64]
# Absolute and relative bound, knots and values by demand, and knots and values of the hysteresis, if any.
ThrustError: TypeAlias = tuple[float, float, Array, Array, tuple[Array, Array] | None]


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


def table_thrust(
    demand: Array, neutral: float, knots: Sequence[float], pieces: Sequence[Sequence[float]], error: ThrustError | None
) -> Array:
    """Thrusts at demands from the neutral in the order of time, shape (n,).

    Args:
        demand: shape (n,).
        neutral: the demand at which the thrust stands still.
        knots: increasing demands from the neutral; a demand beyond them counts as the nearest.
        pieces: coefficients of the cubic in the distance from the lower knot, lowest power first, by piece.
        error: of the curve inside its bound, as a share of it: a piecewise linear function of the demand, and another one that is added where the
            demand has risen last and subtracted where it has fallen.

    Raises:
        ValueError: lengths that do not fit each other.
    """
    if error is not None:
        absolute, relative, places, values, branch = error
        side = None if branch is None else (branch[0].tolist(), branch[1].tolist())
        return _core.thrust(
            np.ascontiguousarray(demand),
            neutral,
            list(knots),
            [list(p) for p in pieces],
            (absolute, relative, places.tolist(), values.tolist(), side),
        )
    return _core.thrust(np.ascontiguousarray(demand), neutral, list(knots), [list(p) for p in pieces], None)
