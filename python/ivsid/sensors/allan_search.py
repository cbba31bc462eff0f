"""The search for the numbers of a sensor's noise: one misfit, and its minima over the mixtures that a record can have.

A mixture has white noise and C, and beside them nothing, a Gauss-Markov bias (B, T), a rate random walk K, both, flicker noise F, or F and K.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import leastsq
from scipy.stats import chi2

from ivsid.sensors.allan_model import Noise

# A rate random walk enters the fit only if it lowers the misfit by more than this, the 99.9 % quantile; else K is 0.
# Source: theorem: Wilks, likelihood ratio.
SIGNIFICANT: Final = float(chi2.ppf(0.999, 1))
# Flicker noise takes the place of a Gauss-Markov bias if it lowers the misfit by more than this, the 99 % quantile of chi^2 with one degree
# of freedom.
# Source: theorem: Wilks, likelihood ratio.
FLICKERS: Final = float(chi2.ppf(0.99, 1))
# Half the range of the logarithm of a number in the fit.
# Source: definition: exp(25) = 7e10, so that squares stay far from overflow.
RANGE: Final = 25.0

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Task:
    """One fit: times, targets and weights, with the scales of its numbers.

    Attributes:
        tau: averaging times [s], shape (q,).
        target: logarithms of the Allan variances, shape (q,).
        whiten: from residuals to independent ones of variance 1.
        low: logarithms of the scales of N, B, T, K and F, shape (5,); T is at least its own.
        slowest: logarithm of the longest T.
        short: scale of C.
        with_short: whether C is free; else it is 0.
    """

    tau: Array
    target: Array
    whiten: Callable[[Array], Array]
    low: Array
    slowest: float
    short: float
    with_short: bool

    def noise(self, p: Array) -> Noise:
        """The noise at the point p of the search: logarithms of N, B, T and K, C in its scale, and the logarithm of F."""
        n, b, t, k, f = np.clip(p[[0, 1, 2, 3, 5]], self.low - RANGE, self.low + RANGE).tolist()
        t = min(max(t, float(self.low[2])), self.slowest)
        return Noise(math.exp(n), math.exp(b), math.exp(t), math.exp(k), float(p[4]) * self.short, math.exp(f))

    def residual(self, p: Array) -> Array:
        """Independent residuals of variance 1 at a point, shape (q,)."""
        return self.whiten(self.target - np.log(self.noise(p).parts(self.tau).sum(axis=0)))

    def slopes(self, p: Array, free: list[int]) -> Array:
        """Derivatives of the residuals by the free numbers, shape (q, len(free))."""
        noise = self.noise(p)
        n, b, k, c, f = noise.parts(self.tau)
        total = n + b + k + c + f
        step = math.log1p(1e-4)
        later = Noise(noise.n, noise.b, noise.t * math.exp(step), noise.k, noise.c, noise.f)
        by = (2 * n, 2 * b, (later.parts(self.tau)[1] - b) / step, 2 * k, self.short / self.tau**2, 2 * f)
        return self.whiten(-np.stack([by[j] / total for j in free], axis=1))

    def least(self, start: Array, free: list[int]) -> tuple[float, Array]:
        """The least misfit over the free numbers and its place; the other numbers stay at ``start``."""
        free = [*free, 4] if self.with_short and 4 not in free else free

        def point(q: Array) -> Array:
            p = start.copy()
            p[free] = q
            return p

        def slopes(q: Array) -> Array:
            return self.slopes(point(q), free)

        # SciPy's stubs know no array of float64 whose shape is open.
        found = leastsq(lambda q: self.residual(point(q)), start[free], Dfun=slopes, maxfev=400, full_output=True)  # type: ignore[call-overload]
        place: Array = found[0]
        best = point(place)
        return float(np.sum(self.residual(best) ** 2)), best


def whitener(spread: Array) -> Callable[[Array], Array]:
    """The map from residuals of this covariance, shape (q, q), to independent ones of variance 1."""
    lower = cholesky(spread + 1e-12 * np.diag(np.diag(spread)), lower=True)
    return lambda r: np.asarray(solve_triangular(lower, r, lower=True), dtype=np.float64)


def best_mixture(task: Task, start: Array, *, starts: int) -> tuple[Array, list[int], list[Array]]:
    """The best numbers, which of them describe the record (the others are 0), and the minima of every mixture."""
    low, c = task.low, start[4]
    no_b, no_k, no_f = low[1] - RANGE, low[3] - RANGE, low[4] - RANGE
    times = np.linspace(low[2], task.slowest, starts + 2)[1:-1]
    b = max(start[1], low[1] - 1.0)
    tried = [np.r_[start[0], b, t, start[3], c, no_f] for t in (start[2], *times)]
    without = min((task.least(np.r_[s[:3], no_k, c, no_f], [0, 1, 2]) for s in tried), key=lambda f: f[0])
    restart = [np.r_[s[:3], low[3] - 1.0, c, no_f] for s in (*tried, without[1])]
    full = min((task.least(s, [0, 1, 2, 3]) for s in restart), key=lambda f: f[0])
    white = task.least(np.r_[start[0], no_b, start[2], no_k, c, no_f], [0])
    only = task.least(np.r_[full[1][0], no_b, start[2], low[3] - 1.0, c, no_f], [0, 3])
    flicker = task.least(np.r_[start[0], no_b, start[2], no_k, c, low[4]], [0, 5])
    both = task.least(np.r_[flicker[1][0], no_b, start[2], low[3] - 1.0, c, flicker[1][5]], [0, 3, 5])
    one = min(without[0], full[0])
    modes = [p for _, p in (without, full, only)]
    if only[0] < white[0] - SIGNIFICANT and only[0] < min(one, both[0]) + SIGNIFICANT:
        # A walk alone explains the slow part, and the bias is 0.
        return only[1], [0, 3], modes
    found, free = (full[1], [0, 1, 2, 3]) if full[0] < without[0] - SIGNIFICANT else (without[1], [0, 1, 2])
    if min(flicker[0], both[0]) < one - FLICKERS:
        # Flicker noise explains more than a bias of one correlation time.
        modes = [flicker[1], both[1]]
        return (both[1], [0, 3, 5], modes) if both[0] < flicker[0] - SIGNIFICANT else (flicker[1], [0, 5], modes)
    return found, free, modes
