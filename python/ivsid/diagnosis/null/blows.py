"""A force in blows: short ones that come seldom, as a bow that slams, ice that is struck or a line that snatches.

The mean square of a log hardly shows them, so that the noise is learnt with them, and no function of the motion follows them. Noise of any spectrum
is a sum of many small pushes: it hardly ever reaches six of its deviations. So a force counts as a blow that is six times what most of the log scatters, and six
times the declared ambient force with the noise of the sensor, beside all that errors of the thrusts and of the readings may make at that moment.

Source: docs/theory.md, "Blows".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter, minimum_filter1d

from ivsid.diagnosis.data.sensor_noise import NORMAL_MEDIAN, specified_noise
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.noise import HALF, slopes_of
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.roughness import QUICK, allowed_ambient, bounds_of_thrusts, told
from ivsid.diagnosis.null.leaving import Others
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import CHANNELS
from ivsid.vehicle.sensors import AccuracySensor, InertialSensor, VelocitySensor

Array = NDArray[np.float64]
# Deviations of the noise from which on a force is a blow.
# Source: definition: a normal error is beyond six of its deviations twice in a thousand million
BLOWS: Final = 6.0
# Whitened errors of which the largest has to be beyond this for a log to be asked.
# Source: definition: a normal error of a hundred thousand is beyond 4.4, and a blow is beyond six in its own units
SEEN: Final = 5.0
# Readings whose median stands for a fifth of a second at the least.
# Source: definition: a single one that is wrong moves no median of three
MEDIAN: Final = 3
# Samples about one within which a thrust that jumps is known to its jump alone.
# Source: geometry: two to either side, as the median of three reaches beside a step in which the jump may be anywhere
ABOUT: Final = 5
# Samples in half a second from which on a slope is one over a second.
# Source: definition: a mean has two at the least
SLOPED: Final = 2


@dataclass(frozen=True)
class Blow:
    """The strongest of them.

    Attributes:
        channel: in which it acts.
        times: force over the declared ambient one, beside all errors at their bounds, or over the scatter of most of the log, whichever is less.
        load: force [N] or moment [N m].
        time: at which it acts, from the first row of the log [s].
        count: seconds of the log that are beyond ``BLOWS``.
    """

    channel: str = CHANNELS[0]
    times: float = 0.0
    load: float = 0.0
    time: float = 0.0
    count: int = 0


@dataclass(frozen=True)
class Series:
    """Accelerations of one axis that errors stand for, by one way of reading them.

    Attributes:
        axis: index of the axis.
        x: accelerations, shape (m,).
        at: their samples, shape (m,).
        noise: deviation that the sensor's noise has in one.
        error: what an error of the readings makes of one at its bound.
        step: share of a jump of the thrusts that one shows where the jump is a step early or late.
    """

    axis: int
    x: Array
    at: NDArray[np.int64]
    noise: float
    error: float
    step: float


def blow(others: Others) -> Blow:
    """The strongest blow in what a model leaves, by slopes over a second and by what accelerometers read for a fifth of one.

    Args:
        others: the fit of the model, with its base beside any thrust curve, which is asked where the model's own errors hold large ones.
    """
    fit = others.fit
    g, noise = fit.gram, fit.noise
    predictor, base = noise.predictor, list(fit.base)
    white = g.left(base, Projection(g, base).coefficients)
    told_of = [k for k, (axis, _) in enumerate(predictor.labels) if axis < len(CHANNELS)]
    if np.abs(white[told_of]).max(initial=0.0) <= SEEN:
        return Blow()
    # Fitted errors of thrusts may be beyond their bounds where errors inside them fit as well.
    errors = others.curve.errors
    inertia, declared = allowed_ambient(predictor.vehicle, fit.states.h.values)
    near = 2 * round(2 * HALF / predictor.log.h) + 1
    thrusts = sum((np.abs(x) for x in bounds_of_thrusts(predictor)), np.zeros((3, noise.good.size)))
    # A demand that jumps within the second changes its error as well.
    thrusts = maximum_filter1d(thrusts[:, : noise.good.size], near, axis=1) / inertia[:, None]
    jumps = _jumps(fit) / inertia[:, None]
    best = Blow()
    for one in (*_slopes(fit, errors), *_readings(fit, errors)):
        k, at = one.axis, one.at
        allowed = thrusts[k, at] + one.step * jumps[k, at] + one.error
        found = _strongest(one.x, float(np.hypot(declared[k], one.noise)), allowed)
        if found is not None and found[0] > best.times:
            times, i, beyond = found
            seconds = np.unique((at[beyond] * predictor.log.h).astype(np.int64)).size
            best = Blow(CHANNELS[k], times, float(inertia[k] * abs(one.x[i])), float(at[i] * predictor.log.h), seconds)
    return best


def _strongest(x: Array, declared: float, errors: Array) -> tuple[float, int, NDArray[np.bool_]] | None:
    """The largest times of a force, its sample, and the samples beyond ``BLOWS``; None where the most of it does not scatter.

    Args:
        x: accelerations, shape (m,).
        declared: deviation of the declared ambient one and of the sensor's noise.
        errors: what errors of thrusts and readings may make of each at their bounds, shape (m,).
    """
    if not x.size:
        return None
    size = np.abs(x - np.median(x))
    usual = float(np.median(size)) / NORMAL_MEDIAN
    if not usual > 0:
        return None
    times = np.minimum((size - errors) / declared, size / usual)
    i = int(np.argmax(times))
    return float(times[i]), i, times > BLOWS


def _jumps(fit: Fit) -> Array:
    """Change of the forces X, Y [N] and N [N m] of all thrusters about each sample, shape (3, n): inside a step no row says when a demand jumps."""
    predictor = fit.noise.predictor
    n, out = fit.noise.good.size, np.zeros((3, fit.noise.good.size))
    for k, thruster in enumerate(predictor.vehicle.thrusters):
        if not thruster.own:
            continue
        force, angle, (x, y) = fit.states.points.thrusts[k, :n], predictor.driving.turned[k, :n], thruster.position
        c, s = np.cos(angle), np.sin(angle)
        for axis, arm in enumerate((c, s, x * s - y * c)):
            along = force * arm
            out[axis] += maximum_filter1d(along, ABOUT) - minimum_filter1d(along, ABOUT)
    return out


def _slopes(fit: Fit, errors: Array) -> Iterator[Series]:
    """Slopes of velocities over a second, where half of one has enough samples."""
    noise = fit.noise
    predictor, sensors = noise.predictor, noise.predictor.vehicle.sensors
    half = round(HALF / predictor.log.h)
    if half < SLOPED:
        return
    # A slope holds the readings of a second and a half.
    whole = minimum_filter1d(noise.good, 4 * half + 1)
    # The means of both halves may be off by all of the accuracy, to either side; a yaw rate by a heading is a slope itself.
    turned = predictor.log.turned
    rate = 4.0 * _accuracy(sensors.heading) if turned else _accuracy(sensors.yaw_rate)
    accuracies = (_accuracy(sensors.velocity), _accuracy(sensors.velocity), rate)
    for k, (slope, counts) in enumerate(slopes_of(predictor, errors, noise.good)):
        if told(predictor, k, noise.left_out):
            at = np.flatnonzero(counts & whole[half:][: counts.size])
            noisy = (
                0.0 if turned and k == 2 else _noise(predictor, "uvr"[k]) * float(np.sqrt(2.0 / half)) / (2.0 * HALF)
            )
            # A jump that is a step late pushes for that step of the second.
            yield Series(k, slope[at], at + half, noisy, accuracies[k] / HALF, predictor.log.h / (2.0 * HALF))


def _readings(fit: Fit, errors: Array) -> Iterator[Series]:
    """Medians of what accelerometers read for a fifth of a second, or of three readings."""
    noise, row = fit.noise, 0
    predictor = noise.predictor
    # An odd number has a middle, so that both signs count alike.
    window = max(MEDIAN, round(QUICK / predictor.log.h)) | 1
    at = np.flatnonzero(noise.good)
    for k, here in enumerate(predictor.axes[:2]):
        own = errors[row : row + len(here.outputs)]
        row += len(here.outputs)
        if "acceleration" in here.outputs and told(predictor, k, noise.left_out) and window * predictor.log.h <= HALF:
            expected, _ = here.ambient(own)
            read = median_filter(own[here.outputs.index("acceleration")] + expected, window)
            # The median of normal numbers scatters by the root of pi / 2 more than their mean.
            noisy = _noise(predictor, ("ax", "ay")[k]) * float(np.sqrt(0.5 * np.pi / window))
            yield Series(k, read[at], at, noisy, _accuracy(predictor.vehicle.sensors.acceleration), 1.0)


def _noise(predictor: Predictor, channel: str) -> float:
    """Standard deviation of a channel's white noise, as its sensor is specified or as the log shows it, whichever is more."""
    log = predictor.log
    return max(log.noise[channel], specified_noise(predictor.vehicle.sensors, log.h)[channel] or 0.0)


def _accuracy(sensor: VelocitySensor | InertialSensor | AccuracySensor | None) -> float:
    """Stated accuracy of a sensor, 0 without one."""
    return sensor.accuracy if sensor is not None else 0.0
