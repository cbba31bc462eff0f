"""Signs in a static recording of more than noise: a filter of the sensor, steps of the readings, a sinusoid, a drift.

None of these signs changes a number of the fit. They tell the reader which averaging times the fit leaves out, and why a recording says
less about the sensor than its length promises.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len, rfft

# Neighbouring bins of the spectrum that are taken together, where the record has enough of them.
# Source: theorem: the mean of 64 exponential variables has a standard deviation of 1/8, and half the plateau stands 4 of these below it.
BINS: Final = 64
# Decades of frequency that are divided, into twenty parts each.
# Source: resource: a record of 1e8 samples has as many.
DECADES: Final = 8
# Lowest bin in which a sinusoid is sought: slower ones are drifts.
# Source: definition: a sinusoid repeats itself in the record.
LEAST_PERIODS: Final = 8
# A sinusoid stands above the noise around it by this factor, times the logarithm of the number of bins.
# Source: theorem: the largest of n exponential variables exceeds 3 ln(n) with probability n^-2.
LINE: Final = 3.0
# Parts of the record whose means show a drift, and the degree of its polynomial.
# Source: definition: a cubic follows the slow warming of a sensor.
PARTS, DEGREE = 32, 3
# A drift is said if it makes the steps between the means larger by this factor, in variance.
# Source: measured: make test (tests/python/test_allan_sensors.py)
DRIFT: Final = 3.0
# Readings that are looked at for steps.
# Source: resource: bounds the time of the sorting
LOOKED: Final = 50_000
# Largest deviation from a whole number of steps.
# Source: definition: the rounding of printed decimals is far below it.
WHOLE: Final = 0.01

# The sinusoid of frequency f makes its largest Allan deviation at this number over f.
# Source: theorem: the maximum of sin(x)^4 / x^2 is at x = 1.1656, and x = pi f tau.
SWELL: Final = 0.371
# Bands of the curve stand apart by this factor of the variance before a hump counts.
# Source: measured: make test (tests/python/test_allan_sensors.py)
APART: Final = 1.25

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Signs:
    """More than noise in one channel.

    Attributes:
        bandwidth: frequency [Hz] at which the sensor's filter has halved the power of the white part; None if it does not.
        step: distance of neighbouring readings [unit]; None if they do not stand on steps.
        sinusoid: frequency [Hz] and amplitude [unit] of the largest one; None if there is none.
        drift: range of the slow course of the reading over the record [unit]; None if a random walk explains it.
    """

    bandwidth: float | None
    step: float | None
    sinusoid: tuple[float, float] | None
    drift: float | None


def signs(values: Array, period: float, white: float) -> Signs:
    """The signs in one channel.

    Args:
        values: readings at a steady rate, shape (n,).
        period: of the readings [s].
        white: spectrum of the white part, N^2 / period, in the square of the unit.
    """
    drift, course = _drift(values)
    size = next_fast_len(values.size, real=True)
    window = np.hanning(values.size)
    power = np.abs(rfft((values - course) * window, size)) ** 2 / np.sum(window**2)
    frequency = np.arange(power.size) / (size * period)
    inner = power[LEAST_PERIODS:-1]
    bins = max(min(BINS, inner.size // 8), 1)
    count = inner.size // bins
    blocks = inner[: count * bins].reshape(count, bins)
    # The maximum of a block stands against the median of its neighbours too: one line does not lift it.
    level = np.median(blocks, axis=1) / np.log(2)
    around = np.maximum(level, np.maximum(np.r_[level[:1], level[:-1]], np.r_[level[1:], level[-1:]]))
    ratio = blocks.max(axis=1) / np.maximum(around, np.finfo(float).tiny)
    # The lowest blocks are steep where slow noise leads.
    ratio[0] = 0.0
    k = int(np.argmax(ratio))
    sinusoid = None
    if ratio[k] > LINE * np.log(inner.size):
        j = LEAST_PERIODS + k * bins + int(np.argmax(blocks[k]))
        sinusoid = float(frequency[j]), float(2 * np.sqrt(power[j] * np.sum(window**2)) / np.sum(window))
    return Signs(_bandwidth(inner, frequency[LEAST_PERIODS:-1], white), _step(values), sinusoid, drift)


def motion(taus: Array, deviation: Array, band: Array) -> float | None:
    """The frequency [Hz] of a motion of the sensor that makes a hump in its Allan deviation; None if there is none.

    Of white noise, flicker noise, biases and walks, no one makes the variance times the averaging time fall. A rise and a fall behind it
    are the mark of a motion to and fro.

    Args:
        taus: averaging times [s], shape (n,).
        deviation: Allan deviation, shape (n,).
        band: its 95 % band, shape (2, n).
    """
    least, most = band**2 * taus
    before = np.r_[np.inf, np.minimum.accumulate(most)[:-1]]
    behind = np.r_[np.minimum.accumulate(most[::-1])[::-1][1:], np.inf]
    humps = np.flatnonzero(least > APART * np.maximum(before, behind))
    return float(SWELL / taus[humps[np.argmax(deviation[humps])]]) if humps.size else None


def _bandwidth(power: Array, frequency: Array, white: float) -> float | None:
    """The frequency from which on the mean power over a share of a decade is below half of the white part."""
    edges = np.unique(np.round(np.geomspace(1, power.size, DECADES * 20)).astype(int))
    kept = [0]
    for edge in edges.tolist():
        if edge - kept[-1] >= BINS:
            kept.append(edge)
    if len(kept) < 2 or white <= 0:
        return None
    begin = np.array(kept[:-1])
    counts = np.diff(kept)
    level = np.add.reduceat(power[: kept[-1]], begin) / counts
    low = np.flatnonzero(level < 0.5 * white)
    return float(frequency[begin[low[0]] + counts[low[0]] // 2]) if low.size else None


def _drift(values: Array) -> tuple[float | None, Array]:
    """The range of the slow course of a record, if a random walk does not explain it, and the course at every sample."""
    edges = np.linspace(0, values.size, PARTS + 1).astype(int)
    means = np.add.reduceat(values, edges[:-1]) / np.diff(edges)
    place = np.linspace(-1, 1, PARTS)
    course = np.polynomial.Polynomial.fit(place, means, DEGREE)
    whole = np.mean(np.diff(means) ** 2)
    rest = np.sum(np.diff(means - course(place)) ** 2) / (PARTS - 1 - DEGREE)
    slow = course(np.linspace(-1 - 1 / PARTS, 1 + 1 / PARTS, values.size))
    return (float(np.ptp(slow)) if whole > DRIFT * rest else None), np.asarray(slow, dtype=np.float64)


def _step(values: Array) -> float | None:
    """The step of the readings: the smallest distance, if all others are whole multiples of it."""
    part = values[:LOOKED]
    levels = np.unique(part)
    if levels.size < 2 or levels.size > part.size / 4:
        return None
    distances = np.diff(levels)
    # Equal decimals that went through a factor differ in their last bits.
    real = distances[distances > 1e-9 * max(np.ptp(levels), np.abs(levels).max())]
    if not real.size:
        return None
    step = float(real.min())
    off = np.abs(real / step - np.round(real / step))
    return step if off.max() < WHOLE * max(1.0, float((real / step).max()) * WHOLE) else None
