"""Noise to half-widths: the number of sigmas that bounds a whole log, and the half-width of an inertial channel."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ivsid.vehicle import InertialSensor, Sensors, Vehicle

# Probability that every error of a log stays within its bound, where the vehicle file states none.
# Source: definition: the default of [sensors] confidence in docs/guide.md.
DEFAULT_CONFIDENCE: Final = 0.999
# Relative slack for half-widths and quantiles, which are evaluated in floats.
# Source: definition: far above the few units of 2^-53 by which the quantile and a dozen operations are off.
ROUNDING: Final = 1e-9


@dataclass(frozen=True)
class Rule:
    """The number of standard deviations that bounds a log (docs/theory.md, "Sensor bounds").

    Attributes:
        sigmas: the factor k.
        confidence: the probability that every error of the log stays within its bound; None under the paper's rule.
        errors: the number of errors in the union bound.
    """

    sigmas: float
    confidence: float | None
    errors: int

    @property
    def guaranteed(self) -> bool:
        """Whether the bounds hold for the whole log with a stated probability."""
        return self.confidence is not None

    @property
    def sentence(self) -> str:
        """The assumption, as printed in results."""
        if self.confidence is None:
            return f"every sensor error stays within {self.sigmas:g} sigma at its sample (the paper's rule; not a bound for a log)"
        return (
            f"sensor bounds hold at every sample (probability >= {self.confidence:g} under the stated noise; "
            f"{self.sigmas:.2f} sigma for {self.errors} errors)"
        )


def sigma_published(n: float, b: float, dt: float, t: float) -> float:
    """The paper's eq. 15 as printed, sigma_c = N / sqrt(dt) + sqrt(dt / t) B, in the channel's unit: a rule and no bound.

    Args:
        n: random walk N [unit sqrt(s)].
        b: bias instability B [unit].
        dt: sampling interval [s].
        t: time of the bias [s].
    """
    return n / math.sqrt(dt) + math.sqrt(dt / t) * b


def half_width(
    sensor: InertialSensor, axis: int, dt: float | NDArray[np.float64], rule: Rule, duration: float
) -> NDArray[np.float64]:
    """Half-width of an inertial channel, in its unit, of the shape of ``dt`` or ().

    Under ``confidence`` it is k N / sqrt(dt) + k B, the union bound over white noise and a Gauss-Markov bias, plus the reflection
    bound of a rate random walk (docs/theory.md, "Sensor bounds"). Under ``sigmas`` it is k times eq. 15 with t = ``bias_time``.

    Args:
        sensor: its noise.
        axis: 0 for x, 1 for y.
        dt: time [s] that each sample averages.
        rule: the number of sigmas.
        duration: of the log [s].
    """
    bias, bias_time = sensor.axis(axis)
    walk = _walk(sensor, axis)
    k = rule.sigmas
    if rule.confidence is None:
        noise = np.asarray(k * sigma_published(walk, bias, float(np.max(dt)), bias_time))
        drift = k * sensor.rate_random_walk * math.sqrt(duration)
    else:
        noise = np.asarray(k * walk / np.sqrt(dt) + k * bias)
        drift = _walk_reach(rule, sensor.rate_random_walk, duration)
    width: NDArray[np.float64] = (noise + drift + sensor.accuracy) * (1 + ROUNDING)
    return width


def _walk(sensor: InertialSensor, axis: int) -> float:
    walk = sensor.random_walk
    return walk[axis] if isinstance(walk, tuple) else walk


def _walk_reach(rule: Rule, rate: float, duration: float) -> float:
    """Bound of a rate random walk W over the log.

    The reflection principle gives P(max |W| > a) <= 4 (1 - Phi(a / (s sqrt(T)))); ``count_errors`` counts the walk as four errors.
    """
    return rule.sigmas * rate * math.sqrt(duration)


def rule_for(sensors: Sensors, errors: int) -> Rule:
    """The rule of a vehicle file: its ``sigmas``, or the factor that its ``confidence`` needs by the union bound over ``errors``."""
    if sensors.sigmas is not None:
        return Rule(sensors.sigmas, None, errors)
    confidence = DEFAULT_CONFIDENCE if sensors.confidence is None else sensors.confidence
    k = -float(ndtri((1 - confidence) / (2 * max(errors, 1))))
    return Rule(k * (1 + ROUNDING), confidence, errors)


def count_errors(n: int, sensors: Iterable[tuple[InertialSensor, int]], vehicle: Vehicle, windows: int = 1) -> int:
    """The number of errors in the union bound of a log.

    White noise and bias count once a sample, a rate random walk four times a log. Each component of the ambient force counts once
    a sample, and once more for its mean over each window that starts there.

    Args:
        n: samples.
        sensors: sensor and axis of each inertial channel.
        vehicle: its ambient force.
        windows: lengths of window that rows will have.
    """
    count = 0
    for sensor, axis in sensors:
        count += n * (_walk(sensor, axis) > 0) + n * (sensor.axis(axis)[0] > 0) + 4 * (sensor.rate_random_walk > 0)
    if vehicle.ambient is not None:
        count += (1 + windows) * n * (2 * (vehicle.ambient.force > 0) + (vehicle.ambient.moment > 0))
    return int(count)
