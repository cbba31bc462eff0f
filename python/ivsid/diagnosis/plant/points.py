"""States of a vehicle at many moments, with all that acts there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Place
from ivsid.effects.environment import earth_to_body

Array = NDArray[np.float64]


class Heading:
    """A heading whose cosine and sine are worked out once; hypotheses and shifted velocities share it."""

    def __init__(self, psi: Array) -> None:
        self.psi = psi
        self._cos: Array | None = None
        self._sin: Array | None = None

    def cos(self) -> Array:
        """Cosine, shape (n,)."""
        if self._cos is None:
            self._cos = np.cos(self.psi)
        return self._cos

    def sin(self) -> Array:
        """Sine, shape (n,)."""
        if self._sin is None:
            self._sin = np.sin(self.psi)
        return self._sin


# Stands for the heading until it is known.
NOWHERE: Final = Heading(np.zeros(0))


@dataclass(frozen=True)
class Points:
    """States at which accelerations are asked for, with all that acts there.

    Attributes:
        nu: u, v [m/s], r [rad/s], shape (3, n).
        psi: heading [rad], shape (n,).
        place: north and east [m], shape (2, n).
        t: clock of the effects [s], shape (n,).
        thrusts: at no speed [N], shape (thrusters, n).
        angles: of azimuth thrusters [rad], shape (thrusters, n).
        wind: the air's velocity north and east [m/s], shape (2, n), or None.
        rudders: angles of rudders [rad], shape (thrusters, n), or None.
        bollard: sum of the thrusts at no speed, X, Y [N], N [N m], shape (3, n), if it is known; it does not depend on the states.
        swing: cosines and sines of ``angles``, if they are known, shape (thrusters, n) each.
        heading: ``psi`` with its cosine and sine.
    """

    nu: Array
    psi: Array
    place: Array
    t: Array
    thrusts: Array
    angles: Array
    wind: Array | None = None
    rudders: Array | None = None
    bollard: Array | None = None
    swing: tuple[Array, Array] | None = None
    heading: Heading = field(default=NOWHERE, repr=False)

    def __post_init__(self) -> None:
        """Keeps the heading of the points of which these are a copy."""
        if self.heading.psi is not self.psi:
            object.__setattr__(self, "heading", Heading(self.psi))

    def moved(self, shift: Array, turn: Array | None = None) -> Points:
        """At other velocities, and on other headings if ``turn`` is given."""
        moved = replace(self, nu=self.nu + shift)
        return moved if turn is None else replace(moved, psi=self.psi + turn)

    def under(self, thrusts: Array, bollard: Array | None = None) -> Points:
        """With other thrusts, and their sum at no speed."""
        return replace(self, thrusts=thrusts, bollard=bollard)


def place_of(p: Points) -> Place:
    """Heading, place, clock and wind as the catalogue's formulas take them; the wind is relative to the hull."""
    if p.wind is None:
        return Place(p.psi, p.place[0], p.place[1], p.t)
    blows = earth_to_body(Place(p.heading, None, None, None), p.wind[0], p.wind[1])
    return Place(p.psi, p.place[0], p.place[1], p.t, blows[0] - p.nu[0], blows[1] - p.nu[1])
