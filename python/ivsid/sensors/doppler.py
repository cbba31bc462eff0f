"""Velocity sensors: Doppler readings to velocities (paper eq. 16-17), in body axes or in earth axes."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.sensors.noise import ROUNDING
from ivsid.vehicle import Sensors, VelocitySensor

# Channels that a velocity sensor with a scale factor error gives.
VELOCITIES: Final = ("u", "v", "velocity_north", "velocity_east")


def doppler(reading: ArrayLike | IntervalArray, sensor: VelocitySensor) -> IntervalArray:
    """The true velocity [m/s], of the reading's shape: (reading +- accuracy) / (1 + s) for all scale errors s.

    s is in [-e, e], or in [0, e] or [-e, 0] if the file states its sign. Eq. 16-17 print the lower end twice (docs/theory.md, "The
    paper's equations, as corrected").

    Args:
        reading: of the sensor [m/s].
        sensor: its accuracy and scale factor error.
    """
    e, sign = sensor.scale_factor_error, sensor.scale_factor_sign
    e, accuracy = (float(np.nextafter(x, np.inf)) if x else 0.0 for x in (e, sensor.accuracy))
    scale = IntervalArray(0.0 if sign > 0 else -e, 0.0 if sign < 0 else e) + 1.0
    centre = reading if isinstance(reading, IntervalArray) else IntervalArray(reading)
    return (centre + IntervalArray(-accuracy, accuracy)) / scale


def doppler_paper(reading: ArrayLike, accuracy: float, scale_factor_error: float) -> IntervalArray:
    """The paper's eq. 16 with its upper end corrected [m/s]: (reading +- accuracy) / (1 - scale_factor_error)."""
    return IntervalArray.around(reading, accuracy) / (1.0 - IntervalArray(scale_factor_error))


def doppler_drift(scale_factor_error: float, speed: float, duration: float) -> float:
    """Along-track drift [m] of a scale factor error at a speed [m/s] over a time [s]; 0.4 % at 2 m/s is 28.8 m/h (paper, V.A)."""
    return scale_factor_error * speed * duration


def body_velocities(log: Log, sensors: Sensors) -> dict[str, IntervalArray]:
    """Velocities u and v [m/s] from the velocity in earth axes and the heading, each of shape (n,); a missing sample is [-inf, inf].

    Raises:
        IvsidError: the vehicle file does not bound the velocity or the heading.
    """
    if sensors.velocity is None or sensors.heading is None:
        section = "velocity" if sensors.velocity is None else "heading"
        raise IvsidError(
            f"{log.name} gives the velocity in earth axes; to bound u and v the vehicle file needs [sensors.{section}] accuracy"
        )
    parts = ("velocity_north", "velocity_east", "psi")
    there = np.all([np.isfinite(log.columns[c]) for c in parts], axis=0)
    north, east, psi = (
        IntervalArray.around(np.where(there, log.columns[c], 0.0), np.where(there, reading_error(log, c, sensors), 0.0))
        for c in parts
    )
    accuracy = np.nextafter(sensors.heading.accuracy, np.inf)
    heading = psi + IntervalArray(-accuracy, accuracy)
    cosine, sine = np.cos(heading), np.sin(heading)
    v_n, v_e = doppler(north, sensors.velocity), doppler(east, sensors.velocity)
    bodies = {"u": v_n * cosine + v_e * sine, "v": v_e * cosine - v_n * sine}
    return {
        name: IntervalArray(np.where(there, x.lower, -np.inf), np.where(there, x.upper, np.inf))
        for name, x in bodies.items()
    }


def reading_error(log: Log, name: str, sensors: Sensors, rows: slice = slice(None)) -> NDArray[np.float64]:
    """The largest distance of a logged reading from the sensor's own, in the channel's unit, one a row.

    It comes from interpolation between samples and from rounding. A distance that follows from a stated rate of the velocity
    itself grows by the sensor's scale factor.
    """
    error = log.error(name, rows)
    if (
        name not in log.by_rate
        or name not in VELOCITIES
        or sensors.velocity is None
        or sensors.velocity.scale_factor_sign < 0
    ):
        return error
    return error * (1 + sensors.velocity.scale_factor_error) * (1 + ROUNDING)
