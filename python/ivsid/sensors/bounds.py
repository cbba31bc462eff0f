"""Readings to intervals: inertial noise (paper eq. 15), Doppler velocity (eq. 16-17), and how sure the bounds are."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.log import Log
from ivsid.log.angles import unwrapped
from ivsid.sensors.derivatives import with_accelerations
from ivsid.sensors.origin import at_origin
from ivsid.sensors.pose import with_velocities
from ivsid.sensors.smoothing import splined
from ivsid.vehicle import InertialSensor, Sensors, Vehicle, VelocitySensor

DEFAULT_CONFIDENCE: Final = 0.999
# What a velocity sensor with a scale factor error shows.
VELOCITIES: Final = ("u", "v", "velocity_north", "velocity_east")
# Relative slack that covers the float evaluation of half-widths and quantiles.
ROUNDING: Final = 1e-9

# Channel, the section of [sensors] that bounds it, axis.
_INERTIAL: Final = (("udot", 0), ("vdot", 1), ("ax", 0), ("ay", 1))
_PLAIN: Final = (("force_X", "force"), ("force_Y", "force"), ("moment_N", "moment"), ("rdot", "yaw_acceleration"))


@dataclass(frozen=True)
class Rule:
    """How many standard deviations bound a log.

    Attributes:
        sigmas: the factor k.
        confidence: the probability that every error of the log stays inside, or None under the paper's rule.
        errors: how many errors the union bound counts.
    """

    sigmas: float
    confidence: float | None
    errors: int

    @property
    def guaranteed(self) -> bool:
        """Whether the bounds hold with a stated probability for the whole log."""
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


@dataclass(frozen=True)
class BoundedLog:
    """A log whose channels are intervals.

    Attributes:
        log: the readings.
        channels: an interval for each sample of each channel that is bounded; a missing sample is every number.
        present: where each channel has a sample.
        rule: how noise was turned into bounds.
        ambient: half-widths (force [N], moment [N m]) of the force that nobody models.
        statistical: what is an estimate and no bound; nothing that rests on it is guaranteed.
    """

    log: Log
    channels: Mapping[str, IntervalArray]
    present: Mapping[str, NDArray[np.bool_]]
    rule: Rule
    ambient: tuple[float, float]
    statistical: tuple[str, ...] = ()


def sigma_published(n: float, b: float, dt: float, t: float) -> float:
    """Eq. 15, sigma_c = N/sqrt(dt) + sqrt(dt/t) B, as printed: the paper's rule, not a bound (METHODS 5.1)."""
    return n / math.sqrt(dt) + math.sqrt(dt / t) * b


def half_width(
    sensor: InertialSensor, axis: int, dt: float | NDArray[np.float64], rule: Rule, duration: float
) -> NDArray[np.float64]:
    """Half-width of an inertial channel, in the unit of the channel, for each time ``dt`` [s] that a sample averages.

    With ``confidence``: k N/sqrt(dt) + k B, the union bound over white noise and Gauss-Markov bias (METHODS 5.1), plus the
    reflection bound of a rate random walk. With ``sigmas``: k times eq. 15 with t = ``bias_time``.
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
    """P(max |W| > a) <= 4 (1 - Phi(a / (s sqrt(T)))): the walk counts as four of the rule's errors."""
    return rule.sigmas * rate * math.sqrt(duration)


def doppler(reading: ArrayLike | IntervalArray, sensor: VelocitySensor) -> IntervalArray:
    """The true velocity [m/s]: (reading +- accuracy) / (1 + s), s in [-e, e], or one half of it where the sign is known.

    Corrects eq. 16-17, which print the same end twice (READING_NOTES).
    """
    e, sign = sensor.scale_factor_error, sensor.scale_factor_sign
    e, accuracy = (float(np.nextafter(x, np.inf)) if x else 0.0 for x in (e, sensor.accuracy))
    scale = IntervalArray(0.0 if sign > 0 else -e, 0.0 if sign < 0 else e) + 1.0
    centre = reading if isinstance(reading, IntervalArray) else IntervalArray(reading)
    return (centre + IntervalArray(-accuracy, accuracy)) / scale


def doppler_paper(reading: ArrayLike, accuracy: float, scale_factor_error: float) -> IntervalArray:
    """Eq. 16 with its upper end corrected: [(u - acc)/(1 - sfe), (u + acc)/(1 - sfe)], a scale error of known size."""
    return IntervalArray.around(reading, accuracy) / (1.0 - IntervalArray(scale_factor_error))


def doppler_drift(scale_factor_error: float, speed: float, duration: float) -> float:
    """Along-track drift [m] of a scale factor error: 0.4 % at 2 m/s is 28.8 m in an hour (paper, V.A)."""
    return scale_factor_error * speed * duration


def rule_for(sensors: Sensors, errors: int) -> Rule:
    """The factor k: as given by ``sigmas``, or from ``confidence`` by the union bound over this many errors."""
    if sensors.sigmas is not None:
        return Rule(sensors.sigmas, None, errors)
    confidence = DEFAULT_CONFIDENCE if sensors.confidence is None else sensors.confidence
    k = -float(ndtri((1 - confidence) / (2 * max(errors, 1))))
    return Rule(k * (1 + ROUNDING), confidence, errors)


def bound_log(log: Log, vehicle: Vehicle, windows: int = 1) -> BoundedLog:
    """Encloses every channel of the log that the vehicle file bounds.

    Args:
        log: the checked log.
        vehicle: its sensors and ambient force.
        windows: how many lengths of window rows will have: the mean of an ambient force over each is one more error a sample.

    Raises:
        IvsidError: a sensor section is missing for a logged channel, or samples are averaged.
    """
    sensors = vehicle.sensors
    _certain_turns(log, sensors)
    channels = body_velocities(log, sensors) if log.derived else {}
    log, enclosed, statistical = velocities_of(log, sensors)
    channels |= enclosed
    sections = _inertial(log, sensors)
    # A channel that came from a clock of its own may have more samples than the log has rows, and closer ones.
    most = max([log.t.size, *(c.samples for c in log.clocks.values())])
    rule = rule_for(sensors, count_errors(most, sections.values(), vehicle, windows))
    duration = float(log.t[-1] - log.t[0])
    interval = _sampling_interval(log)
    radii: dict[str, float | NDArray[np.float64]] = {
        name: half_width(sensor, axis, _own_interval(log, name, interval), rule, duration)
        for name, (sensor, axis) in sections.items()
    }
    for name, section in _PLAIN:
        plain = getattr(sensors, section)
        if name in log.columns and plain is not None:
            radii[name] = plain.accuracy
    present: dict[str, NDArray[np.bool_]] = {name: np.isfinite(x.lower) for name, x in channels.items()}
    for name, values in log.columns.items():
        if name in log.derived:
            continue
        there = ~np.isnan(values)
        if name == "r" and sensors.yaw_rate is not None and sensors.yaw_rate.sampling == "averaged":
            radii[name] = radii[name] + _since_average(log, sensors)
        if name not in radii and (name not in ("u", "v") or sensors.velocity is None):
            continue
        # The decimals of a bound are rounded to a double, too: the next one up holds them.
        radius = np.nextafter(radii[name], np.inf) if name in radii else None
        channels[name] = interval_pieces(values.size, partial(_bounded, log, sensors, name, radius))
        present[name] = there
    _set_averages_apart(channels, present, sensors)
    if "psi" in log.columns and sensors.heading is not None:
        channels["psi"], present["psi"] = _heading(log, sensors.heading.accuracy)
    log, channels, present = at_origin(log, channels, present, sensors)
    log, rates = with_accelerations(log, channels, sensors)
    channels |= rates
    present |= {name: np.isfinite(x.lower) for name, x in rates.items()}
    ambient = (0.0, 0.0)
    if vehicle.ambient is not None:
        k = rule.sigmas * (1 + ROUNDING)
        ambient = (k * vehicle.ambient.force, k * vehicle.ambient.moment)
    return BoundedLog(log, channels, present, rule, ambient, statistical)


def _bounded(log: Log, sensors: Sensors, name: str, radius: NDArray[np.float64] | None, rows: slice) -> IntervalArray:
    """Some samples of a channel within a radius, or as a velocity sensor's; every number where one is missing."""
    values = log.columns[name][rows]
    there = ~np.isnan(values)
    reading = IntervalArray.around(np.where(there, values, 0.0), _reading_error(log, name, sensors, rows))
    if radius is None and sensors.velocity is not None:
        found = doppler(reading, sensors.velocity)
    else:
        reach = np.asarray(0.0 if radius is None else radius)
        reach = reach[rows] if reach.ndim else reach
        found = reading + IntervalArray(-reach, reach)
    if there.all():
        return found
    return IntervalArray(np.where(there, found.lower, -np.inf), np.where(there, found.upper, np.inf))


def _set_averages_apart(
    channels: dict[str, IntervalArray], present: dict[str, NDArray[np.bool_]], sensors: Sensors
) -> None:
    """An averaging accelerometer reads no moment: under another name, so that only rows over whole steps use it."""
    if sensors.acceleration is None or sensors.acceleration.sampling != "averaged":
        return
    if moments := [n for n in ("udot", "vdot") if n in channels]:
        raise IvsidError(
            f'sampling = "averaged" of [sensors.acceleration] is about ax and ay, and the log has {" and ".join(moments)}; give ax and ay, '
            "or leave these columns out: their means are differences of the velocities"
        )
    for name in ("ax", "ay"):
        if name in channels:
            channels[f"mean_{name}"], present[f"mean_{name}"] = channels.pop(name), present.pop(name)


def _heading(log: Log, accuracy: float) -> tuple[IntervalArray, NDArray[np.bool_]]:
    """The heading [rad], without jumps of whole turns."""
    psi = log.columns["psi"]
    there = ~np.isnan(psi)
    turned, lost = np.zeros(psi.shape), log.error("psi")
    turned[there], more = unwrapped(psi[there])
    lost[there] += more
    reach = np.nextafter(accuracy, np.inf)
    around = IntervalArray.around(turned, lost) + IntervalArray(-reach, reach)
    return IntervalArray(np.where(there, around.lower, -np.inf), np.where(there, around.upper, np.inf)), there


def velocities_of(log: Log, sensors: Sensors) -> tuple[Log, dict[str, IntervalArray], tuple[str, ...]]:
    """The velocities that the log lacks, from its pose; and what about them is no bound."""
    if sensors.from_pose == "spline":
        return splined(log, sensors)
    return (*with_velocities(log, sensors), ())


def _since_average(log: Log, sensors: Sensors) -> NDArray[np.float64]:
    """How far a yaw rate may have moved from its mean over the sample before, |rdot| h / 2 [rad/s]."""
    limit = sensors.limits.yaw_acceleration
    if limit is None:
        raise IvsidError(
            'sampling = "averaged" of [sensors.yaw_rate] needs [sensors.limits] yaw_acceleration: it bounds how far r moves from its '
            "mean; state it, or log instantaneous samples"
        )
    if "r" in {*log.clocks, *log.by_rate}:
        raise IvsidError(
            f'{log.name}: r stands on another clock than the rows, where sampling = "averaged" of [sensors.yaw_rate] does not say what a '
            "reading averages; make it the clock of the rows ([log] base), or log instantaneous samples"
        )
    steps = np.diff(log.t)
    before = np.r_[steps.max(), steps] + 2 * log.time_error
    moved: NDArray[np.float64] = np.nextafter(0.5 * limit * before * (1 + ROUNDING), np.inf)
    return moved


def count_errors(n: int, sensors: Iterable[tuple[InertialSensor, int]], vehicle: Vehicle, windows: int = 1) -> int:
    """Errors that the union bound covers in a log of n samples, for each inertial channel's sensor and axis.

    Each sample of white noise and of bias counts once; a rate random walk counts as four; ambient force counts at each sample
    and once more for its mean over each window that starts there.
    """
    count = 0
    for sensor, axis in sensors:
        count += n * (_walk(sensor, axis) > 0) + n * (sensor.axis(axis)[0] > 0) + 4 * (sensor.rate_random_walk > 0)
    if vehicle.ambient is not None:
        count += (1 + windows) * n * (2 * (vehicle.ambient.force > 0) + (vehicle.ambient.moment > 0))
    return int(count)


def _inertial(log: Log, sensors: Sensors) -> dict[str, tuple[InertialSensor, int]]:
    """The sensor and axis of every inertial channel of the log that is bounded."""
    sections: dict[str, tuple[InertialSensor, int]] = {}
    for name, axis in _INERTIAL:
        if name in log.columns and sensors.acceleration is not None:
            sections[name] = (sensors.acceleration, axis)
    if "r" in log.columns and "r" not in log.derived and sensors.yaw_rate is not None:
        sections["r"] = (sensors.yaw_rate, 0)
    return sections


def body_velocities(log: Log, sensors: Sensors) -> dict[str, IntervalArray]:
    """Body velocities [m/s] of a log that has the velocity in earth axes and the heading; a missing sample is every number.

    Raises:
        IvsidError: the vehicle file does not bound one of the two sensors.
    """
    if sensors.velocity is None or sensors.heading is None:
        section = "velocity" if sensors.velocity is None else "heading"
        raise IvsidError(
            f"{log.name} gives the velocity in earth axes; to bound u and v the vehicle file needs [sensors.{section}] accuracy"
        )
    parts = ("velocity_north", "velocity_east", "psi")
    there = np.all([np.isfinite(log.columns[c]) for c in parts], axis=0)
    north, east, psi = (
        IntervalArray.around(
            np.where(there, log.columns[c], 0.0), np.where(there, _reading_error(log, c, sensors), 0.0)
        )
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


def _certain_turns(log: Log, sensors: Sensors) -> None:
    """Refuses a heading that was followed through whole turns with too large an error to be sure of the way round."""
    most = log.certain.get("psi")
    if most is not None and sensors.heading is not None and sensors.heading.accuracy >= most:
        raise IvsidError(
            f"{log.name}: with [sensors.heading] accuracy = {sensors.heading.accuracy:g} rad the way round from one sample of psi to the "
            f"next is not certain (below {max(most, 0.0):.3g} rad it is); state a smaller [log] rates psi, or log psi more often"
        )


def _reading_error(log: Log, name: str, sensors: Sensors, rows: slice = slice(None)) -> NDArray[np.float64]:
    """How far a reading may be from what the sensor would show.

    Where a stated rate says how far the velocity itself can have moved, the sensor's scale factor makes that larger.
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


def _own_interval(log: Log, name: str, rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The time over which each sample behind a channel averages: its own clock's where that is quicker than the rows."""
    clock = log.clocks.get(name)
    return rows if clock is None else np.minimum(rows, clock.interval)


def _sampling_interval(log: Log) -> NDArray[np.float64]:
    """The time over which each sample averages white noise: the log's period, or less where rows stand closer."""
    steps = np.diff(log.t)
    closest = np.minimum(np.r_[steps[0], steps], np.r_[steps, steps[-1]])
    interval: NDArray[np.float64] = np.minimum(closest, log.period)
    return interval
