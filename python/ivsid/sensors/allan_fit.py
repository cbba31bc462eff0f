"""N, B, T and K from an Allan variance, with 95 % bands: generalised least squares on octaves of averaging time.

The model is that of ``allan_model``. Overlapping estimates at different tau share their samples, so that the misfit is weighted by their
covariance. Bands are profile likelihoods: all values of one number for which some choice of the others has a misfit at most 4.71 above the
best. A misfit that chance does not explain widens them by its ratio to its degrees of freedom.

A sensor's own filter and the steps of its readings shape the shortest averaging times. At a time tau that is longer than the memory of any
such filter, it leaves only C / tau^2 (docs/theory.md, "Allan variance"). The fit has C as a number of its own, and begins at the first
octave from which two further octaves may be left out without a fall of the misfit that chance does not explain.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import digamma, polygamma
from scipy.stats import chi2

from ivsid.sensors.allan_model import covariance
from ivsid.sensors.allan_search import RANGE, Task, best_mixture, whitener

NAMES: Final = ("random_walk", "bias_instability", "bias_time", "rate_random_walk")
# Rise of the misfit at the ends of a 95 % band: the 97 % quantile of chi^2 with one degree of freedom. The 95 % quantile held 94 % of the
# truths in 240 simulated sensors, because the choice of the first octave and of the mixture is no part of Wilks' theorem.
# Source: measured: make nightly (tests/python/test_allan_sensors.py)
LEVEL: Final = float(chi2.ppf(0.97, 1))
# Two octaves are left out if they raise the misfit by more than this, the 99 % quantile of chi^2 with two degrees of freedom.
# Source: theorem: Wilks, likelihood ratio.
FOREIGN: Final = float(chi2.ppf(0.99, 2))
# Octaves that a fit of N, B, T, K and C needs.
# Source: theorem: a fit of five numbers has a degree of freedom only with six points.
LEAST_OCTAVES: Final = 6
# Shortest correlation time of a bias [s], and in samples, and as a multiple of the shortest averaging time of the fit. A reading that
# forgets its error faster has noise behind a filter, and no bias.
# Source: measured: make test (tests/python/test_allan_sensors.py)
BIAS_SECONDS, BIAS_SAMPLES, BIAS_START = 1.0, 16, 4
# The white part starts at this multiple of the delay of the filter that its C tells, where exp(-6) of a first-order filter is left.
# Source: measured: make test (tests/python/test_allan_sensors.py)
MEMORY: Final = 6.0
# The record is at least as long as this multiple of the longest averaging time of the fit.
# Source: measured: make constants
LEAST_AVERAGES: Final = 6
# A number below this share of its scale in the record counts as 0.
# Source: definition: its part of the variance is 1e-12.
_NOTHING: Final = 1e-6

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NoiseFit:
    """The fitted noise.

    Attributes:
        values: N [unit sqrt(s)], B [unit], T [s], K [unit/sqrt(s)].
        short: C [unit^2 s^2], below 0 for a low-pass filter and above 0 for noise of increments.
        flicker: whether the bias is flicker noise; B is then its coefficient F, and T the shortest time that counts as a bias.
        bands: the 95 % band of each of ``values`` by its name in ``NAMES``; an end that the record leaves open is 0 or infinite.
        first: index of the shortest averaging time of the fit.
        misfit, freedom: chi^2 of the fit, and its degrees of freedom.
    """

    values: tuple[float, float, float, float]
    short: float
    flicker: bool
    bands: dict[str, tuple[float, float]]
    first: int
    misfit: float
    freedom: int


def octaves(samples: int) -> NDArray[np.int64]:
    """Averaging times of the fit in samples: powers of two, shape (m,)."""
    last = max(int(np.log2(max(samples / LEAST_AVERAGES, 1))), 3)
    return 2 ** np.arange(last + 1)


def fit_noise(m: NDArray[np.int64], observed: Array, samples: int, period: float) -> NoiseFit:
    """Fits N, B, T, K and C to overlapping Allan variances from the octave where the white part starts.

    Args:
        m: averaging times in samples, increasing, shape (q,).
        observed: Allan variances at these times, positive, shape (q,).
        samples: of the record.
        period: of the samples [s].
    """
    last = max(m.size - LEAST_OCTAVES, 0)
    fits: dict[int, _Fitted] = {}

    def fitted(first: int) -> _Fitted:
        if first not in fits:
            fits[first] = _fit_from(m[first:], observed[first:], samples, period)
        return fits[first]

    for first in range(last + 1):
        here = fitted(first)
        further = fitted(min(first + 2, last))
        if here.white and here.misfit - further.misfit < FOREIGN:
            # An octave that is only just acceptable still has a part of the filter in it.
            chosen = min(first + 1, last) if first else 0
            return _banded(fitted(chosen), chosen)
    # A curve that rises from its first octave is behind a filter that is longer than the fit can leave out. Any other shape is no filter.
    chosen = last if observed[1] > observed[0] else 0
    return _banded(fitted(chosen), chosen)


@dataclass(frozen=True)
class _Fitted:
    """A fit from one octave on.

    Attributes:
        task, place, misfit: its task, the best point and the chi^2 there.
        free: indices of the numbers that are not 0.
        modes: minima of every mixture.
        white: whether its shortest time is one of white noise, beyond the memory of the filter.
    """

    task: Task
    place: Array
    misfit: float
    free: list[int]
    modes: list[Array]
    white: bool


def _fit_from(m: NDArray[np.int64], observed: Array, samples: int, period: float) -> _Fitted:
    tau: Array = m.astype(np.float64) * period
    log_observed = np.log(observed)
    fastest = max(BIAS_SECONDS, BIAS_SAMPLES * period, BIAS_START * tau[0])
    # No record tells a bias slower than itself from a rate random walk.
    slowest = float(np.log(samples * period))
    fastest = min(fastest, math.exp(slowest - 1.0))
    scales = [observed[0] * tau[0], observed.min(), fastest**2, 3 * observed.min() / tau[-1], observed.min()]
    low: Array = np.log(scales) / 2
    # The first weights assume samples / m independent averages.
    whiten = whitener(np.diag(2.0 * m / samples))
    scale = float(observed[0] * tau[0] ** 2)
    task = Task(tau, log_observed, whiten, low, slowest, scale, m.size >= LEAST_OCTAVES)
    best = np.r_[low[:2], math.log(tau[len(tau) // 2]), low[3] - 1.0, 0.0, low[4] - RANGE]
    for turn in range(3):
        best, *_ = best_mixture(task, best, starts=5 if turn == 0 else 1)
        noise = task.noise(best)
        spread = covariance(astuple(noise), m, samples, period)
        model = noise.parts(tau).sum(axis=0)
        relative = spread / np.outer(model, model)
        # An estimate is distributed like chi^2 / nu: its logarithm has a negative bias and a variance above 2 / nu.
        nu = 2 / np.diag(relative)
        bias = np.log(nu / 2) - digamma(nu / 2)
        wider = np.sqrt(polygamma(1, nu / 2) / np.diag(relative))
        relative = relative * np.outer(wider, wider)
        task = replace(task, target=log_observed + bias, whiten=whitener(relative))
    best, free, modes = best_mixture(task, best, starts=3)
    noise = task.noise(best)
    n, b, k, _, f = noise.parts(tau)[:, 0]
    white = bool(n > b + k + f and tau[0] >= MEMORY * noise.delay)
    return _Fitted(task, best, float(np.sum(task.residual(best) ** 2)), free, modes, white)


def _banded(fitted: _Fitted, first: int) -> NoiseFit:
    task, best = fitted.task, fitted.place
    low = task.low
    bias = 5 if 5 in fitted.free else 1
    numbers = {"random_walk": 0, "bias_instability": bias, "bias_time": 2, "rate_random_walk": 3}
    slow = [0, 3, 5] if bias == 5 else [0, 1, 2, 3]
    starts = [np.r_[p[:3], max(p[3], low[3] - 1.0), p[4:]] for p in (best, *fitted.modes)]
    least, top = min((task.least(p, slow) for p in starts), key=lambda f: f[0])
    own = fitted.misfit
    least = min(own, least)
    freedom = max(task.tau.size - len(fitted.free) - task.with_short, 1)
    unexplained = max(1.0, own / freedom) if own > chi2.ppf(0.95, freedom) else 1.0
    limit = least + LEVEL * unexplained
    noise = task.noise(best)
    scale = np.r_[low[:4], 0.0, low[4]]
    nothing = best < scale - np.log(1 / _NOTHING)
    values = (
        0.0 if nothing[0] else noise.n,
        0.0 if nothing[bias] else (noise.f if bias == 5 else noise.b),
        math.exp(low[2]) if bias == 5 else noise.t,
        noise.k if 3 in fitted.free and not nothing[3] else 0.0,
    )
    bands = {}
    for name, value in zip(NAMES, values, strict=True):
        j = numbers[name]
        if j not in slow:
            bands[name] = (0.0, float("inf"))
            continue
        others = [i for i in slow if i != j]
        reach = (low[2], task.slowest) if j == 2 else (scale[j] - np.log(1 / _NOTHING), scale[j] + 12.0)
        down, up = (_end(task, [top, best, *fitted.modes], j, others, limit, sign, reach) for sign in (-1.0, 1.0))
        bands[name] = (min(down, value), max(up, value))
    return NoiseFit(values, noise.c, bias == 5, bands, first, own, freedom)


def _end(
    task: Task, starts: list[Array], j: int, others: list[int], limit: float, sign: float, reach: tuple[float, float]
) -> float:
    """The end of a number's band to one side, where the misfit passes the limit; 0 or infinity beyond its range."""
    last = starts[0]

    def passed(x: float) -> bool:
        # One mixture within the limit is enough; the one that was last within it is tried first.
        nonlocal last
        for s in (last, *starts):
            p = s.copy()
            p[j] = x
            misfit, place = task.least(p, others)
            if misfit <= limit:
                last = place
                return False
        return True

    inside, step = float(np.clip(starts[0][j], *reach)), 0.05
    while True:
        outside = inside + sign * step
        if outside < reach[0]:
            return 0.0
        if outside > reach[1]:
            return float("inf")
        if passed(outside):
            break
        inside, step = outside, 2 * step
    for _ in range(6):
        middle = 0.5 * (inside + outside)
        if passed(middle):
            outside = middle
        else:
            inside = middle
    return float(np.exp(outside))
