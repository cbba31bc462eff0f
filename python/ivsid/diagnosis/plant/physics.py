"""Accelerations of a hypothesis at given states: Fossen's equations for whole arrays, from the catalogue's formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import (
    CHANNELS,
    EFFECTS,
    Change,
    Current,
    Force,
    Given,
    Inflow,
    Place,
    Reading,
    Response,
    State,
    Term,
    Thrust,
    for_thruster,
    rigid_body,
)
from ivsid.effects.environment import earth_to_body
from ivsid.propulsion.foil import rudder_force
from ivsid.vehicle import Thruster, Vehicle

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hypothesis:
    """A model with numbers: terms with their values by id, effects that are no terms with theirs, and the size of what is declared.

    ``freed`` are claimed parameters that are fitted after all, since the log contradicts the claim.
    """

    terms: tuple[Term, ...]
    values: Mapping[str, float]
    given: tuple[Given, ...] = ()
    declared_errors: Mapping[str, float] = field(default_factory=dict)
    freed: frozenset[str] = frozenset()

    def with_effect(self, given: Given) -> Hypothesis:
        """The same with an effect more, or with other numbers for one that it has."""
        others = tuple(g for g in self.given if (g.effect.id, g.thruster) != (given.effect.id, given.thruster))
        return replace(self, given=(*others, given))

    def without(self, id_: str, plain: Hypothesis) -> Hypothesis:
        """The same without a cause: a claim that was given up stands again, and every term that ``plain`` has stays."""
        if id_ in self.freed:
            return replace(self, values={**self.values, id_: plain.values[id_]}, freed=self.freed - {id_})
        ids = {t.id for t in plain.terms}
        terms = tuple(t for t in self.terms if t.id in ids or (t.id != id_ and not t.id.startswith(f"{id_}.")))
        given = tuple(g for g in self.given if g.effect.id != id_)
        return replace(self, terms=terms, values={t.id: self.values[t.id] for t in terms}, given=given)


@dataclass(frozen=True)
class Points:
    """Where accelerations are asked for: states, place, thrusts at no speed and their angles; shapes (n,), (k, n).

    ``still`` is what the thrusts at no speed come to, shape (3, n), where it is known: it does not depend on the states.
    """

    nu: Array
    psi: Array
    place: Array
    t: Array
    thrusts: Array
    angles: Array
    force: Array
    wind: Array | None = None
    rudders: Array | None = None
    bollard: Array | None = None

    def moved(self, shift: Array) -> Points:
        """At other velocities."""
        return replace(self, nu=self.nu + shift)

    def under(self, thrusts: Array, bollard: Array | None = None) -> Points:
        """With other thrusts."""
        return replace(self, thrusts=thrusts, bollard=bollard)


def _place(p: Points) -> Place:
    if p.wind is None:
        return Place(p.psi, p.place[0], p.place[1], p.t)
    blows = earth_to_body(Place(p.psi, None, None, None), p.wind[0], p.wind[1])
    return Place(p.psi, p.place[0], p.place[1], p.t, blows[0] - p.nu[0], blows[1] - p.nu[1])


def blade_force(vehicle: Vehicle, k: int, p: Points, push: Any, relative: Any) -> Array:
    """X, Y [N], N [N m] of the rudder behind a thruster, shape (3, n); nothing where there is none."""
    rudder = vehicle.thrusters[k].rudder
    if rudder is None or p.rudders is None:
        return np.zeros_like(p.nu)
    return np.stack(rudder_force(rudder, p.rudders[k], push, *relative))


def thruster_force(
    vehicle: Vehicle,
    given: Sequence[Given],
    p: Points,
    relative: Any,
    declared_errors: Mapping[str, float] | None = None,
) -> Array:
    """X, Y [N], N [N m] of all thrusters and rudders, shape (3, n)."""
    u, v, r = relative
    lost = [_losses(thruster, given) for thruster in vehicle.thrusters]
    if p.bollard is not None and not any(lost) and all(t.rudder is None for t in vehicle.thrusters):
        return p.bollard.copy()
    total = p.force.copy()
    for k, thruster in enumerate(vehicle.thrusters):
        c, s = np.cos(p.angles[k]), np.sin(p.angles[k])
        x, y = thruster.position
        push: Any = p.thrusts[k]
        for g in lost[k]:
            if isinstance(g.effect.acts, Inflow):
                push = g.effect.acts.function(push, (u - r * y) * c + (v + r * x) * s, g.values)
        total += np.stack([push * c, push * s, push * (s * x - c * y)])
        if thruster.rudder is not None:
            off = (declared_errors or {}).get(f"~rudder.{thruster.name}", 0.0)
            total += (1.0 + off) * blade_force(vehicle, k, p, push, relative)
    return total


def _losses(thruster: Thruster, given: Sequence[Given]) -> list[Given]:
    """What takes thrust away by the inflow: the effects, else the file's claim."""
    losses = for_thruster(given, Inflow, thruster.name)
    if not losses and thruster.advance_loss:
        return [Given(EFFECTS["thruster.advance_loss"], (thruster.advance_loss,))]
    return losses


def still_force(vehicle: Vehicle, thrusts: Array, turn: tuple[Array, Array], force: Array) -> Array:
    """X, Y [N], N [N m] of thrusts at no speed, without rudders, shape (3, n); ``turn`` are the cosines and sines of their angles."""
    total = force.copy()
    for thruster, push, c, s in zip(vehicle.thrusters, thrusts, *turn, strict=True):
        x, y = thruster.position
        total[0] += push * c
        total[1] += push * s
        total[2] += push * (s * x - c * y)
    return total


def water(h: Hypothesis, p: Points) -> tuple[Any, Any, Any, Any]:
    """The water's velocity in body axes, and its rate of change there apart from turning."""
    total: list[Any] = [0.0, 0.0, 0.0, 0.0]
    for g in h.given:
        if isinstance(g.effect.acts, Current):
            total = [a + b for a, b in zip(total, g.effect.acts.function(g.values, p.t), strict=True)]
    if all(isinstance(q, float) and q == 0.0 for q in total):
        return 0.0, 0.0, 0.0, 0.0
    here = Place(p.psi, None, None, None)
    return *earth_to_body(here, total[0], total[1]), *earth_to_body(here, total[2], total[3])


def changed(h: Hypothesis, t: Array) -> dict[str, Any]:
    """The values of the terms, with those that effects change in time."""
    values: dict[str, Any] = dict(h.values)
    for g in h.given:
        if isinstance(g.effect.acts, Change):
            values.update(g.effect.acts.function(values, g.values, t))
    return values


class Mass:
    """The mass matrix of a hypothesis, constant or in time, and its inverse."""

    def __init__(self, vehicle: Vehicle, terms: Sequence[Term], values: Mapping[str, Any]) -> None:
        m = vehicle.hull.mass
        x_g, y_g = vehicle.hull.centre_of_gravity
        columns = []
        for unit in np.eye(3).tolist():
            state = State(0.0, 0.0, 0.0, *unit, place=Place(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
            total: dict[str, Any] = rigid_body(state, m * x_g, m * y_g)
            for term in terms:
                for channel, column in _inertial(term, state).items():
                    total[channel] = column * values[term.id] + total.get(channel, 0.0)
            columns.append([total.get(c, 0.0) for c in CHANNELS])
        entries = [[columns[j][i] for j in range(3)] for i in range(3)]
        n = max(np.size(q) for row in entries for q in row)
        matrix = np.zeros((n, 3, 3))
        for i in range(3):
            for j in range(3):
                matrix[:, i, j] = entries[i][j]
        self.inverse: Array = np.asarray(np.linalg.inv(matrix), dtype=np.float64)

    def solve(self, force: Array) -> Array:
        """Accelerations, shape (3, n)."""
        if self.inverse.shape[0] == 1:
            out: Array = self.inverse[0] @ force
            return out
        # Points at samples alone are the first of those that the matrix knows.
        return np.asarray(np.einsum("nij,jn->in", self.inverse[: force.shape[1]], force))


def _inertial(term: Term, state: State) -> dict[str, Any]:
    """The term's column at rest: what multiplies an acceleration."""
    bollard = term.columns(State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, place=state.place))
    # What is there without any acceleration, as a wind, is no inertia.
    columns = {k: c - bollard.get(k, 0.0) for k, c in term.columns(state).items()}
    return {k: c for k, c in columns.items() if isinstance(c, (int, float)) and c}


def acceleration(vehicle: Vehicle, h: Hypothesis, p: Points, mass: Mass | None = None) -> Array:
    """udot, vdot [m/s^2], rdot [rad/s^2] over ground, shape (3, n); ``mass`` saves its inversion where it is known."""
    u_c, v_c, a_u, a_v = water(h, p)
    u, v, r = p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2]
    values = changed(h, p.t)
    m = vehicle.hull.mass
    x_g, y_g = vehicle.hull.centre_of_gravity
    zero = np.zeros_like(r)
    state = State(u, v, r, zero, zero, zero, place=_place(p))
    right = thruster_force(vehicle, h.given, p, (u, v, r), h.declared_errors)
    for term in h.terms:
        for channel, column in term.columns(state).items():
            right[CHANNELS.index(channel)] -= column * values[term.id]
    for channel, column in rigid_body(state, m * x_g, m * y_g).items():
        right[CHANNELS.index(channel)] -= column
    for g in h.given:
        if isinstance(g.effect.acts, Force):
            for channel, value in g.effect.acts.function(state, g.values).items():
                right[CHANNELS.index(channel)] += value
    # M_RB stands on the velocity over ground: what the water's own acceleration does not move.
    right[0] -= a_u * m
    right[1] -= a_v * m
    right[2] -= a_v * (m * x_g) - a_u * (m * y_g)
    nudot = (mass or Mass(vehicle, h.terms, values)).solve(right)
    nudot[0] += r * v_c + a_u
    nudot[1] += -r * u_c + a_v
    return nudot


# Effects that are forces, thrusts or readings: they leave the masses, the water and every other force as they are.
ADDED = (Force, Thrust, Response, Inflow, Reading)


def same_given(a: Given, b: Given) -> bool:
    """Whether two are the same effect with the same numbers."""
    return a is b or (a.effect is b.effect and a.values == b.values and a.thruster == b.thruster)


def added_force(vehicle: Vehicle, h: Hypothesis, p: Points, other: Hypothesis, under: Points) -> Array | None:
    """X, Y [N], N [N m] by which another hypothesis differs at the same states, shape (3, n); None where it differs in more than forces.

    Args:
        vehicle: of both.
        h: the hypothesis.
        p: where.
        other: the other hypothesis.
        under: the same points under the other's thrusts.
    """
    if other.terms is not h.terms or other.values is not h.values or other.declared_errors is not h.declared_errors:
        return None
    gone = [g for g in h.given if not any(same_given(g, q) for q in other.given)]
    new = [g for g in other.given if not any(same_given(g, q) for q in h.given)]
    if not all(isinstance(g.effect.acts, ADDED) for g in (*gone, *new)):
        return None
    u_c, v_c, _, _ = water(h, p)
    relative = (p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2])
    found = np.zeros_like(p.nu)
    if any(isinstance(g.effect.acts, (Thrust, Response, Inflow)) for g in (*gone, *new)):
        found += thruster_force(vehicle, other.given, under, relative, other.declared_errors)
        found -= thruster_force(vehicle, h.given, p, relative, h.declared_errors)
    zero = np.zeros_like(p.psi)
    state = State(*relative, zero, zero, zero, place=_place(p))
    for sign, some in ((1.0, new), (-1.0, gone)):
        for g in some:
            if isinstance(g.effect.acts, Force):
                for channel, value in g.effect.acts.function(state, g.values).items():
                    found[CHANNELS.index(channel)] += sign * value
    return found


def term_column(vehicle: Vehicle, h: Hypothesis, mass: Mass, p: Points, nudot: Array, term: Term) -> Array:
    """How the accelerations change with one term's parameter: -M^-1 times its column at the model's own accelerations."""
    u_c, v_c, a_u, a_v = water(h, p)
    u, v, r = p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2]
    state = State(u, v, r, nudot[0] - r * v_c - a_u, nudot[1] + r * u_c - a_v, nudot[2], place=_place(p))
    force = np.zeros_like(nudot)
    for channel, column in term.columns(state).items():
        force[CHANNELS.index(channel)] = column
    return -mass.solve(force)
