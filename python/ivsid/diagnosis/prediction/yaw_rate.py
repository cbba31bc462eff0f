"""The yaw rate of a vehicle that hardly turns, from its gyro and heading alone: its mean given all readings.

A filtered yaw rate that is mostly noise enters sway and surge by u r and v r. Its error is correlated with itself, so that masses and drags
come out wrong and structure appears (errors in variables). The mean of the yaw rate given the readings has an error that is not correlated
with it, so that regressors made of it have no such bias, and the error is one more noise. Readings later than a sample count as well: the
gyro and the heading know nothing of the errors of the other axes' sensors.

Source: Carroll, Ruppert, Stefanski and Crainiceanu, *Measurement Error in Nonlinear Models*, 2006, chapter 4 (regression calibration);
Wiener, *Extrapolation, Interpolation, and Smoothing of Stationary Time Series*, 1949.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.data.channels import Channels

Array = NDArray[np.float64]
# Width of the band over which the power of the yaw rate is averaged [Hz].
# Source: geometry: some sixty frequencies of a log of 300 s, whose mean power is known to an eighth; an autopilot's band is as wide
BAND: Final = 0.2
# Time by which the readings are mirrored at both ends of the log [s].
# Source: geometry: longer than the memory of a filter of this band
MIRRORED: Final = 20.0
# Time over which a line is put through the heading at either end of the log [s].
# Source: geometry: twenty readings at 10 Hz, in which a vehicle that hardly turns keeps its rate
ENDS: Final = 2.0
# Time over which the heading's distance from the sum of the yaw rates is averaged [s].
# Source: geometry: a hundred readings at 20 Hz, and short beside the time in which such sums drift
SETTLED: Final = 5.0
# Variance of the heading's slope that is added at every frequency, as a share of the gyro's.
# Source: geometry: a constant yaw rate would be known without an error otherwise
LEAST_SLOPE: Final = 1e-4


@dataclass(frozen=True)
class YawRate:
    """The yaw rate over a log, and what is known of its error.

    Attributes:
        rate: its mean given the readings [rad/s], shape (n,).
        heading: the heading that goes with it [rad], shape (n,), or None.
        error: standard deviation of the error by frequency, over the square root of the samples [rad/s], shape (frequencies,).
        length: samples that the frequencies belong to.
        biased: whether a bias of the gyro shifts it: no heading pins it.
    """

    rate: Array
    heading: Array | None
    error: Array
    length: int

    @property
    def spread(self) -> float:
        """Standard deviation of the error [rad/s]."""
        # Frequencies of a real signal stand for two each, but for the first and the last.
        return float(np.sqrt(np.mean(self.error**2)))

    def drawn(self, rng: np.random.Generator) -> Array:
        """A draw of the error [rad/s], shape (n,)."""
        white = np.fft.rfft(rng.standard_normal(self.length))
        return np.asarray(np.fft.irfft(white * self.error, self.length)[: self.rate.size])


def yaw_rate(log: Channels) -> YawRate:
    """The mean of the yaw rate given the gyro's readings and the heading's slopes, at all times of the log.

    At each frequency both readings are weighted by their noise. Their mean shrinks by the share of noise in its power (Wiener).
    """
    n, h = log.n, log.h
    pad = min(n - 2, round(MIRRORED / h))
    length = n + 2 * pad
    w = 2 * np.pi * np.fft.rfftfreq(length, h)

    def mirrored(x: Array, first: float = 0.0, last: float = 0.0, sign: float = 1.0) -> Array:
        return np.concatenate([2 * first + sign * x[pad:0:-1], x, 2 * last + sign * x[-2 : -pad - 2 : -1]])

    gyro = log.rate_noise**2
    weighted, weight = np.fft.rfft(mirrored(log.nu[2])) / gyro, np.full(w.size, 1 / gyro)
    if log.psi is not None:
        # A slope is taken over two steps: it sees less of fast turning, and its noise has the spectrum of a difference.
        seen = np.sinc(w * h / np.pi)
        noise = log.noise["psi"] ** 2 * (np.sin(w * h) / h) ** 2 + LEAST_SLOPE * gyro
        # Headings are turned about their ends, which are those of lines, so that the slopes go on as they came.
        count = max(3, round(ENDS / h))
        ends = np.arange(count)
        first = float(np.polyval(np.polyfit(ends, log.psi[:count], 1), 0))
        last = float(np.polyval(np.polyfit(ends, log.psi[-count:], 1), count - 1))
        slopes = np.gradient(mirrored(log.psi, first, last, -1.0), h)
        weighted = weighted + seen * np.fft.rfft(slopes) / noise
        weight = weight + seen**2 / noise
    mean, noise = weighted / weight, 1 / weight
    width = max(3, round(BAND * length * h))
    power = uniform_filter1d(np.abs(mean) ** 2 / length - noise, width, mode="nearest")
    # Less power than the scatter of such a mean is none.
    power = np.where(power > 2 * noise / np.sqrt(width), power, 0.0)
    share = power / (power + noise)
    rate = np.fft.irfft(mean * share, length)[pad : pad + n]
    heading = None
    if log.psi is not None:
        run = np.r_[0.0, np.cumsum(0.5 * h * (rate[1:] + rate[:-1]))]
        heading = run + uniform_filter1d(log.psi - run, max(1, round(SETTLED / h)), mode="nearest")
    return YawRate(rate, heading, np.sqrt(share * noise), length)
