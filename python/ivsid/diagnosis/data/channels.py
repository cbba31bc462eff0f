"""Stage 0: a log on a uniform clock, with what its sensors are worth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.from_pose import differenced
from ivsid.diagnosis.data.lever_arms import at_origin
from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.sensors.pose import with_velocities
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]

# Above this rate [Hz] a log is thinned: nothing of a hull's motion is quicker.
FASTEST: Final = 25.0
# Where no sample is closer than this, in steps, one is missing; a single one that was lost is filled in from its neighbours.
OFF_CLOCK: Final = 1.05
# A channel whose samples are this much rarer than the rows sets the clock, or is left out where the motion does not need it.
RARER: Final = 1.5
SLOWEST: Final = 1.01
# How many times the distance that one sample in twenty has from the middle of its neighbours an outlier stands away.
FAR_OUT: Final = 10.0
# Times closer than this, in steps, are the same.
SAME: Final = 0.02
SHORTEST: Final = 60.0
# A turn from one sample to the next [rad] beyond which steps of the motion are no longer small.
SPIN: Final = 0.3
# Equal parts of a step in which demands are looked up, at most.
PARTS: Final = 50


@dataclass(frozen=True)
class Between:
    """What is sent and held at equal parts of each step of a clock that is slower than the log, shape (thrusters, n, parts) each.

    Attributes:
        demands: of thrusters.
        angles: of azimuth thrusters [rad].
        rudders: angles of rudders [rad].
    """

    demands: Array
    angles: Array
    rudders: Array

    @property
    def lean(self) -> Array:
        """Weights of the parts in how far the mean of a step's velocities is ahead of the middle of a straight line, shape (parts,).

        The mean of the double integral gives the first parts of a step the most weight; equal parts would have 1 / parts each.
        """
        count = self.demands.shape[2]
        return np.asarray(2 * (count - np.arange(count) - 0.5) / count**2 - 1 / count)


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
        rudders: angles of the rudders behind thrusters [rad], shape (thrusters, n).
        held: demands, angles and forces hold from a sample to the next; else they change on straight lines.
        between: what is held at equal parts of each step, where the clock is slower than the log, or None.
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
    rudders: Array
    held: bool
    between: Between | None
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
    log, _ = with_velocities(differenced(log), vehicle.sensors)
    _usable(log)
    log = at_origin(log, vehicle.sensors)
    log, h, notes = _paced(log)
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
    held = vehicle.log.demand == "hold"
    demands, angles, rudders = _sent(vehicle, resample, held=held)
    between = None
    if held and h > RARER * log.period and vehicle.thrusters:
        parts = min(int(np.ceil(h / log.period - 1e-6)), PARTS)
        between = _between(vehicle, resample, parts)
    force = np.zeros((3, clock.size))
    if not vehicle.thrusters:
        for k, name in enumerate(("force_X", "force_Y", "moment_N")):
            log.column(name, "where the vehicle file has no thrusters")
            force[k] = resample(name, sent=True, held=held)
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
        rudders,
        held,
        between,
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


def _paced(log: Log) -> tuple[Log, float, list[str]]:
    """The log without channels that come too rarely, the step of its clock [s], and what was done."""
    # The usual step is rounded as the times are; the whole log knows it better.
    h = log.period
    whole = (log.t[-1] - log.t[0]) / max(round((log.t[-1] - log.t[0]) / h), 1)
    h = float(whole) if abs(whole / h - 1) < 1e-3 else h
    notes = []
    slowest = max(_interval(log, name) for name in ("u", "v", "r"))
    if slowest > RARER * h:
        if slowest > SLOWEST:
            raise IvsidError(
                f"{log.name} has a velocity every {slowest:.3g} s; a diagnosis needs one a second at least, so log u, v and r faster"
            )
        h = slowest
        notes.append(f"the clock is that of the slowest velocity: {1 / h:.3g} samples a second")
    if 1 / h > FASTEST * 1.01:
        thin = int(np.ceil(1 / h / FASTEST))
        h *= thin
        notes.append(f"every {thin}th sample is used: {1 / h:.3g} a second are enough for the motion of a hull")
    turned = h * float(np.nanquantile(np.abs(log.columns["r"]), 0.95))
    if turned > SPIN:
        raise IvsidError(
            f"{log.name}: the vehicle turns by {turned:.2g} rad from one sample to the next, and a diagnosis follows {SPIN:g}; log faster, or "
            "give a log of slower turns"
        )
    rare = [n for n in ("ax", "ay", "udot", "vdot", "rdot", "psi", "x", "y") if _interval(log, n) > RARER * h]
    if rare:
        notes.append(f"{', '.join(rare)} come too rarely to be used")
    columns = {k: x for k, x in log.columns.items() if k not in rare}
    for name in ("u", "v", "r", "x", "y"):
        if name in columns and (wild := _wild(columns[name])).any():
            columns[name] = np.where(wild, np.nan, columns[name])
            notes.append(f"{int(wild.sum())} samples of {name} stand far out from both neighbours and are left out")
    return replace(log, columns=columns), h, notes


def _wild(x: Array) -> NDArray[np.bool_]:
    """Velocities and places that no motion explains, far beyond both neighbours; an acceleration may jump and come back.

    Beyond both, on the same side: where a force jumps, a sample stands far from the middle of its neighbours and next to one of them.
    """
    there = np.flatnonzero(np.isfinite(x))
    found = np.zeros(x.size, dtype=bool)
    if there.size < 50:
        return found
    values = x[there]
    before, after = values[1:-1] - values[:-2], values[1:-1] - values[2:]
    off, beyond = np.zeros(there.size), np.zeros(there.size)
    off[1:-1] = 0.5 * np.abs(before + after)
    beyond[1:-1] = np.where(before * after > 0, np.minimum(np.abs(before), np.abs(after)), 0.0)
    usual = float(np.quantile(off, 0.95))
    # Its neighbours stand out half as far, since it is their neighbour.
    highest = off > 1.5 * np.maximum(np.r_[0.0, off[:-1]], np.r_[off[1:], 0.0])
    if usual > 0:
        found[there] = (off > max(FAR_OUT * usual, 0.3 * float(values.std()))) & highest & (beyond > 0.5 * off)
    return found


def _sent(vehicle: Vehicle, resample: _Resampler, *, held: bool) -> tuple[Array, Array, Array]:
    """Demands, angles of thrusters and of rudders, shape (thrusters, n)."""
    log = resample.log
    demands = np.zeros((len(vehicle.thrusters), resample.clock.size))
    angles, rudders = np.zeros_like(demands), np.zeros_like(demands)
    for k, thruster in enumerate(vehicle.thrusters):
        log.column(f"demand_{thruster.name}", f"for thruster {thruster.name}")
        demands[k] = resample(f"demand_{thruster.name}", sent=True, held=held)
        angles[k] = thruster.azimuth
        if thruster.steering == "azimuth":
            log.column(f"azimuth_{thruster.name}", f"for the direction of thruster {thruster.name}")
            angles[k] = resample(f"azimuth_{thruster.name}", sent=True, held=held, unwrap=not held)
        if thruster.rudder is not None:
            log.column(f"rudder_{thruster.name}", f"for the rudder of thruster {thruster.name}")
            rudders[k] = resample(f"rudder_{thruster.name}", sent=True, held=held)
    return demands, angles, rudders


def _between(vehicle: Vehicle, resample: _Resampler, parts: int) -> Between:
    """What is sent at equal parts of the steps."""
    demands = np.stack([resample.between(f"demand_{t.name}", parts) for t in vehicle.thrusters])
    angles, rudders = np.zeros_like(demands), np.zeros_like(demands)
    for k, thruster in enumerate(vehicle.thrusters):
        angles[k] = thruster.azimuth
        if thruster.steering == "azimuth":
            angles[k] = resample.between(f"azimuth_{thruster.name}", parts)
        if thruster.rudder is not None:
            rudders[k] = resample.between(f"rudder_{thruster.name}", parts)
    return Between(demands, angles, rudders)


def _usable(log: Log) -> None:
    """Refuses what a diagnosis cannot follow."""
    for name in ("u", "v", "r"):
        log.column(name, "by every equation of motion")
    if log.t[-1] - log.t[0] < SHORTEST:
        raise IvsidError(
            f"{log.name} lasts {log.t[-1] - log.t[0]:.3g} s; a diagnosis needs at least {SHORTEST:.0f} s, so give a longer log"
        )


def _interval(log: Log, name: str) -> float:
    """The usual time between two samples of a channel [s]; 0 where there is none."""
    there = np.isfinite(log.columns[name]) if name in log.columns else np.zeros(0, dtype=bool)
    return float(np.median(np.diff(log.t[there]))) if there.sum() > 2 else 0.0


class _Resampler:
    """Columns on the clock, and where all of them have samples."""

    def __init__(self, log: Log, clock: Array, h: float) -> None:
        self.log, self.clock, self.h = log, clock, h
        self.good = np.ones(clock.size, dtype=bool)

    def __call__(self, name: str, *, sent: bool = False, held: bool = False, unwrap: bool = False) -> Array:
        """A column on the clock: what is ``sent`` goes on where it is missing, what is measured is not good there."""
        values = self.log.columns[name]
        there = np.isfinite(values)
        t, x = self.log.t[there], values[there]
        if unwrap:
            x = np.unwrap(x)
        at = np.clip(np.searchsorted(t, self.clock + SAME * self.h, side="right") - 1, 0, t.size - 1)
        if held:
            found: Array = x[at]
            return found
        if sent:
            return np.interp(self.clock, t, x)
        nearest = np.minimum(np.abs(self.clock - t[at]), np.abs(t[np.minimum(at + 1, t.size - 1)] - self.clock))
        self.good &= nearest <= OFF_CLOCK * self.h
        return np.interp(self.clock, t, x)

    def between(self, name: str, parts: int) -> Array:
        """What is held at equal parts of the steps of a clock that is slower than the log, shape (n, parts)."""
        there = np.isfinite(self.log.columns[name])
        t, x = self.log.t[there], self.log.columns[name][there]
        clock = self.clock[:, None] + np.arange(parts) * (self.h / parts)
        at = np.searchsorted(t, clock + SAME * self.h / parts, side="right") - 1
        return np.asarray(x[np.clip(at, 0, t.size - 1)])

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
        variance = {1: 2.0, 3: 20.0}[order]
        scatter = float(np.median(np.abs(np.diff(x, order))) / 0.6745 / np.sqrt(variance))
        guess = said.get(name)
        if guess:
            scatter = float(np.clip(scatter, guess / 10, guess * 10))
        found[name] = max(scatter, 1e-6 * float(np.std(x)), 1e-9)
    return found
