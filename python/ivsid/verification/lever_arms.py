"""Lever arm and rotation of a sensor, in fractions."""

from __future__ import annotations

from ivsid.vehicle.mount import Mounted
from ivsid.verification.decimals import Decimals
from ivsid.verification.rational import Range, cosine, sided, sine


def mounted(sensor: Mounted) -> bool:
    """Whether a sensor stands off the origin or is turned."""
    return sensor.off_origin or sensor.turned


def arm_of(exact: Decimals, mount: Mounted) -> tuple[Range, Range]:
    """The sensor's place ahead of the origin and to starboard [m]."""
    (x, y), off = exact.pair(mount.position), sided(exact(mount.position_accuracy))
    return x + off, y + off


def turned_back(exact: Decimals, mount: Mounted, a: Range | None, b: Range | None, *, first: bool) -> Range | None:
    """The first or the second component, in the vehicle's axes, of a vector (a, b) in the sensor's; None where one is missing."""
    if a is None or b is None:
        return None
    if not mount.turned:
        return a if first else b
    angle = exact(mount.rotation) + sided(exact(mount.rotation_accuracy))
    c, s = cosine(angle), sine(angle)
    return a * c - b * s if first else a * s + b * c
