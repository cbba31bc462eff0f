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
from ivsid.diagnosis.null.any_curve import with_family

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
# Columns that are transformed together.
# Source: resource: the transforms of all columns of a long log would need its memory a second time
TOGETHER: Final = 16


def strength(fit: Fit, s: Scored) -> float:
    """Variance of a cause's score over that beside white noise; 1 or more.

    Args:
        fit: of the model without the cause.
        s: the cause with its score.
    """
    g, at = with_family(fit.gram.only(fit.base), fit, s)
    base = range(len(fit.base))
    p = Projection(g, base)
    theta, fall = p.solve(at)
    own = g.explained(at, theta) - g.explained(base, g.regression(at, base) @ theta)
    weight = _power(_transformed(fit, own[None]))[0]
    if not (fall > 0 and weight.sum() > 0):
        return 1.0
    # What priors hold back of the cause is no part of its direction, and scatters by the priors.
    share = float((own * own).sum()) / fall
    left = g.y - g.explained(base, p.coefficients) - own
    return max(1.0 + share * (float((weight * _smooth(fit, left)).sum()) / float(weight.sum()) - 1.0), 1.0)


def spectrum(fit: Fit, g: Gram) -> Array:
    """Spectrum of the noise that no column takes, over that of white noise and 1 or more, shape (rows, frequencies).

    Args:
        fit: of the model.
        g: cross-products of its base and of the regressors.
    """
    every = range(len(g.names))
    p = Projection(g, every)
    left = g.y - g.explained(every, p.coefficients)
    found = _smooth(fit, left)
    # The share of each frequency that the columns take: the squared size of their projections there.
    lowest = np.arange(found.shape[1]) < LOWEST
    low = np.concatenate([_kept(fit, part, np.broadcast_to(lowest, found.shape)) for part in g.parts])
    taken = np.zeros_like(found)
    taken[:, lowest] = np.einsum("kf,kf->f", low.conj(), cho_solve(cho_factor(p.normal), low)).real.reshape(
        len(found), -1
    )
    share = 1.0 - uniform_filter1d(taken, WIDTH, axis=1, mode="mirror") / _count(fit, left)
    return np.asarray(np.maximum(found / np.maximum(share, LEFT), 1.0))


def excess(fit: Fit, p: Projection, columns: Sequence[int], above: Array) -> Array:
    """Covariance of the scores of columns that a spectrum adds to that of white noise, shape (columns, columns).

    Args:
        fit: of the model.
        p: least squares beside which they are scored.
        columns: indices.
        above: spectrum of the noise, shape (rows, frequencies).
    """
    g, at = p.g, list(columns)
    x = g.columns(at)
    x -= g.explained(p.base, g.regression(at, p.base))
    samples = x[0].size // len(above)
    weight = (above - 1.0) / samples
    # A frequency between none and the highest stands for itself and its negative.
    weight[:, 1 : (samples + 1) // 2] *= 2.0
    kept = weight > 0
    found = _kept(fit, x, kept) * np.sqrt(weight[kept])
    return np.asarray((found.conj() @ found.T).real, dtype=np.float64)


def _kept(fit: Fit, x: Array, keep: NDArray[np.bool_]) -> NDArray[np.complex128]:
    """Some frequencies of quantities of blocks, shape (quantities, kept); a few quantities are transformed at a time."""
    found = np.empty((len(x), int(keep.sum())), dtype=np.complex128)
    for first in range(0, len(x), TOGETHER):
        found[first : first + TOGETHER] = _transformed(fit, x[first : first + TOGETHER])[:, keep]
    return found


def _transformed(fit: Fit, x: Array) -> NDArray[np.complex128]:
    """Fourier transforms of quantities of blocks, row by row, shape (quantities, rows, frequencies)."""
    rows, length = len(fit.noise.predictor.labels), fit.gram.length
    by_row = x.reshape(len(x), -1, rows, length).transpose(0, 2, 1, 3).reshape(len(x), rows, -1)
    return np.asarray(np.fft.rfft(by_row, axis=2))


def _power(x: NDArray[np.complex128]) -> Array:
    return np.asarray(x.real**2 + x.imag**2)


def _count(fit: Fit, left: Array) -> Array:
    """Samples of each row that count, at least 1, shape (rows, 1): gaps are zeros, and so are axes that are left out."""
    rows, length = len(fit.noise.predictor.labels), fit.gram.length
    counts = (left != 0).reshape(-1, rows, length).sum(axis=(0, 2))
    return np.asarray(np.maximum(counts, 1)[:, None], dtype=np.float64)


def _smooth(fit: Fit, left: Array) -> Array:
    """Spectrum of what is left of the log over that of white noise, shape (rows, frequencies)."""
    power = _power(_transformed(fit, left[None])[0])
    return np.asarray(uniform_filter1d(power, WIDTH, axis=1, mode="mirror") / _count(fit, left), dtype=np.float64)
