"""What a term is. Columns are written with operators and ``functions`` alone, so floats, NumPy arrays and intervals all serve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

from ivsid.effects.functions import signed_square, square

__all__ = ["CHANNELS", "Columns", "Place", "State", "Term", "signed_square", "square"]

CHANNELS: Final = ("surge", "sway", "yaw")
Columns: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Place:
    """Where and when: heading [rad], position north and east [m], time of the log [s], and what blows.

    ``wind_surge`` and ``wind_sway`` are the apparent wind in body axes [m/s]: the air's velocity relative to the vehicle; None
    where no wind is known.
    """

    psi: Any
    x: Any
    y: Any
    t: Any
    wind_surge: Any = None
    wind_sway: Any = None


@dataclass(frozen=True)
class State:
    """Velocities u, v [m/s], r [rad/s] and their time derivatives, all of one kind and shape.

    In a current, velocities and derivatives are those relative to the water (Fossen's equations hold in them as they stand as
    long as the current is steady). ``ax`` and ``ay`` are the specific forces udot - v r and vdot + u r [m/s^2]. Where an
    accelerometer measures them they are given, else they follow; a term that means them asks for them and not for their parts.
    ``place`` is given to the terms that depend on more than the velocities.
    """

    u: Any
    v: Any
    r: Any
    udot: Any
    vdot: Any
    rdot: Any
    ax: Any = field(default=None)
    ay: Any = field(default=None)
    place: Place | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if self.ax is None:
            object.__setattr__(self, "ax", self.udot - self.v * self.r)
        if self.ay is None:
            object.__setattr__(self, "ay", self.vdot + self.u * self.r)


@dataclass(frozen=True)
class Term:
    """One parameter and its column in each channel that it acts in.

    Attributes:
        id: as in EFFECTS.md.
        symbol: in SNAME notation.
        unit: of the parameter.
        columns: from a state to the left-hand side columns by channel.
        of_hull: for a term that needs the hull's length [m]: from the length to the columns.
    """

    id: str
    symbol: str
    unit: str
    columns: Callable[[State], Columns]
    of_hull: Callable[[float], Callable[[State], Columns]] | None = None
