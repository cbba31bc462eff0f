"""White noise of each channel, from its own scatter and the specification of its sensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.vehicle import Sensors

Array = NDArray[np.float64]
# Median of the absolute value of a standard normal number, which turns a median into a standard deviation.
# Source: theorem: 0.75 quantile of the standard normal distribution
NORMAL_MEDIAN: Final = 0.6745
# Standard deviations in a stated accuracy.
# Source: paper: its rule of three sigma (DESIGN.md, "Why does `confidence` replace three sigma?")
SIGMAS_OF_ACCURACY: Final = 3.0
# The estimate stays within this factor of the specification, which is a bound or a wish.
# Source: measured: make constants
FROM_SPECIFICATION: Final = 10.0
# Least noise of a channel, as a share of its standard deviation: a filter needs some, and a simulated channel may have none.
# Source: geometry: readings in six digits are rounded by this much
LEAST_SHARE: Final = 1e-6
# Least noise of a channel that never changes, in its unit.
# Source: geometry: keeps the inverse of its variance a finite number
LEAST: Final = 1e-9
# Largest share of different values among the readings on a coarse scale.
# Source: definition: each is read four times and more
COARSE: Final = 0.25
# Readings by which a scale is told.
# Source: resource: bounds the time of sorting them
SOME: Final = 20_000
# Variance of the first and of the third difference of unit white noise, by order: the sum of the squared binomial coefficients.
# Source: definition: sums of the squares of 1, 1 and of 1, 3, 3, 1
DIFFERENCE_VARIANCE: Final = {1: 2.0, 3: 20.0}
# Differences that the noise is read from, by channel: a motion between jumps of a demand follows a parabola, whose third differences vanish;
# an acceleration jumps itself, and its first differences vanish between jumps.
NO_STEPS: Final[Mapping[str, float]] = {}
_ACCELERATIONS: Final = ("ax", "ay", "rdot")


def sensor_noise(
    readings: Mapping[str, Array | None], sensors: Sensors, h: float, steps: Mapping[str, float] = NO_STEPS
) -> dict[str, float]:
    """Standard deviation of each channel's white noise, by channel.

    Args:
        readings: channels on the clock, shape (n,) each, None where one is not measured.
        sensors: of the vehicle file, with what they are specified for.
        h: step of the clock [s].
        steps: of the coarse scales that readings are rounded to, by channel.
    """
    specified = specified_noise(sensors, h)
    found = {}
    for name, x in readings.items():
        if x is None:
            continue
        order = 1 if name in _ACCELERATIONS else 3
        size = scatter(x, order)
        guess = specified.get(name)
        if guess:
            size = float(np.clip(size, guess / FROM_SPECIFICATION, guess * FROM_SPECIFICATION))
        # Most readings of a slow motion on a coarse scale equal the one before, and their differences hide the rounding.
        size = max(size, steps.get(name, 0.0) / np.sqrt(12))
        found[name] = max(size, LEAST_SHARE * float(np.std(x)), LEAST)
    return found


def specified_noise(sensors: Sensors, h: float) -> dict[str, float | None]:
    """Standard deviation of the white noise that each channel's sensor is specified for, by channel, None without a sensor.

    Args:
        sensors: of the vehicle file.
        h: step of the clock [s].
    """
    specified: dict[str, float | None] = {}
    velocity = None if sensors.velocity is None else sensors.velocity.accuracy / SIGMAS_OF_ACCURACY
    specified |= {"u": velocity, "v": velocity}
    specified["r"] = None if sensors.yaw_rate is None else sensors.yaw_rate.random_walk / np.sqrt(h)
    for axis, name in enumerate(("ax", "ay")):
        specified[name] = None if sensors.acceleration is None else sensors.acceleration.walk(axis) / np.sqrt(h)
    specified["psi"] = None if sensors.heading is None else sensors.heading.accuracy / SIGMAS_OF_ACCURACY
    place = None if sensors.position is None else sensors.position.accuracy / SIGMAS_OF_ACCURACY
    specified |= {"x": place, "y": place}
    return specified


def scale_step(x: Array) -> float:
    """The step of a coarse scale that readings are rounded to; 0 where hardly any two are equal.

    Args:
        x: shape (n,); NaN is a missing reading.
    """
    read = x[np.isfinite(x)][:SOME]
    values = np.unique(read)
    return float(np.median(np.diff(values))) if 1 < values.size < COARSE * read.size else 0.0


def scatter(x: Array, order: int) -> float:
    """Standard deviation of the white noise of readings, by the median of their differences.

    Args:
        x: shape (n,).
        order: of the differences.
    """
    return float(np.median(np.abs(np.diff(x, order))) / NORMAL_MEDIAN / np.sqrt(DIFFERENCE_VARIANCE[order]))
