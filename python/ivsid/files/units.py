"""Factors from named units to SI and radians; units occur only where files are read."""

import math
from typing import Final

from ivsid.errors import IvsidError, meant

# Units of forces [N].
# Source: definition: the standard gravity 9.80665 m/s^2, the international pound 0.45359237 kg
FORCE: Final = {"N": 1.0, "kN": 1e3, "kgf": 9.80665, "gf": 9.80665e-3, "lbf": 4.4482216152605}
# Units of times [s].
# Source: definition: SI
TIME: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86400.0}
# Units of angles [rad].
# Source: definition: SI
ANGLE: Final = {"rad": 1.0, "deg": math.pi / 180.0}

# Units of yaw rates [rad/s].
# Source: definition: SI
RATE: Final = {"rad/s": 1.0, "deg/s": math.pi / 180.0, "deg/h": math.pi / 648000.0}
# Units of accelerations [m/s^2].
# Source: definition: the standard gravity 9.80665 m/s^2
ACCELERATION: Final = {"m/s^2": 1.0, "g": 9.80665, "mg": 9.80665e-3}

# Units that a foreign log's columns may have, in SI.
# Source: definition: SI, the standard gravity, the international nautical mile of 1852 m, the international foot of 0.3048 m
COLUMN: Final = {
    **FORCE,
    **ANGLE,
    **TIME,
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "km": 1e3,
    "ft": 0.3048,
    "m/s": 1.0,
    "cm/s": 1e-2,
    "mm/s": 1e-3,
    "m/min": 1.0 / 60.0,
    "km/h": 1.0 / 3.6,
    "ft/s": 0.3048,
    "mph": 0.44704,
    "kn": 1852.0 / 3600.0,
    "mrad": 1e-3,
    "gon": math.pi / 200.0,
    "rad/s": 1.0,
    "mrad/s": 1e-3,
    "deg/s": math.pi / 180.0,
    "deg/min": math.pi / 10800.0,
    "rad/s^2": 1.0,
    "deg/s^2": math.pi / 180.0,
    "m/s^2": 1.0,
    "cm/s^2": 1e-2,
    "mm/s^2": 1e-3,
    "g": 9.80665,
    "mg": 9.80665e-3,
    "N m": 1.0,
    "kN m": 1e3,
    "%": 1.0,
    "1": 1.0,
    "V": 1.0,
}


def factor(unit: str, table: dict[str, float], what: str) -> float:
    """The SI value of one ``unit``.

    Args:
        unit: name of the unit.
        table: factors by unit, one of this module's.
        what: the quantity, for messages.

    Raises:
        IvsidError: the unit is not in the table.
    """
    if unit not in table:
        raise IvsidError(f"unit '{unit}' of {what} is unknown; {meant(unit, table)}use one of {', '.join(table)}")
    return table[unit]


def random_walk_from_deg_per_sqrt_hour(value: float) -> float:
    """Angle random walk from deg/sqrt(h), the unit of the paper's Table II, to rad/sqrt(s)."""
    return math.radians(value) / 60.0
