"""A rudder behind a propeller, as the vehicle file states it."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from ivsid.files.section import Finite, NonNegative, Positive, Section


class Rudder(Section):
    """A rudder behind the propeller of a thruster.

    Its angle [rad] is the column ``rudder_NAME`` of the log. The angle is positive with the trailing edge to starboard, which turns
    the vehicle to starboard. Under ``frame = "flu"`` a positive angle stands for the trailing edge to port: yaw to port is
    positive there.

    Attributes:
        area: of the blade [m^2].
        aspect_ratio: span squared over area.
        position: ahead of the origin [m]; negative astern.
        propeller_diameter: of the slipstream that reaches the rudder [m]; without it the rudder stands in the free stream.
        stall: angle of attack [rad] beyond which lift falls off.
        drag: drag coefficient at zero angle of attack.
        rate: the largest rate of the angle [rad/s].
        density: of the water [kg/m^3].
        accuracy: the largest relative error of the lift and drag coefficients.
    """

    area: Positive
    aspect_ratio: Positive
    position: Finite
    propeller_diameter: Positive | None = None
    stall: Annotated[float, Field(gt=0, lt=math.pi / 2)] = 0.6
    drag: NonNegative = 0.02
    rate: Positive | None = None
    density: Positive = 1025.0
    accuracy: NonNegative = 0.0
