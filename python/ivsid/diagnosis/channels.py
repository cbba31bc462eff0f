"""Stage 0: a log on a uniform clock, with what its sensors are worth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.pose import with_velocities
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]

# Above this rate [Hz] a log is thinned: nothing of a hull's motion is quicker.
FASTEST: Final = 25.0
# A sample further than this from its place on the clock, in steps, is missing.
OFF_CLOCK: Final = 0.75
SHORTEST: Final = 60.0


@dataclass(frozen=True)
class Channels:
    """A log on the clock t = 0, h, 2 h, ... [s].

    Attributes:
        name: of the log.
        h: step [s].
        t: clock of the effects [s], from the log's first row, shape (n,).
        nu: u, v [m/s], r [rad/s], shape (3, n).
        acceleration: ax, ay [m/s^2] and rdot [rad/s^2], None where not measured.
        averaged: accelerations are means over the step before their row.
        psi: heading [rad], unwrapped, or None.
        place: north and east [m], shape (2, n), or None.
        demands: shape (thrusters, n).
        angles: of azimuth thrusters [rad], shape (thrusters, n).
        force: known X, Y [N], N [N m] beside the thrusters, shape (3, n).
        wind: the air's velocity north and east [m/s], shape (2, n), or None.
        voltage: as a share of its first value, or None.
        depth: [m], or None.
        good: where every channel has a sample, shape (n,).
        noise: standard deviation of each sensor's white noise by channel: nu (3), acceleration (3), psi, place.
        notes: what was thinned or filled.
    """

    name: str
    h: float
    t: Array
    nu: Array
    acceleration: tuple[Array | None, Array | None, Array | None]
    averaged: bool
    psi: Array | None
    place: Array | None
    demands: Array
    angles: Array
    force: Array
    wind: Array | None
    voltage: Array | None
    depth: Array | None
    good: NDArray[np.bool_]
    noise: dict[str, float]
    notes: tuple[str, ...] = ()

    @property
    def n(self) -> int:
        """Samples."""
        return int(self.t.size)

    def has(self, need: str) -> bool:
        """Whether a need of the catalogue, ``a`` or ``a|b``, is there."""
        known = {
            "psi": self.psi is not None,
            "x": self.place is not None,
            "y": self.place is not None,
            "ax": self.acceleration[0] is not None,
            "ay": self.acceleration[1] is not None,
            "udot": self.acceleration[0] is not None,
            "vdot": self.acceleration[1] is not None,
            "rdot": self.acceleration[2] is not None,
            "wind_speed": self.wind is not None,
            "wind_direction": self.wind is not None,
            "voltage": self.voltage is not None,
            "depth": self.depth is not None,
        }
        return any(known.get(name, False) for name in need.split("|"))


def channels(log: Log, vehicle: Vehicle, origin: float | None = None) -> Channels:
    """Brings a log to a uniform clock.

    Args:
        log: as read.
        vehicle: whose thrusters and sensors the log belongs to.
        origin: time at which the clocks of effects start [s]; the log's first row by default.

    Raises:
        IvsidError: the log lacks velocities or demands, or is shorter than a minute.
    """
    log, _ = with_velocities(log, vehicle.sensors)
    _usable(log, vehicle)
    h = log.period
    notes = []
    if 1 / h > FASTEST * 1.01:
        thin = int(np.ceil(1 / h / FASTEST))
        h *= thin
        notes.append(f"every {thin}th sample is used: {1 / h:.3g} a second are enough for the motion of a hull")
    clock = np.arange(int(np.floor((log.t[-1] - log.t[0]) / h + 1e-6)) + 1) * h + log.t[0]
    resample = _Resampler(log, clock, h)
    nu = np.stack([resample(n) for n in ("u", "v", "r")])
    ax, ay = resample.optional("ax"), resample.optional("ay")
    if ax is None and (udot := resample.optional("udot")) is not None:
        ax = udot - nu[1] * nu[2]
    if ay is None and (vdot := resample.optional("vdot")) is not None:
        ay = vdot + nu[0] * nu[2]
    psi = None
    if "psi" in log.columns and "r" not in log.derived:
        psi = resample("psi", unwrap=True)
    place = np.stack([resample("x"), resample("y")]) if {"x", "y"} <= set(log.columns) else None
    demands = np.zeros((len(vehicle.thrusters), clock.size))
    angles = np.zeros_like(demands)
    for k, thruster in enumerate(vehicle.thrusters):
        log.column(f"demand_{thruster.name}", f"for thruster {thruster.name}")
        demands[k] = resample(f"demand_{thruster.name}", held=True)
        angles[k] = thruster.azimuth
        if thruster.steering == "azimuth":
            log.column(f"azimuth_{thruster.name}", f"for the direction of thruster {thruster.name}")
            angles[k] = resample(f"azimuth_{thruster.name}", held=True)
    force = np.zeros((3, clock.size))
    if not vehicle.thrusters:
        for k, name in enumerate(("force_X", "force_Y", "moment_N")):
            log.column(name, "where the vehicle file has no thrusters")
            force[k] = resample(name, held=True)
    wind = None
    if {"wind_speed", "wind_direction"} <= set(log.columns):
        speed, direction = resample("wind_speed"), resample("wind_direction", unwrap=True)
        wind = np.stack([-speed * np.cos(direction), -speed * np.sin(direction)])
    voltage = resample.optional("voltage")
    sensor = vehicle.sensors.acceleration
    made = Channels(
        log.name,
        float(h),
        clock - (log.t[0] if origin is None else origin),
        nu,
        (ax, ay, resample.optional("rdot")),
        sensor is not None and sensor.sampling == "averaged",
        psi,
        place,
        demands,
        angles,
        force,
        wind,
        None if voltage is None else voltage / voltage[0],
        resample.optional("depth"),
        resample.good,
        {},
        tuple(notes),
    )
    object.__setattr__(made, "noise", _noise(made, vehicle))
    return made


def _usable(log: Log, vehicle: Vehicle) -> None:
    """Refuses what a diagnosis cannot follow."""
    for thruster in vehicle.thrusters:
        if thruster.rudder is not None:
            raise IvsidError(
                f"thruster {thruster.name} has a rudder, whose force a diagnosis does not follow yet; log force_X, force_Y, moment_N "
                "in place of the thrusters, or leave the rudder out where it stays amidships"
            )
    for name in ("u", "v", "r"):
        log.column(name, "by every equation of motion")
    if log.t[-1] - log.t[0] < SHORTEST:
        raise IvsidError(
            f"{log.name} lasts {log.t[-1] - log.t[0]:.3g} s; a diagnosis needs at least {SHORTEST:.0f} s, so give a longer log"
        )


class _Resampler:
    """Columns on the clock, and where all of them have samples."""

    def __init__(self, log: Log, clock: Array, h: float) -> None:
        self.log, self.clock, self.h = log, clock, h
        self.good = np.ones(clock.size, dtype=bool)

    def __call__(self, name: str, *, held: bool = False, unwrap: bool = False) -> Array:
        values = self.log.columns[name]
        there = np.isfinite(values)
        t, x = self.log.t[there], values[there]
        if unwrap:
            x = np.unwrap(x)
        at = np.clip(np.searchsorted(t, self.clock + 1e-6 * self.h, side="right") - 1, 0, t.size - 1)
        if held:
            found: Array = x[at]
            return found
        nearest = np.minimum(np.abs(self.clock - t[at]), np.abs(t[np.minimum(at + 1, t.size - 1)] - self.clock))
        self.good &= nearest <= OFF_CLOCK * self.h
        return np.interp(self.clock, t, x)

    def optional(self, name: str) -> Array | None:
        if name not in self.log.columns or not np.isfinite(self.log.columns[name]).any():
            return None
        return self(name)


def _noise(c: Channels, vehicle: Vehicle) -> dict[str, float]:
    """White noise of each sensor: from its scatter about a parabola, which a motion between jumps of a demand follows.

    The specification is a bound or a wish; where it is given, the estimate stays within a factor of ten of it.
    """
    sensors = vehicle.sensors
    said: dict[str, float | None] = {}
    velocity = None if sensors.velocity is None else sensors.velocity.accuracy / 3
    said |= {"u": velocity, "v": velocity}
    said["r"] = None if sensors.yaw_rate is None else sensors.yaw_rate.random_walk / np.sqrt(c.h)
    for axis, name in enumerate(("ax", "ay")):
        said[name] = None if sensors.acceleration is None else sensors.acceleration.walk(axis) / np.sqrt(c.h)
    said["psi"] = None if sensors.heading is None else sensors.heading.accuracy / 3
    said["x"] = said["y"] = None if sensors.position is None else sensors.position.accuracy / 3
    rows = {"u": c.nu[0], "v": c.nu[1], "r": c.nu[2], "ax": c.acceleration[0], "ay": c.acceleration[1]}
    rows |= {"rdot": c.acceleration[2], "psi": c.psi}
    rows |= {"x": None, "y": None} if c.place is None else {"x": c.place[0], "y": c.place[1]}
    found = {}
    for name, x in rows.items():
        if x is None:
            continue
        order = 1 if name in ("ax", "ay", "rdot") else 3
        gain = {1: 2.0, 3: 20.0}[order]
        scatter = float(np.median(np.abs(np.diff(x, order))) / 0.6745 / np.sqrt(gain))
        guess = said.get(name)
        if guess:
            scatter = float(np.clip(scatter, guess / 10, guess * 10))
        found[name] = max(scatter, 1e-6 * float(np.std(x)), 1e-9)
    return found
