"""A column that is taken for a channel, with its stamps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ivsid.files import units
from ivsid.proposal.names import Match, Meaning, Program

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stamps:
    """The stamps of a table: their column and its unit (None for what the size of an epoch or a date says), and the times [s]."""

    column: str
    unit: str | None
    nanoseconds: str | None
    t: Array
    rows: NDArray[np.intp] | None


@dataclass(frozen=True)
class Found:
    """A column that is taken for a channel.

    Attributes:
        match: the column and its meaning.
        table: that holds it.
        t: times of its samples [s], shape (n,).
        values: cells as they are, shape (n,); NaN is a missing sample.
        stated: whether the unit stands in the name, in the header, or in the program's table.
        others: further columns that hold the same channel, which are not taken.
        unread: the unit that its header states, if it is not known: the scale is open, and one stands in its place.
    """

    match: Match
    table: str
    t: Array
    values: Array
    stated: bool
    others: tuple[str, ...] = ()
    unread: str = ""

    @property
    def program(self) -> Program:
        """The program that names columns so."""
        return self.match.program

    @property
    def meaning(self) -> Meaning:
        """Channel, unit and scale."""
        return self.match.meaning

    def with_meaning(self, **changes: object) -> Found:
        """The column with another unit or scale."""
        meaning = self.meaning.model_copy(update=changes)
        return replace(self, match=replace(self.match, meaning=meaning))

    @property
    def factor(self) -> float:
        """From a cell to SI units."""
        return self.meaning.scale * units.COLUMN.get(self.meaning.unit or "1", 1.0)


def si_unit(name: str) -> str:
    """The SI unit of a channel."""
    known = {"psi": "rad", "roll": "rad", "pitch": "rad", "r": "rad/s", "rdot": "rad/s^2", "x": "m", "y": "m"}
    if name in known:
        return known[name]
    if name.startswith(("rudder_", "azimuth_")):
        return "rad"
    return (
        "m/s"
        if name in ("u", "v", "velocity_north", "velocity_east")
        else "m/s^2"
        if name in ("ax", "ay", "udot", "vdot")
        else ""
    )
