"""Motion inside a step of the clock: accelerations at a few places, which give its mean and its first moment.

The middle of a step alone gives them to the second order. Where a light vessel forgets a tenth of its velocity in a step, what that leaves after each
change of the demands stands out of good sensors. Two points of Gauss give them to the fourth order; where the log has demands inside the steps, the
middles of their parts stand for the parts.

Source: Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, 2nd edition, 1993, section II.7 (collocation).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.between import Between
from ivsid.diagnosis.plant.driving import Inside
from ivsid.diagnosis.plant.points import Points

Array = NDArray[np.float64]
# Places of the two points of Gauss, in steps.
# Source: theorem: zeros of Legendre's polynomial of degree two (Hairer, Nørsett, Wanner 1993, II.7)
GAUSS: Final = (0.5 - 3.0**0.5 / 6.0, 0.5 + 3.0**0.5 / 6.0)


@dataclass(frozen=True)
class Places:
    """Places in a step that count alike.

    Attributes:
        at: the places, in steps.
        held: whether what is found at one holds over its part of the step; else what is found at two makes a line.
    """

    at: tuple[float, ...]
    held: bool

    @classmethod
    def of(cls, between: Between | None) -> Places:
        """Those of a log: the middles of the parts in which it has demands, or else the points of Gauss."""
        if between is None:
            return cls(GAUSS, held=False)
        count = between.demands.shape[2]
        return cls(tuple((np.arange(count) + 0.5) / count), held=True)

    def until(self, place: float) -> Array:
        """Weights of what is found at the places in its integral from the start of a step to a place in it, shape (places,)."""
        if self.held:
            count = len(self.at)
            return np.clip(place - np.arange(count) / count, 0.0, 1.0 / count)
        one, two = self.at
        half = 0.5 * place * place
        return np.array([two * place - half, half - one * place]) / (two - one)


@dataclass(frozen=True)
class InsideSteps:
    """Accelerations inside the steps.

    Attributes:
        each: at each place [m/s^2, rad/s^2], shape (places, 3, n).
        places: where.
    """

    each: Array
    places: Places

    @property
    def mean(self) -> Array:
        """Mean acceleration over each step, shape (3, n)."""
        return np.asarray(self.each.mean(axis=0))

    @property
    def moment(self) -> Array:
        """Mean of the rest of the step times the acceleration beyond its mean, in steps, shape (3, n): positive for one that comes early."""
        return np.tensordot((0.5 - np.array(self.places.at)) / len(self.each), self.each, 1)

    def until(self, place: float) -> Array:
        """The acceleration's integral from the start of a step to a place in it, in steps, shape (3, n)."""
        return np.tensordot(self.places.until(place), self.each, 1)

    def apart(self, between: Between) -> Array:
        """Mean of the velocities at the readings of a sample less that at the sample, over a step's length [m/s^2, rad/s^2], shape (3, n)."""
        return _apart(self.each, between)

    def turned(self, between: Between, rate: Array, h: float) -> Array:
        """Mean of the headings at the readings of a sample less that at the sample [rad], shape (n,).

        Args:
            between: with the readings.
            rate: mean yaw rate of each step [rad/s], shape (n,).
            h: length of a step [s].
        """
        start = rate - h * (0.5 * self.mean[2] + self.moment[2])
        rates = np.stack([start + h * self.until(c)[2] for c in self.places.at])
        return h * _apart(rates, between)


def _apart(each: Array, between: Between) -> Array:
    """Mean over the readings of a sample of what the parts before and after it add up to, shape (..., n), from shape (parts, ..., n)."""
    return between.moved(np.moveaxis(each, 0, -1))


def inside(p: Points, nu: Array, psi: Array, t: Array, driven: Inside | None) -> Points:
    """What acts at places inside the steps, shape (..., places n): all of the first place, then all of the next.

    Args:
        p: states at samples and over steps.
        nu: the states, shape (3, places n).
        psi: headings there, shape (places n,).
        t: clock there, shape (places n,).
        driven: thrusts and angles there; those of the whole step by default.
    """
    n = p.psi.size // 2
    count = psi.size // n

    def held(x: Array) -> Array:
        return np.tile(x[..., n:], (1,) * (x.ndim - 1) + (count,))

    def known(x: Array | None) -> Array | None:
        return None if x is None else held(x)

    made = replace(p, nu=nu, psi=psi, place=held(p.place), t=t, wind=known(p.wind))
    if driven is not None:
        return replace(
            made,
            thrusts=driven.thrusts,
            angles=driven.angles,
            rudders=driven.rudders,
            bollard=driven.bollard,
            swing=driven.swing,
        )
    swing = None if p.swing is None else (held(p.swing[0]), held(p.swing[1]))
    return replace(
        made,
        thrusts=held(p.thrusts),
        angles=held(p.angles),
        rudders=known(p.rudders),
        bollard=known(p.bollard),
        swing=swing,
    )
