"""The shape of a physical bound: inequalities that are linear in the parameters of a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, Place, State, Term, rigid_body
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.vehicle import Vehicle

# Lower and upper end of each parameter, by id; equal ends where the numbers are known.
Box: TypeAlias = Mapping[str, tuple[float, float]]
# The names of the accelerations of the three equations, in their order.
ACCELERATIONS: Final = ("udot", "vdot", "rdot")
_SOMEWHERE: Final = Place(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Subject:
    """A model of a vessel, and the velocities at which it was seen.

    Attributes:
        vehicle: with its hull.
        terms: of the model.
        velocities: intervals of u, v [m/s] and r [rad/s], shape (k,) each.
        time: of the velocities [s], shape (k,).
        known_mass: rigid-body mass that the parameters leave out [kg].
    """

    vehicle: Vehicle
    terms: tuple[Term, ...]
    velocities: tuple[IntervalArray, IntervalArray, IntervalArray]
    time: FloatArray
    known_mass: float = 0.0

    def inertia(self) -> tuple[FloatArray, FloatArray]:
        """The known part of the inertia matrix, shape (3, 3), and that of one unit of each parameter, shape (terms, 3, 3)."""
        x_g, y_g = self.vehicle.hull.centre_of_gravity
        mx, my = self.vehicle.hull.mass * x_g, self.vehicle.hull.mass * y_g
        known, units = np.zeros((3, 3)), np.zeros((len(self.terms), 3, 3))
        rest = State(*np.zeros(6).tolist(), place=_SOMEWHERE)
        for j, moved in enumerate(np.eye(3).tolist()):
            state = State(0.0, 0.0, 0.0, *moved, place=_SOMEWHERE)
            for channel, column in rigid_body(state, mx, my, self.known_mass).items():
                known[CHANNELS.index(channel), j] += float(column)
            for k, term in enumerate(self.terms):
                still = term.columns(rest)
                for channel, column in term.columns(state).items():
                    units[k, CHANNELS.index(channel), j] += float(column) - float(still.get(channel, 0.0))
        return known, units

    def enclosed_inertia(self) -> tuple[IntervalArray, IntervalArray]:
        """``inertia`` with every number of the file as the decimal that it is, and every operation rounded outward."""
        hull = self.vehicle.hull
        x_g, y_g = (_decimal(x) for x in hull.centre_of_gravity)
        mass, known_mass = _decimal(hull.mass), _decimal(self.known_mass)
        zero, moved = IntervalArray(np.zeros(3)), [IntervalArray(row) for row in np.eye(3)]
        place = Place(zero, zero, zero, zero, zero, zero)
        rest, state = State(*[zero] * 6, place=place), State(zero, zero, zero, *moved, place=place)
        # Column j of each matrix is the state in which the acceleration j alone is 1.
        known = IntervalArray(np.zeros((3, 3)))
        for number, one in zip((mass * x_g, mass * y_g, known_mass), np.eye(3).tolist(), strict=True):
            known = known + _rows(rigid_body(state, *one), zero) * number
        units = [_rows(t.columns(state), zero) - _rows(t.columns(rest), zero) for t in self.terms]
        return known, IntervalArray.stack(units)


def _decimal(x: float) -> IntervalArray:
    """A number of a file, shape (): its decimal lies between the neighbours of its double, and 0 is exact."""
    return IntervalArray(np.nextafter(x, -np.inf), np.nextafter(x, np.inf)) if x else IntervalArray(0.0)


def _rows(columns: Mapping[str, IntervalArray | float], zero: IntervalArray) -> IntervalArray:
    """The entries of the three equations below one another, of the shape of ``zero`` each."""
    return IntervalArray.stack([zero + columns.get(c, zero) for c in CHANNELS])


@dataclass(frozen=True)
class Inequalities:
    """``matrix @ theta >= least``, a row each.

    Attributes:
        kind: of the rows: the bound that they state.
        matrix: shape (m, terms).
        least: shape (m,).
        channel: index into ("surge", "sway", "yaw"), shape (m,).
        time: at which each was seen [s], shape (m,).
        words: from a row and the most that the left-hand side reaches to a sentence that says what contradicts it.
    """

    kind: str
    matrix: IntervalArray
    least: FloatArray
    channel: NDArray[np.int64]
    time: FloatArray
    words: Callable[[int, float], str]

    def reached(self, ids: tuple[str, ...], box: Box) -> FloatArray:
        """The most that each left-hand side reaches in a box of the parameters, rounded up, shape (m,)."""
        ends = np.array([box[i] for i in ids], dtype=np.float64).reshape(len(ids), 2)
        values = IntervalArray(ends[:, 0], ends[:, 1])
        total = IntervalArray(np.zeros(self.least.shape))
        for j in range(len(ids)):
            total = total + self.matrix[:, j] * values[j]
        return total.upper
