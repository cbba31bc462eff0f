"""Motion inside a step of the clock: accelerations at its two points of Gauss, which give its mean and its first moment to the fourth order.

The middle of a step alone gives them to the second order. Where a light vessel forgets a tenth of its velocity in a step, what that leaves after each
change of the demands stands out of good sensors.

Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, 2nd edition, 1993, section II.7 (collocation).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.points import Points

Array = NDArray[np.float64]
# Places of the two points, in steps.
PLACES: Final = (0.5 - 3.0**0.5 / 6.0, 0.5 + 3.0**0.5 / 6.0)


@dataclass(frozen=True)
class InsideSteps:
    """Accelerations inside the steps.

    Attributes:
        first: at the first point of each step [m/s^2, rad/s^2], shape (3, n).
        second: at the second.
        early: what thrusts that change inside the steps add to the moment, in half steps [m/s^2, rad/s^2], shape (3, n), or 0.
    """

    first: Array
    second: Array
    early: Array | float = 0.0

    @property
    def mean(self) -> Array:
        """Mean acceleration over each step, shape (3, n)."""
        return np.asarray(0.5 * (self.first + self.second))

    @property
    def moment(self) -> Array:
        """Mean of the rest of the step times the acceleration beyond its mean, in steps, shape (3, n): positive for one that comes early."""
        return np.asarray(3.0**0.5 / 12.0 * (self.first - self.second) + 0.5 * self.early)

    def until(self, place: float) -> Array:
        """The acceleration's integral from the start of a step to a place in it, in steps, shape (3, n)."""
        one, two = PLACES
        half = 0.5 * place * place
        return np.asarray(((two * place - half) * self.first + (half - one * place) * self.second) / (two - one))


def doubled(p: Points, nu: Array, psi: Array, t: Array) -> Points:
    """What acts over the steps, at two states in each, shape (..., 2 n).

    Args:
        p: states at samples and over steps.
        nu: the states, shape (3, 2 n).
        psi: headings there, shape (2 n,).
        t: clock there, shape (2 n,).
    """
    n = p.psi.size // 2

    def held(x: Array) -> Array:
        return np.concatenate([x[..., n:], x[..., n:]], axis=-1)

    def known(x: Array | None) -> Array | None:
        return None if x is None else held(x)

    swing = None if p.swing is None else (held(p.swing[0]), held(p.swing[1]))
    return replace(
        p,
        nu=nu,
        psi=psi,
        place=held(p.place),
        t=t,
        thrusts=held(p.thrusts),
        angles=held(p.angles),
        force=held(p.force),
        wind=known(p.wind),
        rudders=known(p.rudders),
        bollard=known(p.bollard),
        swing=swing,
    )
