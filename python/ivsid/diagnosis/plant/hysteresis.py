"""Stop operators of a demand: the hysteresis of play in a drive train, of which any other is made.

A play of width w follows a demand as a pointer is pushed by the ends of a slot: it stays while the demand moves inside the slot. What the pointer is
behind, in half widths, is the stop operator: it lies in [-1, 1], reaches an end after a change of w in one direction, and remembers the last turns
of the demand that were wider than w. A mean of stop operators of several widths is the model of Prandtl and Ishlinskii.

Source: Brokate and Sprekels, *Hysteresis and Phase Transitions*, 1996, chapter 2 (play and stop, Prandtl-Ishlinskii operators).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def stop(demand: Array, width: float) -> Array:
    """The stop operator of a demand in the order of time, from a slot whose middle is the first one, shape (n,).

    Each demand d clips the pointer to [d - w/2, d + w/2]. The composition of two clips is a clip, so that all of them follow from a prefix sum by
    doubling (Hillis and Steele, "Data parallel algorithms", 1986).

    Args:
        demand: from neutral, shape (n,).
        width: of the slot, positive, in its unit.
    """
    low, high = demand - 0.5 * width, demand + 0.5 * width
    step = 1
    while step < demand.size:
        before, after = slice(None, -step), slice(step, None)
        low, high = (np.concatenate([x[:step], np.clip(x[before], low[after], high[after])]) for x in (low, high))
        step *= 2
    pointer = np.clip(demand[:1], low, high)
    return np.asarray((demand - pointer) / (0.5 * width))
