"""Readings of sensors that stand off the origin, are turned, or feel gravity, brought to the body origin.

The formulas are those of ``ivsid.sensors.mounting``, with numbers in place of intervals.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log
from ivsid.vehicle import Sensors
from ivsid.vehicle.mount import Mounted

Array = NDArray[np.float64]
# Gravity [m/s^2] where a vehicle file says that a sensor feels it, and not how much.
# Source: definition: standard gravity, 9.80665 m/s^2, in three digits
GRAVITY: Final = 9.81


def at_origin(log: Log, sensors: Sensors) -> Log:
    """The log with velocities and accelerations of the body origin.

    A specific force that holds gravity is left out if the log has no attitude.

    Args:
        log: with readings in the sensors' own axes.
        sensors: with their mounts.
    """
    columns, notes = dict(log.columns), list(log.notes)
    for sensor, names in ((sensors.velocity, ("u", "v")), (sensors.acceleration, ("ax", "ay"))):
        if sensor is None or not set(names) <= set(columns):
            continue
        gravity = getattr(sensor, "gravity", False)
        if not (sensor.off_origin or sensor.turned or gravity):
            continue
        if names[0] == "u" and log.derived.get("u", ("velocity_north",))[0] != "velocity_north":
            # A velocity from a pose is that of the origin already.
            continue
        pair = columns[names[0]], columns[names[1]]
        if names[0] not in log.derived:
            pair = _turned_back(pair, sensor)
        if gravity:
            tilt = _tilt(columns)
            if tilt is None:
                notes.append(f"{' and '.join(names)} hold gravity and no attitude is logged: they are not used")
                columns = {k: x for k, x in columns.items() if k not in names}
                continue
            g = gravity_of(sensors)
            roll, pitch = tilt
            pair = pair[0] - g * np.sin(pitch), pair[1] + g * np.cos(pitch) * np.sin(roll)
        if sensor.position != (0.0, 0.0):
            averaged = getattr(sensor, "sampling", "") == "averaged"
            pair = _moved(pair, columns, log.t, sensor, force=names[0] == "ax", averaged=averaged)
        columns[names[0]], columns[names[1]] = pair
        notes.append(f"{' and '.join(names)} are brought to the body origin by the mounting of their sensor")
    return replace(log, columns=columns, notes=tuple(notes))


def gravity_of(sensors: Sensors) -> float:
    """Gravity that the accelerometer feels [m/s^2]; 0 where its readings hold none."""
    felt = False if sensors.acceleration is None else sensors.acceleration.gravity
    return GRAVITY if felt is True else float(felt)


def _turned_back(pair: tuple[Array, Array], mount: Mounted) -> tuple[Array, Array]:
    c, s = np.cos(mount.rotation), np.sin(mount.rotation)
    return pair[0] * c - pair[1] * s, pair[0] * s + pair[1] * c


def _moved(
    pair: tuple[Array, Array],
    columns: dict[str, Array],
    t: Array,
    mount: Mounted,
    *,
    force: bool,
    averaged: bool,
) -> tuple[Array, Array]:
    """Readings of a sensor off the origin, moved to it; a specific force that is averaged is moved by the means over the step before it."""
    x, y = mount.position
    r = columns["r"]
    if not force:
        return pair[0] + y * r, pair[1] - x * r
    if averaged and r.size > 1:
        change, last = np.diff(r), np.concatenate([r[:1], r[:-1]])
        rdot, square = np.concatenate([change[:1], change]), (r * r + r * last + last * last) / 3.0
        rdot = rdot / np.concatenate([np.diff(t)[:1], np.diff(t)])
    else:
        square = r * r
        rdot = columns["rdot"] if "rdot" in columns else np.gradient(r, t)
    return pair[0] + x * square + y * rdot, pair[1] - x * rdot + y * square


def _tilt(columns: dict[str, Array]) -> tuple[Array, Array] | None:
    """Roll and pitch [rad], shape (n,) each, from angles or from a quaternion; None if neither is logged."""
    if {"roll", "pitch"} <= set(columns):
        return columns["roll"], columns["pitch"]
    if {"qw", "qx", "qy", "qz"} <= set(columns):
        w, x, y, z = (columns[q] for q in ("qw", "qx", "qy", "qz"))
        norm = np.maximum(w * w + x * x + y * y + z * z, 1e-12)
        roll = np.arctan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z)
        return roll, np.arcsin(np.clip(2 * (w * y - x * z) / norm, -1, 1))
    return None
