"""Where a sensor stands and how it is turned, as a vehicle file says it."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class Mounted(BaseModel):
    """A sensor that may stand off the body origin and be turned about the vertical.

    Attributes:
        position: of the sensor from the body origin, forward and to starboard [m].
        position_accuracy: how far each of the two may be off [m].
        rotation: from the vehicle's x axis to the sensor's, positive to starboard [rad].
        rotation_accuracy: how far it may be off [rad].
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    position: tuple[Finite, Finite] = (0.0, 0.0)
    position_accuracy: NonNegative = 0.0
    rotation: Annotated[float, Field(ge=-2 * math.pi, le=2 * math.pi)] = 0.0
    rotation_accuracy: NonNegative = 0.0

    @property
    def off_origin(self) -> bool:
        """Whether it reads another point's motion."""
        return self.position != (0.0, 0.0) or self.position_accuracy > 0

    @property
    def turned(self) -> bool:
        """Whether its axes are not the vehicle's."""
        return self.rotation != 0.0 or self.rotation_accuracy > 0
