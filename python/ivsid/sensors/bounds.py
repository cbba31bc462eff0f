"""Readings to intervals: an interval for every sample of a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.log import Log
from ivsid.log.angles import turns_of, with_turns
from ivsid.log.record import steps_in
from ivsid.memory.pieces import array_pieces, pieces
from ivsid.sensors.corrections import centres, corrected, corrections, through_water
from ivsid.sensors.derivatives import with_accelerations
from ivsid.sensors.doppler import body_velocities, doppler, reading_error
from ivsid.sensors.noise import ROUNDING, Rule, count_errors, half_width, rule_for
from ivsid.sensors.origin import at_origin
from ivsid.sensors.pose import with_velocities
from ivsid.sensors.smoothing import splined
from ivsid.vehicle import InertialSensor, Sensors, Vehicle
from ivsid.vehicle.carried import with_keys

# Channel and axis of each acceleration.
_INERTIAL: Final = (("udot", 0), ("vdot", 1), ("ax", 0), ("ay", 1))
# Channel, and the section of [sensors] whose accuracy bounds it.
_PLAIN: Final = (("force_X", "force"), ("force_Y", "force"), ("moment_N", "moment"), ("rdot", "yaw_acceleration"))


@dataclass(frozen=True)
class BoundedLog:
    """A log whose channels are intervals.

    Attributes:
        log: the readings.
        channels: intervals of each bounded channel, of shape (n,); a missing sample is [-inf, inf].
        present: whether each channel has a sample, of shape (n,).
        rule: the number of sigmas behind the bounds.
        ambient: half-widths (force [N], moment [N m]) of the ambient force, which no model explains.
        statistical: sentences on channels that are estimates and no bounds; a result that uses them is not guaranteed.
        carried: numbers of ``[model.fitted]`` that the channels take into account.
        corrected: channels without the bias or the scale that ``[model.fitted]`` states.
        stream: bound of the speed of a current [m/s] through which u and v are velocities; 0 over ground.
    """

    log: Log
    channels: Mapping[str, IntervalArray]
    present: Mapping[str, NDArray[np.bool_]]
    rule: Rule
    ambient: tuple[float, float]
    statistical: tuple[str, ...] = ()
    carried: tuple[str, ...] = ()
    corrected: frozenset[str] = frozenset()
    stream: float = 0.0


def bound_log(log: Log, vehicle: Vehicle, windows: int = 1) -> BoundedLog:
    """Encloses every channel of the log that the vehicle file bounds.

    Args:
        log: the checked log.
        vehicle: its sensors and ambient force.
        windows: lengths of window that rows will have: the mean of an ambient force over each is one more error a sample.

    Raises:
        IvsidError: a sensor section is missing or contradicts the log.
    """
    vehicle, keyed = with_keys(vehicle)
    sensors = vehicle.sensors
    _certain_turns(log, sensors)
    found = corrections(log, vehicle)
    channels = body_velocities(log, sensors) if log.derived else {}
    log, enclosed, statistical = velocities_of(log, sensors)
    channels |= enclosed
    sections = _inertial(log, sensors)
    # A channel with a clock of its own may have more samples than the log has rows.
    most = max([log.t.size, *(c.samples for c in log.clocks.values())])
    rule = rule_for(sensors, count_errors(most, sections.values(), vehicle, windows))
    duration = float(log.t[-1] - log.t[0])
    interval = _sampling_interval(log)
    radii: dict[str, float | NDArray[np.float64]] = {
        name: _half_widths(log, name, sensor, axis, interval, rule, duration)
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
        there = array_pieces(values.size, partial(_there, values))
        if name == "r" and sensors.yaw_rate is not None and sensors.yaw_rate.sampling == "averaged":
            radii[name] = _summed(np.asarray(radii[name]), _since_average(log, sensors))
        if name not in radii and (name not in ("u", "v") or sensors.velocity is None):
            continue
        radius = np.asarray(radii[name]) if name in radii else None
        channels[name] = interval_pieces(values.size, partial(_bounded, log, sensors, name, radius))
        present[name] = there
    if "psi" in log.columns and sensors.heading is not None:
        channels["psi"], present["psi"] = _heading(log, sensors.heading.accuracy)
    changed = corrected(channels, found)
    if changed:
        log = replace(log, columns=centres(log, channels, present, changed))
    _set_averages_apart(channels, present, sensors)
    log, channels, present = at_origin(log, channels, present, sensors)
    log, rates = with_accelerations(log, channels, sensors)
    channels |= rates
    present |= {name: np.isfinite(x.lower) for name, x in rates.items()}
    stream = 0.0 if found.water is None else through_water(channels, present, found.water)
    ambient = (0.0, 0.0)
    if vehicle.ambient is not None:
        k = rule.sigmas * (1 + ROUNDING)
        ambient = (k * vehicle.ambient.force, k * vehicle.ambient.moment)
    carried = (*keyed, *found.names)
    return BoundedLog(log, channels, present, rule, ambient, statistical, carried, frozenset(changed), stream)


def _bounded(log: Log, sensors: Sensors, name: str, radius: NDArray[np.float64] | None, rows: slice) -> IntervalArray:
    """Intervals of some samples: reading +- radius, or by ``doppler`` without a radius; [-inf, inf] for a missing sample."""
    values = log.columns[name][rows]
    there = ~np.isnan(values)
    reading = IntervalArray.around(np.where(there, values, 0.0), reading_error(log, name, sensors, rows))
    if radius is None and sensors.velocity is not None:
        found = doppler(reading, sensors.velocity)
    else:
        reach = np.asarray(0.0 if radius is None else radius)
        # The decimal of a bound was rounded to a double; the next double up is no smaller than the decimal.
        reach = reach if radius is None else np.nextafter(reach[rows] if reach.ndim else reach, np.inf)
        found = reading + IntervalArray(-reach, reach)
    if there.all():
        return found
    return IntervalArray(np.where(there, found.lower, -np.inf), np.where(there, found.upper, np.inf))


def _there(values: NDArray[np.float64], rows: slice) -> NDArray[np.bool_]:
    return ~np.isnan(values[rows])


def _summed(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return array_pieces(b.size, lambda rows: (a[rows] if a.ndim else a) + b[rows])


def _half_widths(
    log: Log, name: str, sensor: InertialSensor, axis: int, interval: NDArray[np.float64], rule: Rule, duration: float
) -> NDArray[np.float64]:
    """Half-widths of a channel of an inertial sensor, shape (n,), or () where they are the same everywhere."""
    if rule.confidence is None:
        return half_width(sensor, axis, _own_interval(log, name, interval), rule, duration)
    return array_pieces(
        interval.size, lambda rows: half_width(sensor, axis, _own_interval(log, name, interval[rows]), rule, duration)
    )


def _set_averages_apart(
    channels: dict[str, IntervalArray], present: dict[str, NDArray[np.bool_]], sensors: Sensors
) -> None:
    """Renames the channels of an averaging accelerometer, which holds at no single moment: only rows over whole steps use them."""
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
    """The heading [rad] without jumps of whole turns, and the rows that have one."""
    psi = log.columns["psi"]
    there = array_pieces(psi.size, partial(_there, psi))
    turns = turns_of(psi)
    reach = np.nextafter(accuracy, np.inf)

    def heading(rows: slice) -> IntervalArray:
        known = there[rows]
        turned, more = with_turns(np.where(known, psi[rows], 0.0), turns[rows])
        lost = log.error(name="psi", rows=rows) + np.where(known, more, 0.0)
        around = IntervalArray.around(np.where(known, turned, 0.0), lost) + IntervalArray(-reach, reach)
        return IntervalArray(np.where(known, around.lower, -np.inf), np.where(known, around.upper, np.inf))

    return interval_pieces(psi.size, heading), there


def velocities_of(log: Log, sensors: Sensors) -> tuple[Log, dict[str, IntervalArray], tuple[str, ...]]:
    """The log with the velocities that it lacks, their intervals from its pose, and sentences on those that are no bounds."""
    if sensors.from_pose == "spline":
        return splined(log, sensors)
    return (*with_velocities(log, sensors), ())


def _since_average(log: Log, sensors: Sensors) -> NDArray[np.float64]:
    """The largest distance of a yaw rate from its mean over the sample before, |rdot| h / 2 [rad/s], shape (n,)."""
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
    t = log.t
    longest = max(float(steps_in(t, p).max()) for p in pieces(t.size - 1))

    def moved(rows: slice) -> NDArray[np.float64]:
        before = np.r_[[longest] * (rows.start == 0), np.diff(t[max(rows.start - 1, 0) : rows.stop])]
        return np.asarray(np.nextafter(0.5 * limit * (before + 2 * log.time_error) * (1 + ROUNDING), np.inf))

    return array_pieces(t.size, moved)


def _inertial(log: Log, sensors: Sensors) -> dict[str, tuple[InertialSensor, int]]:
    """Sensor and axis of every bounded inertial channel of the log."""
    sections: dict[str, tuple[InertialSensor, int]] = {}
    for name, axis in _INERTIAL:
        if name in log.columns and sensors.acceleration is not None:
            sections[name] = (sensors.acceleration, axis)
    if "r" in log.columns and "r" not in log.derived and sensors.yaw_rate is not None:
        sections["r"] = (sensors.yaw_rate, 0)
    return sections


def _certain_turns(log: Log, sensors: Sensors) -> None:
    """Refuses a heading whose error is too large to tell the way round between its samples."""
    most = log.certain.get("psi")
    if most is not None and sensors.heading is not None and sensors.heading.accuracy >= most:
        raise IvsidError(
            f"{log.name}: with [sensors.heading] accuracy = {sensors.heading.accuracy:g} rad the way round from one sample of psi to the "
            f"next is not certain (below {max(most, 0.0):.3g} rad it is); state a smaller [log] rates psi, or log psi more often"
        )


def _own_interval(log: Log, name: str, rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The time [s] over which each sample of a channel averages: that of its own clock if that is shorter than the rows'."""
    clock = log.clocks.get(name)
    return rows if clock is None else np.minimum(rows, clock.interval)


def _sampling_interval(log: Log) -> NDArray[np.float64]:
    """The time [s] over which each sample averages white noise: the log's period, or less where rows are closer, shape (n,)."""
    t, period = log.t, log.period

    def interval(rows: slice) -> NDArray[np.float64]:
        # The first and the last row have one neighbour.
        first, last = max(rows.start - 1, 0), min(rows.stop + 1, t.size)
        steps = np.diff(t[first:last])
        steps = np.r_[steps[: first == rows.start], steps, steps[steps.size - (last == rows.stop) :]]
        return np.asarray(np.minimum(np.minimum(steps[:-1], steps[1:]), period))

    return array_pieces(t.size, interval)
