"""Readings to ranges: the sensors' half-widths once more, in fractions (METHODS 5.1)."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cached_property
from typing import Final

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import InertialSensor, Vehicle
from ivsid.verification.decimals import Decimals
from ivsid.verification.pose import PoseVelocities
from ivsid.verification.rational import Range, cosine, normal_factor, root, sided, sine

DEFAULT_CONFIDENCE: Final = 0.999
_ACCELERATIONS: Final = {"udot": 0, "vdot": 1, "ax": 0, "ay": 1}
_PLAIN: Final = {"force_X": "force", "force_Y": "force", "moment_N": "moment", "rdot": "yaw_acceleration"}
EARTH: Final = ("velocity_north", "velocity_east", "psi")


class Readings:
    """Every channel of a log as ranges that hold the truth under the vehicle file's assumptions."""

    def __init__(self, log: Log, vehicle: Vehicle) -> None:
        self.log, self.vehicle, self.exact = log, vehicle, Decimals(vehicle.text)
        self._made: dict[tuple[str, int], Range | None] = {}
        self._times: dict[int, Range] = {}
        self._pose = PoseVelocities.of(log, vehicle.sensors, self.exact, self.raw, self.time)

    def time(self, i: int) -> Range:
        """A time [s]: its decimals, and what a conversion lost."""
        if i not in self._times:
            t = float(self.log.t[i])
            self._times[i] = around(t, self.log.time_rounding)
        return self._times[i]

    def raw(self, name: str, i: int) -> Range | None:
        """A reading without its sensor's error: its decimals, and what a conversion lost; None where it is missing."""
        values = self.log.columns.get(name)
        if values is None or math.isnan(values[i]):
            return None
        value, lost = float(values[i]), self.log.rounding.get(name)
        off = 0.0 if lost is None or math.isnan(lost[i]) else float(lost[i])
        return around(value, off)

    def has(self, name: str) -> bool:
        """Whether the channel is logged, or follows from the pose, and is bounded."""
        if self._pose is not None and name in self._pose.wanted:
            return True
        sensors = self.vehicle.sensors
        if name not in self.log.columns:
            return False
        if name in self.log.derived:
            return sensors.velocity is not None and sensors.heading is not None
        if name in _ACCELERATIONS:
            return sensors.acceleration is not None
        if name in _PLAIN:
            return getattr(sensors, _PLAIN[name]) is not None
        return {"r": sensors.yaw_rate, "u": sensors.velocity, "v": sensors.velocity}.get(name) is not None

    def channel(self, name: str, i: int) -> Range | None:
        """The truth behind a reading; None where it is missing or nothing bounds it."""
        key = (name, i)
        if key not in self._made:
            self._made[key] = self._bounded(name, i) if self.has(name) else None
        return self._made[key]

    def _bounded(self, name: str, i: int) -> Range | None:
        sensors = self.vehicle.sensors
        if self._pose is not None and name in self._pose.wanted:
            return self._pose.velocity(name, i)
        if name in self.log.derived:
            return self._from_earth(name, i)
        reading = self.raw(name, i)
        if reading is None:
            return None
        if name in _PLAIN:
            return reading + sided(self.exact(getattr(sensors, _PLAIN[name]).accuracy))
        if name in _ACCELERATIONS and sensors.acceleration is not None:
            return reading + sided(self._half_width(sensors.acceleration, _ACCELERATIONS[name], name, i))
        if name == "r" and sensors.yaw_rate is not None:
            return reading + sided(self._half_width(sensors.yaw_rate, 0, name, i))
        return self._doppler(reading)

    def _doppler(self, reading: Range) -> Range:
        velocity = self.vehicle.sensors.velocity
        assert velocity is not None
        e = self.exact(velocity.scale_factor_error).upper
        sign = velocity.scale_factor_sign
        scale = Range(0 if sign > 0 else -e, 0 if sign < 0 else e) + 1
        return (reading + sided(self.exact(velocity.accuracy))) / scale

    def _from_earth(self, name: str, i: int) -> Range | None:
        north, east, psi = (self.raw(c, i) for c in EARTH)
        heading = self.vehicle.sensors.heading
        if north is None or east is None or psi is None or heading is None:
            return None
        angle = psi + sided(self.exact(heading.accuracy))
        c, s = cosine(angle), sine(angle)
        north, east = self._doppler(north), self._doppler(east)
        return north * c + east * s if name == "u" else east * c - north * s

    @cached_property
    def errors(self) -> int:
        """Errors that the union bound covers."""
        log, vehicle = self.log, self.vehicle
        n = max([log.t.size, *(c.samples for c in log.clocks.values())])
        count = 0
        for name, axis in {**_ACCELERATIONS, "r": 0}.items():
            sensor = vehicle.sensors.yaw_rate if name == "r" else vehicle.sensors.acceleration
            if name not in log.columns or name in log.derived or sensor is None:
                continue
            walk, bias = _axis(sensor.random_walk, axis), _axis(sensor.bias_instability, axis)
            count += n * ((walk > 0) + (bias > 0)) + 4 * (sensor.rate_random_walk > 0)
        if vehicle.ambient is not None:
            count += 2 * n * (2 * (vehicle.ambient.force > 0) + (vehicle.ambient.moment > 0))
        return int(count)

    @cached_property
    def factor(self) -> Range:
        """The number of standard deviations: as stated, or proved large enough for the stated confidence."""
        sensors = self.vehicle.sensors
        if sensors.sigmas is not None:
            return self.exact(sensors.sigmas)
        confidence = self.exact(DEFAULT_CONFIDENCE if sensors.confidence is None else sensors.confidence)
        return Range(normal_factor((1 - confidence.upper) / (2 * max(self.errors, 1))))

    @cached_property
    def ambient(self) -> tuple[Range, Range]:
        """All that the force [N] and the moment [N m] that nobody models may be."""
        ambient = self.vehicle.ambient
        if ambient is None:
            return Range(0), Range(0)
        return sided(self.factor * self.exact(ambient.force)), sided(self.factor * self.exact(ambient.moment))

    def _half_width(self, sensor: InertialSensor, axis: int, name: str, i: int) -> Range:
        walk, bias = (self.exact(_axis(x, axis)) for x in (sensor.random_walk, sensor.bias_instability))
        k, t = self.factor, self.log.t
        drift = k * self.exact(sensor.rate_random_walk) * root(Range(Fraction(float(t[-1])) - Fraction(float(t[0]))))
        if self.vehicle.sensors.sigmas is not None:
            step = Range(max(self._interval(name, j) for j in (range(t.size) if len(set(np.diff(t))) > 1 else (0,))))
            noise = walk / root(step) + root(step / self.exact(_axis(sensor.bias_time, axis))) * bias
            return k * noise + drift + self.exact(sensor.accuracy)
        return k * walk / root(Range(self._interval(name, i))) + k * bias + drift + self.exact(sensor.accuracy)

    @cached_property
    def _period(self) -> Fraction:
        return Fraction(self.log.period)

    def _interval(self, name: str, i: int) -> Fraction:
        """The time over which a sample averages white noise: the period, or less where samples stand closer."""
        t = self.log.t
        steps = [Fraction(float(t[j + 1])) - Fraction(float(t[j])) for j in (i - 1, i) if 0 <= j < t.size - 1]
        least = min([*steps, self._period])
        clock = self.log.clocks.get(name)
        return least if clock is None else min(least, Fraction(clock.interval))


def around(value: float, off: float) -> Range:
    """The decimals that were read as a double, half a unit in its last place to either side, and what was lost beside that."""
    half = Range.around(0.0, math.ulp(value))
    return Range.around(value, off) + Range.raw(half.low // 2, half.high // 2)


def _axis(value: float | tuple[float, float], axis: int) -> float:
    return value[axis] if isinstance(value, tuple) else value
