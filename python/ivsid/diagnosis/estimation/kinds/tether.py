"""Pulls toward a place: the anchor of a tether, on a grid around the track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.kinds.searched import SearchedCandidate, beside
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.estimation.whitening import Whitening

Array = NDArray[np.float64]
# Least reach of the grid from the middle of the track [m].
# Source: measured: make constants
LEAST_REACH: Final = 20.0
# Anchors along each side of the grid.
# Source: resource: time of 225 sums; a seventh of the reach lies between two of them, which later steps refine
GRID: Final = 15
# Anchors that get exact columns.
# Source: resource: two columns each
EXACT: Final = 6
# Cosine of two pulls beside the plain model, above which they are one.
# Source: geometry: each explains nine tenths of what the other does
ALIKE: Final = 0.95
# Least length of a pull beside the plain model, as a share of the largest.
# Source: geometry: what is left of a far anchor is an error of the plain model's columns
SHORT: Final = 0.02
# Most samples that are summed for an anchor.
# Source: resource: time of the grid
SAMPLES: Final = 1500
# Squared distance that is added to that of an anchor [m^2].
# Source: geometry: the direction to an anchor below the hull stays a number
NEAR: Final = 1e-4
# Places of the track around which anchors stand closer: the pull of one beside the track turns while it is passed, and is constant before and after.
# Source: resource: a twenty-fourth of the track lies between two of them, which later steps refine
PASSED: Final = 24
# Their distance from the track, as a share of the reach.
# Source: geometry: half the distance of two places of a straight track
ASIDE: Final = 0.02
# Independent anchors in the grid and along the track.
# Source: geometry: twenty of the grid, whose neighbours are alike, and one for each place of the track
LOOKS: Final = 20.0 + PASSED
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
        thin = slice(None, n, max(1, n // SAMPLES))
        x, y = p.place[0, thin], p.place[1, thin]
        c, sine = np.cos(p.psi[thin]), np.sin(p.psi[thin])
        anchors = _anchors(p.place[:, :n], x, y)
        dn, de = anchors[:, 0, None] - x, anchors[:, 1, None] - y
        d = np.sqrt(dn**2 + de**2 + NEAR)
        ahead, aside = (dn * c + de * sine) / d, (de * c - dn * sine) / d
        # Nothing of the base is left in the errors, so that the lengths of the signatures alone have to be those beside it.
        # Their sums count, and not every so many of them: what explains noise changes from sample to sample, a pull does not.
        force = np.add.reduceat(s.mass.inverse[0].T @ back, np.arange(n)[thin], axis=1)
        fall = ahead @ force[0] + aside @ force[1]
        (u, v, r), one = p.nu[:, thin], np.ones(x.size)
        inverse = s.mass.inverse[0]
        own = np.hstack(
            [
                inverse[0, 0] * beside(ahead, (one, u, u * np.abs(u))),
                inverse[1, 1] * beside(aside, (one, v, v * np.abs(v), u * r)),
            ]
        )
        length = np.linalg.norm(own, axis=1)
        own = own / np.maximum(length, SHORT * length.max())[:, None]
        score = fall / np.maximum(length, SHORT * length.max())
        chosen: list[int] = []
        for k in np.argsort(-score):
            if score[k] > 0 and all(own[k] @ own[q] < ALIKE for q in chosen):
                chosen.append(int(k))
            if len(chosen) == EXACT:
                break
        return [(float(anchors[k, 0]), float(anchors[k, 1])) for k in chosen], LOOKS

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


def _anchors(place: Array, x: Array, y: Array) -> Array:
    """Anchors on a grid over the reach of the track, and beside the track, shape (anchors, 2).

    Args:
        place: the track, shape (2, n).
        x: north of its samples that are summed, shape (m,).
        y: east of them, shape (m,).
    """
    low, high = place.min(axis=1), place.max(axis=1)
    reach = max(float((high - low).max()), LEAST_REACH)
    along = np.linspace(-1.0, 1.0, GRID) * reach
    grid = np.stack(np.meshgrid(along, along, indexing="ij"), axis=-1).reshape(-1, 2) + 0.5 * (low + high)
    passed = np.linspace(0, x.size - 1, PASSED).astype(np.int64)
    near = ASIDE * reach * np.array([(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
    beside = (np.stack([x[passed], y[passed]], axis=1)[:, None] + near).reshape(-1, 2)
    return np.concatenate([grid, beside])
