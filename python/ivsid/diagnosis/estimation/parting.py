"""How far readings part that follow from one another: a heading from what a gyro adds up, a position from what velocities do.

A filter follows a compass that is drawn aside for half a minute, or a position that drifts with reflected signals, and its prediction errors are small. What
the change of the one and the sum of the other differ by over seconds or minutes holds all of it, and no model of the vehicle.

Source: docs/theory.md, "Readings that part".
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.vehicle import InertialSensor

Array = NDArray[np.float64]
# Times over which readings may part [s].
# Source: geometry: a reading that is wrong for some seconds and for half a minute, and a gyro that drifts as it warms, which adds up over minutes
OVER: Final = (5.0, 10.0, 20.0, 60.0, 120.0, 240.0)
# Time over which readings are averaged at either end [s].
# Source: geometry: several samples, so that single ones that jump do not count, and little of the shortest time
MEAN: Final = 1.0
# Standard deviations that count as a bound of an error for which no bound is stated.
# Source: definition: as of the noise of an accuracy
SIGMAS: Final = 3.0
# Heading over yaw rate, and position over velocities, as channels of ``parted``.
HEADING: Final = "psi by r"
PLACE: Final = "x y by u v"


def parted(predictor: Predictor, states: FilteredStates) -> dict[str, float]:
    """The farthest that readings part over seconds or minutes, over what their stated accuracies allow, by channels; of those that state both.

    Args:
        predictor: of a log.
        states: of a hypothesis, whose sensor effects are taken out of the readings.
    """
    return {name: max(found, default=0.0) for name, found in _found(predictor, states)}


def _found(predictor: Predictor, states: FilteredStates) -> Iterator[tuple[str, list[float]]]:
    log, sensors = predictor.log, predictor.vehicle.sensors
    wrong = predictor.sensed(states.h.given, states)
    u, v, r = (x - wrong[q] for x, q in zip(log.nu, ("u", "v", "r"), strict=True))
    if log.psi is None or sensors.heading is None:
        return
    psi, off = log.psi - wrong.get("psi", 0.0), sensors.heading.accuracy
    off += log.steps.get("psi", 0.0)
    # Where neither a noise nor a bound is stated, readings may scatter by anything.
    gyro = sensors.yaw_rate
    if gyro is not None and (gyro.accuracy or gyro.random_walk) and not log.turned:
        slow, noise = _drift(gyro, float(log.t[-1] - log.t[0])), SIGMAS * gyro.random_walk
        yield HEADING, [_worst(predictor, psi, r, 2 * off + slow * s + noise * np.sqrt(s), s) for s in OVER]
    if log.place is not None and sensors.position is not None and sensors.velocity is not None:
        c, s = np.cos(psi), np.sin(psi)
        speed = float(np.hypot(u, v).max())
        velocity = sensors.velocity
        # Errors across and along the hull, and those of the direction.
        rate = (
            np.sqrt(2.0) * velocity.accuracy + (velocity.scale_factor_error + velocity.rotation_accuracy + off) * speed
        )
        rate += velocity.position_accuracy * float(np.abs(r).max())
        pairs = zip(log.place, (u * c - v * s, u * s + v * c), strict=True)
        place = sensors.position.accuracy + max(log.steps.get(q, 0.0) for q in "xy")
        allowed = [2 * place + rate * s for s in OVER]
        yield (
            PLACE,
            [_worst(predictor, x, q, a, s) for x, q in pairs for a, s in zip(allowed, OVER, strict=True)],
        )


def _drift(gyro: InertialSensor, time: float) -> float:
    """The bound of a slow error of a gyro over a log of so long [rad/s]."""
    return gyro.accuracy + SIGMAS * (gyro.axis(0)[0] + gyro.rate_random_walk * float(np.sqrt(time)))


def _worst(predictor: Predictor, x: Array, rate: Array, allowed: float, time: float) -> float:
    """The farthest that a reading and the sum of its rate part over a time [s], over what is allowed; 0 if no stretch is whole."""
    log = predictor.log
    lag, mean = round(time / log.h), max(1, round(MEAN / log.h))
    if log.n <= lag + mean or allowed <= 0:
        return 0.0
    ends, missed = (uniform_filter1d(q, mean) for q in (x - _sum(rate, log.h), _missed(rate, log.h)))
    lost = np.r_[0, np.cumsum(~log.good)]
    # A stretch counts where no sample of it, and of the means at its ends, is missing.
    first, last = np.arange(mean, log.n - lag - mean), np.arange(mean + lag, log.n - mean)
    whole = lost[last + mean] == lost[first - mean]
    moved, more = (np.abs(q[last] - q[first])[whole].max(initial=0.0) for q in (ends, missed))
    return float(moved / (allowed + more))


def _sum(rate: Array, h: float) -> Array:
    """What a rate adds up to from the first sample on, over straight lines between samples, shape (n,)."""
    return np.asarray(np.r_[0.0, h * np.cumsum(0.5 * (rate[1:] + rate[:-1]))])


def _missed(rate: Array, h: float) -> Array:
    """What such a sum may miss of a rate that bends inside the steps: as much as that over every other sample misses of it, shape (n,)."""
    rarer = np.repeat(_sum(rate, h)[::2] - _sum(rate[::2], 2 * h), 2)
    return np.asarray(rarer[: rate.size])
