"""Demands as fractions or percentages where their forces do not fit the hull's mass, and would as the other one.

A curve without ends takes any demand, and one in percent takes a fraction for next to nothing. The change of u or v over a window is the
impulse of the force over the total mass, which is between half of the hull's mass and ten times it (docs/theory.md, "Physical bounds").
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.propulsion.demand_unit import PERCENT, WHOLE, percentages
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.setup.finding import Checked, SetupFinding
from ivsid.setup.histories import History, stated
from ivsid.setup.response import EXPLAINS, Array, Axis, axes
from ivsid.setup.suspects import scaled
from ivsid.vehicle import Thruster, Vehicle

# Least and largest total mass, in the hull's.
# Source: Newman, *Marine Hydrodynamics*, 1977, section 4.13 and table 4.3, as in physical.masses
MASSES: Final = (0.5, 10.0)
# Largest total mass under a fault that is named, in the hull's. A hull's mass in tonnes, with an added mass, is eleven times too small for
# demands a hundred times too large.
# Source: geometry: half of 10
NAMED: Final = 5.0
# A hundred percent are one.
# Source: definition
HUNDRED: Final = 100.0


def scale(vehicle: Vehicle, log: Log) -> Checked:
    """Fractions for percentages, and percentages for fractions, of all thrusters whose demands have that range together."""
    if not vehicle.thrusters:
        return Checked((), log)
    for says, factors in (("fractions", _fractions(vehicle, log)), ("percentages", _percentages(vehicle, log))):
        if not factors:
            continue
        columns = {**log.columns, **{k: log.columns[k] * x for k, x in factors.items()}}
        try:
            other = History("setup.demand.unit", says, "", stated(vehicle, replace(log, columns=columns)))
            seen = [a for a in axes(vehicle, log, (other,)) if a.name != "r"]
        except (IvsidError, KeyError):
            # A demand or a channel is missing: the fit says so.
            continue
        if any(_fits(a, a.stated, vehicle, MASSES[1]) for a in seen):
            continue
        plain = max(seen, key=lambda a: a.share(a.others[0]), default=None)
        if plain is not None and _fits(plain, plain.others[0], vehicle, NAMED):
            return Checked((_finding(log, vehicle, plain, says, factors),), log)
    return Checked((), log)


def _mass(axis: Axis, force: Array) -> float:
    """The total mass [kg] that a force history gives to a change; infinite where the force explains none of it."""
    across = float(force @ axis.change)
    return float(force @ force) / across if across > 0 else float("inf")


def _fits(axis: Axis, force: Array, vehicle: Vehicle, most: float) -> bool:
    """Whether a force history explains most of a change, with a mass that the hull can have, at most ``most`` times its own."""
    ratio = _mass(axis, force) / vehicle.hull.mass
    return axis.share(force) >= EXPLAINS and MASSES[0] <= ratio <= most


def _range(vehicle: Vehicle, log: Log) -> list[tuple[Thruster, Array, float]]:
    """Thrusters that count from zero, with their demands and the end of their curve."""
    found = []
    for t in vehicle.thrusters:
        values = log.columns.get(f"demand_{t.name}")
        if t.neutral == 0.0 and values is not None and bool((np.abs(values) > 0).any()):
            low, high = ThrustCurve(t).range
            found.append((t, values, max(-low, high)))
    return found


def _fractions(vehicle: Vehicle, log: Log) -> dict[str, float]:
    """Factors of demands that are no larger than the whole, beside a curve that goes to ten or more, or to no end."""
    return {
        f"demand_{t.name}": end if end < float("inf") else HUNDRED
        for t, values, end in _range(vehicle, log)
        if float(np.nanmax(np.abs(values))) <= WHOLE and end >= PERCENT[0]
    }


def _percentages(vehicle: Vehicle, log: Log) -> dict[str, float]:
    """Factors of demands of the size of percentages, beside a curve without ends; ``demands`` names them beside one of fractions."""
    return {
        f"demand_{t.name}": 1.0 / HUNDRED
        for t, values, end in _range(vehicle, log)
        if end == float("inf") and percentages(values)
    }


def _finding(log: Log, vehicle: Vehicle, axis: Axis, says: str, factors: dict[str, float]) -> SetupFinding:
    before, after = _mass(axis, axis.stated), _mass(axis, axis.others[0])
    has = f"a mass of {before:.3g} kg" if before < float("inf") else "no mass"
    words = (
        f"{log.name}: {', '.join(factors)} {'is' if len(factors) == 1 else 'are'} of the size of {says}: with the forces that the file makes of them, "
        f"{axis.name} changes as {has} would, against {after:.3g} kg with the demands times {next(iter(factors.values())):g} and a hull of "
        f"{vehicle.hull.mass:g} kg"
    )
    lines = ", ".join(scaled(vehicle, k, x) for k, x in factors.items())
    evidence = {
        "mass": before,
        "mass_without": after,
        "hull": vehicle.hull.mass,
        "explained_without": axis.share(axis.others[0]),
    }
    remedy = f"state {lines} under [log.columns], or the curves in that unit"
    return SetupFinding(
        "setup.demand.unit", words, {k: x for k, x in evidence.items() if np.isfinite(x)}, remedy, certain=False
    )
