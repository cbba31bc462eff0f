"""Readings to ranges: the half-widths of the sensors a second time, in fractions (docs/theory.md, "Sensor bounds").

With the accelerometer's bias taken apart, a reading is the true value plus one constant of the log, within this range: the change of a
Gauss-Markov bias since the middle of the log is bounded by k B sqrt(2 (1 - exp(-|t - t_m| / T))) at each sample.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cached_property
from typing import Final

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import AccelerationSensor, Vehicle
from ivsid.vehicle.carried import with_keys
from ivsid.vehicle.mount import Mounted
from ivsid.verification.carried import Carried
from ivsid.verification.decimals import Decimals, around
from ivsid.verification.errors import UnprovedError
from ivsid.verification.gravity import along_and_across, size
from ivsid.verification.half_widths import HalfWidths, axis_of
from ivsid.verification.lever_arms import arm_of, mounted, turned_back
from ivsid.verification.pose import PoseVelocities
from ivsid.verification.rates import Rates
from ivsid.verification.rational import Range, cosine, normal_factor, pi, root, sided, sine
from ivsid.verification.refused import refuse

# Probability that all errors of a log keep their bounds, where the vehicle file states neither it nor ``sigmas``.
# Source: definition: default of [sensors] confidence, docs/guide.md
DEFAULT_CONFIDENCE: Final = 0.999
_ACCELERATIONS: Final = {"udot": 0, "vdot": 1, "ax": 0, "ay": 1}
_PLAIN: Final = {"force_X": "force", "force_Y": "force", "moment_N": "moment", "rdot": "yaw_acceleration"}
EARTH: Final = ("velocity_north", "velocity_east", "psi")
# Readings of a velocity sensor, to which its scale factor error applies.
_VELOCITIES: Final = ("u", "v", "velocity_north", "velocity_east")
AXES: Final = ("x", "y")


class Readings:
    """Channels of a log as ranges that hold the true values under the vehicle file's assumptions."""

    def __init__(self, log: Log, vehicle: Vehicle, *, apart: bool = False, windows: int = 1) -> None:
        vehicle, self.keyed = with_keys(vehicle)
        self.log, self.vehicle, self.exact, self.windows = log, vehicle, Decimals(vehicle.text), windows
        self.carried = Carried(log, vehicle, self.exact)
        refuse(log, vehicle, self.exact)
        self.apart = self._one_bias() if apart else {}
        self._made: dict[tuple[str, int], Range | None] = {}
        self._times: dict[int, Range] = {}
        self.pose = PoseVelocities.of(log, vehicle.sensors, self.exact, self.raw, self.time)
        self._rates = Rates(log, vehicle.sensors.limits, self.exact, self)

    def _one_bias(self) -> dict[str, str]:
        """The channel of each axis of an accelerometer whose bias is one unknown of the log."""
        sensor, sensors = self.vehicle.sensors.acceleration, self.vehicle.sensors
        names = [n for n in _ACCELERATIONS if n in self.log.columns]
        found = {AXES[_ACCELERATIONS[n]]: n for n in names}
        if sensor is None or sensors.sigmas is not None or not names or len(found) < len(names):
            raise UnprovedError("a bias can be taken apart under confidence only, from one acceleration an axis")
        if any(map(self.carried.biased, (*names, "r"))) or self.carried.water is not None:
            raise UnprovedError("the bias of an accelerometer beside fitted errors of readings cannot be taken apart")
        if sensor.sampling == "averaged" or sensor.off_origin or sensor.turned or sensor.gravity:
            raise UnprovedError("the bias of a mounted or averaging accelerometer cannot be taken apart")
        if {*found.values()} & {*self.log.clocks, *self.log.by_rate}:
            raise UnprovedError("the bias of an accelerometer of another clock than the rows cannot be taken apart")
        if sensors.limits.yaw_jerk is not None and "rdot" not in self.log.columns:
            raise UnprovedError("a bias cannot be taken apart beside accelerations that follow from a jerk in yaw")
        return found

    def bias(self, axis: str) -> Range:
        """The range of an accelerometer's bias in the middle of the log [m/s^2]."""
        sensor = self.vehicle.sensors.acceleration
        assert sensor is not None
        return sided(self.factor * self.exact(axis_of(sensor.bias_instability, AXES.index(axis))))

    def time(self, i: int) -> Range:
        """The time of a row [s], with the rounding of its decimals and of a conversion."""
        if i not in self._times:
            t = float(self.log.t[i])
            self._times[i] = around(t, self.log.time_rounding)
        return self._times[i]

    def raw(self, name: str, i: int) -> Range | None:
        """A reading with the rounding of its decimals and of a conversion, without its sensor's error; None where it is missing."""
        values = self.log.columns.get(name)
        if values is None or math.isnan(values[i]):
            return None
        value, lost = float(values[i]), self.log.rounding.get(name)
        off = 0.0 if lost is None or math.isnan(lost[i]) else float(lost[i])
        made = around(value, off)
        velocity = self.vehicle.sensors.velocity
        if (
            name in self.log.by_rate
            and name in _VELOCITIES
            and velocity is not None
            and velocity.scale_factor_sign >= 0
        ):
            # A change of the velocity between samples appears in the reading times the scale factor.
            made = made + sided(self.exact(velocity.scale_factor_error).upper * Fraction(off))
        return made

    def heading(self, i: int) -> Range | None:
        """The heading [rad] up to whole turns; None where it is missing or has no bound."""
        psi, heading = self.raw("psi", i), self.vehicle.sensors.heading
        return None if psi is None or heading is None else psi + sided(self.exact(heading.accuracy))

    def whole_turns(self, name: str, i: int) -> Range:
        """The multiple of a turn [rad] to add to an angle at the next row, by the shorter way round."""
        values = self.log.columns[name]
        return pi() * (-2 * round(float(values[i + 1] - values[i]) / (2 * math.pi)))

    def has(self, name: str) -> bool:
        """Whether the channel is logged, or follows from the pose, and is bounded."""
        return self.logged(name) or self._rates.made(name)

    def logged(self, name: str) -> bool:
        """Whether the channel is logged, or follows from the pose, and is bounded; accelerations from velocities do not count."""
        if self.pose is not None and name in self.pose.wanted:
            return True
        sensors = self.vehicle.sensors
        if name not in self.log.columns:
            return False
        if name in self.log.derived:
            return sensors.velocity is not None and sensors.heading is not None
        if name in _ACCELERATIONS:
            # A mean over a step is no acceleration at a row.
            return sensors.acceleration is not None and not (
                sensors.acceleration.sampling == "averaged" and name in ("ax", "ay")
            )
        if name in _PLAIN:
            return getattr(sensors, _PLAIN[name]) is not None
        return {"r": sensors.yaw_rate, "u": sensors.velocity, "v": sensors.velocity}.get(name) is not None

    def channel(self, name: str, i: int) -> Range | None:
        """The range of the true value; None where the reading is missing or has no bound."""
        key = (name, i)
        if key not in self._made:
            found = self._bounded(name, i) if self.has(name) else None
            self._made[key] = found if self.carried.water is None else self._through_water(name, found, i)
        return self._made[key]

    def _through_water(self, name: str, over_ground: Range | None, i: int) -> Range | None:
        """A velocity, or its rate, through the water, from that over ground."""
        if name not in ("u", "v", "udot", "vdot") or self.carried.water is None:
            return over_ground
        psi, (north, east) = self.heading(i), self.carried.water
        if psi is None or over_ground is None:
            return None
        c, s = cosine(psi), sine(psi)
        ahead, across = north * c + east * s, east * c - north * s
        if name in ("u", "v"):
            return over_ground - (ahead if name == "u" else across)
        r = self.channel("r", i)
        if r is None:
            return None
        return over_ground - r * across if name == "udot" else over_ground + r * ahead

    @property
    def stream(self) -> Range | None:
        """The speed of a current [m/s], or None."""
        water = self.carried.water
        return None if water is None else root(water[0].square() + water[1].square())

    def _bounded(self, name: str, i: int) -> Range | None:
        sensors = self.vehicle.sensors
        if self.pose is not None and name in self.pose.wanted:
            return self.pose.velocity(name, i)
        if not self.logged(name):
            return self._rates.rate(name, i)
        if name in self.log.derived:
            earth = self._from_earth(name, i)
            velocity = sensors.velocity
            return self._moved_by(velocity, name, earth, i) if velocity is not None and earth is not None else earth
        reading = self.raw(name, i)
        if reading is None:
            return None
        if name in _PLAIN:
            return reading + sided(self.exact(getattr(sensors, _PLAIN[name]).accuracy))
        feels = sensors.acceleration
        if name in ("ax", "ay") and feels is not None and (mounted(feels) or feels.gravity):
            return self._force_at_origin(feels, name, i)
        if name in ("u", "v") and sensors.velocity is not None and mounted(sensors.velocity):
            return self._velocity_at_origin(sensors.velocity, name, i)
        return self._plain(name, i)

    def _plain(self, name: str, i: int) -> Range | None:
        """A reading with its sensor's own error, at the sensor's place."""
        sensors, reading = self.vehicle.sensors, self.raw(name, i)
        if reading is None:
            return None
        if name in _ACCELERATIONS and sensors.acceleration is not None:
            reading = reading + sided(self._half_width(sensors.acceleration, _ACCELERATIONS[name], name, i))
        elif name == "r" and sensors.yaw_rate is not None:
            reading = reading + sided(self._half_width(sensors.yaw_rate, 0, name, i) + self._since_average(i))
        else:
            reading = self._doppler(reading)
        return self.carried.without(name, reading)

    def _velocity_at_origin(self, mount: Mounted, name: str, i: int) -> Range | None:
        """Velocity u or v of the body origin [m/s] from a sensor off the origin or turned."""
        pair = [self._plain(n, i) for n in ("u", "v")]
        return self._moved_by(mount, name, turned_back(self.exact, mount, pair[0], pair[1], first=name == "u"), i)

    def _moved_by(self, mount: Mounted, name: str, speed: Range | None, i: int) -> Range | None:
        if speed is None or not mount.off_origin:
            return speed
        r, (x, y) = self.channel("r", i), arm_of(self.exact, mount)
        if r is None:
            return None
        return speed + y * r if name == "u" else speed - x * r

    def _force_at_origin(self, mount: Mounted, name: str, i: int) -> Range | None:
        """Specific force a_x or a_y of the body origin [m/s^2] likewise, less gravity."""
        force = turned_back(self.exact, mount, self._plain("ax", i), self._plain("ay", i), first=name == "ax")
        if force is not None and isinstance(mount, AccelerationSensor) and mount.gravity:
            force = force - self._gravity(mount.gravity, i)[name == "ay"]
        if force is None or not mount.off_origin:
            return force
        r, (x, y) = self.channel("r", i), arm_of(self.exact, mount)
        rdot = self.channel("rdot", i) if self.logged("rdot") else self._rates.rate("rdot", i)
        if r is None or rdot is None:
            return None
        return force + x * r.square() + y * rdot if name == "ax" else force - x * rdot + y * r.square()

    def _gravity(self, stated: bool | float, i: int) -> tuple[Range, Range]:
        attitude = self.vehicle.sensors.attitude
        if attitude is None:
            raise UnprovedError("accelerations that hold gravity need [sensors.attitude]")
        return along_and_across(self.raw, i, self.exact(attitude.accuracy), size(self.exact, stated))

    def averages(self, name: str) -> bool:
        """Whether a channel holds means of a specific force over the steps."""
        sensor = self.vehicle.sensors.acceleration
        return sensor is not None and sensor.sampling == "averaged" and name in self.log.columns

    def average(self, name: str, i: int) -> Range | None:
        """The mean of a_x or a_y over the step before a row; None where it is missing."""
        return self._plain(name, i)

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
        """Number of errors that the union bound covers."""
        log, vehicle = self.log, self.vehicle
        n = max([log.t.size, *(c.samples for c in log.clocks.values())])
        count = 0
        for name, axis in {**_ACCELERATIONS, "r": 0}.items():
            sensor = vehicle.sensors.yaw_rate if name == "r" else vehicle.sensors.acceleration
            if name not in log.columns or name in log.derived or sensor is None:
                continue
            walk, bias = axis_of(sensor.random_walk, axis), axis_of(sensor.bias_instability, axis)
            count += n * ((walk > 0) + (bias > 0)) + 4 * (sensor.rate_random_walk > 0)
        if vehicle.ambient is not None:
            count += (1 + self.windows) * n * (2 * (vehicle.ambient.force > 0) + (vehicle.ambient.moment > 0))
        # The bias in the middle of the log is one more error of each axis.
        return int(count) + len(self.apart)

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
        """Ranges of the ambient force [N] and moment [N m]."""
        ambient = self.vehicle.ambient
        if ambient is None:
            return Range(0), Range(0)
        return sided(self.factor * self.exact(ambient.force)), sided(self.factor * self.exact(ambient.moment))

    @cached_property
    def _half_width(self) -> HalfWidths:
        one = self.vehicle.sensors.sigmas is not None
        return HalfWidths(self.log, self.exact, self.factor, one=one, apart=self.apart.values(), time=self.time)

    def _since_average(self, i: int) -> Range:
        """Bound of the yaw rate's distance from its mean over the step before [rad/s]."""
        sensor, limit = self.vehicle.sensors.yaw_rate, self.vehicle.sensors.limits.yaw_acceleration
        if sensor is None or sensor.sampling != "averaged":
            return Range(0)
        if limit is None:
            raise UnprovedError("an averaging gyro needs [sensors.limits] yaw_acceleration")
        k = i - 1 if i else int(np.argmax(np.diff(self.log.t)))
        return self.exact(limit) * (self.time(k + 1) - self.time(k)) / 2
