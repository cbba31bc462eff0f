"""Velocities enclosed from the pose, for logs with x, y, psi and no velocity sensor (a camera, an acoustic net).

The mean of a velocity over a window is an exact difference of two positions. The stated limits of the vessel bound the distance of
the velocity at a moment inside from that mean: |V(t) - mean V| <= A ((t - t_i)^2 + (t_j - t)^2) / (2 T), where A bounds the
acceleration in earth axes over the window. A vessel that turns accelerates in earth axes without acceleration in its own. Therefore
A = sqrt(2) a + R W, with a from the limits, and R and W bounds of |r| and the speed inside the window from the same two poses and the
limit of the yaw acceleration. The intervals of several windows are intersected: short windows are widened by the sensor, long ones by
A. The limits narrow the result once more, because no velocity changes faster than they state.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.log.angles import unwrapped
from ivsid.vehicle import Sensors

POSE: Final = ("x", "y", "psi")
# Just above the square root of 2: the largest norm of two components that are each at most 1.
# Source: geometry: the diagonal of a square.
DIAGONAL: Final = 1.4142135623730952
# Lengths of the windows, as shares of the length at which sensor and acceleration contribute the same width. Every window holds, so
# that their choice decides the width alone.
# Source: measured: make constants
SHARES: Final = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Pose:
    """The pose in intervals, the rows that have one, and the clock."""

    t: IntervalArray
    x: IntervalArray
    y: IntervalArray
    psi: IntervalArray
    turns: NDArray[np.bool_]
    moves: NDArray[np.bool_]
    # The number of uncertain turns before each row: between two headings the way round may be unknown. No window crosses one.
    piece: NDArray[np.intp]


def with_velocities(log: Log, sensors: Sensors) -> tuple[Log, dict[str, IntervalArray]]:
    """The log with the velocities that it lacks, and their intervals, each of shape (n,): u, v [m/s], r [rad/s].

    ``r`` needs ``psi``, [sensors.heading] and [sensors.limits] yaw_acceleration. ``u`` and ``v`` also need ``x``, ``y``,
    [sensors.position] and the limit of the acceleration. Only rows with a pose get a velocity. A log that lacks none, or whose pose
    is not bounded, is unchanged.

    Raises:
        IvsidError: the pose contradicts its bounds: no velocity within the limits satisfies all windows.
    """
    limits = sensors.limits
    turn = "psi" in log.columns and sensors.heading is not None and limits.yaw_acceleration is not None
    move = (
        turn
        and all(c in log.columns for c in POSE)
        and sensors.position is not None
        and limits.acceleration is not None
    )
    wanted = [n for n in ("u", "v", "r") if n not in log.columns and (turn if n == "r" else move)]
    if not wanted or ("u" in log.columns) != ("v" in log.columns):
        return log, {}
    pose = _pose(log, sensors, moving=move)
    found = {n: _everything(log.t.size) for n in wanted}
    for half in _windows(log, sensors, moving="u" in wanted):
        for name, x in _enclosed(pose, half, sensors, moving="u" in wanted).items():
            if name in found:
                found[name] = _meet(found[name], x, log)
    columns = dict(log.columns)
    for name, wide in found.items():
        limit = limits.yaw_acceleration if name == "r" else limits.acceleration
        found[name] = x = _reached(wide, log, limit or np.inf)
        known = np.isfinite(x.lower)
        columns[name] = np.where(known, x.midpoint, np.nan)
        if not known.any():
            return log, {}
    made = replace(
        log,
        columns=columns,
        derived={**log.derived, **{n: POSE if n != "r" else ("psi",) for n in wanted}},
        assumes=(*log.assumes, _sentence(wanted, sensors)),
        notes=(*log.notes, f"{', '.join(wanted)} are enclosed from the pose at rows that have one"),
    )
    return made, found


def _sentence(wanted: list[str], sensors: Sensors) -> str:
    parts = [f"heading within {sensors.heading.accuracy!r} rad"] if sensors.heading else []
    limits = [f"|rdot| never exceeds {sensors.limits.yaw_acceleration!r} rad/s^2"]
    if "u" in wanted and sensors.position is not None:
        parts.insert(0, f"position within {sensors.position.accuracy!r} m")
        limits.insert(0, f"|udot| and |vdot| never exceed {sensors.limits.acceleration!r} m/s^2")
    return f"{', '.join(wanted)} follow from the pose ({', '.join(parts)}, less than half a turn between samples) where {' and '.join(limits)}"


def _everything(n: int) -> IntervalArray:
    return IntervalArray(np.full(n, -np.inf), np.full(n, np.inf))


def _pose(log: Log, sensors: Sensors, *, moving: bool) -> _Pose:
    psi = log.columns["psi"]
    there = ~np.isnan(psi)
    assert sensors.heading is not None
    turned, lost, piece = np.zeros(psi.shape), log.error("psi"), np.zeros(psi.shape, dtype=np.intp)
    turned[there], more = unwrapped(psi[there])
    lost[there] += more
    # For a true turn below pi, two readings less than pi - 2 e apart have turned the short way.
    off = sensors.heading.accuracy + lost[there]
    most = np.pi - off[1:] - off[:-1] - 1e-9
    piece[np.flatnonzero(there)[1:]] = np.abs(np.diff(turned[there])) >= most
    piece = np.cumsum(piece)
    heading = IntervalArray.around(turned, lost) + _reach(sensors.heading.accuracy)
    both = there & (~np.isnan(log.columns["x"]) & ~np.isnan(log.columns["y"]) if moving else True)
    clock = IntervalArray.around(log.t, log.time_error)
    if not moving or sensors.position is None:
        return _Pose(clock, heading, heading, heading, there, both, piece)
    x, y = (
        IntervalArray.around(np.where(both, log.columns[c], 0.0), np.where(both, log.error(c), 0.0))
        + _reach(sensors.position.accuracy)
        for c in ("x", "y")
    )
    return _Pose(clock, x, y, heading, there, both, piece)


def _reach(accuracy: float) -> IntervalArray:
    above = float(np.nextafter(accuracy, np.inf))
    return IntervalArray(-above, above)


def _windows(log: Log, sensors: Sensors, *, moving: bool) -> list[int]:
    """Half-lengths of the windows in rows: shares of the best length for the heading and for the position."""
    best = []
    if sensors.heading is not None and sensors.limits.yaw_acceleration is not None:
        best.append(np.sqrt(8 * sensors.heading.accuracy / sensors.limits.yaw_acceleration))
    if moving and sensors.position is not None and sensors.limits.acceleration is not None:
        best.append(np.sqrt(8 * sensors.position.accuracy / (DIAGONAL * sensors.limits.acceleration)))
    halves = {max(1, round(0.5 * s * b / log.period)) for b in best for s in SHARES}
    return sorted(h for h in halves if 2 * h < log.t.size)


def _enclosed(pose: _Pose, half: int, sensors: Sensors, *, moving: bool) -> Mapping[str, IntervalArray]:
    """Velocities at every row from the poses ``half`` rows before and after it; [-inf, inf] where one is missing."""
    n = pose.t.shape[0]
    at = np.arange(half, n - half)
    i, j = at - half, at + half
    before, after, span = pose.t[at] - pose.t[i], pose.t[j] - pose.t[at], pose.t[j] - pose.t[i]
    # Distance from the mean per unit of acceleration [s]: half the span at its ends, a quarter in the middle.
    weight = (before.square() + after.square()) / (span * 2.0)
    yaw = sensors.limits.yaw_acceleration
    assert yaw is not None
    mean = (pose.psi[j] - pose.psi[i]) / span
    r = mean + _sided(weight * _point(yaw))
    turns = pose.turns[i] & pose.turns[j] & (pose.piece[i] == pose.piece[j])
    result = {"r": _spread(n, at, turns, r)}
    if not moving or sensors.limits.acceleration is None:
        return result
    own = _point(DIAGONAL) * _point(sensors.limits.acceleration)
    rate = IntervalArray((mean + _sided(span * 0.5 * _point(yaw))).magnitude)
    north, east = (pose.x[j] - pose.x[i]) / span, (pose.y[j] - pose.y[i]) / span
    speed = np.sqrt(north.square() + east.square())
    room = 1.0 - rate * span * 0.5
    bounded = room.lower > 0
    room = IntervalArray(np.where(bounded, room.lower, 1.0))
    fastest = (speed + own * span * 0.5) / room
    off = _sided((own + rate * fastest) * weight)
    cosine, sine = np.cos(pose.psi[at]), np.sin(pose.psi[at])
    known = turns & bounded & pose.moves[i] & pose.moves[j] & pose.moves[at]
    result["u"] = _spread(n, at, known, north * cosine + east * sine + off)
    result["v"] = _spread(n, at, known, east * cosine - north * sine + off)
    return result


def _point(x: float) -> IntervalArray:
    """An interval that holds a stated decimal, which was rounded to a double."""
    return IntervalArray(np.nextafter(x, -np.inf), np.nextafter(x, np.inf))


def _sided(x: IntervalArray) -> IntervalArray:
    return IntervalArray(-x.upper, x.upper)


def _reached(x: IntervalArray, log: Log, limit: float) -> IntervalArray:
    """Each velocity narrowed by all others, because it changes by at most ``limit`` a second; rows without one stay so."""
    t = log.t - log.t[0]
    far = limit * t
    # Slack for a product, a difference and a sum of floats, each off by half a unit of the largest operand, and for the stamps.
    size = (
        np.abs(np.where(np.isfinite(x.upper), x.upper, 0.0))
        + np.abs(np.where(np.isfinite(x.lower), x.lower, 0.0))
        + far[-1]
    )
    slack = 8 * float(np.spacing(size.max())) + 4 * limit * log.time_error
    up = np.minimum(
        np.minimum.accumulate(x.upper - far) + far, np.minimum.accumulate((x.upper + far)[::-1])[::-1] - far
    )
    down = np.maximum(
        np.maximum.accumulate(x.lower + far) - far, np.maximum.accumulate((x.lower - far)[::-1])[::-1] + far
    )
    known = np.isfinite(x.lower)
    reach = IntervalArray(
        np.where(known, np.minimum(down - slack, up + slack), -np.inf), np.where(known, up + slack, np.inf)
    )
    if (known & (down - slack > up + slack)).any():
        raise _contradiction(log, int(np.argmax(known & (down - slack > up + slack))))
    return _meet(x, reach, log)


def _spread(n: int, at: NDArray[np.intp], known: NDArray[np.bool_], x: IntervalArray) -> IntervalArray:
    lower, upper = np.full(n, -np.inf), np.full(n, np.inf)
    lower[at[known]], upper[at[known]] = x.lower[known], x.upper[known]
    return IntervalArray(lower, upper)


def _meet(a: IntervalArray, b: IntervalArray, log: Log) -> IntervalArray:
    lower, upper = np.maximum(a.lower, b.lower), np.minimum(a.upper, b.upper)
    if (lower > upper).any():
        raise _contradiction(log, int(np.argmax(lower > upper)))
    return IntervalArray(lower, upper)


def _contradiction(log: Log, k: int) -> IvsidError:
    return IvsidError(
        f"{log.name}: around t = {log.t[k]:.6g} s the pose moves as no velocity within the bounds can; raise the accuracy of "
        "[sensors.position] or [sensors.heading], or [sensors.limits] acceleration or yaw_acceleration, or leave those samples empty"
    )
