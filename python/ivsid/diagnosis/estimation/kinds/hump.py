"""Forces that stand out about one speed: their speeds and widths on a grid over the speeds of the log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.declared_errors import through_water
from ivsid.diagnosis.estimation.kinds.searched import PEAKS, SearchedCandidate, beside
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.effects import CHANNELS, Force, Given, State

Array = NDArray[np.float64]
# Speeds of the grid, from the lowest quarter of the speeds of the log up to the fastest.
# Source: geometry: neighbours are a twelfth of the speeds apart, a quarter of the narrowest hump that fills a third of them
SPEEDS: Final = 12
# Widths of the grid, in the speed of the hump.
# Source: geometry: humps of neighbouring widths have a cosine of 0.95
WIDTHS: Final = (0.15, 0.3, 0.6)
# Share of samples below which no speed of the grid lies.
# Source: geometry: a hump has slower samples beside it, from which it stands out
SLOWEST: Final = 0.25
# Least top speed at which a hump is looked for [m/s].
# Source: geometry: a quotient by it stays a number
AT_REST: Final = 1e-3
# Cosine of two humps beside the plain drags, above which they are one.
# Source: geometry: each explains nine tenths of what the other does
ALIKE: Final = 0.95
# Least length of a hump beside the plain drags, as a share of its own.
# Source: geometry: what is left of a hump that is wide beside the speeds is an error of the plain drags' columns
SHORT: Final = 0.02
# Most samples that are summed for a hump.
# Source: resource: time of the grid
SAMPLES: Final = 1500


@dataclass(frozen=True)
class HumpCandidate(SearchedCandidate):
    """A force about a speed: linear in its height, searched in its speed and width."""

    sums: ClassVar[bool] = True

    @property
    def limited(self) -> int:
        """The height; the search gives speed and width."""
        return 1

    def search(self, s: Signatures, _white: Whitening, back: Array) -> tuple[list[tuple[float, ...]], float]:
        """Speeds and widths [m/s]."""
        n = s.predictor.log.n
        thin = slice(None, n, max(1, n // SAMPLES))
        u, v, r = (q[thin] for q in through_water(s))
        speeds = np.abs(u)
        top, low = float(speeds.max()), float(np.quantile(speeds, SLOWEST))
        if top < AT_REST:
            return [], 1.0
        values = [
            (float(at), float(at * width))
            for at in np.linspace(max(low, top / SPEEDS), top, SPEEDS)
            for width in WIDTHS
        ]
        # Their sums count, and not every so many of the errors: what explains noise changes from sample to sample, a drag does not.
        errors = np.add.reduceat(s.mass.inverse[0].T @ back, np.arange(n)[thin], axis=1)
        unit = self._forces(State(u, v, r, 0.0, 0.0, 0.0), values)
        # Nothing of the base is left in the errors, so that the lengths of the humps alone have to be those beside it.
        own = np.concatenate([beside(unit[:, k], base) for k, base in enumerate(_plain(u, v, r))], axis=1)
        length = np.linalg.norm(own, axis=1)
        kept = np.flatnonzero(length > SHORT * np.linalg.norm(unit, axis=(1, 2)))
        if not kept.size:
            return [], 1.0
        own = own[kept] / length[kept, None]
        score = np.einsum("kcn,cn->k", unit[kept], errors) / length[kept]
        cosines = own @ own.T
        chosen: list[int] = []
        for k in np.argsort(-score):
            if score[k] > 0 and all(cosines[k, q] < ALIKE for q in chosen):
                chosen.append(int(k))
            if len(chosen) == PEAKS:
                break
        # As many independent humps as equal eigenvalues have the same sum and the same sum of squares.
        return [values[kept[k]] for k in chosen], float(kept.size**2 / (cosines**2).sum())

    def _forces(self, state: State, values: list[tuple[float, float]]) -> Array:
        """Humps of 1 N at some speeds and widths, shape (values, 3, samples)."""
        assert isinstance(self.effect.acts, Force)
        found = np.zeros((len(values), len(CHANNELS), len(state.u)))
        for k, value in enumerate(values):
            for channel, force in self.effect.acts.function(state, (1.0, *value)).items():
                found[k, CHANNELS.index(channel)] = force
        return found

    def exact(self, s: Signatures, value: tuple[float, ...]) -> list[Array]:
        """A hump of 1 N."""
        return [s.whole(Given(self.effect, (1.0, *value)))]

    def possible(self, theta: tuple[float, ...]) -> bool:
        """A hump is a drag."""
        return theta[0] > 0

    def numbers(self, value: tuple[float, ...], theta: tuple[float, ...]) -> tuple[float, ...]:
        """Height [N], speed and width [m/s]."""
        return theta[0], *value


def _plain(u: Array, v: Array, r: Array) -> tuple[tuple[Array, ...], ...]:
    """Columns of the plain model at hand in each channel, apart from the accelerations, and a constant."""
    one = np.ones(u.size)
    return (one, u, u * np.abs(u)), (one, v, v * np.abs(v), u * r), (one, r, r * np.abs(r))
