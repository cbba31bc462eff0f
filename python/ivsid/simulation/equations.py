"""The equations of motion of a vehicle with its true numbers, as one compiled function of time and state.

M_RB nudot + C_RB(nu) nu + M_A nudot_r + C_A(nu_r) nu_r + D(nu_r) nu_r = tau (Fossen), with nu_r relative to the water. An
identification shares with them the formulas of ``effects`` and nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from ivsid.effects import (
    CHANNELS,
    Change,
    Current,
    Force,
    Given,
    Inflow,
    Place,
    State,
    Term,
    acting,
    needed_terms,
    rigid_body,
    with_stated,
    with_terms,
)
from ivsid.effects.environment import earth_to_body
from ivsid.effects.functions import cos, sin
from ivsid.effects.quantity import Quantity
from ivsid.errors import IvsidError
from ivsid.propulsion.foil import rudder_force
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation.compiled import Steps, function, runge_kutta
from ivsid.simulation.symbols import Symbol, Tape, solve
from ivsid.vehicle import Vehicle
from ivsid.vehicle.rudder import Rudder

# (t, u, v, r, psi, x, y, X, Y, N, wind north, wind east, thrusts, angles) -> rates of u, v, r, psi, x, y
Rates: TypeAlias = Callable[..., tuple[Quantity, ...]]
# A time [s] after every change, so that a mass matrix can be checked at the end of all changes.
# Source: definition: close to the largest float64.
AGE: Final = 1e300
_STATE: Final = ("t", "u", "v", "r", "psi", "x", "y", "X", "Y", "N", "wind_north", "wind_east")


@dataclass(frozen=True)
class Plant:
    """A vehicle with its true physics.

    Attributes:
        vehicle: hull, thrusters and sensors.
        terms: the terms of the motion.
        values: their true values by id.
        given: the effects beside the terms.
    """

    vehicle: Vehicle
    terms: tuple[Term, ...]
    values: Mapping[str, float]
    given: tuple[Given, ...]


def plant(vehicle: Vehicle, wanted: Sequence[Term], given: Sequence[Given]) -> Plant:
    """The plant whose terms are the model's and those that the given effects add.

    Args:
        vehicle: the vehicle.
        wanted: the terms of its model.
        given: all effects with values, the model's own terms among them.

    Raises:
        IvsidError: a term without a value, or an effect that the vehicle cannot have.
    """
    terms = with_terms(vehicle, wanted, given)
    values = {t.id: value for g in given if g.effect.terms for t, value in zip(g.effect.terms, g.values, strict=True)}
    missing = [t.id for t in needed_terms(vehicle, terms) if t.id not in values]
    if missing:
        raise IvsidError(
            f"the scenario's [truth] has no value for {', '.join(missing)}; add it, or give the vehicle file's [model.fitted] one"
        )
    others = tuple(g for g in given if not g.effect.terms)
    _check(vehicle, others)
    return Plant(vehicle, terms, values, others)


def _check(vehicle: Vehicle, given: Sequence[Given]) -> None:
    for g in given:
        endless = [t.name for t in vehicle.thrusters if not ThrustCurve(t).largest and g.thruster in (None, t.name)]
        if "largest_thrust" in g.effect.asks and endless:
            raise IvsidError(
                f"{g.effect.id} bends the curve between rest and its largest thrust, and {endless[0]} has no end; give a table or "
                "demand_range"
            )
        for draw, (name, value) in zip(g.effect.draws, g.named.items(), strict=True):
            if draw == "thruster" and value >= len(vehicle.thrusters):
                raise IvsidError(f"{name} = {value:g}, but the vehicle has {len(vehicle.thrusters)} thrusters, from 0")


def equations(plant: Plant, *, arrays: bool = False) -> Rates:
    """The compiled rates of u, v, r, psi, x and y.

    The function takes the time [s]; u, v [m/s], r [rad/s] over ground; heading [rad], north, east [m]; external X, Y [N] and
    N [N m]; the wind's velocity north and east [m/s]; then the thrust of each thruster at no speed [N]; then the angle of each [rad]
    (of the rudder, or of an azimuth thruster; unused for the others).

    Args:
        plant: the vehicle with its true physics.
        arrays: whether the arguments are arrays of one shape; else floats.

    Raises:
        IvsidError: masses and inertia that do not make a regular mass matrix.
    """
    tape, names, results = _written(plant)
    return function(tape, names, results, arrays=arrays)


def steps(plant: Plant, inside: float) -> Steps:
    """A Runge-Kutta step of the same equations, for floats; X, Y, N, wind, thrusts and angles hold over it.

    Args:
        plant: the vehicle with its true physics.
        inside: share of a step by which its ends are evaluated from inside.

    Raises:
        IvsidError: as ``equations``.
    """
    tape, names, results = _written(plant)
    moving = _STATE.index("X")
    thrusts = [f"T{k}" for k in range(len(plant.vehicle.thrusters))]
    return runge_kutta(tape, names[1:moving], names[moving:], thrusts, results, inside)


def _written(plant: Plant) -> tuple[Tape, list[str], tuple[Quantity, ...]]:
    """The equations on a tape, the names of their arguments, and their results."""
    tape = Tape()
    t, u, v, r, psi, x, y, X, Y, N, wn, we = (tape.symbol(n) for n in _STATE)
    thrusts = [tape.symbol(f"T{k}") for k in range(len(plant.vehicle.thrusters))]
    angles = [tape.symbol(f"A{k}") for k in range(len(plant.vehicle.thrusters))]
    heading = Place(psi, x, y, t)
    north, east, north_rate, east_rate = _current(plant.given, t)
    u_c, v_c = earth_to_body(heading, north, east)
    u_r, v_r = u - u_c, v - v_c
    blows = earth_to_body(heading, wn, we)
    place = Place(psi, x, y, t, blows[0] - u, blows[1] - v)
    values = _changed(plant, t)
    mass = plant.vehicle.hull.mass
    x_g, y_g = plant.vehicle.hull.centre_of_gravity

    def left(state: State) -> list[Quantity]:
        total: dict[str, Quantity] = rigid_body(state, mass * x_g, mass * y_g)
        for term in plant.terms:
            for channel, column in term.columns(state).items():
                total[channel] = column * values[term.id] + total.get(channel, 0.0)
        return [total.get(c, 0.0) for c in CHANNELS]

    at_rest = [State(0.0, 0.0, 0.0, *unit, place=place) for unit in ((0.0, 0.0, 0.0), *np.eye(3).tolist())]

    def inertia() -> list[list[Quantity]]:
        base, *columns = (left(s) for s in at_rest)
        return [[columns[j][i] - base[i] for j in range(3)] for i in range(3)]

    # Every change in time is a step or monotone, so that its extremes stand at the start and at the end of all time.
    for moment in (0.0, AGE):
        values = _changed(plant, moment)
        _regular(inertia())
    values = _changed(plant, t)
    matrix = inertia()
    free = left(State(u_r, v_r, r, 0.0, 0.0, 0.0, place=place))
    force = _thrust(plant, thrusts, angles, (u_r, v_r, r))
    for push, numbers in acting(plant.given, Force):
        moving = State(u_r, v_r, r, 0.0, 0.0, 0.0, place=place)
        for channel, value in push.function(moving, numbers).items():
            force[CHANNELS.index(channel)] = force[CHANNELS.index(channel)] + value
    # M_RB acts on the velocity over ground, so that the acceleration of the water counts as a force on the rigid body.
    a_u, a_v = earth_to_body(heading, north_rate, east_rate)
    inertial = (a_u * mass, a_v * mass, a_v * (mass * x_g) - a_u * (mass * y_g))
    outside = (X, Y, N)
    right = [outside[k] + force[k] - free[k] - inertial[k] for k in range(3)]
    udot_r, vdot_r, rdot = solve(matrix, right)
    udot = udot_r + r * v_c + a_u
    vdot = vdot_r - r * u_c + a_v
    c, s = cos(psi), sin(psi)
    results = (udot, vdot, rdot, r, u * c - v * s, u * s + v * c)
    names = [*_STATE, *(q.name for q in thrusts), *(q.name for q in angles)]
    return tape, names, results


def _current(given: Sequence[Given], t: Symbol) -> list[Quantity]:
    total: list[Quantity] = [0.0, 0.0, 0.0, 0.0]
    for current, numbers in acting(given, Current):
        total = [a + b for a, b in zip(total, current.function(numbers, t), strict=True)]
    return total


def _changed(plant: Plant, t: Quantity) -> dict[str, Quantity]:
    values: dict[str, Quantity] = dict(plant.values)
    for change, numbers in acting(plant.given, Change):
        values.update(change.function(values, numbers, t))
    return values


def _regular(matrix: list[list[Quantity]]) -> None:
    # A matrix that depends on the heading holds symbols and cannot be checked here.
    if any(isinstance(q, Symbol) for row in matrix for q in row):
        return
    numbers = np.array(matrix, dtype=np.float64)
    if (
        not np.isfinite(numbers).all()
        or np.linalg.cond(numbers) > 1e12
        or np.linalg.eigvalsh(numbers + numbers.T)[0] <= 0
    ):
        raise IvsidError(
            "the mass matrix of the model is not positive definite; masses and inertia must be positive, payloads and the centre of "
            "gravity's offset small beside them"
        )


def _thrust(
    plant: Plant, thrusts: Sequence[Symbol], angles: Sequence[Symbol], relative: tuple[Quantity, Quantity, Quantity]
) -> list[Quantity]:
    """X, Y [N], N [N m] of all thrusters and rudders at a velocity relative to the water."""
    u, v, r = relative
    total: list[Quantity] = [0.0, 0.0, 0.0]
    for k, thruster in enumerate(plant.vehicle.thrusters):
        px, py = thruster.position
        c: Quantity
        s: Quantity
        if thruster.steering == "azimuth":
            c, s = cos(angles[k]), sin(angles[k])
        else:
            c, s = axis(thruster.azimuth)
        inflow = (u - r * py) * c + (v + r * px) * s
        push: Quantity = thrusts[k]
        for loss, numbers in acting(with_stated(plant.given, Inflow, thruster), Inflow):
            push = loss.function(push, inflow, numbers)
        parts = [push * c, push * s, push * (s * px - c * py)]
        if thruster.rudder is not None:
            blade = [
                push.tape.note(
                    f"rudder{k}({angles[k].name}, {push.name}, {u.name}, {v.name}, {r.name})[{j}]",
                    angles[k],
                    push,
                    u,
                    v,
                    r,
                )
                for j in range(3)
            ]
            push.tape.provide(f"rudder{k}", _blade(thruster.rudder))
            parts = [a + b for a, b in zip(parts, blade, strict=True)]
        total = [a + b for a, b in zip(total, parts, strict=True)]
    return total


def _blade(rudder: Rudder) -> Callable[..., Quantity]:
    return lambda delta, thrust, u, v, r: rudder_force(rudder, delta, thrust, u, v, r)


def axis(azimuth: float) -> tuple[float, float]:
    """Cosine and sine of a fixed direction [rad]; for a right angle they are exactly 0 and +-1."""
    c, s = math.cos(azimuth), math.sin(azimuth)
    return (0.0 if abs(c) < 1e-15 else c), (0.0 if abs(s) < 1e-15 else s)
