"""Velocities enclosed from the pose: where a log has x, y, psi and no velocity sensor (a camera, an acoustic net).

The mean of a velocity over a window is an exact difference of two positions. How far the velocity at a moment inside can be
from that mean, the stated limits of the vessel bound: |V(t) - mean V| <= A ((t - t_i)^2 + (t_j - t)^2) / (2 T), where A bounds
the acceleration in earth axes over the window. A turning vessel accelerates in earth axes without any acceleration in its own,
so A = sqrt(2) a + R W, with a and the yaw acceleration from the limits, R and W bounds on |r| and the speed inside the window
that follow from the same two poses. Several windows are intersected: short ones suffer from the sensor, long ones from A. What is left is
narrowed by the limits once more: no velocity changes faster than they say.
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
DIAGONAL: Final = 1.4142135623730952
# Windows that are tried, as shares of the one where sensor and acceleration weigh the same.
SHARES: Final = (0.35, 0.5, 0.7, 1.0, 1.4, 2.0)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class _Pose:
    """The pose in intervals, where it is there, and the clock."""

    t: IntervalArray
    x: IntervalArray
    y: IntervalArray
    psi: IntervalArray
    turns: NDArray[np.bool_]
    moves: NDArray[np.bool_]
    # Counts the places where the way round from one heading to the next is not certain: windows stay between them.
    piece: NDArray[np.intp]


def with_velocities(log: Log, sensors: Sensors) -> tuple[Log, dict[str, IntervalArray]]:
    """The log with the velocities that it lacks, and their intervals; unchanged where it lacks none or the pose is not bounded.

    Needs ``psi``, [sensors.heading] and [sensors.limits] yaw_acceleration for ``r``; ``x``, ``y``, [sensors.position] and the
    limit on the acceleration too for ``u`` and ``v``. Only rows that have a pose get a velocity.

    Raises:
        IvsidError: the pose contradicts its own bounds: no velocity within the limits fits all windows.
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
    # A truth that turns by less than pi gives readings less than pi - 2 e apart only the right way round.
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
    """Half-lengths in rows: about where sensor and acceleration weigh the same, for the heading and for the position."""
    best = []
    if sensors.heading is not None and sensors.limits.yaw_acceleration is not None:
        best.append(np.sqrt(8 * sensors.heading.accuracy / sensors.limits.yaw_acceleration))
    if moving and sensors.position is not None and sensors.limits.acceleration is not None:
        best.append(np.sqrt(8 * sensors.position.accuracy / (DIAGONAL * sensors.limits.acceleration)))
    halves = {max(1, round(0.5 * s * b / log.period)) for b in best for s in SHARES}
    return sorted(h for h in halves if 2 * h < log.t.size)


def _enclosed(pose: _Pose, half: int, sensors: Sensors, *, moving: bool) -> Mapping[str, IntervalArray]:
    """Velocities at every row from the poses ``half`` rows before and after it; every number where one is missing."""
    n = pose.t.shape[0]
    at = np.arange(half, n - half)
    i, j = at - half, at + half
    before, after, span = pose.t[at] - pose.t[i], pose.t[j] - pose.t[at], pose.t[j] - pose.t[i]
    # Times on the mean that the moment can be off, per unit of acceleration: half the span at the ends, a quarter in the middle.
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
    """A stated decimal, with the rounding of its double."""
    return IntervalArray(np.nextafter(x, -np.inf), np.nextafter(x, np.inf))


def _sided(x: IntervalArray) -> IntervalArray:
    return IntervalArray(-x.upper, x.upper)


def _reached(x: IntervalArray, log: Log, limit: float) -> IntervalArray:
    """What a velocity can still be, given all others: it changes by at most ``limit`` a second. Rows without one stay without."""
    t = log.t - log.t[0]
    far = limit * t
    # Floats below: a product, a difference and a sum, each off by half a unit of the largest operand, and the stamps themselves.
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
