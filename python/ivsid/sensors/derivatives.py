"""Accelerations enclosed from velocities, where the vehicle file bounds the rate of change of an acceleration.

The mean of udot over a window is an exact difference of two velocities. If |d^2 u / dt^2| <= J, the acceleration at a moment t of
the window [t_i, t_j] differs from that mean by at most J ((t - t_i)^2 + (t_j - t)^2) / (2 (t_j - t_i)). The intervals of several
windows, and the stated limit of the acceleration itself, are intersected.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.vehicle import Sensors

# Lengths of the windows, as shares of the length at which reading and jerk contribute the same width. The best length varies with
# the motion; every window holds, so that their choice decides the width alone.
# Source: measured: make constants
SHARES: Final = (0.5, 0.7, 1.0, 1.4)
RATES: Final = {"udot": "u", "vdot": "v", "rdot": "r"}


def enclosed_rate(
    log: Log, channel: IntervalArray, limit: float | None, jerk: float | None, name: str
) -> IntervalArray | None:
    """Intervals of the rate of change of a channel at every row, shape (n,); None if neither limit is stated.

    Args:
        log: its clock.
        channel: shape (n,); a missing sample is [-inf, inf].
        limit: bound of the rate [unit/s].
        jerk: bound of the rate of change of the rate [unit/s^2].
        name: for messages.

    Raises:
        IvsidError: no rate within the limits satisfies all windows.
    """
    if limit is None and jerk is None:
        return None
    n = log.t.size
    most = np.inf if limit is None else float(np.nextafter(limit, np.inf))
    lower, upper = np.full(n, -most), np.full(n, most)
    if jerk is not None:
        bend = IntervalArray(np.nextafter(jerk, -np.inf), np.nextafter(jerk, np.inf))
        clock = IntervalArray.around(log.t, log.time_error)
        known = np.isfinite(channel.lower) & np.isfinite(channel.upper)
        for before, after in _windows(log, channel, known, jerk):
            at = np.arange(before, n - after)
            i, j = at - before, at + after
            span = clock[j] - clock[i]
            weight = ((clock[at] - clock[i]).square() + (clock[j] - clock[at]).square()) / (span * 2.0)
            off = (weight * bend).upper
            mean = (channel[j] - channel[i]) / span + IntervalArray(-off, off)
            there = known[i] & known[j]
            lower[at[there]] = np.maximum(lower[at[there]], mean.lower[there])
            upper[at[there]] = np.minimum(upper[at[there]], mean.upper[there])
    if (lower > upper).any():
        k = int(np.argmax(lower > upper))
        raise IvsidError(
            f"{log.name}: around t = {log.t[k]:.6g} s {name} changes as no motion within the limits can; raise [sensors.limits] "
            "acceleration, yaw_acceleration, jerk or yaw_jerk, or the accuracy of the sensor"
        )
    return IntervalArray(lower, upper)


def with_accelerations(
    log: Log, channels: Mapping[str, IntervalArray], sensors: Sensors
) -> tuple[Log, dict[str, IntervalArray]]:
    """The log with the accelerations that it lacks, and their intervals, each of shape (n,).

    They need the limit ``jerk`` (udot, vdot [m/s^2]) or ``yaw_jerk`` (rdot [rad/s^2]); without it the log is unchanged.

    Raises:
        IvsidError: as ``enclosed_rate``.
    """
    limits = sensors.limits
    found: dict[str, IntervalArray] = {}
    for name, (source, measured, limit, jerk) in {
        "udot": ("u", "ax", limits.acceleration, limits.jerk),
        "vdot": ("v", "ay", limits.acceleration, limits.jerk),
        "rdot": ("r", "rdot", limits.yaw_acceleration, limits.yaw_jerk),
    }.items():
        if jerk is None or source not in channels or name in channels or measured in channels:
            continue
        rate = enclosed_rate(log, channels[source], limit, jerk, source)
        if rate is not None and np.isfinite(rate.lower).any():
            found[name] = rate
    if not found:
        return log, {}
    columns = {n: np.where(np.isfinite(x.lower), x.midpoint, np.nan) for n, x in found.items()}
    parts = [f"|d2{RATES[n]}/dt2| never exceeds {(limits.yaw_jerk if n == 'rdot' else limits.jerk)!r}" for n in found]
    for n in found:
        limit = limits.yaw_acceleration if n == "rdot" else limits.acceleration
        parts += [f"|{n}| never exceeds {limit!r}"] if limit is not None else []
    sentence = f"{', '.join(found)} follow from {', '.join(RATES[n] for n in found)} where {' and '.join(parts)}"
    made = replace(
        log,
        columns={**log.columns, **columns},
        derived={**log.derived, **{n: (RATES[n],) for n in found}},
        assumes=(*log.assumes, sentence),
    )
    return made, found


def _windows(log: Log, channel: IntervalArray, known: NDArray[np.bool_], jerk: float) -> Sequence[tuple[int, int]]:
    """Windows as rows before and after the moment: of about the best length, and one-sided ones for the ends of the log."""
    if not known.any():
        return ()
    width = float(np.median((channel.upper - channel.lower)[known]))
    best = np.sqrt(4 * width / jerk)
    halves = {max(1, round(0.5 * s * best / log.period)) for s in SHARES}
    sided = max(1, round(0.7 * best / log.period))
    pairs = [*((h, h) for h in sorted(halves)), (sided, 0), (0, sided)]
    return [p for p in pairs if sum(p) < log.t.size]
