"""Numbers that stand for a missing sample, as -9999 and 1e20 do: known ones, where they lie far outside of all other cells."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.memory.pieces import array_pieces, pieces

Array = NDArray[np.float64]

# Magnitudes that programs write in place of a sample: nines, ends of integers, the fill values of netCDF and climate data.
# Source: definition: Campbell, NetCDF Users Guide (NC_FILL_FLOAT), CF conventions, two's complement
MARKERS: Final = (
    *(999.0, 999.25, 999.9, 999.99, 9999.0, 9999.9, 9999.99, 9999.999, 99999.0, 99999.9, 999999.0),
    *(7999.0, 32767.0, 32768.0, 2147483647.0, 2147483648.0, 9.969209968386869e36, 1e20, 1e30, 1e35, 1e37),
)
# A marker is more than so many times as large as every other cell.
# Source: definition: a digit beyond what the sensor reads
BEYOND: Final = 10.0
# Markers of one column.
# Source: definition: one for a lost reading, one for a sensor that is switched off
MOST: Final = 2


def without_markers(values: Array) -> tuple[Array, tuple[tuple[float, int], ...]]:
    """Cells of a column without those that mark a missing sample, and each marker with the number of its cells.

    A marker is a number of ``MARKERS`` or its negative, and more than ``BEYOND`` times as large as every other cell that is left.

    Args:
        values: as they stand in the file, shape (n,); NaN is a missing sample.
    """
    found: list[tuple[float, int]] = []
    kept = values
    for _ in range(MOST):
        largest = _largest(kept, np.inf)
        marker = next((m for m in MARKERS if np.isclose(largest, m, rtol=1e-7, atol=0.0)), None)
        rest = 0.0 if marker is None else _largest(kept, largest)
        if marker is None or rest <= 0.0 or BEYOND * rest >= largest:
            break
        counts = {x: sum(int((kept[p] == x).sum()) for p in pieces(kept.size)) for x in (-largest, largest)}
        found += [(x, count) for x, count in counts.items() if count]
        kept = _without(kept, largest)
    return kept, tuple(found)


def _without(values: Array, magnitude: float) -> Array:
    return array_pieces(values.size, lambda part: np.where(np.abs(values[part]) == magnitude, np.nan, values[part]))


def _largest(values: Array, below: float) -> float:
    """The largest magnitude below a number; 0 where there is none."""
    parts = (np.abs(values[p]) for p in pieces(values.size))
    return max((float(np.max(x, where=x < below, initial=0.0)) for x in parts), default=0.0)
