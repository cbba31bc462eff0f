"""Known forces of a vehicle without thrusters, as thrusters that follow them: what holds of a thrust and of its accuracy holds of them."""

from __future__ import annotations

import math
from typing import Final

from ivsid.vehicle.thrusters import Accuracy, Thruster
from ivsid.vehicle.vehicle import Vehicle

# Arm of a known moment over the hull's length: its force along the hull is this much less than one with an arm of that length.
# Source: definition: far below the accuracy of any force, far above the rounding of a number
ARM: Final = 1e6
# Length of the hull where the file states none [m].
# Source: definition: any will do beside ARM
LENGTH: Final = 1.0


# Columns of known forces, by axis.
# Source: definition: docs/guide.md, "Columns of a log"
COLUMNS: Final = ("force_X", "force_Y", "moment_N")


class KnownForce(Thruster):
    """A known force or moment whose error is a function of one of the known forces.

    Attributes:
        axis: the column of the force that is known.
        by: that of the force on which its error depends.
    """

    axis: str
    by: str

    @property
    def column(self) -> str:
        """As of ``Thruster``."""
        return self.by

    @property
    def own(self) -> bool:
        """Whether it is the force itself; the others are further parts of its error, of which one is as large as its bound."""
        return self.by == self.axis

    @property
    def words(self) -> str:
        """As of ``Thruster``."""
        return f"the known {self.axis}" if self.own else f"the known {self.axis} by {self.by}"


def with_known_forces(vehicle: Vehicle) -> Vehicle:
    """The vehicle with its known forces as thrusters ahead and to starboard and one at a long arm; itself if it has thrusters.

    A known force is as accurate as ``[sensors.force]`` and ``[sensors.moment]`` state, and exact where they state nothing. Who adds up thrusts to a known
    force leaves errors in it that follow any of them: a force that is off with each of the known ones has three parts, of which one gives it.
    """
    if vehicle.thrusters:
        return vehicle
    return vehicle.model_copy(update={"thrusters": tuple(_of(vehicle, a, b) for a in COLUMNS for b in COLUMNS)})


def _of(vehicle: Vehicle, axis: str, by: str) -> KnownForce:
    arm = ARM * (vehicle.hull.length or LENGTH) if axis == "moment_N" else 1.0
    sensor = vehicle.sensors.moment if axis == "moment_N" else vehicle.sensors.force
    return KnownForce(
        name=axis if by == axis else f"{axis}_by_{by}",
        axis=axis,
        by=by,
        gain=1 / arm if by == axis else 0.0,
        position=(0.0, -arm if axis == "moment_N" else 0.0),
        azimuth=math.pi / 2 if axis == "force_Y" else 0.0,
        accuracy=Accuracy(absolute=0.0 if sensor is None else sensor.accuracy / arm),
    )
