"""The median of many numbers in bounded memory, with the bits of NumPy's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

# Numbers that are sorted at once, and numbers that are counted at once.
# Source: resource: 8 MB
FEW: Final = 1 << 20
# Bits by which numbers are told apart in one pass.
# Source: resource: a table of 65,536 counts
BITS: Final = 16

Array = NDArray[np.float64]


def median(count: int, part: Callable[[slice], Array]) -> float:
    """The median of ``count`` finite numbers, as ``np.median`` gives it.

    Args:
        count: at least 1.
        part: the numbers of a slice of indices; it is asked several times.
    """
    if count <= FEW:
        return float(np.median(part(slice(0, count))))
    low = _ranked(count, part, (count - 1) // 2)
    if count % 2:
        return low
    below, above = 0, np.inf
    for values in _parts(count, part):
        below += int(np.count_nonzero(values <= low))
        larger = values[values > low]
        above = min(above, float(larger.min())) if larger.size else above
    high = low if below > count // 2 else above
    return float(np.mean(np.array([low, high])))


def _parts(count: int, part: Callable[[slice], Array]) -> Iterator[Array]:
    return (part(slice(a, min(a + FEW, count))) for a in range(0, count, FEW))


def _ranked(count: int, part: Callable[[slice], Array], rank: int) -> float:
    """The number with this rank, from 0: the leading bits of its place in the order, then those after them."""
    known, shift = None, 64
    while shift:
        shift -= BITS
        counts = np.zeros(1 << BITS, dtype=np.int64)
        for values in _parts(count, part):
            keys = _keys(values)
            if known is not None:
                keys = keys[keys >> np.uint64(shift + BITS) == known]
            counts += np.bincount((keys >> np.uint64(shift) & np.uint64((1 << BITS) - 1)).astype(np.intp), minlength=1 << BITS)
        place = int(np.searchsorted(np.cumsum(counts), rank, side="right"))
        rank -= int(counts[:place].sum())
        known = np.uint64(((0 if known is None else int(known)) << BITS) | place)
    return float(_values(np.array([known], dtype=np.uint64))[0])


# The sign of a double.
# Source: definition: IEEE 754-2019, binary64
_SIGN: Final = np.uint64(1 << 63)


def _keys(values: Array) -> NDArray[np.uint64]:
    """Integers in the order of the numbers; -0 counts as 0."""
    bits = (np.asarray(values, dtype=np.float64) + 0.0).view(np.uint64)
    return np.where(bits & _SIGN, ~bits, bits | _SIGN)


def _values(keys: NDArray[np.uint64]) -> Array:
    """The numbers of keys."""
    return np.where(keys & _SIGN, keys ^ _SIGN, ~keys).view(np.float64)
