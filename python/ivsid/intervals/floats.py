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
        IvsidError: another type, or an integer without an exact double.
    """
    array = np.asarray(values)
    if array.dtype == np.float64:
        return cast(FloatArray, array)
    if array.dtype.kind in "biu" or array.dtype in (np.float32, np.float16):
        floats = array.astype(np.float64)
        large = np.abs(floats) >= LARGEST_EXACT
        if array.dtype.kind in "iu" and large.any():
            exact = all(int(f) == int(i) for f, i in zip(floats[large], array[large], strict=True))
            if not exact:
                raise IvsidError(
                    f"{what} has an integer beyond 2**53 without an exact double; enclose it by two bounds"
                )
        return floats
    raise IvsidError(f"{what} is of type {array.dtype}; give float64 numbers")
