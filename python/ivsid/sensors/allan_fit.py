"""N, B, T and K from an Allan variance, with 95 % bands: generalised least squares on octaves of averaging time.

White noise N, a first-order Gauss-Markov bias (B, T) and a rate random walk K give at averaging time tau

    sigma^2 = N^2 / tau + (2 B^2 T / tau) (1 - T / (2 tau) (3 - 4 exp(-tau/T) + exp(-2 tau/T))) + K^2 tau / 3.

Overlapping estimates at different tau share their samples, so that the misfit is weighted by their covariance. For Gaussian noise of
spectrum S the covariance follows from the theorems of Isserlis and Parseval: cov = 2/M integral S^2 |H_j|^2 |H_k|^2 df. H is the filter
of the Allan variance, and M the larger of the two numbers of differences. Bands are profile likelihoods: all values of one number for
which some choice of the others has a misfit at most 3.84 (chi^2 of one degree of freedom, 95 %) above the best.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares
from scipy.special import digamma, polygamma
from scipy.stats import chi2

NAMES: Final = ("random_walk", "bias_instability", "bias_time", "rate_random_walk")
# Rise of the misfit at the ends of a 95 % band: the 95 % quantile of chi^2 with one degree of freedom.
# Source: theorem: Wilks, likelihood ratio.
LEVEL: Final = float(chi2.ppf(0.95, 1))
# A rate random walk enters the fit only if it lowers the misfit by more than this, the 99.9 % quantile; else K is 0.
# Source: theorem: Wilks, likelihood ratio.
SIGNIFICANT: Final = float(chi2.ppf(0.999, 1))
# Frequencies of the integral for the covariance, spaced geometrically.
# Source: measured: make constants
FREQUENCIES: Final = 4000
# The record is at least as long as this multiple of the longest averaging time of the fit.
# Source: measured: make constants
LEAST_AVERAGES: Final = 6
# A number below this share of its scale in the record counts as 0.
# Source: definition: its part of the variance is 1e-12.
_NOTHING: Final = 1e-6
# Half the range of the logarithm of a number in the fit.
# Source: definition: exp(25) = 7e10, so that squares stay far from overflow.
_RANGE: Final = 25.0

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NoiseFit:
    """The fitted noise.

    Attributes:
        values: N [unit/sqrt(s)], B [unit], T [s], K [unit/s/sqrt(s)].
        bands: the 95 % band of each by its name in ``NAMES``; an end that the record leaves open is 0 or infinite.
    """

    values: tuple[float, float, float, float]
    bands: dict[str, tuple[float, float]]


def octaves(samples: int) -> NDArray[np.int64]:
    """Averaging times of the fit in samples: powers of two, shape (m,)."""
    last = max(int(np.log2(max(samples / LEAST_AVERAGES, 1))), 3)
    return 2 ** np.arange(last + 1)


def variance(tau: Array, n: float, b: float, t: float, k: float) -> Array:
    """The Allan variance of N, B, T, K at averaging times [s], in the square of the channel's unit (formula above)."""
    x = tau / t
    # 1 - (3 - 4 exp(-x) + exp(-2x)) / (2x) cancels for small x, where its series x^2/3 - x^3/4 is used.
    safe = np.maximum(x, 1e-3)
    hump = np.where(x > 1e-3, 1 - (3 - 4 * np.exp(-safe) + np.exp(-2 * safe)) / (2 * safe), x * x / 3 - x**3 / 4)
    return np.asarray(n * n / tau + 2 * b * b / x * hump + k * k * tau / 3, dtype=np.float64)


def covariance(values: tuple[float, ...], m: NDArray[np.int64], samples: int, period: float) -> Array:
    """Covariance of overlapping estimates of the Allan variance, shape (q, q), in the fourth power of the channel's unit.

    Args:
        values: N, B, T, K of the noise.
        m: averaging times in samples, shape (q,).
        samples: of the record.
        period: of the samples [s].
    """
    n, b, t, k = values
    f = np.geomspace(0.02 / samples, 0.5, FREQUENCIES)
    half = np.pi * f
    decay = np.exp(-period / t)
    # |1 - exp(-iw)|^2 = 4 sin^2(w/2); the sampled Gauss-Markov process is an autoregression of order 1.
    spectrum = (
        n * n / period
        + b * b * (1 - decay**2) / ((1 - decay) ** 2 + 4 * decay * np.sin(half) ** 2)
        + k * k * period / (4 * np.sin(half) ** 2)
    )
    filtered = spectrum * np.stack([2 * np.sin(half * q) ** 4 / (q * np.sin(half)) ** 2 for q in m])
    weight = np.gradient(f)
    shared = 2 * (filtered * weight) @ filtered.T
    estimates = samples - 2 * m + 1
    return np.asarray(2 * shared / np.maximum.outer(estimates, estimates), dtype=np.float64)


def fit_noise(m: NDArray[np.int64], observed: Array, samples: int, period: float) -> NoiseFit:
    """Fits N, B, T and K to overlapping Allan variances.

    Args:
        m: averaging times in samples, increasing, shape (q,).
        observed: Allan variances at these times, positive, shape (q,).
        samples: of the record.
        period: of the samples [s].
    """
    tau: Array = m.astype(np.float64) * period
    log_observed = np.log(observed)
    low: Array = np.log([observed[0] * period, observed.min(), tau[0] ** 2, 3 * observed.min() / tau[-1]]) / 2
    # No record tells a bias slower than itself from a rate random walk.
    slowest = float(np.log(samples * period))
    start = _start(tau, observed)
    # The first weights assume samples / m independent averages.
    whiten = _whitener(np.diag(2.0 * m / samples))
    bias: Array = np.zeros(m.shape)
    best = start
    for turn in range(3):
        best, with_k = _best(tau, log_observed + bias, whiten, best, (low, slowest), starts=5 if turn == 0 else 1)
        numbers = _numbers(best, low, slowest)
        spread = covariance(numbers, m, samples, period)
        model = variance(tau, *numbers)
        relative = spread / np.outer(model, model)
        # An estimate is distributed like chi^2 / nu: its logarithm has a negative bias and a variance above 2 / nu.
        nu = 2 / np.diag(relative)
        bias = np.log(nu / 2) - digamma(nu / 2)
        wider = np.sqrt(polygamma(1, nu / 2) / np.diag(relative))
        relative = relative * np.outer(wider, wider)
        whiten = _whitener(relative)
    best, with_k = _best(tau, log_observed + bias, whiten, best, (low, slowest), starts=3)
    return _banded(tau, log_observed + bias, whiten, best, (low, slowest), with_k=with_k)


def _whitener(spread: Array) -> Callable[[Array], Array]:
    lower = cholesky(spread + 1e-12 * np.diag(np.diag(spread)), lower=True)
    return lambda r: np.asarray(solve_triangular(lower, r, lower=True), dtype=np.float64)


def _start(tau: Array, observed: Array) -> Array:
    n = np.sqrt(observed[0] * tau[0])
    middle = tau[len(tau) // 2]
    start: Array = np.log([n, np.sqrt(observed.min()), middle, np.sqrt(3 * observed[-1] / tau[-1]) * 0.1])
    return start


def _numbers(p: Array, low: Array, slowest: float) -> tuple[float, float, float, float]:
    n, b, t, k = np.clip(p, low - _RANGE, low + _RANGE)
    t = min(max(float(t), float(low[2])), slowest)
    return float(np.exp(n)), float(np.exp(b)), float(np.exp(t)), float(np.exp(k))


def _residual(
    tau: Array, target: Array, whiten: Callable[[Array], Array], ends: tuple[Array, float]
) -> Callable[[Array], Array]:
    def residual(p: Array) -> Array:
        return whiten(target - np.log(variance(tau, *_numbers(p, *ends))))

    return residual


def _minimum(residual: Callable[[Array], Array], start: Array, free: list[int]) -> tuple[float, Array]:
    """The least misfit over the free numbers and its place; the other numbers stay at ``start``."""

    def part(q: Array) -> Array:
        p = start.copy()
        p[free] = q
        return residual(p)

    found = least_squares(part, start[free], method="lm", max_nfev=400)
    p = start.copy()
    p[free] = found.x
    return 2 * float(found.cost), p


def _best(
    tau: Array, target: Array, whiten: Callable[[Array], Array], start: Array, ends: tuple[Array, float], *, starts: int
) -> tuple[Array, bool]:
    """The best numbers, and whether the record shows a rate random walk; without one K is 0."""
    residual = _residual(tau, target, whiten, ends)
    low = ends[0]
    times = np.linspace(low[2] + 1.0, ends[1], starts + 2)[1:-1]
    tried = [start, *(np.r_[start[0], start[1], t, start[3]] for t in times)]
    without = min((_minimum(residual, np.r_[s[:3], low[3] - _RANGE], [0, 1, 2]) for s in tried), key=lambda f: f[0])
    restart = [np.r_[s[:3], low[3] - 1.0] for s in (*tried, without[1])]
    full = min((_minimum(residual, s, [0, 1, 2, 3]) for s in restart), key=lambda f: f[0])
    quiet = np.r_[start[0], low[1] - _RANGE, start[2], low[3] - _RANGE]
    white = _minimum(residual, quiet, [0])
    only = _minimum(residual, np.r_[full[1][0], low[1] - _RANGE, start[2], low[3] - 1.0], [0, 3])
    if only[0] < white[0] - SIGNIFICANT and only[0] < min(without[0], full[0]) + SIGNIFICANT:
        # A walk alone explains the slow part, and the bias is 0.
        return only[1], True
    if full[0] < without[0] - SIGNIFICANT:
        return full[1], True
    return without[1], False


def _banded(
    tau: Array, target: Array, whiten: Callable[[Array], Array], best: Array, ends: tuple[Array, float], *, with_k: bool
) -> NoiseFit:
    residual = _residual(tau, target, whiten, ends)
    low = ends[0]
    least, top = _minimum(residual, np.r_[best[:3], max(best[3], low[3] - 1.0)], [0, 1, 2, 3])
    own = float(np.sum(residual(best) ** 2))
    if own < least:
        least, top = own, best
    nothing = best < low - np.log(1 / _NOTHING)
    n, b, t, k = (
        0.0 if z and name != "bias_time" else v
        for name, z, v in zip(NAMES, nothing, _numbers(best, *ends), strict=True)
    )
    values = n, b, t, k if with_k else 0.0
    bands = {}
    for j, name in enumerate(NAMES):
        others = [i for i in range(4) if i != j]
        reach = (low[j], ends[1]) if name == "bias_time" else (low[j] - np.log(1 / _NOTHING), low[j] + 12.0)
        down, up = (_end(residual, [top, best], j, others, least + LEVEL, sign, reach) for sign in (-1.0, 1.0))
        bands[name] = (min(down, values[j]), max(up, values[j]))
    return NoiseFit(values, bands)


def _end(
    residual: Callable[[Array], Array],
    starts: list[Array],
    j: int,
    others: list[int],
    limit: float,
    sign: float,
    reach: tuple[float, float],
) -> float:
    """The end of a number's band to one side, where the misfit passes the limit; 0 or infinity beyond its range."""
    warm = list(starts)

    def misfit(x: float) -> float:
        found = []
        for s in warm:
            p = s.copy()
            p[j] = x
            found.append(_minimum(residual, p, others))
        least = min(found, key=lambda f: f[0])
        warm[:] = [starts[0], least[1]]
        return least[0]

    inside, step = float(np.clip(starts[0][j], *reach)), 0.05
    while True:
        outside = inside + sign * step
        if outside < reach[0]:
            return 0.0
        if outside > reach[1]:
            return float("inf")
        if misfit(outside) > limit:
            break
        inside, step = outside, 2 * step
    for _ in range(6):
        middle = 0.5 * (inside + outside)
        if misfit(middle) > limit:
            outside = middle
        else:
            inside = middle
    return float(np.exp(outside))
