"""Strength of the noise at the frequencies of a cause or of a regressor, from the log's own residual.

The noise is whitened by a few coefficients, and an ambient force may have any spectrum: a swell in a narrow band, or gusts that last longer than the
filters expect. What a score sums of it is its spectrum weighted by that of the direction. Scores of directions d_i beside the base have the covariances
sum_f D_i(f)* D_j(f) S(f), where white noise gives sum_f D_i(f)* D_j(f).

Source: Priestley, *Spectral Analysis and Time Series*, 1981, section 6.2.3 (smoothed periodogram); Grenander and Rosenblatt, *Statistical Analysis of
Stationary Time Series*, 1957, chapter 7 (regression beside noise of any spectrum).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection

Array = NDArray[np.float64]
# Frequencies of the log over which its spectrum is a mean: half of them on either side.
# Source: geometry: a mean of thirteen has an error of a quarter, and is as local as a log of five minutes tells gusts of twenty seconds apart
WIDTH: Final = 13
# Lowest frequencies of the log at which the share is counted that columns take of the noise.
# Source: resource: the products of all columns there; above, hundreds of columns take little of what is far more values
LOWEST: Final = 400
# Least share of the noise that columns leave, as far as the spectrum counts on it.
# Source: geometry: what is left of a smaller share is a mean of two values or less
LEFT: Final = 0.15


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
    weight, fall = _power(_transformed(fit, own[None])[0]), float(theta @ H @ theta)
    if not (fall > 0 and weight.sum() > 0):
        return 1.0
    # What priors hold back of the cause is no part of its direction, and scatters by the priors.
    share = float((own * own).sum()) / fall
    return max(1.0 + share * (float((weight * _smooth(fit, left)).sum()) / float(weight.sum()) - 1.0), 1.0)


def spectrum(fit: Fit, g: Gram) -> Array:
    """Spectrum of the noise that no column takes, over that of white noise and 1 or more, shape (rows, frequencies).

    Args:
        fit: of the model.
        g: cross-products of its base and of the regressors.
    """
    every = range(len(g.names))
    p = Projection(g, every)
    x = g.columns(every).reshape(len(every), *fit.gram.y.shape)
    # The share of each frequency that the columns take: the squared size of their projections there.
    low = _transformed(fit, x)[..., :LOWEST]
    flat = low.reshape(len(low), -1)
    taken = np.zeros((low.shape[1], fit.gram.y.size // low.shape[1] // 2 + 1))
    taken[:, :LOWEST] = np.einsum("kf,kf->f", flat.conj(), cho_solve(cho_factor(p.normal), flat)).real.reshape(
        low.shape[1:]
    )
    left = g.y - g.explained(every, p.coefficients)
    count = _count(fit, left)
    share = np.maximum(1.0 - uniform_filter1d(taken, WIDTH, axis=1, mode="mirror") / count, LEFT)
    return np.asarray(np.maximum(_smooth(fit, left) / share, 1.0))


def excess(fit: Fit, p: Projection, columns: Sequence[int], above: Array) -> Array:
    """Covariance of the scores of columns that a spectrum adds to that of white noise, shape (columns, columns).

    Args:
        fit: of the model.
        p: least squares beside which they are scored.
        columns: indices.
        above: spectrum of the noise, shape (rows, frequencies).
    """
    g, at = p.g, list(columns)
    x = g.columns(at).reshape(len(at), -1)
    x -= g.regression(at, p.base).T @ g.columns(p.base).reshape(len(p.base), -1)
    found = _transformed(fit, x.reshape(len(at), *fit.gram.y.shape)) * np.sqrt(above - 1.0)
    rows, n = found.shape[1], fit.gram.y.size
    # A frequency between none and the highest stands for itself and its negative.
    found[..., 1 : (n // rows + 1) // 2] *= np.sqrt(2.0)
    flat = found.reshape(len(at), -1)
    return np.asarray((flat.conj() @ flat.T).real / (n // rows), dtype=np.float64)


def _transformed(fit: Fit, x: Array) -> NDArray[np.complex128]:
    """Fourier transforms of quantities of blocks, row by row, shape (quantities, rows, frequencies)."""
    rows, length = len(fit.noise.predictor.labels), fit.gram.length
    by_row = x.reshape(len(x), -1, rows, length).transpose(0, 2, 1, 3).reshape(len(x), rows, -1)
    return np.asarray(np.fft.rfft(by_row, axis=2))


def _power(x: NDArray[np.complex128]) -> Array:
    return np.asarray(x.real**2 + x.imag**2)


def _count(fit: Fit, left: Array) -> float:
    """Samples of a row that count: gaps are zeros."""
    return max(float((left != 0).sum()) / len(fit.noise.predictor.labels), 1.0)


def _smooth(fit: Fit, left: Array) -> Array:
    """Spectrum of what is left of the log over that of white noise, shape (rows, frequencies)."""
    power = _power(_transformed(fit, left.reshape(1, *fit.gram.y.shape))[0])
    return np.asarray(uniform_filter1d(power, WIDTH, axis=1, mode="mirror") / _count(fit, left), dtype=np.float64)
