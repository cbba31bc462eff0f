"""Position and orientation of a sensor on the vehicle."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from ivsid.files.section import NonNegative, Pair, Section


class Mounted(Section):
    """A sensor that may stand off the body origin and be turned about the vertical.

    Attributes:
        position: of the sensor from the body origin, forward and to starboard [m].
        position_accuracy: bound on the error of each of the two [m].
        rotation: from the vehicle's x axis to the sensor's, positive to starboard [rad].
        rotation_accuracy: bound on its error [rad].
    """

    position: Pair = (0.0, 0.0)
    position_accuracy: NonNegative = 0.0
    rotation: Annotated[float, Field(ge=-2 * math.pi, le=2 * math.pi)] = 0.0
    rotation_accuracy: NonNegative = 0.0

    @property
    def off_origin(self) -> bool:
        """Whether the sensor reads the motion of another point than the body origin."""
        return self.position != (0.0, 0.0) or self.position_accuracy > 0

    @property
    def turned(self) -> bool:
        """Whether the axes of the sensor differ from the vehicle's."""
        return self.rotation != 0.0 or self.rotation_accuracy > 0
