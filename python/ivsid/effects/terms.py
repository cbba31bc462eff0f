"""Terms: one parameter each, with its columns in the equations of motion.

Columns are written with operators and ``functions`` alone, so that floats, NumPy arrays, intervals and symbols all serve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple, Self, TypeAlias

from ivsid.effects.quantity import Quantity

CHANNELS: Final = ("surge", "sway", "yaw")
# Forces [N], moments [N m] or columns by channel; a channel that is left out is 0.
Columns: TypeAlias = dict[str, Quantity]


@dataclass(frozen=True)
class Place:
    """Pose, time and wind, for terms that depend on more than the velocities.

    Attributes:
        psi: heading [rad].
        x: position north [m].
        y: position east [m].
        t: time of the log [s].
        wind_surge: apparent wind in body axes, ahead [m/s]: the air's velocity relative to the vehicle; None if unknown.
        wind_sway: the same to starboard [m/s].
    """

    psi: Quantity
    x: Quantity
    y: Quantity
    t: Quantity
    wind_surge: Quantity = None
    wind_sway: Quantity = None


class _Quantities(NamedTuple):
    """The quantities of a ``State``, all given."""

    u: Quantity
    v: Quantity
    r: Quantity
    udot: Quantity
    vdot: Quantity
    rdot: Quantity
    ax: Quantity
    ay: Quantity
    place: Place | None


class State(_Quantities):
    """Velocities u, v [m/s], r [rad/s] and their time derivatives, all of one kind and shape.

    In a current, velocities and derivatives are those relative to the water: Fossen's equations hold in them unchanged as long as
    the current is steady.

    Attributes:
        u: velocity ahead [m/s].
        v: velocity to starboard [m/s].
        r: yaw rate [rad/s].
        udot: rate of u [m/s^2].
        vdot: rate of v [m/s^2].
        rdot: rate of r [rad/s^2].
        ax: specific force udot - v r [m/s^2]. It is given where an accelerometer measures it and follows from the others
            elsewhere; a term that means the specific force uses ax and not its parts.
        ay: specific force vdot + u r [m/s^2], as ax.
        place: for terms that depend on pose, time or wind.
    """

    __slots__ = ()

    def __new__(
        cls,
        u: Quantity,
        v: Quantity,
        r: Quantity,
        udot: Quantity,
        vdot: Quantity,
        rdot: Quantity,
        ax: Quantity = None,
        ay: Quantity = None,
        *,
        place: Place | None = None,
    ) -> Self:
        """The state with its specific forces."""
        along = udot - v * r if ax is None else ax
        across = vdot + u * r if ay is None else ay
        return super().__new__(cls, u, v, r, udot, vdot, rdot, along, across, place)

    def __getnewargs_ex__(self) -> tuple[tuple[Quantity, ...], dict[str, Place | None]]:
        """Arguments of a copy: ``place`` is given by its name."""
        return tuple(self[:8]), {"place": self.place}


@dataclass(frozen=True)
class Term:
    """One parameter and its column in each channel that it acts in.

    Attributes:
        id: the catalogue's id, as ``drag.surge.linear``.
        symbol: in SNAME notation.
        unit: of the parameter.
        columns: from a state to the left-hand side columns by channel.
        of_hull: for a term along the hull: from the hull's length [m] to the columns; None for all others.
    """

    id: str
    symbol: str
    unit: str
    columns: Callable[[State], Columns]
    of_hull: Callable[[float], Callable[[State], Columns]] | None = None
