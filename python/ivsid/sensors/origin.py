"""Bounded logs of mounted sensors, brought to the body origin by the formulas of ``mounting``."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.sensors.derivatives import enclosed_rate
from ivsid.sensors.mounting import GRAVITY, force_at_origin, velocity_at_origin, without_gravity
from ivsid.vehicle import AccelerationSensor, Sensors

# A quaternion whose squared norm is off 1 by more than this is not used: it is no rotation.
# Source: geometry: rounding to two decimals moves it, to first order, by at most 2 * 0.005 * (|w| + |x| + |y| + |z|), and the sum is at most 2.
MOST_OFF_UNIT: Final = 0.02
# A pitch beyond this [rad] is not used: the error of the roll grows as 1 / cos(pitch), here by 2.8.
# Source: geometry: roll is undefined at a pitch of pi / 2.
STEEP: Final = 1.2


def at_origin(
    log: Log, channels: dict[str, IntervalArray], present: dict[str, NDArray[np.bool_]], sensors: Sensors
) -> tuple[Log, dict[str, IntervalArray], dict[str, NDArray[np.bool_]]]:
    """The log, its channels and their presence with velocities and specific forces of the body origin.

    Channels whose sensors stand at the origin, in body axes and without gravity, stay as they are.

    Raises:
        IvsidError: a needed channel is not logged or not bounded, or the log contradicts the mounting.
    """
    moved: dict[str, IntervalArray] = {}
    velocity, acceleration = sensors.velocity, sensors.acceleration
    r = channels.get("r")
    sensed = log.derived.get("u", ("velocity_north",))[0] == "velocity_north"
    if velocity is not None and (velocity.off_origin or velocity.turned) and {"u", "v"} <= set(channels) and sensed:
        turning = _needed(r, "r", "yaw_rate", "velocity", log) if velocity.off_origin else channels["u"]
        pair = velocity_at_origin((channels["u"], channels["v"]), turning, velocity, own_axes="u" not in log.derived)
        moved |= dict(zip(("u", "v"), pair, strict=True))
    if acceleration is not None and (acceleration.off_origin or acceleration.turned or acceleration.gravity):
        if acceleration.sampling == "averaged":
            raise IvsidError(
                '[sensors.acceleration] has a mounting or gravity and sampling = "averaged", which cannot be undone together; log '
                "instantaneous samples, or leave ax and ay out"
            )
        if "udot" in log.columns or "vdot" in log.columns:
            raise IvsidError(
                f"{log.name} logs udot, vdot, which are of the origin, and [sensors.acceleration] has a mounting or gravity, which "
                "belong to ax, ay; name the columns ax, ay, or leave the keys out"
            )
        if len({"ax", "ay"} & set(channels)) == 1:
            raise IvsidError(
                f"{log.name} logs one of ax and ay, and [sensors.acceleration] has a mounting or gravity, which needs both; log both, or "
                "leave the column out"
            )
        if {"ax", "ay"} <= set(channels):
            moved |= _forces_at_origin(log, channels, sensors, acceleration)
    if not moved:
        return log, channels, present
    known = {name: np.isfinite(x.lower) & np.isfinite(x.upper) for name, x in moved.items()}
    for name, x in moved.items():
        there = known[name]
        channels[name] = IntervalArray(np.where(there, x.lower, -np.inf), np.where(there, x.upper, np.inf))
        present[name] = there
    centres = {name: np.where(known[name], channels[name].midpoint, np.nan) for name in moved}
    note = f"{', '.join(moved)} are brought to the body origin by the mounting of their sensors"
    assumes = (*log.assumes, *_assumptions(sensors, set(moved)))
    return (
        replace(log, columns={**log.columns, **centres}, notes=(*log.notes, note), assumes=assumes),
        channels,
        present,
    )


def _assumptions(sensors: Sensors, moved: set[str]) -> list[str]:
    """Assumptions of the readings at the origin, beside the bounds of the readings themselves."""
    words = []
    for name, sensor, own in (
        ("velocity", sensors.velocity, {"u", "v"}),
        ("acceleration", sensors.acceleration, {"ax", "ay"}),
    ):
        if sensor is None or not own & moved:
            continue
        x, y = sensor.position
        words.append(
            f"the {name} sensor stands at ({x!r}, {y!r}) m within {sensor.position_accuracy!r} m, turned by {sensor.rotation!r} rad within "
            f"{sensor.rotation_accuracy!r} rad; the vehicle moves in the plane"
        )
    acceleration, limits = sensors.acceleration, sensors.limits
    if acceleration is not None and {"ax", "ay"} & moved:
        if acceleration.off_origin:
            for what, limit in (("|rdot|", limits.yaw_acceleration), ("|d2r/dt2|", limits.yaw_jerk)):
                words += (
                    [f"{what} never exceeds {limit!r}, where the yaw acceleration is not measured"] if limit else []
                )
        if acceleration.gravity:
            g = f"within {GRAVITY}" if acceleration.gravity is True else f"{acceleration.gravity!r} within 1e-6"
            tilt = "" if sensors.attitude is None else f", roll and pitch within {sensors.attitude.accuracy!r} rad"
            words.append(f"gravity is {g} m/s^2{tilt}")
    return words


def _needed(x: IntervalArray | None, name: str, section: str, sensor: str, log: Log) -> IntervalArray:
    if x is None:
        raise IvsidError(
            f"[sensors.{sensor}] stands off the origin, so {log.name} needs the column {name}, and the vehicle file "
            f"[sensors.{section}]; give both, or leave position out"
        )
    return x


def _forces_at_origin(
    log: Log, channels: dict[str, IntervalArray], sensors: Sensors, sensor: AccelerationSensor
) -> dict[str, IntervalArray]:
    pair = channels["ax"], channels["ay"]
    if sensor.gravity:
        roll, pitch = _tilt(log, sensors)
        g = IntervalArray(*GRAVITY) if sensor.gravity is True else IntervalArray.around(sensor.gravity, 1e-6)
        # Roll and pitch are the vehicle's: the reading is turned to the vehicle's axes first.
        level = sensor.model_copy(update={"position": (0.0, 0.0), "position_accuracy": 0.0})
        pair = without_gravity(force_at_origin(pair, roll, roll, level), roll, pitch, g)
        sensor = sensor.model_copy(update={"rotation": 0.0, "rotation_accuracy": 0.0})
    if sensor.off_origin:
        r = _needed(channels.get("r"), "r", "yaw_rate", "acceleration", log)
        limits = sensors.limits
        rdot = channels.get("rdot")
        if rdot is None:
            rdot = enclosed_rate(log, r, limits.yaw_acceleration, limits.yaw_jerk, "r")
        rdot = _needed(rdot, "rdot", "limits] yaw_acceleration, or [sensors.yaw_acceleration", "acceleration", log)
        pair = force_at_origin(pair, r, rdot, sensor)
    elif sensor.turned:
        pair = force_at_origin(pair, pair[0], pair[0], sensor)
    return dict(zip(("ax", "ay"), pair, strict=True))


def _tilt(log: Log, sensors: Sensors) -> tuple[IntervalArray, IntervalArray]:
    """Roll and pitch [rad] of every row, each of shape (n,); [-pi, pi] where they are missing."""
    if sensors.attitude is None:
        raise IvsidError(
            "[sensors.acceleration] gravity takes gravity away by the attitude; give the vehicle file [sensors.attitude] accuracy [rad]"
        )
    c = log.columns
    lost: float | NDArray[np.float64]
    if {"roll", "pitch"} <= set(c):
        roll, pitch, lost = c["roll"], c["pitch"], np.maximum(log.error("roll"), log.error("pitch"))
    elif {"qw", "qx", "qy", "qz"} <= set(c):
        w, x, y, z = (c[q] for q in ("qw", "qx", "qy", "qz"))
        norm = w * w + x * x + y * y + z * z
        off = np.abs(norm - 1) > MOST_OFF_UNIT
        roll = np.arctan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z)
        pitch = np.arcsin(np.clip(2 * (w * y - x * z) / norm, -1, 1))
        roll, pitch = (np.where(off, np.nan, q) for q in (roll, pitch))
        # Errors of the quaternion turn the vertical by at most twice their size; roll and pitch follow divided by cos(pitch).
        parts = sum(log.error(q) for q in ("qw", "qx", "qy", "qz"))
        steep = np.abs(pitch) > STEEP
        roll, pitch = (np.where(steep, np.nan, q) for q in (roll, pitch))
        lost = 4 * parts / np.cos(STEEP) + 1e-12
    else:
        raise IvsidError(
            f"{log.name} has accelerations with gravity and no attitude; give columns qw, qx, qy, qz, or roll and pitch [rad]"
        )
    there = np.isfinite(roll) & np.isfinite(pitch)
    reach = np.nextafter(sensors.attitude.accuracy, np.inf)
    tilted = []
    for angle in (roll, pitch):
        around = IntervalArray.around(np.where(there, angle, 0.0), np.where(there, lost, 0.0)) + IntervalArray(
            -reach, reach
        )
        # Without an attitude gravity may have any direction in the reading.
        tilted.append(IntervalArray(np.where(there, around.lower, -np.pi), np.where(there, around.upper, np.pi)))
    return tilted[0], tilted[1]
