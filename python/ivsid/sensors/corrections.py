"""Readings without the errors that ``[model.fitted]`` states: biases, scales, and a steady current, in intervals.

A reading of a channel with the bias b and the scale s is (1 + s) x + b beside its sensor's own error, by the catalogue's effects; this
module inverts that. In a steady current (c_N, c_E) the equations of motion hold for the velocities through the water,

    u - (c_N cos psi + c_E sin psi),    v - (c_E cos psi - c_N sin psi),

and for their rates. The specific forces a_x and a_y are those over ground, since the water does not accelerate.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray, of_decimals
from ivsid.log import Log
from ivsid.vehicle import Vehicle
from ivsid.vehicle.carried import Ends, ends_of

Channels: TypeAlias = Mapping[str, IntervalArray]

_ACCELERATION_BIAS: Final = {"x": ("ax", "udot"), "y": ("ay", "vdot")}
_CURRENT: Final = ("current.steady.north", "current.steady.east")


@dataclass(frozen=True)
class Corrections:
    """What the readings of a log owe to the numbers of ``[model.fitted]``.

    Attributes:
        bias: of each channel, in its unit.
        scale: of each channel.
        water: the current to north and east [m/s], or None.
        names: the numbers that are taken into account.
    """

    bias: Mapping[str, Ends]
    scale: Mapping[str, Ends]
    water: tuple[Ends, Ends] | None
    names: tuple[str, ...]


def corrections(log: Log, vehicle: Vehicle) -> Corrections:
    """The corrections of a log's readings; numbers that no reading of the log feels count as taken into account."""
    numbers, sensors = vehicle.model.fitted, vehicle.sensors
    bias: dict[str, Ends] = {}
    scale: dict[str, Ends] = {}
    names: list[str] = []
    for axis, channels in _ACCELERATION_BIAS.items():
        name = f"sensor.acceleration.bias.{axis}"
        if name in numbers and numbers[name].value is not None:
            bias |= {c: ends_of(numbers[name]) for c in channels if c in log.columns and c not in log.derived}
            names.append(name)
    name = "sensor.yaw_rate.bias"
    logged = "r" in log.columns and "r" not in log.derived
    if name in numbers and numbers[name].value is not None:
        bias |= {"r": ends_of(numbers[name])} if logged else {}
        names.append(name)
    gyro = sensors.yaw_rate
    scales: dict[str, tuple[tuple[str, ...], bool]] = {
        # The bound of an average's distance, and of a change between samples, is one of the true rate.
        "sensor.yaw_rate.scale": (("r",), gyro is None or gyro.sampling != "averaged"),
        "sensor.velocity.scale": (("u", "v"), log.derived.get("u", ("",))[0] != "velocity_north"),
    }
    for name, (axes, whole) in scales.items():
        if name not in numbers or numbers[name].value is None:
            continue
        own = [c for c in axes if c in log.columns and c not in log.derived]
        if ends_of(numbers[name])[0] <= -1 or not whole or {*own} & {*log.by_rate}:
            continue
        scale |= dict.fromkeys(own, ends_of(numbers[name]))
        names.append(name)
    water = None
    if (
        all(n in numbers and numbers[n].value is not None for n in _CURRENT)
        and "psi" in log.columns
        and sensors.heading
    ):
        water = ends_of(numbers[_CURRENT[0]]), ends_of(numbers[_CURRENT[1]])
        names += _CURRENT
    return Corrections(bias, scale, water, tuple(names))


def corrected(channels: dict[str, IntervalArray], found: Corrections) -> set[str]:
    """Takes biases and scales out of channels in their place, and names those that it changed."""
    changed = set()
    for name in sorted({*found.bias, *found.scale} & {*channels}):
        x = channels[name]
        if name in found.bias:
            x = x - of_decimals(found.bias[name])
        if name in found.scale:
            x = x / (of_decimals(found.scale[name]) + 1.0)
        channels[name] = x
        changed.add(name)
    return changed


def through_water(
    channels: dict[str, IntervalArray], present: dict[str, NDArray[np.bool_]], water: tuple[Ends, Ends]
) -> float:
    """Makes velocities and their rates those through the water, in their place; they are missing where the heading is.

    Returns:
        A bound of the speed of the current [m/s].
    """
    north, east = (of_decimals(e) for e in water)
    psi = channels["psi"]
    cosine, sine = np.cos(psi), np.sin(psi)
    ahead, across = cosine * north + sine * east, cosine * east - sine * north
    # The current turns in body axes as the vessel turns under it: its rate is (r v_c, -r u_c).
    r = channels.get("r", IntervalArray(np.full(psi.shape, -np.inf), np.full(psi.shape, np.inf)))
    for name, moved in (("u", ahead), ("v", across), ("udot", r * across), ("vdot", -(r * ahead))):
        if name in channels:
            x = channels[name] - moved
            there = present[name] & present["psi"] & np.isfinite(x.lower) & np.isfinite(x.upper)
            channels[name] = IntervalArray(np.where(there, x.lower, -np.inf), np.where(there, x.upper, np.inf))
            present[name] = there
    total = north.square() + east.square()
    return float(np.nextafter(np.sqrt(total.upper), np.inf))


def centres(
    log: Log, channels: Channels, present: Mapping[str, NDArray[np.bool_]], names: set[str]
) -> dict[str, NDArray[np.float64]]:
    """The columns of a log with the middles of some channels, NaN where a sample is missing."""
    made = {n: np.where(present[n], channels[n].midpoint, np.nan) for n in sorted(names)}
    return {**log.columns, **made}
