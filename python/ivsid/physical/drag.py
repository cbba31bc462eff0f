"""Drag: water takes energy from a vessel that moves through it, at every velocity, whatever the single coefficients are.

A motion along one axis alone is opposed by the drags of that axis together: linear, quadratic and cubic terms may make up for one another inside the
range of the velocities that were seen, and for no others. The power of all axes together is not positive either.

Terms that only turn energy from one axis to another, as a lift or a Munk moment, are no drags. Neither are those whose sign depends on the vessel.

Source: Fossen 2011, property 6.4 (D(nu) is positive for a body that moves through a fluid).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, EFFECTS, Place, State, Term
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.memory.order import places
from ivsid.memory.pieces import pieces
from ivsid.physical.bound import Box, Inequalities, Subject

KIND: Final = "physical.drag"
POWER: Final = "physical.power"
# Velocities of each axis, and states, that a bound takes, evenly spaced by their size or their time: neighbours say the same.
# Source: resource: rows of a regression, each of which is one more in every linear program
SPACED: Final = 40
_NAMES: Final = (("u", "m/s", "N"), ("v", "m/s", "N"), ("r", "rad/s", "N m"))
# Two states at which a term shows whether it is a drag.
# Source: definition: no axis at rest, and no two products of velocities alike
_PROBES: Final = ((0.7, 0.3, 0.2), (-0.4, 0.5, -0.9))


def sentence(subject: Subject) -> str:
    """The bound as an assumption."""
    names = ", ".join(t.id for t in subject.terms if is_drag(t)) or "none in this model"
    return f"drags ({names}) oppose a motion along one axis alone, all together, at each velocity of the log whose sign is certain"


def is_drag(term: Term) -> bool:
    """Whether a term only takes energy: no inertia, no sign of its own, and as much of it ahead as astern."""
    effect = EFFECTS.get(term.id)
    if effect is None or any(p.signed for p in effect.parameters):
        return False
    rest = [0.0] * 3
    if any(term.columns(_state(*rest, *unit)) != term.columns(_state(*rest, *rest)) for unit in np.eye(3).tolist()):
        return False
    powers = [(_power(term, nu), _power(term, tuple(-x for x in nu))) for nu in _PROBES]
    return all(there + back > 0 for there, back in powers)


def _state(*numbers: float) -> State:
    return State(*numbers, place=Place(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def _power(term: Term, nu: tuple[float, ...]) -> float:
    columns = term.columns(_state(*nu, 0.0, 0.0, 0.0))
    return sum(float(columns.get(c, 0.0)) * x for c, x in zip(CHANNELS, nu, strict=True))


def inequalities(subject: Subject, _box: Box | None = None) -> tuple[Inequalities, ...]:
    """A row for each axis and velocity, and for each state as a whole."""
    drags = [is_drag(t) for t in subject.terms]
    if not any(drags):
        return ()
    parts = [_along(subject, drags, axis) for axis in range(3)]
    rows = [p for p in parts if p[1].size]
    made = []
    if rows:
        matrix = IntervalArray.concatenate([p[0] for p in rows])
        channel = np.concatenate([np.full(p[1].size, p[3]) for p in rows]).astype(np.int64)
        speed, time = np.concatenate([p[1] for p in rows]), np.concatenate([p[2] for p in rows])

        def words(row: int, reached: float) -> str:
            name, unit, force = _NAMES[channel[row]]
            return (
                f"the drags in {CHANNELS[channel[row]]} drive: at {name} = {speed[row]:.3g} {unit} alone they push along the motion with "
                f"{-reached:.3g} {force} or more"
            )

        made.append(Inequalities(KIND, matrix, np.zeros(channel.size), channel, time, words))
    made.append(_whole(subject, drags))
    return tuple(made)


def _along(subject: Subject, drags: list[bool], axis: int) -> tuple[IntervalArray, FloatArray, FloatArray, int]:
    """Opposing force of one unit of each term at velocities of one axis alone, their middles, times, and the axis."""
    x = subject.velocities[axis]

    def certain(rows: slice) -> NDArray[np.bool_]:
        low, high = x.lower[rows], x.upper[rows]
        return ((low > 0) | (high < 0)) & np.isfinite(low) & np.isfinite(high)

    def size(rows: slice) -> FloatArray:
        there = certain(rows)
        both = np.where(there, x.lower[rows], 0.0) + np.where(there, x.upper[rows], 0.0)
        return np.where(there, both, np.inf)

    n = x.shape[0]
    count = sum(int(np.count_nonzero(certain(p))) for p in pieces(n))
    chosen = np.unique(places(n, size, _spaced(count)))
    here, zero = x[chosen], IntervalArray(np.zeros(chosen.size))
    u, v, r = (here if k == axis else zero for k in range(3))
    state = State(u, v, r, zero, zero, zero, place=_at_rest(zero))
    ahead = here.lower > 0
    columns = []
    for term, drag in zip(subject.terms, drags, strict=True):
        column = term.columns(state).get(CHANNELS[axis], zero) if drag else zero
        lower, upper = np.broadcast_to(column.lower, ahead.shape), np.broadcast_to(column.upper, ahead.shape)
        columns.append(IntervalArray(np.where(ahead, lower, -upper), np.where(ahead, upper, -lower)))
    matrix = IntervalArray.stack(columns, axis=1)
    # A velocity at which no term acts says nothing.
    acts = (matrix.upper > 0).any(axis=1)
    return matrix[np.flatnonzero(acts)], here.midpoint[acts], subject.time[chosen][acts], axis


def _whole(subject: Subject, drags: list[bool]) -> Inequalities:
    """Power that one unit of each term takes at states as a whole."""

    def known(rows: slice) -> NDArray[np.bool_]:
        there = [np.isfinite(x.lower[rows]) & np.isfinite(x.upper[rows]) for x in subject.velocities]
        return np.asarray(np.all(there, axis=0))

    n = subject.time.size
    count = sum(int(np.count_nonzero(known(p))) for p in pieces(n))
    chosen = np.unique(places(n, lambda rows: np.where(known(rows), 0.0, 1.0), _spaced(count)))
    zero = IntervalArray(np.zeros(chosen.size))
    nu = u, v, r = [x[chosen] for x in subject.velocities]
    state = State(u, v, r, zero, zero, zero, place=_at_rest(zero))
    columns = []
    for term, drag in zip(subject.terms, drags, strict=True):
        power = zero
        for channel, column in term.columns(state).items() if drag else ():
            power = power + column * nu[CHANNELS.index(channel)]
        columns.append(power)
    time = subject.time[chosen]

    def words(row: int, reached: float) -> str:
        return f"the drags drive: at t = {time[row]:.6g} s they give the vessel {-reached:.3g} W or more"

    return Inequalities(
        POWER,
        IntervalArray.stack(columns, axis=1),
        np.zeros(chosen.size),
        np.zeros(chosen.size, dtype=np.int64),
        time,
        words,
    )


def _spaced(count: int) -> list[int]:
    """Evenly spaced ranks among ``count``."""
    ranks: list[int] = np.linspace(0, max(count - 1, 0), min(SPACED, count)).astype(int).tolist()
    return ranks


def _at_rest(zero: IntervalArray) -> Place:
    return Place(zero, zero, zero, zero, zero, zero)
