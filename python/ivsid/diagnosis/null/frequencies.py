"""Strength of the noise at the frequencies of a cause or of a regressor, from the log's own residual.

The noise is whitened by a few coefficients, and an ambient force may have any spectrum: a swell in a narrow band, or gusts that last longer than the
filters expect. What a score sums of it is its spectrum weighted by that of the direction. Scores of directions d_i beside the base have the covariances
sum_f D_i(f)* D_j(f) S(f), where white noise gives sum_f D_i(f)* D_j(f). S is an estimate, the better the more frequencies make it.

Source: Priestley, *Spectral Analysis and Time Series*, 1981, section 6.2.3 (smoothed periodogram); Grenander and Rosenblatt, *Statistical Analysis of
Stationary Time Series*, 1957, chapter 7 (regression beside noise of any spectrum).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.ndimage import uniform_filter1d
from scipy.special import chdtri, fdtrc

from ivsid.diagnosis.estimation.cross_products import RIDGE, Gram
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
# Least chance, and least square of a mean, that counts.
# Source: geometry: the smallest doubles, below which a fall is infinite
NOTHING: Final = 1e-300
# Columns that are transformed together.
# Source: resource: the transforms of all columns of a long log would need its memory a second time
TOGETHER: Final = 32


@dataclass(frozen=True)
class Spectrum:
    """Spectrum of the noise of a log, from what columns leave of it.

    Attributes:
        found: over that of white noise, shape (rows, frequencies).
        free: share of the noise at each frequency that the columns leave, shape (rows, frequencies).
    """

    found: Array
    free: Array

    @property
    def above(self) -> Array:
        """The spectrum, 1 or more, shape (rows, frequencies)."""
        return np.maximum(self.found, 1.0)

    def freedom(self, weight: Array) -> Array:
        """Degrees of freedom of means of the spectrum: twice the number of frequencies that make one, where they make it alike.

        Source: Satterthwaite, *Biometrics Bulletin* 2, 1946.

        Args:
            weight: of each frequency, shape (means, rows, frequencies).
        """
        # What the columns leave of the two squares of each frequency enters by the weights of all that are near.
        each = uniform_filter1d(weight / self.free, WIDTH, axis=2, mode="mirror") * self.found * self.free
        squares = (each * each / self.free).sum(axis=(1, 2))
        means = each.sum(axis=(1, 2))
        return np.where(squares > 0, 2.0 * means**2 / np.maximum(squares, NOTHING), np.inf)


@dataclass(frozen=True)
class Strength:
    """Strength of the noise at a cause's frequencies.

    Attributes:
        value: variance of the cause's score over that beside white noise; 1 or more.
        freedom: degrees of freedom of the estimate.
    """

    value: float
    freedom: float

    def beside(self, fall: float, count: int) -> float:
        """Fall of chi-squared that is as rare beside white noise as a fall beside this noise.

        Args:
            fall: of the cause.
            count: of its numbers.
        """
        return float(as_rare(np.array(fall / self.value), count, np.array(self.freedom)))


def as_rare(fall: Array, count: int, freedom: Array) -> Array:
    """Falls of chi-squared that are as rare in known noise as falls in noise whose strength is estimated: the ratio of both is Snedecor's F.

    Args:
        fall: over the estimated strength.
        count: degrees of freedom of each fall.
        freedom: degrees of freedom of each estimate; infinite for a known one.
    """
    known = ~np.isfinite(freedom)
    chance = np.maximum(fdtrc(count, np.where(known, 1.0, freedom), fall / count), NOTHING)
    return np.where(known, fall, np.minimum(chdtri(count, chance), fall))


class Frequencies:
    """The base of a fit at the frequencies of its log, which all causes share.

    Args:
        fit: of the model without causes.
    """

    def __init__(self, fit: Fit) -> None:
        self.fit = fit

    @cached_property
    def _low(self) -> NDArray[np.complex128]:
        return _lowest(self.fit, self.fit.bare.parts)

    @cached_property
    def _taken(self) -> Array:
        return _projected(self.fit.bare.normal(range(len(self.fit.base))), self._low)

    @cached_property
    def _left(self) -> Array:
        g, base = self.fit.bare, range(len(self.fit.base))
        return g.y - g.explained(base, Projection(g, base).coefficients)

    def strength(self, s: Scored) -> Strength:
        """Strength of the noise at a cause's frequencies.

        Args:
            s: the cause with its score.
        """
        fit = self.fit
        g, at = with_family(self.fit.bare, fit, s)
        base = range(len(fit.base))
        p = Projection(g, base)
        theta, fall = p.solve(at)
        in_base = g.regression(at, base)
        own = g.explained(at, theta) - g.explained(base, in_base @ theta)
        weight = _power(_transformed(fit, own[None]))
        if not (fall > 0 and weight.sum() > 0):
            return Strength(1.0, np.inf)
        # What the cause takes beside the base adds to what the base takes.
        beside = _lowest(fit, g.parts[len(self.fit.bare.parts) :]) - in_base.T @ self._low
        taken = self._taken + _projected(p.information(at) + RIDGE * np.eye(len(at)), beside)
        found = _spectrum(fit, self._left - own, taken)
        mean = float((weight * found.found).sum() / weight.sum())
        # What priors hold back of the cause is no part of its direction, and scatters by the priors.
        share = float((own * own).sum()) / fall
        return Strength(max(1.0 + share * (mean - 1.0), 1.0), float(found.freedom(weight)[0]))


def spectrum(fit: Fit, g: Gram, slow: Array | None = None, lowest: int = 0) -> Spectrum:
    """Spectrum of the noise that no column takes.

    Args:
        fit: of the model.
        g: cross-products of its base and of the regressors.
        slow: signatures of slow forces that stand beside it and are held to a bound of their own, shape (forces, numbers).
        lowest: frequencies of the log that are theirs, and count as white.
    """
    every = range(len(g.names))
    p = Projection(g, every)
    left = g.y - g.explained(every, p.coefficients)
    if slow is not None:
        own = slow @ slow.T
        ridge = RIDGE * max(float(np.trace(own)), NOTHING) * np.eye(len(own))
        left = left - (slow.T @ np.linalg.solve(own + ridge, slow @ left.ravel())).reshape(left.shape)
    found = _spectrum(fit, left, _projected(p.normal, _lowest(fit, g.parts)))
    return replace(found, found=np.where(np.arange(found.found.shape[1]) < lowest, 1.0, found.found))


@dataclass(frozen=True)
class Scatter:
    """How scores scatter beyond what they do in white noise.

    Attributes:
        more: covariance that a spectrum adds to that of white noise, shape (columns, columns).
        freedom: degrees of freedom of the estimate of each column's scatter, shape (columns,).
    """

    more: Array
    freedom: Array


def excess(fit: Fit, p: Projection, columns: Sequence[int], noise: Spectrum) -> Scatter:
    """How a spectrum scatters the scores of columns.

    Args:
        fit: of the model.
        p: least squares beside which they are scored.
        columns: indices.
        noise: spectrum of the noise.
    """
    g, at = p.g, list(columns)
    in_base = g.regression(at, p.base)
    above = noise.above
    samples = g.y.size // len(above)
    weight = (above - 1.0) / samples
    # A frequency between none and the highest stands for itself and its negative.
    weight[:, 1 : (samples + 1) // 2] *= 2.0
    kept = weight > 0
    # Real and imaginary parts side by side: the real part of complex products is half of the work.
    found, freedom = np.empty((len(at), 2 * int(kept.sum()))), np.empty(len(at))
    root = np.sqrt(weight[kept])
    for first in range(0, len(at), TOGETHER):
        some = slice(first, first + TOGETHER)
        parts = _transformed(fit, g.columns(at[some]) - g.explained(p.base, in_base[:, some]))
        here = parts[:, kept]
        found[some] = np.concatenate([here.real * root, here.imag * root], axis=1)
        freedom[some] = noise.freedom(_power(parts))
    return Scatter(found @ found.T, freedom)


def _spectrum(fit: Fit, left: Array, taken: Array) -> Spectrum:
    """Spectrum of the noise from what columns leave, shape (blocks, numbers).

    Args:
        fit: of the model.
        left: what they leave.
        taken: squared sizes of the lowest frequencies in them, shape (rows x frequencies,).
    """
    found = _smooth(fit, left)
    every = np.zeros_like(found)
    every[:, :LOWEST] = taken.reshape(len(found), -1)
    share = 1.0 - uniform_filter1d(every, WIDTH, axis=1, mode="mirror") / _count(fit, left)
    free = np.maximum(share, LEFT)
    return Spectrum(found / free, free)


def _projected(normal: Array, low: NDArray[np.complex128]) -> Array:
    """Squared sizes of frequencies in columns, from their normal matrix and their lowest frequencies, shape (rows x frequencies,)."""
    own = solve_triangular(np.linalg.cholesky(normal), np.concatenate([low.real, low.imag], axis=1), lower=True)
    return np.asarray(np.einsum("kf,kf->f", own, own).reshape(2, -1).sum(axis=0))


def _lowest(fit: Fit, parts: Sequence[Array]) -> NDArray[np.complex128]:
    """Lowest frequencies of quantities of blocks, shape (quantities, rows x frequencies); a few quantities are transformed at a time."""
    found = [
        _transformed(fit, x[first : first + TOGETHER])[:, :, :LOWEST].reshape(len(x[first : first + TOGETHER]), -1)
        for x in parts
        for first in range(0, len(x), TOGETHER)
    ]
    return np.concatenate(found)


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
