"""Pulls toward a place: the anchor of a tether, on a grid around the track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.kinds.searched import PEAKS, SearchedCandidate
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.estimation.whitening import Whitening

Array = NDArray[np.float64]
# Least reach of the grid from the middle of the track [m].
# Source: measured: make constants
LEAST_REACH: Final = 20.0
# Anchors along each side of the grid.
# Source: resource: time of 225 sums; a seventh of the reach lies between two of them, which later steps refine
GRID: Final = 15
# Most samples that are summed for an anchor.
# Source: resource: time of the grid
SAMPLES: Final = 1500
# Squared distance that is added to that of an anchor [m^2].
# Source: geometry: the direction to an anchor below the hull stays a number
NEAR: Final = 1e-4
# Independent anchors in the grid.
# Source: measured: make constants
LOOKS: Final = 20.0
# Largest arm of a tether [m].
# Source: measured: make constants
MOST_ARM: Final = 3.0
# Least pull that has an arm [N].
# Source: geometry: a quotient by it stays a number
NO_PULL: Final = 1e-12


@dataclass(frozen=True)
class TetherCandidate(SearchedCandidate):
    """A constant pull toward an anchor."""

    @property
    def limited(self) -> int:
        """The pull; the other columns give its arm, and the search its place."""
        return 1

    def search(self, s: Signatures, _white: Whitening, back: Array) -> tuple[list[tuple[float, ...]], float]:
        """Anchors north, east [m]."""
        log = s.predictor.log
        if log.place is None:
            return [], 1.0
        p = s.states.points
        n = log.n
        x, y = p.place[0, :n], p.place[1, :n]
        reach = max(float(np.ptp(x)), float(np.ptp(y)), LEAST_REACH)
        force = s.mass.inverse[0].T @ back
        north = force[0] * np.cos(p.psi[:n]) - force[1] * np.sin(p.psi[:n])
        east = force[0] * np.sin(p.psi[:n]) + force[1] * np.cos(p.psi[:n])
        middle = (0.5 * (float(x.min()) + float(x.max())), 0.5 * (float(y.min()) + float(y.max())))
        every = []
        thin = slice(None, None, max(1, n // SAMPLES))
        for a in np.linspace(-1.0, 1.0, GRID):
            for b in np.linspace(-1.0, 1.0, GRID):
                anchor = (middle[0] + a * reach, middle[1] + b * reach)
                dn, de = anchor[0] - x[thin], anchor[1] - y[thin]
                d = np.sqrt(dn**2 + de**2 + NEAR)
                every.append((float(np.sum((dn * north[thin] + de * east[thin]) / d)), anchor))
        every.sort(key=lambda q: -q[0])
        return [anchor for _, anchor in every[:PEAKS]], LOOKS

    def exact(self, s: Signatures, value: tuple[float, ...]) -> list[Array]:
        """The pull, and its moment on an arm of 1 m."""
        return s.pull((value[0], value[1]))

    def possible(self, theta: tuple[float, ...]) -> bool:
        """A tether pulls."""
        return theta[0] > 0

    def numbers(self, value: tuple[float, ...], theta: tuple[float, ...]) -> tuple[float, ...]:
        """Pull [N], anchor north and east [m] and arm [m], from the coefficients of the pull and of its moment."""
        pull = theta[0] if abs(theta[0]) > NO_PULL else NO_PULL
        return pull, value[0], value[1], float(np.clip(theta[1] / pull, -MOST_ARM, MOST_ARM))
