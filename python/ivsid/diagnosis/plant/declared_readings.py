"""Errors of readings that a vehicle file declares: slow biases, the velocity's scale, and where a sensor stands and whither it points.

Each is linear in its size. A bias is slow: an ``accuracy`` bounds the whole error of a reading, and not its noise alone. A compass errs by the heading
as well: iron on board, or magnetometers that differ. A velocity in earth axes is wrong in them, and an error of the heading turns it.

Source: docs/theory.md, "Declared errors of readings"; Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2011, chapter 7
(readings off the origin); Archibald Smith's exact deviation coefficients B to E (semicircular and quadrantal deviation).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.thrust_errors import BOUNDED
from ivsid.sensors.lever_arms import gravity_of
from ivsid.vehicle import Vehicle
from ivsid.vehicle.mount import Mounted

Array = NDArray[np.float64]
# Standard deviation of an error with a bound of its own, in units of its bound.
# Source: theorem: 3.29 of them, half an interval of 99.9 %, hold the bound; a scale at its bound costs 9 in chi-squared, of the 25 that count
SCALE: Final = 1 / 3
# Shapes in time of a slow error: a constant, and cosines of half a period to three periods over the log.
# Source: measured: of 26 sound logs whose velocities wandered in up to three periods, three had an oscillating current beside five shapes, and none beside seven;
# two sound logs whose gyro wandered so, beside three shapes, had a heading that was 3.8 and 4.9 times as wrong as declared, and none beside seven
WANDERING: Final = 7
# Least accuracy of the place of a sensor, in lengths of the hull, and of its rotation [rad], whatever the vehicle file states.
# Source: geometry: a tape along a hull, and a millimetre on a metre of a bracket
LEAST_ARM: Final = 1e-3
LEAST_TURN: Final = 1e-3
BIAS: Final = "~bias."
# Compass: parts of its deviation that go with the sine and the cosine of the heading, and of twice the heading.
DEVIATION: Final = "~deviation.psi"
PARTS: Final[Mapping[str, Callable[[Array], Array]]] = {
    f"{DEVIATION}.B": np.sin,
    f"{DEVIATION}.C": np.cos,
    f"{DEVIATION}.D": lambda psi: np.sin(2.0 * psi),
    f"{DEVIATION}.E": lambda psi: np.cos(2.0 * psi),
}
# First words of the names of errors with a bound of their own.
ARM: Final = "~arm."
FIXED: Final = ("~scale.", ARM, "~turn.")
# What a unit of each adds to the readings.
_FIXED: Final[Mapping[str, Callable[[Mapping[str, Array]], dict[str, Array]]]] = {
    "~scale.velocity": lambda c: {"u": c["u"], "v": c["v"]},
    "~arm.velocity.x": lambda c: {"v": c["r"]},
    "~arm.velocity.y": lambda c: {"u": -c["r"]},
    "~turn.velocity": lambda c: {"u": c["v"], "v": -c["u"]},
    "~arm.acceleration.x": lambda c: {"ax": -(c["r"] ** 2), "ay": c["rdot"]},
    "~arm.acceleration.y": lambda c: {"ax": -c["rdot"], "ay": -(c["r"] ** 2)},
    "~turn.acceleration": lambda c: {"ax": c["ay"], "ay": -c["ax"]},
}


def slow_shapes(n: int) -> list[Array]:
    """Shapes in time of a slow error over a log of n samples, shape (n,) each."""
    t = (np.arange(n) + 0.5) / n
    return [np.cos(np.pi * j * t) for j in range(WANDERING)]


def deviation_shapes(psi: Array) -> list[Array]:
    """Shapes of a compass's deviation over headings [rad], shape (n,) each."""
    return [shape(psi) for shape in PARTS.values()]


class _Slow(NamedTuple):
    """A slow error of a reading.

    Attributes:
        constant: standard deviation of its constant part.
        wave: the same of each of its cosines.
        bound: of the whole error; none where its standard deviation alone is declared.
    """

    constant: float
    wave: float
    bound: float | None


def _of(accuracy: float, instability: float = 0.0) -> _Slow:
    """The error of an accuracy and of an instability beside it, whose waves together vary as its constant does."""
    waves = instability * float(np.sqrt(2.0 / (WANDERING - 1)))
    bound = accuracy + instability / SCALE if accuracy else None
    return _Slow(instability + BOUNDED * accuracy, waves + BOUNDED * accuracy, bound)


def _slow(vehicle: Vehicle, *, earth: bool) -> dict[str, _Slow]:
    """Slow errors of readings by channel, of the velocity in the axes in which it is read."""
    sensors = vehicle.sensors
    acceleration, gyro = sensors.acceleration, sensors.yaw_rate
    found: dict[str, _Slow] = {}
    if acceleration is not None:
        # A wrong attitude leaves a part of gravity in the readings.
        tilt = 0.0 if sensors.attitude is None else gravity_of(sensors) * sensors.attitude.accuracy
        found |= {q: _of(acceleration.accuracy + tilt, acceleration.axis(k)[0]) for k, q in enumerate(("ax", "ay"))}
    if gyro is not None:
        found["r"] = _of(gyro.accuracy, gyro.axis(0)[0])
    of = {"north east" if earth else "u v": sensors.velocity, "psi": sensors.heading, "x y": sensors.position}
    of["rdot"] = sensors.yaw_acceleration
    return found | {q: _of(s.accuracy) for channels, s in of.items() if s is not None for q in channels.split()}


def _mounts(vehicle: Vehicle) -> dict[str, Mounted]:
    """Sensors that may stand elsewhere, by name."""
    of = {"velocity": vehicle.sensors.velocity, "acceleration": vehicle.sensors.acceleration}
    return {name: mount for name, mount in of.items() if mount is not None}


def _bounds(vehicle: Vehicle) -> dict[str, float]:
    """Bound of each error of ``FIXED``, by name."""
    velocity = vehicle.sensors.velocity
    found = {} if velocity is None else {"~scale.velocity": velocity.scale_factor_error}
    for name, mount in _mounts(vehicle).items():
        arm = max(mount.position_accuracy, LEAST_ARM * (vehicle.hull.length or 0.0))
        found |= {f"~arm.{name}.x": arm, f"~arm.{name}.y": arm}
        found[f"~turn.{name}"] = max(mount.rotation_accuracy, LEAST_TURN)
    return found


def deviations(vehicle: Vehicle, *, earth: bool = False) -> Iterator[tuple[str, float]]:
    """Name and standard deviation of each declared error of a reading that is not nothing; ``earth`` says that velocities are read in earth axes."""
    slow = _slow(vehicle, earth=earth).items()
    found = {f"{BIAS}{q}.{j}": e.wave if j else e.constant for q, e in slow for j in range(WANDERING)}
    found |= {name: SCALE * bound for name, bound in _bounds(vehicle).items()}
    if (heading := vehicle.sensors.heading) is not None:
        found |= dict.fromkeys(PARTS, BOUNDED * heading.accuracy)
    return ((name, size) for name, size in found.items() if size)


def assumed(vehicle: Vehicle, name: str) -> bool:
    """Whether an error of a mounting is there by its least accuracy alone."""
    kind, sensor, *_ = name.removeprefix("~").split(".")
    mount = _mounts(vehicle).get(sensor)
    if mount is None or kind not in ("arm", "turn"):
        return False
    return not (mount.position_accuracy if kind == "arm" else mount.rotation_accuracy)


def bounded(vehicle: Vehicle, *, earth: bool = False) -> Iterator[tuple[str, tuple[str, ...], Array]]:
    """Errors of readings inside a bound: name of the whole, names of its parts, and their sizes by values of one bound, shape (parts, values).

    The values of a slow error are those at as many moments as it has shapes, at which the shapes are orthogonal (discrete cosine transform); those of a
    deviation, which a constant completes, are those on five headings round the compass (discrete Fourier transform).
    """
    for name, parts, sizes in _inside(vehicle, earth=earth):
        # Positions count from the first one, whose error is as large.
        yield name, parts, 2.0 * sizes if name in (f"{BIAS}x", f"{BIAS}y") else sizes


def _inside(vehicle: Vehicle, *, earth: bool) -> Iterator[tuple[str, tuple[str, ...], Array]]:
    """The same for the readings as they are."""
    at = (np.arange(WANDERING) + 0.5) / WANDERING
    shapes = np.linalg.inv(np.cos(np.pi * np.outer(at, np.arange(WANDERING))))
    for q, error in _slow(vehicle, earth=earth).items():
        if error.bound is not None:
            yield f"{BIAS}{q}", tuple(f"{BIAS}{q}.{j}" for j in range(WANDERING)), error.bound * shapes
    if (heading := vehicle.sensors.heading) is not None and heading.accuracy:
        # Largest where no constant hides it: the four parts of any values on the five headings.
        there = deviation_shapes(2.0 * np.pi * np.arange(len(PARTS) + 1) / (len(PARTS) + 1))
        yield DEVIATION, tuple(PARTS), heading.accuracy * np.linalg.pinv(np.stack(there, axis=1))
    for name, bound in _bounds(vehicle).items():
        yield name, (name,), np.array([[bound]])


def drawn_inside(vehicle: Vehicle, rng: np.random.Generator, *, earth: bool = False) -> dict[str, float]:
    """Sizes of all errors of readings inside a bound, anywhere in it, by name of the part.

    Args:
        vehicle: whose sensors they are.
        rng: draws them.
        earth: whether velocities are read in earth axes.
    """
    found: dict[str, float] = {}
    for _, parts, sizes in _inside(vehicle, earth=earth):
        found |= dict(zip(parts, (sizes @ rng.uniform(-1.0, 1.0, sizes.shape[1])).tolist(), strict=True))
    return found


def unit(name: str, c: Mapping[str, Array], slow: Sequence[Array], *, earth: bool = False) -> dict[str, Array]:
    """What a unit of a declared error adds to the readings, shape (n,) each, by channel.

    Args:
        name: of the error.
        c: u, v [m/s], r [rad/s], ax, ay [m/s^2], rdot [rad/s^2] and psi [rad] at samples, shape (n,) each.
        slow: shapes in time of a slow bias, shape (n,) each.
        earth: whether velocities are read in earth axes, and turned by the heading that is read.
    """
    if name.startswith(BIAS):
        channel, wave = name.removeprefix(BIAS).split(".")
        error = slow[int(wave)]
    elif name in PARTS:
        channel, error = "psi", PARTS[name](c["psi"])
    else:
        return _FIXED[name](c)
    if channel == "north":
        return {"u": np.cos(c["psi"]) * error, "v": -np.sin(c["psi"]) * error}
    if channel == "east":
        return {"u": np.sin(c["psi"]) * error, "v": np.cos(c["psi"]) * error}
    if earth and channel == "psi":
        return {"psi": error, "u": c["v"] * error, "v": -c["u"] * error}
    return {channel: error}


def declared(
    errors: Mapping[str, float], c: Mapping[str, Array], slow: Sequence[Array], *, earth: bool = False
) -> dict[str, Array]:
    """What declared errors add to the readings, shape (n,) each, by channel; channels without one are left out.

    Args:
        errors: sizes by name, of which those of readings count.
        c: as of ``unit``.
        slow: as of ``unit``.
        earth: as of ``unit``.
    """
    out: dict[str, Array] = {}
    for name, size in errors.items():
        if size and name.startswith((BIAS, DEVIATION, *FIXED)):
            for q, x in unit(name, c, slow, earth=earth).items():
                out[q] = out.get(q, 0.0) + size * x
    return out
