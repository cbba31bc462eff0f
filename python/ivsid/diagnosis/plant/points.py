"""States of a vehicle at many moments, with all that acts there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Place
from ivsid.effects.environment import earth_to_body

Array = NDArray[np.float64]


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
        force: known X, Y [N], N [N m] beside the thrusters, shape (3, n).
        wind: the air's velocity north and east [m/s], shape (2, n), or None.
        rudders: angles of rudders [rad], shape (thrusters, n), or None.
        bollard: sum of ``force`` and of the thrusts at no speed, X, Y [N], N [N m], shape (3, n), if it is known; it does not depend on the states.
    """

    nu: Array
    psi: Array
    place: Array
    t: Array
    thrusts: Array
    angles: Array
    force: Array
    wind: Array | None = None
    rudders: Array | None = None
    bollard: Array | None = None

    def moved(self, shift: Array) -> Points:
        """At other velocities."""
        return replace(self, nu=self.nu + shift)

    def under(self, thrusts: Array, bollard: Array | None = None) -> Points:
        """With other thrusts, and their sum at no speed."""
        return replace(self, thrusts=thrusts, bollard=bollard)


def place_of(p: Points) -> Place:
    """Heading, place, clock and wind as the catalogue's formulas take them; the wind is relative to the hull."""
    if p.wind is None:
        return Place(p.psi, p.place[0], p.place[1], p.t)
    blows = earth_to_body(Place(p.psi, None, None, None), p.wind[0], p.wind[1])
    return Place(p.psi, p.place[0], p.place[1], p.t, blows[0] - p.nu[0], blows[1] - p.nu[1])
