"""A log on a uniform clock, with the noise of its sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.between import Between, Straddled
from ivsid.diagnosis.data.clock import RARE, check_usable, first_reading, paced
from ivsid.diagnosis.data.from_pose import differenced
from ivsid.diagnosis.data.lost_rows import LostDemands, LostRows
from ivsid.diagnosis.data.resampling import ACCELERATIONS, VELOCITIES, Resampler, read_in
from ivsid.diagnosis.data.sensor_noise import scale_step, sensor_noise
from ivsid.diagnosis.data.whole_rows import whole_rows
from ivsid.log import Log
from ivsid.sensors.lever_arms import at_origin
from ivsid.sensors.pose import with_velocities
from ivsid.vehicle import KnownForce, Thruster, Vehicle, with_known_forces

Array = NDArray[np.float64]
# Most equal parts of a step in which demands are looked up.
# Source: resource: memory of thrusts, of shape (thrusters, n, parts)
MOST_PARTS: Final = 50
# Step above which thrusts are followed part by part, as a lag that the vehicle file does not know would ask for [s].
# Source: geometry: a lag bends the heading by the square of the step, on 0.1 s by a quarter of what it does on 0.2 s
LONG: Final = 0.101
# The same where the vehicle file has a lag [s].
# Source: geometry: a lag bends the heading by the square of the step, on 0.05 s by a sixteenth of what it does on 0.2 s
LONG_BESIDE_LAG: Final = 0.03
# Length of the parts [s].
# Source: measured: a sound ROV of 12 kg at 10 Hz with a lag of 0.06 s had a lag of 2,147 in chi-squared by whole steps, 63 by halves and 4 by quarters
PART: Final = 0.025
# The same where rows come at irregular times, and begin at the nearest part.
# Source: measured: a sound twin of 30 t at 5 Hz whose rows stray by a tenth had structure of 37 in its change of thrust in parts of 25 ms, and of 22 and 19 in
# those of 12 and 6 ms
PART_ASTRAY: Final = 0.0125
# Time constant of a thruster, in steps, from which on its thrust changes evenly over one.
# Source: geometry: a fifth of a change is made in a step, and bends by a tenth of that
EVEN: Final = 5.0
# Rounding of a number of steps that is rounded to a whole one.
# Source: geometry: far above the rounding of a quotient of times, far below a step
WHOLE: Final = 1e-6
# Noise of a yaw rate that differences of the heading give, over its scatter: it corrects no filter.
# Source: definition: such a reading changes a filtered rate by less than a millionth
UNREAD: Final = 1e3
# Times above this are seconds since 1970 and are counted from the log's first sample [s].
# Source: definition: 1e8 s is more than three years
EPOCH: Final = 1e8


@dataclass(frozen=True)
class Channels:
    """A log on the clock t = 0, h, 2 h, ... [s].

    Attributes:
        name: of the log.
        h: step [s].
        t: clock of the effects [s], from the log's first row, shape (n,).
        nu: u, v [m/s], r [rad/s], shape (3, n).
        acceleration: ax, ay, or udot and vdot [m/s^2], and rdot [rad/s^2], None where not measured.
        averaged: whether accelerations are means over the step before their row.
        psi: heading [rad], unwrapped, or None.
        place: north and east [m], shape (2, n), or None.
        demands: shape (thrusters, n).
        angles: of azimuth thrusters [rad], shape (thrusters, n).
        rudders: angles of the rudders behind thrusters [rad], shape (thrusters, n).
        held: whether demands and angles hold from a sample to the next (zero-order hold); else they change on straight lines.
        between: demands and angles inside the steps, if the clock is slower than the log, or None.
        wind: the air's velocity north and east [m/s], shape (2, n), or None.
        voltage: as a share of its first value, or None.
        depth: [m], or None.
        good: samples at which every channel was measured, shape (n,).
        steps: of the coarse scales that readings are rounded to, by channel, in its unit.
        noise: standard deviation of each sensor's white noise by channel: nu (3), acceleration (3), psi, place.
        notes: sentences on the samples and channels that are not used.
        running: whether angles run from a sample to the next where demands hold.
        turned: whether the heading alone tells the yaw rate, which is no reading then.
        earth: whether u and v follow from velocities in earth axes.
        rates: of both accelerations, whether they are udot and vdot.
        lost: losses of rows, over which demands may have jumped, or None.
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
    wind: Array | None
    voltage: Array | None
    depth: Array | None
    good: NDArray[np.bool_]
    noise: dict[str, float]
    steps: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    running: bool = False
    turned: bool = False
    earth: bool = False
    rates: tuple[bool, bool] = (False, False)
    lost: LostDemands | None = None

    @property
    def n(self) -> int:
        """Number of samples."""
        return int(self.t.size)

    @property
    def rate_noise(self) -> float:
        """Standard deviation of the yaw rate's white noise [rad/s], beyond all that counts where the heading alone tells it."""
        return self.noise["r"] * (UNREAD if self.turned else 1.0)

    def has(self, need: str) -> bool:
        """Whether the log has a channel that an effect of the catalogue needs, ``a`` or ``a|b``."""
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


def _long(t: Thruster) -> float:
    """Step above which the thrust of a thruster is followed part by part [s]."""
    return LONG_BESIDE_LAG if t.time_constant else LONG


def channels(log: Log, vehicle: Vehicle, origin: float | None = None) -> Channels:
    """A log on a uniform clock: steps 1 to 4 of the chapter.

    Args:
        log: as read.
        vehicle: whose thrusters and sensors the log belongs to.
        origin: time at which the clocks of effects start [s]; the log's first row by default.

    Raises:
        IvsidError: the log lacks velocities or demands, is shorter than a minute, or turns faster than its clock can follow.
    """
    vehicle = with_known_forces(vehicle)
    known = len(log.notes)
    # Velocities of a pose get rows of their own.
    lost = LostRows(log)
    log, _ = with_velocities(differenced(log), vehicle.sensors)
    check_usable(log)
    steps = {name: step for name, x in log.columns.items() if (step := scale_step(x))}
    log = at_origin(log, vehicle.sensors)
    held = vehicle.log.demand == "hold"
    # Only a force that keeps its direction is linear in its thrust, so that the mean of one gives that of the other.
    fixed = all(t.steering == "fixed" and t.rudder is None for t in vehicle.thrusters)
    made = log.notes[known:]
    log, h, count, notes = paced(log, inside=held and fixed)
    averaged = _averaged(vehicle)
    log = whole_rows(log, averaged=averaged)
    # The first time has as many of its step's readings before it as after it; velocities that set the clock are read at its times.
    start = log.t[0] + 0.5 * (count - 1) * (h / count) if count > 1 else first_reading(log)
    clock = np.arange(int(np.floor((log.t[-1] - start) / h + WHOLE)) + 1) * h + start
    resample = Resampler(log, lost, clock, h, count)
    nu = np.stack([resample(n) for n in VELOCITIES])
    between = _inside_steps(vehicle, resample, fixed=fixed) if held else None
    since = None if not averaged else 0 if between is None else between.demands.shape[2]
    ax, ay = (resample.optional(n, since=since) for n in ("ax", "ay"))
    rdot = resample.optional("rdot")
    rates = tuple(a is None and name in log.columns for a, name in ((ax, "udot"), (ay, "vdot")))
    ax = resample.optional("udot", since=since) if rates[0] else ax
    ay = resample.optional("vdot", since=since) if rates[1] else ay
    psi = resample("psi", unwrap=True) if "psi" in log.columns else None
    place = np.stack([resample("x"), resample("y")]) if {"x", "y"} <= set(log.columns) else None
    demands, angles, rudders = _sent(vehicle, resample, held=held)
    wind = None
    if {"wind_speed", "wind_direction"} <= set(log.columns):
        speed, direction = resample("wind_speed"), resample("wind_direction", unwrap=True)
        wind = np.stack([-speed * np.cos(direction), -speed * np.sin(direction)])
    voltage = resample.optional("voltage")
    readings = {"u": nu[0], "v": nu[1], "r": nu[2], "ax": ax, "ay": ay, "rdot": rdot, "psi": psi}
    readings |= {"x": None, "y": None} if place is None else {"x": place[0], "y": place[1]}
    return Channels(
        log.name,
        float(h),
        clock - (log.t[0] if origin is None else origin),
        nu,
        (ax, ay, rdot),
        averaged,
        psi,
        place,
        demands,
        angles,
        rudders,
        held,
        between,
        wind,
        None if voltage is None else voltage / voltage[0],
        resample.optional("depth"),
        resample.good,
        sensor_noise(readings, vehicle.sensors, float(h), steps),
        steps,
        (*made, *notes),
        turned="r" in log.derived,
        earth=log.derived.get("u", ("",))[0] == "velocity_north",
        rates=(rates[0], rates[1]),
        lost=lost.demands(_columns(vehicle, log), clock),
    )


def _columns(vehicle: Vehicle, log: Log) -> list[list[str]]:
    """Names of the demands of each thruster."""
    each = [(t.column, *(f"{kind}_{t.name}" for kind in ("azimuth", "rudder"))) for t in vehicle.thrusters]
    return [[name for name in names if name in log.columns] for names in each]


def _sent(vehicle: Vehicle, resample: Resampler, *, held: bool) -> tuple[Array, Array, Array]:
    """Demands, angles of thrusters and of rudders, shape (thrusters, n)."""
    log = resample.log
    demands = np.zeros((len(vehicle.thrusters), resample.clock.size))
    angles, rudders = np.zeros_like(demands), np.zeros_like(demands)
    for k, thruster in enumerate(vehicle.thrusters):
        known = isinstance(thruster, KnownForce)
        log.column(
            thruster.column, "where the vehicle file has no thrusters" if known else f"for thruster {thruster.name}"
        )
        demands[k] = resample(thruster.column, sent=True, held=held)
        angles[k] = thruster.azimuth
        if thruster.steering == "azimuth":
            log.column(f"azimuth_{thruster.name}", f"for the direction of thruster {thruster.name}")
            angles[k] = resample(f"azimuth_{thruster.name}", sent=True, held=held, unwrap=not held)
        if thruster.rudder is not None:
            log.column(f"rudder_{thruster.name}", f"for the rudder of thruster {thruster.name}")
            rudders[k] = resample(f"rudder_{thruster.name}", sent=True, held=held)
    return demands, angles, rudders


def _averaged(vehicle: Vehicle) -> bool:
    """Whether accelerometers give means over the step before their row."""
    sensor = vehicle.sensors.acceleration
    return sensor is not None and sensor.sampling == "averaged"


def _inside_steps(vehicle: Vehicle, resample: Resampler, *, fixed: bool) -> Between | None:
    """Held demands and angles inside the steps, if the clock is slower than the log, rows come at irregular times or a step is long; else None.

    Args:
        vehicle: with thrusters.
        resample: of its log.
        fixed: whether no thruster turns.
    """
    h, count, period = resample.h, resample.count, resample.log.period
    # Rows inside the steps of a slower clock stand off it wherever they come from.
    slower = h > RARE * period
    astray = resample.between_rows if slower and count == 1 else resample.irregular
    bent = fixed and any(h > _long(t) and (t.time_constant or 0.0) < EVEN * h for t in vehicle.thrusters)
    if not (slower or astray or bent):
        return None
    if slower and not (astray and count > 1):
        # Times between two samples cut the steps of the log in half.
        parts = min(int(np.ceil(h / period - WHOLE)) * (2 - count % 2), MOST_PARTS)
    else:
        parts = min(int(np.ceil(h / (PART_ASTRAY if astray else PART) - WHOLE)), MOST_PARTS)
    if not astray:
        return _between(vehicle, resample, parts, _read(parts, count))
    between = _between(vehicle, resample, parts, (0,))
    # Means over the step before hold what happened between their rows.
    averaged = _averaged(vehicle)
    felt = (*(n for n in read_in(resample.log, ACCELERATIONS) if n == "rdot" or not averaged), "u")[0]
    return Straddled.of(between, resample.places, resample.rows("u", parts), resample.rows(felt, parts))


def _read(parts: int, count: int) -> tuple[int, ...]:
    """Parts of a step from a sample to each of the readings that are averaged around it."""
    return tuple(round((k - 0.5 * (count - 1)) * parts / count) for k in range(count))


def _between(vehicle: Vehicle, resample: Resampler, parts: int, read: tuple[int, ...]) -> Between:
    """Demands and angles at equal parts of the steps."""
    demands = np.stack([resample.between(t.column, parts) for t in vehicle.thrusters])
    angles, rudders = np.zeros_like(demands), np.zeros_like(demands)
    for k, thruster in enumerate(vehicle.thrusters):
        angles[k] = thruster.azimuth
        if thruster.steering == "azimuth":
            angles[k] = resample.between(f"azimuth_{thruster.name}", parts)
        if thruster.rudder is not None:
            rudders[k] = resample.between(f"rudder_{thruster.name}", parts)
    return Between(demands, angles, rudders, read)


def on_one_origin(train: Log, test: Log, vehicle: Vehicle) -> tuple[Channels, Channels]:
    """Both logs on their clocks, with times since 1970 counted from the first sample of TRAIN."""
    origin = float(train.t[0]) if max(train.t[0], test.t[0]) > EPOCH else None
    return channels(train, vehicle, origin), channels(test, vehicle, origin)
