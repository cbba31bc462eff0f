"""Velocities of a log that has a pose alone: mean velocities between its samples, each at the middle of its step.

A smoother looks ahead and leaves errors with a long memory; a difference does neither beyond its own step, and what two neighbours share
is whitened away. The step is long enough for the noise of the pose and short beside the motion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log

Array = NDArray[np.float64]
# Steps of the differences [s].
STEP: Final = 0.25
POSE: Final = ("x", "y", "psi")


def differenced(log: Log) -> Log:
    """The log with u, v, r from its pose where it has none of them; the position itself is used up by that.

    Args:
        log: with x, y and psi, and without u, v, r; else it comes back as it is.
    """
    if set(POSE) - set(log.columns) or {"u", "v", "r"} & set(log.columns):
        return log
    h = max(STEP, log.period)
    t = log.t[0] + h * np.arange(int((log.t[-1] - log.t[0]) / h) + 1)
    x, y = (_mean(log, name, t, h) for name in ("x", "y"))
    psi = _mean(log, "psi", t, h)
    middle = 0.5 * (psi[1:] + psi[:-1])
    north, east = np.diff(x) / h, np.diff(y) / h
    c, s = np.cos(middle), np.sin(middle)
    made = {"u": north * c + east * s, "v": east * c - north * s, "r": np.diff(psi) / h, "psi": middle}
    at = 0.5 * (t[1:] + t[:-1])
    # The other channels keep their own times, and the velocities get rows of theirs.
    every = np.union1d(log.t, at)
    columns = {}
    for name, values in log.columns.items():
        if name not in POSE:
            columns[name] = _spread(every, log.t, values)
    columns |= {name: _spread(every, at, values) for name, values in made.items()}
    note = f"velocities are differences of the pose over {h:.3g} s, each at the middle of its step"
    return replace(log, t=every, columns=columns, notes=(*log.notes, note))


def _mean(log: Log, name: str, t: Array, h: float) -> Array:
    """A channel at the ends of the steps: a straight line through its samples of the quarter of a step on either side; NaN where there are none."""
    values = log.columns[name]
    there = np.isfinite(values)
    own, x = log.t[there], values[there]
    if name == "psi":
        x = np.unwrap(x)
    found = np.full(t.size, np.nan)
    for k, moment in enumerate(t.tolist()):
        a, b = np.searchsorted(own, [moment - 0.25 * h, moment + 0.25 * h + 1e-9])
        if b - a > 1:
            off = own[a:b] - moment
            slope = np.polyfit(off, x[a:b], 1)
            found[k] = slope[-1]
        elif b - a == 1 and abs(own[a] - moment) < 0.1 * h:
            found[k] = x[a]
    return found


def _spread(every: Array, t: Array, values: Array) -> Array:
    out = np.full(every.size, np.nan)
    out[np.searchsorted(every, t)] = values
    return out
