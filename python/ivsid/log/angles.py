"""Angles that wrap: followed through whole turns, with the reading error below which the turns are certain."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.memory.pieces import pieces
from ivsid.memory.room import DOUBLE, room

Array = NDArray[np.float64]

# A whole turn [rad].
# Source: definition
TURN: Final = 2 * np.pi
PLAIN: Final = ("psi", "wind_direction")
BY_THRUSTER: Final = ("azimuth_", "rudder_")


def is_angle(name: str) -> bool:
    """Whether a channel is an angle: the same after a whole turn."""
    return name in PLAIN or name.startswith(BY_THRUSTER)


def unwrapped(values: Array) -> tuple[Array, Array]:
    """Angles with whole turns added, so that no neighbours are more than half a turn apart.

    Turns are counted as integers: sums of rounded turns would lose more with every wrap of a long log.

    Args:
        values: angles [rad], shape (n,), none missing.

    Returns:
        The angles and the bounds of their rounding [rad], shape (n,) each.
    """
    return with_turns(values, turns_of(values))


def turns_of(values: Array) -> Array:
    """The whole turns [1] to add to each angle [rad]; those of a missing one are of no use."""
    turns, last, done = room(values.size, DOUBLE), np.nan, 0.0
    for part in pieces(values.size):
        here = values[part]
        known = np.flatnonzero(~np.isnan(here))
        if not known.size:
            turns[part] = 0.0
            continue
        followed = here[known]
        steps = np.diff(followed, prepend=followed[0] if np.isnan(last) else last)
        # Sums of integers are exact.
        there = done - np.cumsum(np.round(steps / TURN))
        turns[part] = 0.0
        turns[part][known] = there
        last, done = followed[-1], there[-1]
    return turns


def with_turns(values: Array, turns: Array) -> tuple[Array, Array]:
    """Angles with whole turns added, and the bounds of their rounding [rad]."""
    whole = turns * TURN
    made = values + whole
    # 2 pi as a double is off by less than half a unit, a product and a sum are rounded.
    lost = np.where(turns != 0, np.spacing(np.abs(whole)) + np.spacing(np.abs(made)), 0.0)
    return made, lost


def wrapped(values: Array) -> tuple[Array, Array]:
    """Angles [rad] between -pi and pi, and the bounds of their rounding; NaN stays NaN."""
    return np.arctan2(np.sin(values), np.cos(values)), 8 * np.spacing(np.abs(np.nan_to_num(values)) + np.pi)


def certain_below(values: Array, t: Array, rate: float, longest: float, jitter: float) -> float:
    """The bound on the error of a reading [rad] below which the whole turns are certain: the least over all neighbours.

    Let the truth turn by at most L h < pi in a step h, and let each reading be off by at most e. Two unwrapped readings then differ
    by at most L h + 2 e where the turns are right, and by at least 2 pi - L h - 2 e where they are wrong.

    Args:
        values: unwrapped angles.
        t: their times [s].
        rate: L, the largest rate of change [rad/s].
        longest: steps longer than this are gaps, which are not bridged.
        jitter: bound on the error of each time [s].

    Returns:
        The bound [rad]; infinite where no two samples are neighbours.
    """
    steps = np.diff(t)
    room = 0.5 * (TURN - rate * (steps + 2 * jitter) - np.abs(np.diff(values)))
    near = steps <= longest
    # The factor and the last term hold the roundings above.
    return float(room[near].min()) * (1 - 1e-9) - 1e-9 if near.any() else np.inf
