"""Single samples of velocities, places and headings that no motion explains."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log.quality import corners

Array = NDArray[np.float64]
# Fewest samples of a channel in which outliers are looked for: the 95 % quantile of fewer rests on one or two of them.
# Source: geometry: a twentieth of 50 samples is 2.5
FEWEST: Final = 50
# Quantile of a channel that counts as usual.
# Source: definition: one sample in twenty lies beyond
USUAL: Final = 0.95
# Outlier threshold, as a multiple of the 95 % quantile of the deviation from the neighbours' midpoint.
# Source: theorem: ten 95 % quantiles are 19.6 standard deviations of Gaussian noise, which no sample of a log reaches
THRESHOLD: Final = 10.0
# Smallest deviation of an outlier, as a share of the channel's standard deviation: a nearly noise-free channel has sharp corners.
# Source: measured: make constants
LEAST_SHARE: Final = 0.3
# The deviation of an outlier exceeds those of its neighbours by this factor.
# Source: geometry: between 1, the highest of three, and 2, the ratio at a single outlier (it moves its neighbours' midpoints by half)
ABOVE_NEIGHBOURS: Final = 1.5
# The distance from the nearer neighbour, on the same side of both, as a share of the deviation from their midpoint.
# Source: geometry: between 0, a jump that ends at the next sample, and 1, an outlier between equal neighbours
BEYOND_BOTH: Final = 0.5


def outliers(x: Array, *, turns: bool = False) -> NDArray[np.bool_]:
    """The samples of a velocity, a place or a heading that stand far beyond both neighbours, shape (n,).

    An outlier lies beyond both neighbours on the same side. A force that jumps moves a sample far from the midpoint of its neighbours,
    too, but next to one of them, and one that turns round makes a corner, to which the samples before or after it lead. Accelerations are no subject:
    they may jump and come back.

    Args:
        x: readings, NaN where one is missing, shape (n,).
        turns: whether it is a heading [rad], which has no sharp corners and may turn by any number of turns.
    """
    there = np.flatnonzero(np.isfinite(x))
    found = np.zeros(x.size, dtype=bool)
    if there.size < FEWEST:
        return found
    values = np.unwrap(x[there]) if turns else x[there]
    before, after = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    off, beyond = np.zeros(there.size), np.zeros(there.size)
    off[1:-1] = 0.5 * np.abs(before + after)
    beyond[1:-1] = np.where(before * after > 0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    corner = np.zeros(there.size, dtype=bool)
    corner[1:-1] = corners(np.diff(values))
    usual = float(np.quantile(off, USUAL))
    highest = off > ABOVE_NEIGHBOURS * np.maximum(np.r_[0.0, off[:-1]], np.r_[off[1:], 0.0])
    if usual > 0:
        far = off > max(THRESHOLD * usual, 0.0 if turns else LEAST_SHARE * float(values.std()))
        found[there] = far & highest & (beyond > BEYOND_BOTH * off) & ~corner
    return found
