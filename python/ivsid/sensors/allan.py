"""Allan deviation of a static recording: random walk, bias instability and rate random walk (paper V.A, eq. 15, Figs 1-2).

The curve is the overlapping Allan deviation of allantools. ``allan_fit`` fits to it a random walk N, a first-order Gauss-Markov bias
(standard deviation B, time T) and a rate random walk K together, from the averaging time on at which the white part starts. The bias makes
a hump that peaks at 0.617 B near tau = 1.89 T. Flicker noise takes its place where it explains more; it makes the curve flat. The lowest
point of the curve divided by 0.664 is the classical flicker coefficient.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import allantools
import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from ivsid.errors import IvsidError
from ivsid.sensors.allan_fit import fit_noise, octaves
from ivsid.sensors.allan_model import Noise, relative_variances, variance
from ivsid.sensors.noise import sigma_published
from ivsid.sensors.recording import Signs, motion, signs

# Allan deviation of flicker noise divided by its bias instability, sqrt(2 ln(2) / pi).
# Source: definition: IEEE Std 952-1997, bias instability.
FLICKER: Final = 0.664
# Points of the drawn curve.
# Source: resource: bounds the time of an analysis, one pass over the record a point.
POINTS: Final = 40
# Samples below which a recording is refused: five octaves for the four numbers of the fit need 96.
# Source: theorem: a fit of four numbers has a degree of freedom only with five points.
MINIMUM_SAMPLES: Final = 100


@dataclass(frozen=True)
class AllanDeviation:
    """The Allan deviation of one channel and the numbers fitted to it.

    Attributes:
        channel: its name.
        taus: averaging times [s], shape (n,).
        deviation: overlapping Allan deviation, in the channel's unit, shape (n,).
        error: standard error of each point under the fitted noise, shape (n,).
        band: 95 % band of the deviation at each point (chi^2 with the degrees of freedom of the fitted noise), shape (2, n).
        random_walk: N [unit sqrt(s)].
        bias_instability: B, the standard deviation of the Gauss-Markov bias, or the coefficient of flicker noise [unit].
        bias_time: T [s]; for flicker noise the shortest time that the fit counts as a bias.
        rate_random_walk: K [unit/sqrt(s)]; 0 if the record shows none.
        bands: the 95 % band of each of these four numbers by its name here; ends that the record leaves open are 0 or infinite.
        short: C [unit^2 s^2], the part of the sensor's filter (below 0) or of noise of increments (above 0).
        start: shortest averaging time of the fit [s].
        flicker: whether the bias is flicker noise.
        explained: whether chance explains the misfit of the fit; else its bands are widened.
        resolved: whether the bias shows inside the record; else B is the largest that the fit tolerates, not a measurement.
        floor: lowest deviation over 0.664, the classical flicker coefficient [unit].
        floor_time: averaging time of the lowest deviation [s].
        sigma_c: eq. 15 with the record's period and T [unit].
        mean: mean reading [unit].
        signs: a filter, steps, a sinusoid or a drift in the recording.
        motion: frequency [Hz] of a motion of the sensor that makes a hump in the curve; None if there is none.
        period: of the samples [s].
        coarse: whether the steps of the readings are larger than their noise, so that rounding is no white noise.
        white_bound: N for a sensor bound [unit sqrt(s)]: noise of increments counts as white noise of the same size at a sample.
        bias_bound: B for a sensor bound [unit]: flicker noise counts with its standard deviation over a record of this length.
    """

    channel: str
    taus: NDArray[np.float64]
    deviation: NDArray[np.float64]
    error: NDArray[np.float64]
    band: NDArray[np.float64]
    random_walk: float
    bias_instability: float
    bias_time: float
    rate_random_walk: float
    bands: Mapping[str, tuple[float, float]]
    short: float
    start: float
    flicker: bool
    explained: bool
    resolved: bool
    floor: float
    floor_time: float
    sigma_c: float
    mean: float
    signs: Signs
    motion: float | None
    period: float
    coarse: bool
    white_bound: float
    bias_bound: float

    def model(self, taus: NDArray[np.float64]) -> NDArray[np.float64]:
        """The fitted deviation at averaging times [s], in the channel's unit; NaN below the shortest of the fit."""
        bias, flicker = (0.0, self.bias_instability) if self.flicker else (self.bias_instability, 0.0)
        fitted = variance(taus, self.random_walk, bias, self.bias_time, self.rate_random_walk, self.short, flicker)
        return np.sqrt(np.where(taus > 0.999 * self.start, fitted, np.nan))


def allan_deviation(channel: str, values: NDArray[np.float64], period: float) -> AllanDeviation:
    """The Allan deviation of one channel of a static recording, with the noise fitted to it.

    Args:
        channel: its name, for messages.
        values: readings at a steady rate, shape (n,), n >= 100.
        period: of the readings [s].

    Raises:
        IvsidError: too few samples, missing samples, or a constant channel.
    """
    if values.size < MINIMUM_SAMPLES:
        raise IvsidError(
            f"channel {channel} has {values.size} samples; an Allan deviation needs at least {MINIMUM_SAMPLES}"
        )
    if np.isnan(values).any():
        raise IvsidError(f"channel {channel} misses samples; an Allan deviation needs a gap-free record: cut one out")
    if np.ptp(values) == 0:
        raise IvsidError(f"channel {channel} is constant at {values[0]:g}; a live sensor is needed")
    longest = values.size / 5
    grid = np.unique(np.round(np.geomspace(1, longest, POINTS)).astype(int))
    powers = octaves(values.size)
    wanted = np.union1d(grid, powers)
    with np.errstate(divide="ignore", invalid="ignore"):
        taus, deviation, _, _ = allantools.oadev(values, rate=1 / period, data_type="freq", taus=wanted * period)
    samples = np.round(taus / period).astype(np.int64)
    usable = np.isfinite(deviation) & (deviation > 0)
    fitted = usable & np.isin(samples, powers)
    if fitted.sum() < 4:
        raise IvsidError(
            f"channel {channel} repeats itself so that its Allan deviation vanishes; give a recording of a live sensor"
        )
    found = fit_noise(samples[fitted], deviation[fitted] ** 2, values.size, period)
    n, b, t, k = found.values
    start = float(samples[fitted][found.first] * period)
    noise = Noise(n, 0.0 if found.flicker else b, t, k, found.short, b if found.flicker else 0.0)
    shown = usable & (samples <= longest)
    taus, deviation, samples = taus[shown], deviation[shown], samples[shown]
    spread = relative_variances(noise, samples, values.size, period)
    freedom = 2 / spread
    error = deviation * np.sqrt(spread) / 2
    band = deviation * np.sqrt(np.stack([freedom / chi2.ppf(0.975, freedom), freedom / chi2.ppf(0.025, freedom)]))
    lowest = int(np.argmin(np.where(taus > 0.999 * start, deviation, np.inf)))
    hump = 1.89 * t
    humped = b * 0.617 > 0.5 * n / np.sqrt(hump) and 2 * taus[0] < hump < taus[-1]
    # Flicker noise of coefficient F has the variance F^2 ln(duration / period) / pi over a record.
    over_record = math.sqrt(math.log(values.size) / math.pi)
    seen = signs(values, period, n * n / period)
    return AllanDeviation(
        channel,
        taus,
        deviation,
        error,
        band,
        n,
        b,
        t,
        k,
        found.bands,
        found.short,
        start,
        found.flicker,
        bool(found.misfit <= chi2.ppf(0.999, found.freedom)),
        bool(found.flicker or humped),
        float(deviation[lowest]) / FLICKER,
        float(taus[lowest]),
        sigma_published(n, b, period, t),
        float(values.mean()),
        seen,
        motion(taus, deviation, band),
        period,
        seen.step is not None and seen.step > float(values.std()),
        math.sqrt(n * n + 2 * max(found.short, 0.0) / (3 * period)),
        b * over_record if found.flicker else b,
    )
