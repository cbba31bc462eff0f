"""Clocks that begin anew: times of day as text past midnight, and seconds of a day or a week that fall back to zero."""

from __future__ import annotations

from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.log.record import steps_in
from ivsid.memory.pieces import any_piece

Array = NDArray[np.float64]

# Nanoseconds of a day.
# Source: definition
DAY: Final = 86_400 * 10**9
# Seconds after which a numeric clock begins anew: a day, and the week of GPS.
# Source: definition: IS-GPS-200, section 3.3.4, for the week
ROUNDS: Final = (86_400.0, 604_800.0)
# Largest step over the end of a round, in median steps: a clock that was set anew, or a second run in one file, steps otherwise.
# Source: definition: as many samples may be lost there
STEPS: Final = 20.0


def past_midnight(stamps: pl.Series) -> tuple[pl.Series, list[int]]:
    """Times of day whose days are counted: one more where the time falls by more than half a day, one less where it rises back by as much.

    Args:
        stamps: nanoseconds since midnight, integers; null where one is missing.

    Returns:
        The stamps since the first midnight, and the positions at which a day was added.
    """
    known = np.flatnonzero(stamps.is_not_null().to_numpy())
    step = np.diff(stamps.drop_nulls().to_numpy())
    turned = np.where(step < -DAY // 2, 1, np.where(step > DAY // 2, -1, 0))
    # A rise is the way back over the last midnight, and only there: else it is a gap of more than half a day.
    days, day = np.zeros(known.size, dtype=np.int64), 0
    for k in np.flatnonzero(turned).tolist():
        if turned[k] > 0 or day > 0:
            day += int(turned[k])
            days[k + 1 :] = day
    if not days.any():
        return stamps, []
    whole = np.zeros(len(stamps), dtype=np.int64)
    whole[known] = days
    return stamps + pl.Series(whole * DAY), known[np.flatnonzero(np.diff(days) > 0) + 1].tolist()


def begun_anew(stamps: Array, scale: float) -> tuple[Array, float, list[int]]:
    """What a numeric clock that begins anew each day or week lacks: whole rounds, where it falls back and goes on with its own step.

    Args:
        stamps: as they are, NaN where one is missing, shape (n,).
        scale: of their unit [s].

    Returns:
        Rounds to add to each stamp, shape (n,), their length in the unit of the stamps, and the positions at which one begins.
    """
    if not any_piece(stamps.size - 1, lambda part: bool((steps_in(stamps, part) < 0).any())):
        return np.zeros(0), 0.0, []
    step = np.diff(stamps)
    back = np.flatnonzero(step < 0)
    usual = float(np.median(step[step > 0])) if (step > 0).any() else 0.0
    for seconds in ROUNDS:
        length = seconds / scale
        inside = bool(np.nanmin(stamps) >= 0.0 and np.nanmax(stamps) <= length)
        over = step[back] + length
        anew = back[(over > 0) & (over <= STEPS * usual)] + 1
        if inside and anew.size:
            rounds = np.zeros(stamps.size)
            rounds[anew] = 1.0
            return np.cumsum(rounds), length, anew.tolist()
    return np.zeros(0), 0.0, []


def is_clock_face(stamps: Array) -> bool:
    """Whether numbers are the digits of a clock, hhmmss, as GNSS receivers write them: they leap by 40 from second 59 to the next minute.

    Args:
        stamps: NaN where one is missing, shape (n,).
    """
    # A stamp that no clock shows stands among the first of almost every log, so that a long one is not copied.
    if any_piece(stamps.size, lambda part: _beyond_clock(stamps[part])):
        return False
    known = stamps[np.isfinite(stamps)]
    if known.size < 2:
        return False
    minutes = np.floor(known / 100)
    over = np.flatnonzero(np.diff(minutes) > 0)
    step = np.diff(known)
    inside = step[np.diff(minutes) == 0]
    usual = float(np.median(inside[inside > 0])) if (inside > 0).any() else 0.0
    if not over.size or not usual:
        return False
    # Seconds leap nowhere; the digits leap at each full minute, and at each full hour by 4,000 more.
    turned = 40.0 * np.diff(minutes)[over] + np.where(
        np.floor(minutes[over + 1] / 100) > np.floor(minutes[over] / 100), 2400.0, 0.0
    )
    rest = step[over] - turned
    return bool(((rest > 0) & (rest <= STEPS * usual)).all())


def _beyond_clock(stamps: Array) -> bool:
    """Whether some number is none that a clock shows as hhmmss."""
    known = stamps[np.isfinite(stamps)]
    minutes = np.floor(known / 100)
    off = (known < 0) | (known >= 240_000) | (known - 100 * minutes >= 60) | (minutes % 100 >= 60)
    return bool(off.any())
