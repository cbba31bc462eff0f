"""Force histories: the modelled forces as the vehicle file has them, and as each wrong set-up of the thrusters would have them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log
from ivsid.propulsion.actuation import nominal_force
from ivsid.setup.suspects import DEGREE, in_unit, renamed, scaled
from ivsid.vehicle import Thruster, Vehicle

Array = NDArray[np.float64]
# Ids of the faults below.
HISTORIES: Final = (
    *(
        "setup.yaw_rate.sign",
        "setup.thruster.reversed",
        "setup.thruster.swapped",
        "setup.angle.sign",
        "setup.angle.unit",
        "setup.force.sign",
        "setup.frame",
    ),
)


@dataclass(frozen=True)
class History:
    """Forces under a wrong set-up.

    Attributes:
        id: of the fault.
        says: the fault in words.
        remedy: the key of the vehicle file to change.
        forces: X, Y [N], N [N m] as means over the step after each row, shape (n, 3).
        channels: of the motion whose sign the fault is, none for a fault of a thruster.
        reverses: whether one thruster alone is reversed, so that its failure would be the middle of this and the stated forces.
    """

    id: str
    says: str
    remedy: str
    forces: Array
    channels: frozenset[str] = frozenset()
    reverses: bool = False


def stated(vehicle: Vehicle, log: Log) -> Array:
    """Forces as the vehicle file has them.

    Raises:
        IvsidError: a missing column, or a demand outside its curve.
    """
    return nominal_force(_holding(vehicle), log)


def histories(vehicle: Vehicle, log: Log) -> Iterator[History]:
    """Forces under each wrong set-up that the vehicle can have: reversed and swapped thrusters, angles and logged forces of the wrong sign."""
    plain = stated(vehicle, log)
    remedy = f"state {scaled(vehicle, 'r', -1.0)} under [log.columns]"
    yield History("setup.yaw_rate.sign", "yaw rate r has the wrong sign", remedy, plain * [1, 1, -1], frozenset({"r"}))
    if not vehicle.thrusters:
        for k, name in enumerate(("force_X", "force_Y", "moment_N")):
            remedy = f"state {scaled(vehicle, name, -1.0)} under [log.columns]"
            yield History(
                "setup.force.sign", f"{name} has the wrong sign", remedy, plain * np.where(np.arange(3) == k, -1, 1)
            )
        return
    for thruster in vehicle.thrusters:
        alone = nominal_force(_only(vehicle, thruster.model_copy(update={"rudder": None})), log)
        remedy = f"mirror the curve of thruster {thruster.name} under [[thrusters]]"
        if thruster.steering == "fixed":
            remedy += f", or state azimuth = {math.remainder(thruster.azimuth + math.pi, 2 * math.pi):.6g} for it"
        says = f"thruster {thruster.name} pushes the wrong way"
        yield History("setup.thruster.reversed", says, remedy, plain - 2 * alone, reverses=len(vehicle.thrusters) > 1)
        for prefix, turns in (("rudder_", thruster.rudder is not None), ("azimuth_", thruster.steering == "azimuth")):
            name = prefix + thruster.name
            if turns and name in log.columns:
                columns = {**log.columns, name: -log.columns[name]}
                remedy = f"state {scaled(vehicle, name, -1.0)} under [log.columns]"
                forces = stated(vehicle, replace(log, columns=columns))
                yield History("setup.angle.sign", f"{name} has the wrong sign", remedy, forces)
                if prefix == "rudder_":
                    continue
                # A lift goes with the angle in any measure. A direction does not, and only the right one pushes where the vessel goes.
                columns = {**log.columns, name: log.columns[name] * DEGREE}
                remedy = f"state {in_unit(vehicle, name, 'deg', DEGREE)} under [log.columns]"
                forces = stated(vehicle, replace(log, columns=columns))
                yield History("setup.angle.unit", f"{name} is in degrees and taken for radians", remedy, forces)
    if len(vehicle.thrusters) > 1:
        yield History(
            "setup.thruster.reversed",
            "all thrusters push the wrong way",
            "mirror the curves under [[thrusters]]",
            -plain,
        )
    for a, b in combinations([t.name for t in vehicle.thrusters], 2):
        swap = {f"demand_{a}": log.columns[f"demand_{b}"], f"demand_{b}": log.columns[f"demand_{a}"]}
        forces = stated(vehicle, replace(log, columns={**log.columns, **swap}))
        names = (f"demand_{a}", f"demand_{b}")
        remedy = f"state {renamed(vehicle, *names)}, {renamed(vehicle, *names[::-1])} under [log.columns], or exchange their positions"
        yield History("setup.thruster.swapped", f"thrusters {a} and {b} are swapped", remedy, forces)
    yield History(
        "setup.frame", "v, r and psi are in other axes", 'state frame = "flu" under [log]', plain * [1, -1, -1]
    )


def _holding(vehicle: Vehicle) -> Vehicle:
    """The vehicle with demands beyond a curve kept at its end: their range is examined elsewhere."""
    return vehicle.model_copy(
        update={"thrusters": tuple(t.model_copy(update={"outside": "hold"}) for t in vehicle.thrusters)}
    )


def _only(vehicle: Vehicle, thruster: Thruster) -> Vehicle:
    return _holding(vehicle.model_copy(update={"thrusters": (thruster,)}))
