"""Columns of rows: what a parameter's column is worth at a state, and what of it acceleration and velocity make."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ivsid.verification.errors import UnprovedError
from ivsid.verification.physics import Column, Motion, State, moving
from ivsid.verification.rational import Range


@dataclass(frozen=True)
class Row:
    """The left-hand side by parameter and the right-hand side [N or N m], as ranges that hold the truth."""

    matrix: dict[str, Range]
    right: Range


class Unknown:
    """An acceleration that nothing bounds: it may stand in a column that is not used, or be multiplied by exactly nothing, and nowhere else."""

    def __init__(self, name: str) -> None:
        self.name = name

    def _used(self, *_: Any) -> Unknown:
        return self

    def _times(self, other: Any) -> Unknown | Range:
        # It is finite, whatever it is.
        return Range(0) if isinstance(other, Range) and not other.magnitude else self

    __add__ = __radd__ = __sub__ = __rsub__ = __neg__ = _used
    __mul__ = __rmul__ = _times


def value(columns: Column, state: State, channel: str) -> Range:
    """A column at a state; 0 where the parameter has none in this equation."""
    column = columns(state).get(channel)
    if isinstance(column, Unknown):
        raise UnprovedError(f"{column.name} is neither measured nor bounded")
    return Range(0) if column is None else column


def in_motion(columns: Column, state: State, channel: str) -> Motion:
    """The same with its rate of change."""
    return moving(columns(state)[channel])


def share(columns: Column, derivative: str, channel: str) -> Range:
    """What one unit of an acceleration adds to a column."""
    rates = [Range(int(derivative == name)) for name in ("udot", "vdot", "rdot")]
    return value(columns, State(Range(0), Range(0), Range(0), *rates), channel)


def moves(columns: Column, channel: str) -> bool:
    """Whether velocities stand in a column, asked at two states."""
    still, here = Range(0), Range(Fraction(3, 10))
    states = [
        State(u, v, r, still, still, still, psi=here)
        for u, v, r in (tuple(Range(Fraction(x, 10)) for x in nu) for nu in ((3, 7, 11), (-9, 4, -2)))
    ]
    return any(value(columns, s, channel).magnitude for s in states)


def summed(per_step: list[Range], lengths: list[Range]) -> Range:
    """The integral of what is given by its means over steps."""
    found = Range(0)
    for mean, length in zip(per_step, lengths, strict=True):
        found = found + mean * length
    return found
