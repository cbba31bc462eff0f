"""Velocities that a log has by its pose alone: differences over short steps, each at the middle of its step.

A smoother looks ahead and leaves errors with a long memory. A difference does neither beyond its own step. Two neighbouring differences
share the pose between them, and the whitening takes out the noise that they share.

A yaw rate that is a difference of headings says nothing beside them: it is a start for the filter of yaw, which the heading alone corrects.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.sensor_noise import scatter
from ivsid.errors import IvsidError
from ivsid.log import Log

Array = NDArray[np.float64]
# Step of the differences [s]: long enough for the noise of the pose, short beside the motion.
# Source: measured: make constants
STEP: Final = 0.25
# Reach of the straight line through the pose around either end of a step, as a share of the step.
# Source: geometry: the lines of both ends leave half of the step between them, and the ends of neighbouring steps share one line
SIDE: Final = 0.25
# Farthest distance of a single sample that stands for the pose at an end of a step, as a share of the step.
# Source: measured: make constants
CLOSE: Final = 0.1
# Largest share of the noise in the variance of velocities that a pose alone gives.
# Source: geometry: regressors with more of it give masses and drags that are off by as much
DROWNED: Final = 0.1
POSE: Final = ("x", "y", "psi")
# Headings from which a yaw rate and their noise are told.
# Source: definition: a third difference needs four
FEWEST: Final = 4
# Factors by which differences of the heading are longer where its noise asks for it, the shortest first.
# Source: geometry: the noise of a difference falls with its length, and hulls turn in half a second to half a minute
LONGER: Final = (1, 2, 4, 8)
# Largest share of the heading's noise in the variance of its differences.
# Source: definition: the standard deviation of such a yaw rate is off by half a per cent
NOISY: Final = 0.01


def differenced(log: Log) -> Log:
    """The log with u, v [m/s] and r [rad/s] from its pose, where it lacks them, or with r where it lacks that alone.

    With u and v the position leaves the log: the velocities hold all that it says. Another log comes back as it is.

    Args:
        log: with psi [rad], and x, y [m] if it lacks velocities.

    Raises:
        IvsidError: velocities of a pose alone would be mostly noise.
    """
    if "psi" not in log.columns:
        return log
    if {"u", "v"} <= set(log.columns):
        return log if "r" in log.columns else _turning(log)
    if set(POSE) - set(log.columns) or {"u", "v"} & set(log.columns):
        return log
    h = STEP
    if log.period > 2 * SIDE * STEP:
        # The pose comes too rarely for a line around each end, so that the ends are its samples.
        h = log.period * max(round(STEP / log.period), 1)
    t = log.t[0] + h * np.arange(int((log.t[-1] - log.t[0]) / h) + 1)
    x, y = (_mean(log, name, t, h) for name in ("x", "y"))
    psi = _mean(log, "psi", t, h)
    middle = 0.5 * (psi[1:] + psi[:-1])
    north, east = np.diff(x) / h, np.diff(y) / h
    c, s = np.cos(middle), np.sin(middle)
    made = {"u": north * c + east * s, "v": east * c - north * s, "r": np.diff(psi) / h, "psi": middle}
    at = 0.5 * (t[1:] + t[:-1])
    share = _share(made)
    if share > DROWNED:
        raise IvsidError(
            f"{log.name} has no velocities but those of its pose, whose noise is {100 * share:.0f} % of the variance of the velocities that it gives, and a diagnosis follows "
            f"{100 * DROWNED:.0f} %; log u, v and r, or a pose with less noise"
        )
    # The other channels keep their own times, and the velocities get rows of their own.
    every = np.union1d(log.t, at)
    columns = {}
    for name, values in log.columns.items():
        if name not in POSE:
            columns[name] = _spread(every, log.t, values)
    columns |= {name: _spread(every, at, values) for name, values in made.items() if name not in columns}
    note = f"velocities are differences of the pose over {h:.3g} s, each at the middle of its step"
    return replace(log, t=every, columns=columns, notes=(*log.notes, note))


def _turning(log: Log) -> Log:
    """The log with a yaw rate at its rows: differences of the heading over the shortest time in which its noise is small."""
    there = np.isfinite(log.columns["psi"])
    if there.sum() < FEWEST:
        return log
    t, psi = log.t[there], np.unwrap(log.columns["psi"][there])
    noise = scatter(psi, 3)
    for longer in LONGER:
        half = longer * max(STEP, float(np.median(np.diff(t))))
        first, last = (np.clip(log.t + x, t[0], t[-1]) for x in (-half, half))
        r = (np.interp(last, t, psi) - np.interp(first, t, psi)) / np.maximum(last - first, half)
        if 2.0 * (noise / (2.0 * half)) ** 2 <= NOISY * float(np.var(r)):
            break
    return replace(
        log,
        # A compass that is read more rarely than the log's rows sets the clock, as a rare velocity does.
        columns={**log.columns, "r": np.where(there, r, np.nan)},
        derived={**log.derived, "r": ("psi",)},
        notes=(*log.notes, "the heading alone tells the yaw rate: no gyro is logged"),
    )


def _share(made: Mapping[str, Array]) -> float:
    """Share of the noise in the variance of u and v."""
    known = [made[q][np.isfinite(made[q])] for q in ("u", "v")]
    if min(x.size for x in known) < FEWEST:
        return 0.0
    return sum(scatter(x, 3) ** 2 for x in known) / max(sum(float(np.var(x)) for x in known), 1e-300)


def _mean(log: Log, name: str, t: Array, h: float) -> Array:
    """A channel at times t, shape of t: the value of a straight line through its samples within ``SIDE`` steps, NaN if it has none there."""
    values = log.columns[name]
    there = np.isfinite(values)
    own, x = log.t[there], values[there]
    if name == "psi":
        x = np.unwrap(x)
    found = np.full(t.size, np.nan)
    for k, moment in enumerate(t.tolist()):
        a, b = np.searchsorted(own, [moment - SIDE * h, moment + SIDE * h + 1e-9])
        if b - a > 1:
            off = own[a:b] - moment
            slope = np.polyfit(off, x[a:b], 1)
            found[k] = slope[-1]
        elif b - a == 1 and abs(own[a] - moment) < CLOSE * h:
            found[k] = x[a]
    return found


def _spread(every: Array, t: Array, values: Array) -> Array:
    out = np.full(every.size, np.nan)
    out[np.searchsorted(every, t)] = values
    return out
