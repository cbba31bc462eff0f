"""Cells of the yaw rate that are cut anew: that they hold every state of the step before (docs/theory.md, "Guaranteed simulation", "Cells of the yaw rate")."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ivsid.verification.rational import Range

# Number of the yaw rate among the velocities.
# Source: definition: u, v, r
YAW: Final = 2


def meet(a: Sequence[Range], b: Sequence[Range]) -> bool:
    """Whether two boxes share a yaw rate."""
    return a[YAW].low <= b[YAW].high and b[YAW].low <= a[YAW].high


def covers(cells: Sequence[Sequence[Range]], box: Sequence[Range]) -> bool:
    """Whether each state of a box lies in a cell.

    Cells that meet the box in yaw have to hold its u and v, and their yaw rates have to follow each other without a gap.
    """
    reached = box[YAW].low
    for cell in sorted((c for c in cells if meet(c, box)), key=lambda c: c[YAW].low):
        beside = all(cell[k].low <= box[k].low and box[k].high <= cell[k].high for k in range(YAW))
        if not beside or cell[YAW].low > reached:
            return False
        reached = max(reached, cell[YAW].high)
    # An empty list of cells reaches no further than the lower end, which may be the upper one, too.
    return reached >= box[YAW].high and any(meet(c, box) for c in cells)
