"""What the checker does not recompute: sentences, each of which makes a verdict ``not_checked``."""

from __future__ import annotations

from ivsid.log import Log
from ivsid.vehicle import Vehicle


def estimated(log: Log, vehicle: Vehicle) -> bool:
    """Whether velocities are slopes of splines, which no bound holds for."""
    columns = log.columns
    turns, moves = "psi" in columns, {"x", "y", "psi"} <= set(columns)
    lacks = ("r" not in columns and turns) or (not {"u", "v"} <= set(columns) and moves)
    return vehicle.sensors.from_pose == "spline" and lacks


def not_recomputed(log: Log, vehicle: Vehicle) -> dict[str, str]:
    """By kind of row, or "" for all: why the checker cannot make it."""
    sensors, found = vehicle.sensors, {}
    acceleration = sensors.acceleration
    rudders = [t.name for t in vehicle.thrusters if t.rudder is not None]
    if rudders:
        found[""] = f"the force of the rudder behind thruster {rudders[0]} is not recomputed by the checker"
    if acceleration is not None and acceleration.gravity and {"ax", "ay"} & set(log.columns):
        found["pointwise"] = "accelerations that hold gravity are not recomputed by the checker"
    if estimated(log, vehicle):
        found[""] = "velocities by splines are an estimate, which the checker cannot prove"
    return found
