"""A Voith-Schneider unit is written as one thruster of the vehicle file and read as two: its surge force and its sway force."""

from __future__ import annotations

import math
from typing import Final

# Keys of a thrust curve, of which the sway force may have its own.
_CURVES: Final = ("table", "polynomial", "gain", "quadratic")


def expand_units(table: object) -> object:
    """The table of a vehicle file with each Voith-Schneider unit replaced by its two thrusters.

    ``kind = "voith-schneider"`` makes ``NAME_surge`` and ``NAME_sway`` at the position of the unit. The second pushes a quarter turn to
    starboard of the first. Each has its own demand column. A table ``sway`` holds the curve of the sway force; without one both
    thrusters follow the curve of the unit.

    Args:
        table: as TOML gives it; anything but a table of thrusters is returned as it is, for the model to refuse.

    Raises:
        ValueError: an unknown ``kind``, or a ``sway`` that is no table.
    """
    if not isinstance(table, dict) or not isinstance(table.get("thrusters"), (list, tuple)):
        return table
    thrusters: list[object] = []
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
