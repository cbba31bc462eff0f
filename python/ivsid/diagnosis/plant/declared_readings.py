"""Errors of readings that a vehicle file declares: slow biases, the velocity's scale, and where a sensor stands and whither it points.

Each is linear in its size. A bias is slow: an ``accuracy`` bounds the whole error of a reading, and not its noise alone.

Source: docs/theory.md, "Declared errors of readings"; Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2011, chapter 7
(readings off the origin).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.thrust_errors import BOUNDED
from ivsid.vehicle import Vehicle
from ivsid.vehicle.mount import Mounted

Array = NDArray[np.float64]
# Standard deviation of an error with a bound of its own, in units of its bound.
# Source: theorem: 3.29 of them, half an interval of 99.9 %, hold the bound; a scale at its bound costs 9 in chi-squared, of the 25 that count
SCALE: Final = 1 / 3
# Shapes in time of a bias whose instability is declared: a constant, and cosines of half a period and of one over the log.
# Source: measured: make constants
SLOW_WAVES: Final = 3
# The same of an error whose bound alone is declared: up to three periods.
# Source: measured: of 26 sound logs whose velocities wandered in up to three periods, three had an oscillating current beside five shapes, and none beside seven
WANDERING: Final = 7
# Least accuracy of the place of a sensor, in lengths of the hull, and of its rotation [rad], whatever the vehicle file states.
# Source: geometry: a tape along a hull, and a millimetre on a metre of a bracket
LEAST_ARM: Final = 1e-3
LEAST_TURN: Final = 1e-3
BIAS: Final = "~bias."
# Channels whose sensors have an accuracy, which bounds the whole error.
_ACCURATE: Final = ("u", "v", "psi", "x", "y")
# First words of the names of errors with a bound of their own.
FIXED: Final = ("~scale.", "~arm.", "~turn.")
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
    return [np.cos(np.pi * j * t) for j in range(max(SLOW_WAVES, WANDERING))]


def deviations(vehicle: Vehicle) -> Iterator[tuple[str, float]]:
    """Name and standard deviation of each declared error of a reading that is not nothing."""
    sensors = vehicle.sensors
    velocity, acceleration, gyro = sensors.velocity, sensors.acceleration, sensors.yaw_rate
    slow: dict[str, float] = {}
    bounds: dict[str, float] = {}
    if velocity is not None:
        bounds |= dict.fromkeys(("u", "v"), velocity.accuracy)
    if acceleration is not None:
        slow |= {q: acceleration.axis(k)[0] + BOUNDED * acceleration.accuracy for k, q in enumerate(("ax", "ay"))}
    if gyro is not None:
        slow["r"] = gyro.axis(0)[0] + BOUNDED * gyro.accuracy
    if sensors.heading is not None:
        bounds["psi"] = sensors.heading.accuracy
    if sensors.position is not None:
        bounds |= dict.fromkeys(("x", "y"), sensors.position.accuracy)
    found = {f"{BIAS}{q}.{j}": size for q, size in slow.items() for j in range(SLOW_WAVES)}
    found |= {f"{BIAS}{q}.{j}": BOUNDED * size for q, size in bounds.items() for j in range(WANDERING)}
    if velocity is not None:
        found["~scale.velocity"] = SCALE * velocity.scale_factor_error
    for name, mount in (("velocity", velocity), ("acceleration", acceleration)):
        found |= _mounting(name, mount, vehicle.hull.length)
    return ((name, size) for name, size in found.items() if size)


def assumed(vehicle: Vehicle, name: str) -> bool:
    """Whether an error of a mounting is there by its least accuracy alone."""
    if not name.startswith(("~arm.", "~turn.")):
        return False
    sensor = name.split(".")[1]
    mount = vehicle.sensors.velocity if sensor == "velocity" else vehicle.sensors.acceleration
    return mount is None or not (mount.position_accuracy if name.startswith("~arm.") else mount.rotation_accuracy)


def bounded(vehicle: Vehicle) -> Iterator[tuple[str, tuple[str, ...], Array]]:
    """Errors of readings inside a bound: name of the whole, names of its parts, and their sizes by values of one bound, shape (parts, values).

    The values of a slow error are those at as many moments as it has shapes, at which the shapes are orthogonal (discrete cosine transform).
    """
    at = (np.arange(WANDERING) + 0.5) / WANDERING
    shapes = np.linalg.inv(np.cos(np.pi * np.outer(at, np.arange(WANDERING))))
    for name, size in deviations(vehicle):
        whole, _, wave = name.rpartition(".")
        if name.startswith(FIXED):
            yield name, (name,), np.array([[size / SCALE]])
        elif wave == "0" and whole.removeprefix(BIAS) in _ACCURATE:
            # Positions count from the first one, whose error is as large.
            bound = size / BOUNDED * (2.0 if whole[-1] in "xy" else 1.0)
            yield whole, tuple(f"{whole}.{j}" for j in range(WANDERING)), bound * shapes


def _mounting(name: str, mount: Mounted | None, length: float | None) -> dict[str, float]:
    if mount is None:
        return {}
    arm = max(mount.position_accuracy, LEAST_ARM * (length or 0.0))
    arms = dict.fromkeys((f"~arm.{name}.x", f"~arm.{name}.y"), SCALE * arm)
    return {**arms, f"~turn.{name}": SCALE * max(mount.rotation_accuracy, LEAST_TURN)}


def unit(name: str, c: Mapping[str, Array], slow: Sequence[Array]) -> dict[str, Array]:
    """What a unit of a declared error adds to the readings, shape (n,) each, by channel.

    Args:
        name: of the error.
        c: u, v [m/s], r [rad/s], ax, ay [m/s^2] and rdot [rad/s^2] at samples, shape (n,) each.
        slow: shapes in time of a slow bias, shape (n,) each.
    """
    if name.startswith(BIAS):
        channel, wave = name.removeprefix(BIAS).split(".")
        return {channel: slow[int(wave)]}
    return _FIXED[name](c)


def declared(errors: Mapping[str, float], c: Mapping[str, Array], slow: Sequence[Array]) -> dict[str, Array]:
    """What declared errors add to the readings, shape (n,) each, by channel; channels without one are left out.

    Args:
        errors: sizes by name, of which those of readings count.
        c: as of ``unit``.
        slow: as of ``unit``.
    """
    out: dict[str, Array] = {}
    for name, size in errors.items():
        if size and name.startswith((BIAS, *FIXED)):
            for q, x in unit(name, c, slow).items():
                out[q] = out.get(q, 0.0) + size * x
    return out
