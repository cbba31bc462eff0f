"""Angles that wrap: followed through whole turns, and how sure that is."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TURN: Final = 2 * np.pi
PLAIN: Final = ("psi", "wind_direction")
BY_THRUSTER: Final = ("azimuth_", "rudder_")


def is_angle(name: str) -> bool:
    """Whether a channel is an angle, which is the same after a whole turn."""
    return name in PLAIN or name.startswith(BY_THRUSTER)


def unwrapped(values: Array) -> tuple[Array, Array]:
    """Angles [rad], none missing, with whole turns added so that no neighbours are more than half a turn apart, and what that lost.

    Turns are counted as integers: sums of rounded turns would lose more with every wrap of a long log.
    """
    turns = -np.r_[0.0, np.cumsum(np.round(np.diff(values) / TURN))]
    whole = turns * TURN
    made = values + whole
    # 2 pi as a double is off by less than half a unit, a product and a sum are rounded.
    lost = np.where(turns != 0, np.spacing(np.abs(whole)) + np.spacing(np.abs(made)), 0.0)
    return made, lost


def wrapped(values: Array) -> tuple[Array, Array]:
    """Angles between -pi and pi, and what that lost; NaN stays."""
    return np.arctan2(np.sin(values), np.cos(values)), 8 * np.spacing(np.abs(np.nan_to_num(values)) + np.pi)


def certain_below(values: Array, t: Array, rate: float, longest: float, jitter: float) -> float:
    """The error of a reading [rad] below which whole turns were surely followed right: the least over all neighbours.

    A truth that turns by at most L h < pi in a step h gives unwrapped readings w apart with |w| <= L h + 2 e where the turns are right, and
    |w| >= 2 pi - L h - 2 e where they are not.

    Args:
        values: unwrapped angles.
        t: their times [s].
        rate: L, the largest rate of change [rad/s].
        longest: steps longer than this are gaps, which are not bridged.
        jitter: how far each time may be off [s].
    """
    steps = np.diff(t)
    room = 0.5 * (TURN - rate * (steps + 2 * jitter) - np.abs(np.diff(values)))
    near = steps <= longest
    return float(room[near].min()) * (1 - 1e-9) - 1e-9 if near.any() else np.inf
