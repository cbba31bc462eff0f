"""Strength of the noise at the frequencies of a cause, from the log's own residual.

The noise is whitened by a few coefficients, and an ambient force may have any spectrum: a swell in a narrow band, or gusts that last longer than the
filters expect. What a score sums of it is its spectrum weighted by that of the cause. The score s of a direction d beside the base has the variance
sum_f |D(f)|^2 S(f) where white noise gives sum_f |D(f)|^2; their ratio says how much of a fall of chi-squared the noise makes by itself.

Source: Priestley, *Spectral Analysis and Time Series*, 1981, section 6.2.3 (smoothed periodogram); Grenander and Rosenblatt, *Statistical Analysis of
Stationary Time Series*, 1957, chapter 7 (regression beside noise of any spectrum).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored

Array = NDArray[np.float64]
# Frequencies of the log over which its spectrum is a mean: half of them on either side.
# Source: geometry: a mean of thirteen has an error of a quarter, and is as local as a log of five minutes tells gusts of twenty seconds apart
WIDTH: Final = 13


def strength(fit: Fit, s: Scored) -> float:
    """Variance of a cause's score over that beside white noise; 1 or more.

    Args:
        fit: of the model without the cause.
        s: the cause with its score.
    """
    p, g = fit.projection, fit.gram
    at, first = list(s.columns), s.first_block(g, fit.noise.predictor.log)
    x = g.columns(at)
    x[:, :first] = 0.0
    cross = g.blocks[first:, at][:, :, p.base].sum(axis=0)
    solved = np.linalg.solve(p.normal, cross.T)
    H = g.blocks[first:, at][:, :, at].sum(axis=0) - cross @ solved
    score = g.score[first:, at].sum(axis=0) - cross @ p.coefficients
    theta = np.linalg.lstsq(H, score, rcond=None)[0]
    own = np.tensordot(theta, x, axes=1) - g.explained(p.base, solved @ theta)
    left = g.y - g.explained(p.base, p.coefficients) - own
    rows = len(fit.noise.predictor.labels)
    weight, power = (_power(_by_row(a, rows, g.length)) for a in (own, left))
    whole = float(weight.sum())
    if not whole > 0:
        return 1.0
    # Gaps are zeros in both.
    spectrum = uniform_filter1d(power, WIDTH, axis=1, mode="mirror") / max(float((left != 0).sum()) / rows, 1.0)
    return max(float((weight * spectrum).sum()) / whole, 1.0)


def _by_row(blocks: Array, rows: int, length: int) -> Array:
    """A quantity of blocks in the order of time, shape (rows, n)."""
    return blocks.reshape(len(blocks), rows, length).transpose(1, 0, 2).reshape(rows, -1)


def _power(x: Array) -> Array:
    """Squared sizes at the frequencies of the log, shape (rows, n / 2 + 1)."""
    found = np.fft.rfft(x, axis=1)
    return np.asarray(found.real**2 + found.imag**2)
