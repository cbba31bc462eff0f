"""Latitude and longitude as a position in metres about the first fix."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from ivsid.proposal.found import Found

# Half the large axis of the earth's ellipsoid [m].
# Source: definition: WGS 84
EQUATOR: Final = 6378137.0
# Its squared eccentricity.
# Source: definition: WGS 84, flattening 1 / 298.257223563
ECCENTRICITY: Final = 6.69437999014e-3


def local(channels: Mapping[str, Found]) -> dict[str, Found]:
    """The channels with ``x`` and ``y`` from latitude and longitude, where they have no position of their own."""
    made = dict(channels)
    latitude, longitude = made.pop("latitude", None), made.pop("longitude", None)
    if latitude is None or longitude is None or {"x", "y"} & made.keys():
        return made
    north, east = _per_degree(latitude)
    # Body axes that point to port go with axes of the earth that begin in the east.
    names = ("x", "y") if latitude.program.frame == "frd" else ("y", "x")
    for name, f, metres in zip(names, (latitude, longitude), (north, east), strict=True):
        first = float(f.values[np.isfinite(f.values)][0]) * f.meaning.scale
        made[name] = f.with_meaning(channel=name, unit=None, scale=metres * f.meaning.scale, offset=-metres * first)
    return made


def _per_degree(latitude: Found) -> tuple[float, float]:
    """Metres north and east for a degree at the first fix: radii of curvature of the ellipsoid."""
    phi = np.radians(float(latitude.values[np.isfinite(latitude.values)][0]) * latitude.meaning.scale)
    square = 1 - ECCENTRICITY * np.sin(phi) ** 2
    meridian, across = EQUATOR * (1 - ECCENTRICITY) / square**1.5, EQUATOR / square**0.5
    return float(np.radians(meridian)), float(np.radians(across) * np.cos(phi))


def is_earthbound(found: Found) -> bool:
    """Whether a column is a latitude or a longitude that was turned into metres."""
    return found.meaning.offset != 0.0 and found.meaning.channel in ("x", "y")
