"""Arrays of float64 from the numbers of a user, without a rounding."""

from __future__ import annotations

from typing import Final, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ivsid.errors import IvsidError

FloatArray: TypeAlias = NDArray[np.float64]

# Integers below this size are doubles.
# Source: definition: 53 bits of a double
LARGEST_EXACT: Final = 2.0**53


def exact_floats(values: ArrayLike, what: str) -> FloatArray:
    """The numbers as float64, of the same shape and without a copy where possible.

    Args:
        values: float64, shorter floats, integers or booleans.
        what: their name, for messages.

    Raises:
        IvsidError: another type or kind of array, or an integer without an exact double.
    """
    if isinstance(values, np.ma.MaskedArray | np.matrix):
        # The first has entries that are missing, and the second another product.
        kind = "a masked array" if isinstance(values, np.ma.MaskedArray) else "a matrix of NumPy"
        raise IvsidError(f"{what} is {kind}; give a plain array of float64 numbers")
    try:
        array = np.asarray(values)
    except ValueError:
        raise IvsidError(f"{what} has rows of different lengths; give an array of float64 numbers") from None
    if not array.flags.aligned:
        array = array.copy()
    if array.dtype == np.float64:
        if not isinstance(values, np.ndarray):
            _check_integers(values, array, what)
        return cast(FloatArray, array)
    if array.dtype.kind in "biu" or array.dtype in (np.float32, np.float16):
        floats = array.astype(np.float64)
        large = np.abs(floats) >= LARGEST_EXACT
        if array.dtype.kind in "iu" and large.any():
            _compare(floats[large], array[large], what)
        return floats
    raise IvsidError(f"{what} is of type {array.dtype}; give float64 numbers")


def _check_integers(values: ArrayLike, floats: FloatArray, what: str) -> None:
    """Refuses integers that NumPy rounded, because floats stand beside them in a list."""
    large = np.isfinite(floats) & (np.abs(floats) >= LARGEST_EXACT)
    if large.any():
        given = np.asarray(values, dtype=object)[large]
        whole = np.array([isinstance(x, int | np.integer) for x in given])
        _compare(floats[large][whole], given[whole], what)


def _compare(floats: FloatArray, integers: NDArray[np.object_] | NDArray[np.integer], what: str) -> None:
    if any(int(f) != int(i) for f, i in zip(floats, integers, strict=True)):
        raise IvsidError(f"{what} has an integer beyond 2**53 without an exact double; enclose it by two bounds")
