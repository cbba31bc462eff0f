"""Parts that the checker does not recompute: each sentence makes a verdict ``not_checked``."""

from __future__ import annotations

from ivsid.log import Log
from ivsid.vehicle import Vehicle
from ivsid.vehicle.carried import with_keys
from ivsid.verification.carried import Carried
from ivsid.verification.decimals import Decimals
from ivsid.verification.errors import UncheckedError
from ivsid.verification.physics import model


def estimated(log: Log, vehicle: Vehicle) -> bool:
    """Whether velocities are slopes of splines, which have no bounds."""
    columns = log.columns
    turns, moves = "psi" in columns, {"x", "y", "psi"} <= set(columns)
    lacks = ("r" not in columns and turns) or (not {"u", "v"} <= set(columns) and moves)
    return vehicle.sensors.from_pose == "spline" and lacks


def not_recomputed(log: Log, vehicle: Vehicle) -> str | None:
    """The reason why the checker cannot recompute the rows of a log; None if it can."""
    if estimated(log, vehicle):
        return "velocities by splines are an estimate, which the checker cannot prove"
    return None


def left_out(log: Log, vehicle: Vehicle) -> list[str]:
    """Numbers of the file's model that are no parameter of the rows and that no row takes into account: causes that the rows leave out."""
    try:
        parameters = model(vehicle, "total")
    except UncheckedError:
        return []
    vehicle, keyed = with_keys(vehicle)
    known = {*keyed, *Carried(log, vehicle, Decimals(vehicle.text)).names, *parameters}
    return [n for n in vehicle.model.numbers if n not in known]
