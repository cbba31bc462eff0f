"""A low pass without a shift in time: a Butterworth filter that runs forward and backward.

Source: Oppenheim and Schafer, *Discrete-Time Signal Processing*, 2010, section 7.2 (bilinear transformation).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.linear.filters import respond

Array = NDArray[np.float64]
# Order of the filter: an even number, since its poles go in pairs.
# Source: measured: make constants
ORDER: Final = 4
# Samples beyond each end, for each pair of poles and once more, by which a signal is continued through its last point.
# Source: definition: scipy.signal.sosfiltfilt continues by as many
BEYOND: Final = 6


def low_passed(x: Array, band: float) -> Array:
    """Rows below a frequency, shape (rows, n).

    Args:
        x: of the same shape; at least as many samples as it is continued by.
        band: cut-off frequency, in samples^-1.
    """
    edge = min(BEYOND * (ORDER // 2) + BEYOND // 2, x.shape[1] - 1)
    before = 2 * x[:, :1] - x[:, edge:0:-1]
    after = 2 * x[:, -1:] - x[:, -2 : -edge - 2 : -1]
    rows = np.concatenate([before, x, after], axis=1)
    for _ in range(2):
        rows = np.stack([_once(row, band) for row in rows])[:, ::-1]
    return rows[:, edge : rows.shape[1] - edge]


def _once(x: Array, band: float) -> Array:
    """The filter in one direction, at rest at the first value, shape (n,)."""
    warped = float(np.tan(np.pi * band))
    first, out = x[0], x - x[0]
    for k in range(ORDER // 2):
        damping = 2.0 * float(np.sin(np.pi * (2 * k + 1) / (2 * ORDER))) * warped
        whole = 1.0 + damping + warped**2
        top = np.array([1.0, 2.0, 1.0]) * (warped**2 / whole)
        below = np.array([1.0, 2.0 * (warped**2 - 1.0) / whole, (1.0 - damping + warped**2) / whole])
        out = respond([out], top[None, None], below[None])[0]
    return np.asarray(out + first, dtype=np.float64)
