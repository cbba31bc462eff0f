"""Logs and vehicle files that make no rows: ``identify`` refuses them, so that no result can rest on them."""

from __future__ import annotations

from fractions import Fraction

from ivsid.log import Log
from ivsid.vehicle import Vehicle
from ivsid.verification.decimals import Decimals
from ivsid.verification.errors import UnprovedError
from ivsid.verification.lever_arms import mounted


def refuse(log: Log, vehicle: Vehicle, exact: Decimals) -> None:
    """Refuses readings that mean another quantity than a row would take them for.

    Raises:
        UnprovedError: the first such reading.
    """
    sensors, columns = vehicle.sensors, set(log.columns)
    most, heading = log.certain.get("psi"), sensors.heading
    if most is not None and heading is not None and exact(heading.accuracy).upper >= Fraction(most):
        raise UnprovedError("the way round from one sample of psi to the next is not certain")
    gyro = sensors.yaw_rate
    if gyro is not None and gyro.sampling == "averaged" and "r" in {*log.clocks, *log.by_rate}:
        raise UnprovedError("what a gyro on another clock than the rows averages is not known")
    feels = sensors.acceleration
    if feels is None:
        return
    elsewhere, at_origin = mounted(feels) or bool(feels.gravity), {"udot", "vdot"} & columns
    if at_origin and (feels.sampling == "averaged" or elsewhere):
        raise UnprovedError("an accelerometer that averages, is mounted or feels gravity reads no udot or vdot")
    if elsewhere and feels.sampling == "averaged" and {"ax", "ay"} & columns:
        raise UnprovedError(
            "averages of an accelerometer that is mounted or feels gravity cannot be brought to the origin"
        )
    if elsewhere and len({"ax", "ay"} & columns) == 1:
        raise UnprovedError("an accelerometer that is mounted or feels gravity needs both of its axes")
