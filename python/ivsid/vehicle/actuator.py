"""Further parts of a thruster in the vehicle file: quadratic curve, rudder, and the Voith-Schneider unit as two thrusters."""

from __future__ import annotations

import math
from typing import Annotated, Any, Final

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]

# Keys that a Voith-Schneider unit's sway force may have of its own.
_CURVES: Final = ("table", "polynomial", "gain", "quadratic")


class Quadratic(BaseModel):
    """T = k n|n| with k = ``forward`` for a positive demand n and ``reverse`` (the same by default) for a negative one [N]."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    forward: NonNegative
    reverse: NonNegative | None = None

    @property
    def astern(self) -> float:
        """The coefficient of negative demands."""
        return self.forward if self.reverse is None else self.reverse


class Rudder(BaseModel):
    """A rudder behind the propeller; its angle [rad] is the column ``rudder_NAME``, positive with the trailing edge to starboard.

    That turns the vehicle to starboard, which is positive. Under ``frame = "flu"`` a positive angle turns it to positive yaw, too, to
    port: there the trailing edge stands to port.

    Attributes:
        area: of the blade [m^2].
        aspect_ratio: span squared over area.
        position: ahead of the origin [m]; negative astern.
        propeller_diameter: of the slipstream that reaches it [m]; without one, the rudder stands in the free stream.
        stall: angle of attack [rad] beyond which lift falls off.
        drag: coefficient at no angle of attack.
        rate: how fast the rudder turns at most [rad/s].
        density: of the water [kg/m^3].
        accuracy: the largest error of its lift and drag coefficients, as a share.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    area: Positive
    aspect_ratio: Positive
    position: Annotated[float, Field(allow_inf_nan=False)]
    propeller_diameter: Positive | None = None
    stall: Annotated[float, Field(gt=0, lt=math.pi / 2)] = 0.6
    drag: NonNegative = 0.02
    rate: Positive | None = None
    density: Positive = 1025.0
    accuracy: NonNegative = 0.0


def expand_units(table: Any) -> Any:
    """The vehicle's table with each Voith-Schneider unit as the two thrusters that it is.

    ``kind = "voith-schneider"`` makes ``NAME_surge`` and ``NAME_sway`` at the unit's position, the second a quarter turn to
    starboard, each with its demand column; ``sway`` holds a curve of its own, else both follow the unit's.
    """
    if not isinstance(table, dict) or not isinstance(table.get("thrusters"), (list, tuple)):
        return table
    thrusters: list[Any] = []
    for unit in table["thrusters"]:
        if not isinstance(unit, dict) or "kind" not in unit:
            thrusters.append(unit)
            continue
        kind = unit["kind"]
        rest = {k: v for k, v in unit.items() if k not in ("kind", "sway")}
        if kind == "fixed":
            thrusters.append(rest)
            continue
        if kind != "voith-schneider":
            raise ValueError(f'a thruster of kind {kind!r} is not known; use "fixed" or "voith-schneider"')
        sway = unit.get("sway", {})
        if not isinstance(sway, dict):
            raise ValueError(
                f"sway = {sway!r} of a Voith-Schneider unit is no curve; give it a table, polynomial, gain or quadratic"
            )
        own = {k: v for k, v in rest.items() if k not in _CURVES} if any(k in sway for k in _CURVES) else rest
        azimuth = rest.get("azimuth", 0.0)
        turned = azimuth + math.pi / 2 if isinstance(azimuth, (int, float)) else azimuth
        thrusters.append({**rest, "name": f"{rest.get('name')}_surge"})
        thrusters.append({**own, **sway, "name": f"{rest.get('name')}_sway", "azimuth": turned})
    return {**table, "thrusters": thrusters}
