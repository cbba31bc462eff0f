"""The Allan variance of a sensor's noise, and the covariance of its estimates.

White noise N, a first-order Gauss-Markov bias (B, T), a rate random walk K, a short-time part C and flicker noise F give at averaging
time tau

    sigma^2 = N^2 / tau + (2 B^2 T / tau) (1 - T / (2 tau) (3 - 4 exp(-tau/T) + exp(-2 tau/T))) + K^2 tau / 3
              + C / tau^2 + (2 ln 2 / pi) F^2.

C is below 0 for white noise behind a low-pass filter, from averaging times on that are longer than the memory of the filter. It is above 0
for noise of increments, as 3 Q^2 of quantised angles (IEEE Std 952-1997, C.1.1). For Gaussian noise of spectrum S the theorems of Isserlis
and Parseval give the covariance 2/M integral S^2 |H_j|^2 |H_k|^2 df. H is the filter of the Allan variance, and M the larger of the two
numbers of differences.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

# Frequencies of the integral for the covariance, spaced geometrically.
# Source: measured: make constants
FREQUENCIES: Final = 4000

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Noise:
    """The noise of a sensor, in the channel's unit.

    Attributes:
        n: white noise N [unit sqrt(s)].
        b, t: standard deviation B [unit] and correlation time T [s] of the Gauss-Markov bias.
        k: rate random walk K [unit/sqrt(s)].
        c: short-time part C [unit^2 s^2], of either sign.
        f: flicker noise F [unit].
    """

    n: float
    b: float
    t: float
    k: float
    c: float = 0.0
    f: float = 0.0

    @property
    def delay(self) -> float:
        """Time constant [s] of the filter of first order that leaves a C below 0; a C above 0 is noise of increments."""
        return -2 * min(self.c, 0.0) / (3 * self.n**2) if self.n else 0.0

    def parts(self, tau: Array) -> Array:
        """The parts N, B, K, C, F of the Allan variance at averaging times [s], shape (5, m)."""
        x = tau / self.t
        # 1 - (3 - 4 exp(-x) + exp(-2x)) / (2x) cancels for small x, where its series x^2/3 - x^3/4 is used.
        safe = np.maximum(x, 1e-3)
        hump = np.where(x > 1e-3, 1 - (3 - 4 * np.exp(-safe) + np.exp(-2 * safe)) / (2 * safe), x * x / 3 - x**3 / 4)
        white = self.n**2 / tau
        # A filter takes away no more than there is: the floor keeps logarithms finite on the way of a search.
        short = np.maximum(self.c / tau**2, (1e-9 - 1) * white)
        flat = np.full_like(tau, 2 * np.log(2) / np.pi * self.f**2)
        return np.stack([white, 2 * self.b**2 / x * hump, self.k**2 * tau / 3, short, flat])

    def spectrum(self, f: Array, period: float) -> Array:
        """Two-sided spectrum of the samples at frequencies [1/sample], shape (m,), in the square of the unit."""
        half = np.pi * f
        decay = np.exp(-period / self.t)
        # A filter of second order (Butterworth) that leaves the same C: its power is flat up to its bandwidth, so that the covariance of the
        # shortest averages is not below that of any usual filter.
        # |1 - exp(-iw)|^2 = 4 sin^2(w/2); the sampled Gauss-Markov process is an autoregression of order 1.
        return np.asarray(
            self.n**2 / period / (1 + (2 * np.sqrt(2) * np.sin(half) * self.delay / period) ** 4)
            + 4 * max(self.c, 0.0) / 3 / period**2 * np.sin(half) ** 2
            + self.b**2 * (1 - decay**2) / ((1 - decay) ** 2 + 4 * decay * np.sin(half) ** 2)
            + self.k**2 * period / (4 * np.sin(half) ** 2)
            + self.f**2 / (2 * half),
            dtype=np.float64,
        )


def variance(tau: Array, n: float, b: float, t: float, k: float, c: float = 0.0, f: float = 0.0) -> Array:
    """The Allan variance at averaging times [s], shape (m,), in the square of the channel's unit (formula above)."""
    return np.asarray(Noise(n, b, t, k, c, f).parts(tau).sum(axis=0), dtype=np.float64)


def covariance(values: tuple[float, ...], m: NDArray[np.int64], samples: int, period: float) -> Array:
    """Covariance of overlapping estimates of the Allan variance, shape (q, q), in the fourth power of the channel's unit.

    Args:
        values: the numbers of a ``Noise``.
        m: averaging times in samples, shape (q,).
        samples: of the record.
        period: of the samples [s].
    """
    filtered, weight = _filtered(Noise(*values), m, samples, period)
    shared = 2 * (filtered * weight) @ filtered.T
    estimates = samples - 2 * m + 1
    return np.asarray(2 * shared / np.maximum.outer(estimates, estimates), dtype=np.float64)


def relative_variances(noise: Noise, m: NDArray[np.int64], samples: int, period: float) -> Array:
    """Variance of each estimate over the square of its expectation, both from the spectrum, shape (q,)."""
    filtered, weight = _filtered(noise, m, samples, period)
    variances = 4 * (filtered**2 @ weight) / (samples - 2 * m + 1)
    return np.asarray(variances / (2 * filtered @ weight) ** 2, dtype=np.float64)


def _filtered(noise: Noise, m: NDArray[np.int64], samples: int, period: float) -> tuple[Array, Array]:
    """The spectrum behind the filter of each averaging time, shape (q, f), and the weights of the frequencies."""
    f = np.geomspace(0.02 / samples, 0.5, FREQUENCIES)
    half = np.pi * f
    passed = np.stack([2 * np.sin(half * q) ** 4 / (q * np.sin(half)) ** 2 for q in m])
    return noise.spectrum(f, period) * passed, np.gradient(f)
