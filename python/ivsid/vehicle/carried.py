"""Numbers of ``[model.fitted]`` that stand for keys of the vehicle file, and the ranges of all of them.

A lag, a dead band, a limit or an advance loss of thrusters, and the place and the turn of a sensor, are keys of the file. Where
``[model.fitted]`` gives them, the file means the same as with the keys.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from ivsid.vehicle.mount import Mounted
from ivsid.vehicle.sensors import Sensors
from ivsid.vehicle.thrusters import Thruster
from ivsid.vehicle.vehicle import Fitted, Vehicle

# Causes in thrusters that a key of the thruster states, with the least value that it takes.
_KEYS: Final = {
    "thruster.lag": "time_constant",
    "thruster.deadband": "dead_band",
    "thruster.saturation": "limit",
    "thruster.advance_loss": "advance_loss",
}
_SHAFT: Final = "thruster.shaft_lag"
_ARMS: Final = {"velocity": "sensor.velocity.lever_arm", "acceleration": "sensor.acceleration.lever_arm"}
_TURN: Final = "sensor.velocity.misalignment"

Ends = tuple[float, float]


def ends_of(number: Fitted) -> Ends:
    """The range of a fitted number with a value: its interval, or the value alone where an end is missing."""
    value = 0.0 if number.value is None else number.value
    if number.lower is None or number.upper is None:
        return value, value
    return min(number.lower, value), max(number.upper, value)


def of_thruster(vehicle: Vehicle, id_: str, thruster: str) -> Fitted | None:
    """A cause with one number for a thruster; the number that names the thruster replaces that of all."""
    numbers = vehicle.model.fitted
    found = numbers.get(f"{id_}.{thruster}", numbers.get(id_))
    return None if found is None or found.value is None else found


def names_of(vehicle: Vehicle, id_: str) -> list[str]:
    """The names under which ``[model.fitted]`` has the numbers of a cause."""
    return [n for n in vehicle.model.numbers if n == id_ or n.startswith(f"{id_}.")]


def with_keys(vehicle: Vehicle) -> tuple[Vehicle, tuple[str, ...]]:
    """The vehicle with the keys that its fitted numbers stand for, and the names of these numbers."""
    if not vehicle.model.numbers:
        return vehicle, ()
    thrusters = list(vehicle.thrusters)
    carried: list[str] = []
    limits = vehicle.sensors.limits
    bounded = limits.acceleration is not None and limits.yaw_acceleration is not None
    for id_, key in _KEYS.items():
        if key == "advance_loss" and not bounded:
            continue
        made = [_keyed(t, key, of_thruster(vehicle, id_, t.name)) for t in thrusters]
        if names_of(vehicle, id_) and None not in made:
            thrusters = [t for t in made if t is not None]
            carried += names_of(vehicle, id_)
    made = [_on_shaft(t, of_thruster(vehicle, _SHAFT, t.name)) for t in thrusters]
    if names_of(vehicle, _SHAFT) and None not in made:
        thrusters = [t for t in made if t is not None]
        carried += names_of(vehicle, _SHAFT)
    sensors, mounts = _mounted(vehicle.sensors, vehicle.model.fitted)
    changed = {"thrusters": tuple(thrusters), "sensors": sensors}
    return vehicle.model_copy(update=changed), (*carried, *mounts)


def _keyed(thruster: Thruster, key: str, number: Fitted | None) -> Thruster | None:
    """The thruster with a key, or None where the key does not take the number."""
    if number is None:
        return thruster
    value = number.value or 0.0
    if value < 0 or (key == "limit" and value == 0) or (key == "time_constant" and not _has_ends(thruster)):
        return None
    return thruster.model_copy(update={key: value})


def _on_shaft(thruster: Thruster, number: Fitted | None) -> Thruster | None:
    """The thruster with a lag of its shaft, or None where it has another lag."""
    if number is None:
        return thruster
    if thruster.time_constant or (number.value or 0.0) < 0 or not _has_ends(thruster):
        return None
    return thruster.model_copy(update={"time_constant": number.value, "lag": "demand"})


def _has_ends(thruster: Thruster) -> bool:
    """Whether the curve ends, so that a lag has a range of starts."""
    return thruster.table is not None or thruster.demand_range is not None


def _mounted(sensors: Sensors, numbers: Mapping[str, Fitted]) -> tuple[Sensors, list[str]]:
    """The sensors at the places that the fitted numbers give, where the file says nothing of them."""
    carried: list[str] = []
    for name, id_ in _ARMS.items():
        sensor: Mounted | None = getattr(sensors, name)
        pair = [numbers.get(f"{id_}.{axis}") for axis in ("x", "y")]
        # An arm of the accelerometer needs the yaw acceleration.
        limits = sensors.limits
        turning = limits.yaw_acceleration or limits.yaw_jerk or sensors.yaw_acceleration
        if name == "acceleration" and turning is None:
            continue
        if sensor is None or sensor.off_origin or any(p is None or p.value is None for p in pair):
            continue
        values = [(p.value or 0.0, ends_of(p)) for p in pair if p is not None]
        place = {
            "position": tuple(v for v, _ in values),
            "position_accuracy": max(_reach(v, e) for v, e in values),
        }
        sensors = sensors.model_copy(update={name: sensor.model_copy(update=place)})
        carried += [f"{id_}.x", f"{id_}.y"]
    turn, velocity = numbers.get(_TURN), sensors.velocity
    if turn is not None and turn.value is not None and velocity is not None and not velocity.turned:
        turned = {"rotation": turn.value, "rotation_accuracy": _reach(turn.value, ends_of(turn))}
        sensors = sensors.model_copy(update={"velocity": velocity.model_copy(update=turned)})
        carried.append(_TURN)
    return sensors, carried


def _reach(value: float, ends: Ends) -> float:
    """The largest distance of an end from the value, rounded up to two digits, so that its decimal is exact and short."""
    most = max(value - ends[0], ends[1] - value)
    if most <= 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(most)) - 1)
    return float(f"{(math.floor(most / unit) + 1) * unit:.1e}")
