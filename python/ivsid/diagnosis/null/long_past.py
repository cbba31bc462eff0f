"""The log's own past errors over some correlation times of the ambient force, and large ones apart.

Gusts that begin at once are no noise of a linear filter. After a large error the next ones have its sign, since the filter believes a share of it,
and after a small one they do not. A demand under feedback is a curve of such errors, so that a thrust error can stand for what the filter lacks.

Source: docs/theory.md, "Own past"; Kitagawa, "Non-Gaussian state-space modeling of nonstationary time series", JASA 82, 1987.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.null.frequencies import Spectrum, spectrum
from ivsid.diagnosis.null.own_past import LAGS, OwnPast, late
from ivsid.linear.filters import decaying

Array = NDArray[np.float64]
# Memories of the fading means of past errors, in correlation times of the ambient force.
# Source: geometry: one of the force itself, and one as slow as the slow forces are quick
MEMORIES: Final = (1.0, 4.0)
# Size of a whitened error from which on it is a large one.
# Source: definition: normal noise exceeds it once in eighty samples
LARGE: Final = 2.5


class LongPast(OwnPast):
    """The base of a fit beside the log's own past errors, their fading means, and the large ones among them once more."""

    def _before(self, errors: Array) -> Array:
        predictor = self.fit.noise.predictor
        large = np.where(np.abs(errors) > LARGE, errors, 0.0)
        kept = [float(np.exp(-predictor.log.h / (m * max(predictor.ambient.time)))) for m in MEMORIES]
        means = [late(decaying((1.0 - a) * errors, a), 1) for a in kept]
        return np.concatenate([super()._before(errors), *means, *(late(large, lag) for lag in range(1, LAGS + 1))])

    def spectrum(self, g: Gram) -> Spectrum | None:
        """Spectrum of the noise: past errors of a few seconds leave what is slower.

        Args:
            g: cross-products of the base and of further columns.
        """
        return spectrum(self.fit, g)
