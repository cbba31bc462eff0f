"""Mounted sensors: readings off the origin, in turned axes or with gravity, brought to the body origin in intervals.

A sensor at (l_x, l_y) whose x axis is turned by a to starboard reads, in its own axes, the velocity (u - l_y r, v + l_x r) and the
specific force (a_x - l_x r^2 - l_y rdot, a_y + l_x rdot - l_y r^2), by the catalogue's sensor.velocity.lever_arm,
sensor.velocity.misalignment and sensor.acceleration.lever_arm. This module inverts them, with an interval for each number.
"""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np

from ivsid.intervals import IntervalArray
from ivsid.vehicle.mount import Mounted

Pair: TypeAlias = tuple[IntervalArray, IntervalArray]
# Least and largest gravity at sea level [m/s^2]: 9.7803 at the equator and 9.8322 at the poles, with room for the anomalies of
# mountains and seamounts.
# Source: definition: normal gravity of the ellipsoid WGS 84.
GRAVITY: Final = (9.76, 9.84)


def velocity_at_origin(reading: Pair, r: IntervalArray, mount: Mounted, *, own_axes: bool = True) -> Pair:
    """Velocities u and v of the body origin [m/s] from those at the sensor, each of shape (n,).

    Args:
        reading: intervals of the true velocity at the sensor, in its axes [m/s].
        r: yaw rate [rad/s].
        mount: position and rotation of the sensor.
        own_axes: whether the reading is in the sensor's axes; a velocity in earth axes has already been turned by the heading.
    """
    u, v = _turned_back(reading, mount) if own_axes else reading
    if not mount.off_origin:
        return u, v
    x, y = _arm(mount)
    return u + y * r, v - x * r


def force_at_origin(reading: Pair, r: IntervalArray, rdot: IntervalArray, mount: Mounted) -> Pair:
    """Specific force a_x, a_y of the body origin [m/s^2] from that at the sensor, each of shape (n,).

    Args:
        reading: intervals of the specific force at the sensor, in its axes [m/s^2].
        r: yaw rate [rad/s].
        rdot: yaw acceleration [rad/s^2].
        mount: position and rotation of the sensor.
    """
    ax, ay = _turned_back(reading, mount)
    if not mount.off_origin:
        return ax, ay
    x, y = _arm(mount)
    centripetal = r.square()
    return ax + x * centripetal + y * rdot, ay - x * rdot + y * centripetal


def without_gravity(reading: Pair, roll: IntervalArray, pitch: IntervalArray, gravity: IntervalArray) -> Pair:
    """Acceleration from specific force, both in body axes [m/s^2]: a_x = f_x - g sin(pitch), a_y = f_y + g cos(pitch) sin(roll).

    Args:
        reading: specific force [m/s^2].
        roll: angle about the x axis [rad].
        pitch: angle about the y axis [rad].
        gravity: its size [m/s^2].
    """
    fx, fy = reading
    return fx - gravity * np.sin(pitch), fy + gravity * (np.cos(pitch) * np.sin(roll))


def _arm(mount: Mounted) -> Pair:
    reach = mount.position_accuracy
    return tuple(IntervalArray.around(p, reach + np.spacing(abs(p) + reach)) for p in mount.position)  # type: ignore[return-value]


def _turned_back(reading: Pair, mount: Mounted) -> Pair:
    if not mount.turned:
        return reading
    first, second = reading
    reach = mount.rotation_accuracy
    angle = IntervalArray.around(mount.rotation, reach + np.spacing(abs(mount.rotation) + reach))
    cosine, sine = np.cos(angle), np.sin(angle)
    return first * cosine - second * sine, first * sine + second * cosine
