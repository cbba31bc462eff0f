"""Cells of signs: whether the closed cells and the proved signs cover every combination of signs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

# One sign an unknown: 1, -1, or 0 for both.
Cell: TypeAlias = tuple[int, ...]


def covers(cells: Sequence[Cell], n: int, proved: Mapping[Cell, tuple[Cell, int | None]] | None = None) -> bool:
    """Whether every combination of n signs that a consistent parameter can have lies in a cell.

    Args:
        cells: the closed cells.
        n: number of unknowns.
        proved: for a region of signs, the smaller region that holds all of its consistent parameters, and the unknown
            whose two signs were examined apart.
    """
    return _covered(list(cells), (0,) * n, proved or {})


def _covered(cells: list[Cell], region: Cell, proved: Mapping[Cell, tuple[Cell, int | None]]) -> bool:
    if any(all(c in (0, r) for c, r in zip(cell, region, strict=True)) for cell in cells):
        return True
    smaller, branch = proved.get(region, (region, None))
    if any(all(c in (0, r) for c, r in zip(cell, smaller, strict=True)) for cell in cells):
        return True
    near = [cell for cell in cells if all(c * r >= 0 for c, r in zip(cell, smaller, strict=True))]
    split = [k for k, r in enumerate(smaller) if not r and (k == branch or any(cell[k] for cell in near))]
    if not split or (not near and branch is None):
        return False
    k = branch if branch in split else split[0]
    return all(_covered(near, (*smaller[:k], s, *smaller[k + 1 :]), proved) for s in (1, -1))
