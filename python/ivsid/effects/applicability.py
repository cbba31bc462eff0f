"""Applicability: what a vehicle lacks for an effect, by the needs that the effect declares and by those of its physics."""

from __future__ import annotations

from collections.abc import Sequence

from ivsid.effects.effect import Effect
from ivsid.vehicle import KnownForce, Vehicle


def lacking(effect: Effect, vehicle: Vehicle, largest: Sequence[float]) -> str | None:
    """The reason in words why an effect cannot act on a vehicle, or None.

    Args:
        effect: in question.
        vehicle: of the file.
        largest: the largest thrust of each thruster's curve [N], 0 for a curve without an end.
    """
    if any(t.of_hull for t in effect.terms) and vehicle.hull.length is None:
        return "the vehicle file gives no hull.length"
    thrusters = [t for t in vehicle.thrusters if not isinstance(t, KnownForce)]
    if effect.acts.at_thruster and not thrusters:
        return "the forces are given, and no thruster"
    sides = [t.position[1] for t in thrusters]
    if "both_sides" in effect.asks and not min(sides, default=0.0) < 0 < max(sides, default=0.0):
        return "no thrusters on both sides"
    if "largest_thrust" in effect.asks and not all(largest):
        return "a thrust curve without an end"
    return None
