"""What a term is. Columns are written with operators alone, so floats, NumPy arrays and intervals all serve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final, TypeAlias

CHANNELS: Final = ("surge", "sway", "yaw")
Columns: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class State:
    """Velocities u, v [m/s], r [rad/s] and their time derivatives, all of one kind and shape.

    ``ax`` and ``ay`` are the specific forces udot - v r and vdot + u r [m/s^2]. Where an accelerometer measures them they
    are given, else they follow; a term that means them asks for them and not for their parts.
    """

    u: Any
    v: Any
    r: Any
    udot: Any
    vdot: Any
    rdot: Any
    ax: Any = field(default=None)
    ay: Any = field(default=None)

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
    """

    id: str
    symbol: str
    unit: str
    columns: Callable[[State], Columns]


def signed_square(x: Any) -> Any:
    """``x |x|``; tight for intervals that hold both signs."""
    return x.signed_square() if hasattr(x, "signed_square") else x * abs(x)


def square(x: Any) -> Any:
    """``x^2``; tight for intervals that hold both signs."""
    return x.square() if hasattr(x, "square") else x * x
