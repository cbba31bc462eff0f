"""Passes of the filters: what each hands on of an error of the states, and how far it may move them so that they settle.

A pass filters the readings with the accelerations at the states of the pass before. An error of the states moves these accelerations by their
slopes, and the next states by that over the memory of each axis. Damping hands errors on with the opposite sign, so that a part of the way
settles where the whole of it goes too far.

Source: Young, *Iterative Solution of Large Linear Systems*, 1971 (under-relaxation).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.prediction.kalman import Axis

Array = NDArray[np.float64]
# Part of an error of the states that passes in the place of one may leave.
# Source: definition: two of them, as most calls ask for, leave less than a hundredth
LEFT: Final = 1 / 16
# Passes in the place of one, at most.
# Source: resource: the time of a fit grows with them; of a radius of eight they leave a sixth of an error
MOST: Final = 8


def handed_on(axes: Sequence[Axis], slopes: Array, *, still: bool = False) -> float:
    """Bound of what a pass of the filters hands on of an error of the states: each by the slopes of the accelerations, over the memory of its axis.

    Args:
        axes: of surge, sway and yaw, and further ones.
        slopes: of the accelerations with the velocities [1/s], shape (3, 3, samples).
        still: whether the yaw rate is that of its sensors, which hands nothing on.

    Returns:
        The spectral radius of the matrix of both.
    """
    count = 2 if still else 3
    memory = np.array([axis.memory for axis in axes[:count]])
    # Where states have run away no slope says anything.
    size = np.nan_to_num(np.sqrt(np.mean(slopes[:count, :count] ** 2, axis=2)), nan=0.0, posinf=0.0)
    return float(np.abs(np.linalg.eigvals(memory[:, None] * size)).max())


def passes(radius: float) -> tuple[float, int]:
    """How far a pass moves the errors, from 0 to 1, and passes in the place of one: all the way and one where errors die out anyway.

    A filter that forgets after a time T answers to a frequency w by 1 / (1 + i w T), so that damping hands errors on by factors on a circle
    over 0 and minus the radius. A part 2 / (2 + radius) leaves radius / (2 + radius) of each, and no polynomial of passes leaves less.
    """
    if radius <= 1.0:
        return 1.0, 1
    share = 2.0 / (2.0 + radius)
    return share, min(int(np.ceil(np.log(LEFT) / np.log(1.0 - share))), MOST)
