"""Accelerations of a hypothesis at given states: Fossen's equations in three degrees of freedom, for whole arrays.

Source: Fossen 2011, with the terms and effects of the catalogue (docs/theory.md, "The catalogue of effects").
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.points import Points, place_of
from ivsid.diagnosis.plant.thruster_forces import ThrusterForces, thruster_force
from ivsid.effects import (
    CHANNELS,
    Change,
    Current,
    Force,
    Given,
    Place,
    State,
    Term,
    acting,
    rigid_body,
)
from ivsid.effects.environment import earth_to_body
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
Number: TypeAlias = float | Array


@dataclass(frozen=True)
class Hypothesis:
    """A model with numbers.

    Attributes:
        terms: linear in one parameter each.
        values: of the terms' parameters, by id, in their units.
        given: effects that are no terms, with their numbers.
        declared_errors: sizes of the errors that the vehicle file declares, by name, in units of their bounds.
        freed: claimed parameters that are fitted after all, since the log contradicts the claim.
    """

    terms: tuple[Term, ...]
    values: Mapping[str, float]
    given: tuple[Given, ...] = ()
    declared_errors: Mapping[str, float] = field(default_factory=dict)
    freed: frozenset[str] = frozenset()

    def with_effect(self, given: Given) -> Hypothesis:
        """With one more effect, or with other numbers for one that it has."""
        others = tuple(g for g in self.given if (g.effect.id, g.thruster) != (given.effect.id, given.thruster))
        return replace(self, given=(*others, given))

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers of terms and effects, by name."""
        return {**self.values, **{name: x for g in self.given for name, x in g.named.items()}}

    def without(self, id_: str, plain: Hypothesis) -> Hypothesis:
        """Without a cause: a claim that was given up stands again, and every term of ``plain`` stays.

        Args:
            id_: of the cause.
            plain: the model of the vehicle file.
        """
        if id_ in self.freed:
            return replace(self, values={**self.values, id_: plain.values[id_]}, freed=self.freed - {id_})
        ids = {t.id for t in plain.terms}
        terms = tuple(t for t in self.terms if t.id in ids or (t.id != id_ and not t.id.startswith(f"{id_}.")))
        given = tuple(g for g in self.given if g.effect.id != id_)
        return replace(self, terms=terms, values={t.id: self.values[t.id] for t in terms}, given=given)


def water(h: Hypothesis, p: Points) -> tuple[Number, Number, Number, Number]:
    """The water's velocity in body axes [m/s], and its rate of change in body axes apart from turning [m/s^2], along x and y each."""
    total: list[Number] = [0.0, 0.0, 0.0, 0.0]
    for current, numbers in acting(h.given, Current):
        total = [a + b for a, b in zip(total, current.function(numbers, p.t), strict=True)]
    if all(isinstance(q, float) and q == 0.0 for q in total):
        return 0.0, 0.0, 0.0, 0.0
    here = Place(p.heading, None, None, None)
    u, v = earth_to_body(here, total[0], total[1])
    if all(isinstance(q, float) and q == 0.0 for q in total[2:]):
        return u, v, 0.0, 0.0
    return u, v, *earth_to_body(here, total[2], total[3])


def changed(h: Hypothesis, t: Array) -> dict[str, Number]:
    """The values of the terms by id, of which effects may change some in time, shape (n,)."""
    values: dict[str, Number] = dict(h.values)
    for change, numbers in acting(h.given, Change):
        values.update(change.function(values, numbers, t))
    return values


class Mass:
    """The mass matrix of a hypothesis, constant or in time.

    Attributes:
        inverse: of the matrix, shape (1, 3, 3) or (n, 3, 3).
    """

    def __init__(self, vehicle: Vehicle, terms: Sequence[Term], values: Mapping[str, Number]) -> None:
        m = vehicle.hull.mass
        x_g, y_g = vehicle.hull.centre_of_gravity
        columns = []
        for unit in np.eye(3).tolist():
            state = State(0.0, 0.0, 0.0, *unit, place=Place(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
            total: dict[str, Number] = rigid_body(state, m * x_g, m * y_g)
            for term in terms:
                for channel, column in _inertial(term, state).items():
                    total[channel] = column * values[term.id] + total.get(channel, 0.0)
            columns.append([total.get(c, 0.0) for c in CHANNELS])
        # Cramer's rule for all moments at once: LAPACK takes ten times as long for many small matrices.
        cofactors = [[_cofactor(columns, j, i) for j in range(3)] for i in range(3)]
        determinant = np.asarray(sum(columns[j][0] * cofactors[0][j] for j in range(3)))
        if not determinant.all():
            raise np.linalg.LinAlgError("Singular matrix")
        n = max(np.size(q) for row in cofactors for q in row)
        self.inverse: Array = np.empty((n, 3, 3))
        for i in range(3):
            for j in range(3):
                self.inverse[:, j, i] = cofactors[i][j] / determinant

    def solve(self, force: Array) -> Array:
        """Accelerations udot, vdot [m/s^2], rdot [rad/s^2] of a force X, Y [N], N [N m], shape (3, n) each."""
        if self.inverse.shape[0] == 1:
            out: Array = self.inverse[0] @ force
            return out
        # A force at samples alone belongs to the first matrices: samples come before steps.
        return np.asarray(np.einsum("nij,jn->in", self.inverse[: force.shape[1]], force))


def _cofactor(m: Sequence[Sequence[Number]], i: int, j: int) -> Number:
    """The cofactor of an entry of a matrix of three rows."""
    a, b = (i + 1) % 3, (i + 2) % 3
    c, d = (j + 1) % 3, (j + 2) % 3
    return m[a][c] * m[b][d] - m[a][d] * m[b][c]


def _inertial(term: Term, state: State) -> dict[str, float]:
    """Coefficients of the accelerations in a term's column, at rest."""
    at_rest = term.columns(State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, place=state.place))
    # A column that is there without any acceleration, as a wind's, is no inertia.
    columns = {k: c - at_rest.get(k, 0.0) for k, c in term.columns(state).items()}
    return {k: c for k, c in columns.items() if isinstance(c, (int, float)) and c}


class Dynamics:
    """The equations of motion of a hypothesis, with all that does not depend on the states worked out once.

    Args:
        vehicle: of the hypothesis.
        h: the hypothesis.
        mass: its mass matrix, if it is known already.
    """

    def __init__(self, vehicle: Vehicle, h: Hypothesis, mass: Mass | None = None) -> None:
        self.vehicle, self.h = vehicle, h
        # Masses that change in time are inverted at each state.
        self._mass = mass if mass or acting(h.given, Change) else Mass(vehicle, h.terms, h.values)
        self._thrust = ThrusterForces(vehicle, h.given, h.declared_errors)
        self._forces = acting(h.given, Force)
        self._moving = bool(acting(h.given, Current))

    def acceleration(self, p: Points) -> Array:
        """udot, vdot [m/s^2], rdot [rad/s^2] over ground at some states, shape (3, n)."""
        h, (u, v, r) = self.h, p.nu
        m = self.vehicle.hull.mass
        x_g, y_g = self.vehicle.hull.centre_of_gravity
        if self._moving:
            u_c, v_c, a_u, a_v = water(h, p)
            u, v = u - u_c, v - v_c
        values = changed(h, p.t)
        state = State(u, v, r, 0.0, 0.0, 0.0, place=place_of(p))
        right = self._thrust.at(p, (u, v, r))
        rows = dict(zip(CHANNELS, right, strict=True))
        for term in h.terms:
            for channel, column in term.columns(state).items():
                # What is proportional to an acceleration is none here.
                if not isinstance(column, float) or column:
                    rows[channel] -= column * values[term.id]
        for channel, column in rigid_body(state, m * x_g, m * y_g).items():
            rows[channel] -= column
        for force, numbers in self._forces:
            for channel, value in force.function(state, numbers).items():
                rows[channel] += value
        mass = self._mass or Mass(self.vehicle, h.terms, values)
        if not self._moving:
            return mass.solve(right)
        # The rigid body's mass acts on the acceleration over ground, of which the water's own is a part.
        right[0] -= a_u * m
        right[1] -= a_v * m
        right[2] -= a_v * (m * x_g) - a_u * (m * y_g)
        nudot = mass.solve(right)
        nudot[0] += r * v_c + a_u
        nudot[1] += -r * u_c + a_v
        return nudot


def acceleration(vehicle: Vehicle, h: Hypothesis, p: Points, mass: Mass | None = None) -> Array:
    """udot, vdot [m/s^2], rdot [rad/s^2] over ground, shape (3, n).

    Args:
        vehicle: of the hypothesis.
        h: the hypothesis.
        p: states.
        mass: its mass matrix, if it is known already.
    """
    return Dynamics(vehicle, h, mass).acceleration(p)


def same_given(a: Given, b: Given) -> bool:
    """Whether two effects are the same, with the same numbers."""
    return a is b or (a.effect is b.effect and a.values == b.values and a.thruster == b.thruster)


def added_force(vehicle: Vehicle, h: Hypothesis, p: Points, other: Hypothesis, under: Points) -> Array | None:
    """X, Y [N], N [N m] that another hypothesis adds at the same states, shape (3, n); None if the two differ in more than forces.

    Args:
        vehicle: of both.
        h: the hypothesis.
        p: states and its thrusts.
        other: the other hypothesis.
        under: the same states under the other's thrusts.
    """
    if other.terms is not h.terms or other.values is not h.values or other.declared_errors is not h.declared_errors:
        return None
    gone = [g for g in h.given if not any(same_given(g, q) for q in other.given)]
    new = [g for g in other.given if not any(same_given(g, q) for q in h.given)]
    if not all(g.effect.acts.additive for g in (*gone, *new)):
        return None
    u_c, v_c, _, _ = water(h, p)
    relative = (p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2])
    found = np.zeros_like(p.nu)
    if any(g.effect.acts.at_thruster for g in (*gone, *new)):
        found += thruster_force(vehicle, other.given, under, relative, other.declared_errors)
        found -= thruster_force(vehicle, h.given, p, relative, h.declared_errors)
    zero = np.zeros_like(p.psi)
    state = State(*relative, zero, zero, zero, place=place_of(p))
    for sign, some in ((1.0, new), (-1.0, gone)):
        for force, numbers in acting(some, Force):
            for channel, value in force.function(state, numbers).items():
                found[CHANNELS.index(channel)] += sign * value
    return found


def term_column(vehicle: Vehicle, h: Hypothesis, mass: Mass, p: Points, nudot: Array, term: Term) -> Array:
    """Slope of the accelerations with one term's parameter, shape (3, n): -M^-1 times its column.

    Args:
        vehicle: of the hypothesis.
        h: the hypothesis.
        mass: its mass matrix.
        p: states.
        nudot: the model's own accelerations there, shape (3, n), at which the column is evaluated.
        term: whose parameter changes.
    """
    u_c, v_c, a_u, a_v = water(h, p)
    u, v, r = p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2]
    state = State(u, v, r, nudot[0] - r * v_c - a_u, nudot[1] + r * u_c - a_v, nudot[2], place=place_of(p))
    force = np.zeros_like(nudot)
    for channel, column in term.columns(state).items():
        force[CHANNELS.index(channel)] = column
    return -mass.solve(force)
