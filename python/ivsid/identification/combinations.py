"""Combinations of parameters that the data determine where single parameters stay unbounded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ivsid.intervals import FloatArray

# Coefficients below this share of the largest count as 0; the directions are floats of linear programs.
# Source: measured: make constants
SMALL: Final = 1e-6
# Singular values below this share of the largest count as 0.
# Source: measured: make constants
RANK: Final = 1e-9


def determined(n: int, directions: Sequence[FloatArray]) -> list[FloatArray]:
    """Combinations c of n parameters that stay bounded: c d = 0 for every direction d in which the set is unbounded.

    Gauss-Jordan elimination with full pivoting makes each combination name few parameters; its leading coefficient is 1. The result
    is an estimate, as the directions are.

    Args:
        n: number of parameters.
        directions: shape (n,) each.

    Returns:
        Combinations, shape (n,) each; the single parameters where no direction is given.
    """
    if not directions:
        return list(np.eye(n))
    open_ = np.array(directions)
    size = np.maximum(np.abs(open_).max(axis=0), np.finfo(float).tiny)
    scale = np.where(size > np.finfo(float).tiny, size, 1.0)
    _, values, basis = np.linalg.svd(open_ / scale, full_matrices=True)
    rank = int((values > RANK * values[0]).sum())
    rest = basis[rank:]
    rows: list[FloatArray] = []
    for _ in range(rest.shape[0]):
        i, j = np.unravel_index(int(np.argmax(np.abs(rest))), rest.shape)
        pivot = rest[i] / rest[i, j]
        rest = np.delete(rest, i, axis=0)
        rest = rest - np.outer(rest[:, j], pivot)
        rows = [r - r[j] * pivot for r in rows] + [pivot]
    made = []
    for row in rows:
        kept = np.where(np.abs(row) < SMALL * np.abs(row).max(), 0.0, row) / scale
        made.append(kept / kept[np.flatnonzero(kept)[0]])
    return sorted(made, key=lambda r: int(np.flatnonzero(r)[0]))


def in_words(combination: dict[str, float]) -> str:
    """A combination as text, such as ``mass.surge + 0.3 drag.surge.quadratic``."""
    text = ""
    for id_, c in combination.items():
        sign = " - " if c < 0 else " + "
        size = "" if abs(abs(c) - 1) < SMALL else f"{abs(c):.3g} "
        text += (sign if text else sign.strip().replace("+", "")) + size + id_
    return text
