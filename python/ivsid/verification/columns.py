"""Columns of rows: the value of a parameter's column at a state, and its parts from acceleration and from velocity."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ivsid.verification.errors import UnprovedError
from ivsid.verification.physics import Column, Motion, State, moving
from ivsid.verification.rational import Range


@dataclass(frozen=True)
class Row:
    """The left-hand side by parameter and the right-hand side [N or N m], as ranges that hold the true values."""

    matrix: dict[str, Range]
    right: Range


class Unknown:
    """An acceleration without a bound: it may stand in a column that is not used, or be multiplied by exactly 0."""

    def __init__(self, name: str) -> None:
        self.name = name

    def _used(self, *_: object) -> Unknown:
        return self

    def _times(self, other: object) -> Unknown | Range:
        # The acceleration is finite, so that 0 times it is 0.
        return Range(0) if isinstance(other, Range) and not other.magnitude else self

    __add__ = __radd__ = __sub__ = __rsub__ = __neg__ = _used
    __mul__ = __rmul__ = _times


def value(columns: Column, state: State, channel: str) -> Range:
    """A column at a state; 0 where the parameter has none in this equation.

    Raises:
        UnprovedError: the column needs an acceleration without a bound.
    """
    column = columns(state).get(channel)
    if isinstance(column, Unknown):
        raise UnprovedError(f"{column.name} is neither measured nor bounded")
    return Range(0) if column is None else column


def in_motion(columns: Column, state: State, channel: str) -> Motion:
    """A column at a state with its rate of change."""
    return moving(columns(state)[channel])


def share(columns: Column, derivative: str, channel: str) -> Range:
    """The coefficient of an acceleration in a column."""
    rates = [Range(int(derivative == name)) for name in ("udot", "vdot", "rdot")]
    return value(columns, State(Range(0), Range(0), Range(0), *rates), channel)


def moves(columns: Column, channel: str) -> bool:
    """Whether a column depends on velocities, asked at two states without acceleration."""
    zero, here = Range(0), Range(Fraction(3, 10))
    states = [
        State(u, v, r, zero, zero, zero, psi=here)
        for u, v, r in (tuple(Range(Fraction(x, 10)) for x in nu) for nu in ((3, 7, 11), (-9, 4, -2)))
    ]
    return any(value(columns, s, channel).magnitude for s in states)


def summed(per_step: list[Range], lengths: list[Range]) -> Range:
    """The integral of a quantity from its means over steps of the given lengths [s]."""
    found = Range(0)
    for mean, length in zip(per_step, lengths, strict=True):
        found = found + mean * length
    return found
