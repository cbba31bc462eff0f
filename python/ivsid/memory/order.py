"""Numbers by their rank among many, in bounded memory: the bits of NumPy's median and sort."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
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
    low = float(_ranked(count, part, [(count - 1) // 2])[0][0])
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


def places(count: int, part: Callable[[slice], Array], ranks: Sequence[int]) -> NDArray[np.intp]:
    """The places of the numbers with these ranks, from 0 and in ascending order, as a stable sort has them.

    Args:
        count: of all numbers, none of them NaN.
        part: the numbers of a slice of indices; it is asked several times.
        ranks: in ascending order, each below ``count``.
    """
    if not ranks:
        return np.zeros(0, dtype=np.intp)
    if count <= FEW:
        return np.argsort(part(slice(0, count)), kind="stable")[list(ranks)]
    values, after = _ranked(count, part, ranks)
    found = np.full(len(ranks), -1)
    seen = np.zeros(len(ranks), dtype=np.int64)
    distinct = np.unique(values)
    for start, here in zip(range(0, count, FEW), _parts(count, part), strict=True):
        for value in distinct[np.isin(distinct, here)]:
            where = np.flatnonzero(here == value)
            for k in np.flatnonzero((values == value) & (found < 0)):
                if seen[k] + where.size > after[k]:
                    found[k] = start + where[after[k] - seen[k]]
                seen[k] += where.size
    return found


def _ranked(count: int, part: Callable[[slice], Array], ranks: Sequence[int]) -> tuple[Array, NDArray[np.int64]]:
    """The numbers with these ranks, and how many equal ones stand before each: the leading bits of their places first, then those after them."""
    left = np.array(ranks, dtype=np.int64)
    known = np.zeros(left.size, dtype=np.uint64)
    for shift in range(64 - BITS, -1, -BITS):
        begins = np.unique(known)
        counts = np.zeros((begins.size, 1 << BITS), dtype=np.int64)
        for values in _parts(count, part):
            keys = _keys(values) >> np.uint64(shift)
            before = keys >> np.uint64(BITS)
            group = np.minimum(np.searchsorted(begins, before), begins.size - 1)
            mine = begins[group] == before
            digits = (keys[mine] & np.uint64((1 << BITS) - 1)).astype(np.intp)
            counts += np.bincount(group[mine] * (1 << BITS) + digits, minlength=counts.size).reshape(counts.shape)
        totals = np.cumsum(counts, axis=1)
        for k, group in enumerate(np.searchsorted(begins, known)):
            place = int(np.searchsorted(totals[group], left[k], side="right"))
            left[k] -= totals[group, place] - counts[group, place]
            known[k] = known[k] << np.uint64(BITS) | np.uint64(place)
    return _values(known), left


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
