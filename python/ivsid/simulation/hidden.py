"""Hidden effects: drawn from a seed, for tests that must find them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final
from zlib import crc32

import numpy as np

from ivsid.effects import EFFECTS, Effect, Reading, lacking, terms_of
from ivsid.errors import IvsidError
from ivsid.programme.scenario import Scenario
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Vehicle

# Smallest and largest multiple of the typical size.
# Source: definition: the range of hidden effects that the user's guide states.
SIZES: Final = (0.1, 3.0)


def hidden_effect(vehicle: Vehicle, scenario: Scenario, seed: int) -> dict[str, float]:
    """An effect drawn from the seed: none with probability 1/3, else any of the catalogue that the model lacks.

    Its size is log-uniform from 0.1 to 3 times the typical one, scaled to the vehicle by Froude's law. Sign, direction, phase and
    time are drawn, too.

    Returns:
        Numbers by id and part, as ``simulate`` takes them; empty for none.
    """
    rng = np.random.default_rng([seed, 0x1D])
    nothing = rng.uniform() < 1 / 3
    possible = [e for e in EFFECTS.values() if can_hide(e, vehicle, scenario)]
    if nothing or not possible:
        return {}
    effect = possible[int(rng.integers(len(possible)))]
    effect = as_logged(effect, scenario)
    size = float(np.exp(rng.uniform(np.log(SIZES[0]), np.log(SIZES[1]))))
    return draw(effect, size, vehicle, scenario, rng)


def hidden_effects(
    vehicle: Vehicle, scenario: Scenario, seed: int, count: int, sizes: tuple[float, float] = SIZES
) -> dict[str, float]:
    """``count`` different effects drawn from the seed, each as ``hidden_effect`` draws one.

    Args:
        vehicle: on which they act.
        scenario: its manoeuvres and its truth.
        seed: of the draws.
        count: number of effects.
        sizes: smallest and largest multiple of an effect's typical size.

    Raises:
        IvsidError: fewer than ``count`` effects can act on the vehicle.
    """
    rng = np.random.default_rng([seed, 0x1D, count])
    possible = [e for e in EFFECTS.values() if can_hide(e, vehicle, scenario)]
    if len(possible) < count:
        raise IvsidError(
            f"{count} effects are asked for and {len(possible)} can be hidden in {vehicle.name}; ask for fewer"
        )
    found: dict[str, float] = {}
    for drawn in sorted(possible, key=lambda e: _lot(seed, e))[:count]:
        effect = as_logged(drawn, scenario)
        size = float(np.exp(rng.uniform(np.log(sizes[0]), np.log(sizes[1]))))
        found |= draw(effect, size, vehicle, scenario, rng)
    return found


def _lot(seed: int, effect: Effect) -> float:
    """A number that an effect draws for itself, so that one which joins the catalogue changes the draws of few seeds."""
    return float(np.random.default_rng([seed, 0x1D, crc32(effect.id.encode())]).uniform())


def can_hide(effect: Effect, vehicle: Vehicle, scenario: Scenario) -> bool:
    """Whether the effect can act on this vehicle and is neither in its model nor in the scenario's truth."""
    stated = (*scenario.truth, *vehicle.model.numbers)
    if any(key == effect.id or key.startswith(f"{effect.id}.") for key in stated):
        return False
    if effect.stated and getattr(scenario.environment, effect.stated) is not None:
        return False
    if effect.plain:
        # A term of the plain model is an effect only for the paper's model, in which surge and sway share a column.
        return vehicle.model.terms == "paper" and bool(effect.shares)
    if effect.terms and {t.id for t in terms_of(vehicle)} & {effect.id, *effect.parts}:
        return False
    if isinstance(effect.acts, Reading):
        return getattr(vehicle.sensors, effect.acts.sensor) is not None
    return lacking(effect, vehicle, [ThrustCurve(t).largest for t in vehicle.thrusters]) is None


def draw(
    effect: Effect, size: float, vehicle: Vehicle, scenario: Scenario, rng: np.random.Generator
) -> dict[str, float]:
    """Numbers by id and part for an effect at a multiple of its typical size; direction, sign and time are drawn."""
    if effect.plain:
        return _own_sway(effect, size, scenario.truth)
    angle = float(rng.uniform(0, 2 * math.pi))
    sign = float(rng.choice((-1.0, 1.0)))
    pairs = [p.scaled(vehicle.hull.mass) for p in effect.parameters if p.draw in ("north", "east")]
    reach = math.hypot(*pairs)
    found = {}
    for name, p in zip(effect.parts, effect.parameters, strict=True):
        typical = p.scaled(vehicle.hull.mass, max((ThrustCurve(t).largest for t in vehicle.thrusters), default=0.0))
        if p.unit == "demand":
            typical = p.typical / 100 * _span(vehicle, scenario)
        match p.draw:
            case "size":
                value = typical / size if p.inverse else p.none + (typical - p.none) * size
                value *= sign if p.signed else 1.0
            case "north":
                value = size * reach * math.cos(angle)
            case "east":
                value = size * reach * math.sin(angle)
            case "angle":
                value = float(rng.uniform(0, 2 * math.pi))
            case "time":
                value = float(rng.uniform(0.25, 0.75)) * scenario.duration
            case "thruster":
                value = float(rng.integers(len(vehicle.thrusters)))
            case _:
                value = typical
        found[name] = min(value, p.most)
    return found


def _own_sway(effect: Effect, size: float, truth: Mapping[str, float]) -> dict[str, float]:
    """A sway mass or drag that differs from the shared one by the ratio of their typical sizes."""
    other = effect.shares
    ratio = effect.parameters[0].typical / EFFECTS[other].parameters[0].typical
    return {effect.id: truth.get(other, EFFECTS[other].parameters[0].typical) * (1 + (ratio - 1) * size)}


def as_logged(effect: Effect, scenario: Scenario) -> Effect:
    """The form of an effect for the logs of a scenario: its numbers multiply the cause itself where the log will hold it."""
    measured = effect.measured
    if measured is None or any(getattr(scenario.environment, n, 0.0) is None for n in measured.needs):
        return effect
    return measured


def _span(vehicle: Vehicle, scenario: Scenario) -> float:
    """The demand that counts as 100 %: the largest of the tables, else the largest of the scenario."""
    ends = [max(map(abs, t.table.demand)) for t in vehicle.thrusters if t.table is not None]
    asked = [abs(q) for s in scenario.segments for q in np.atleast_1d(s.demand)]
    return float(max(ends or asked or [100.0])) or 100.0
