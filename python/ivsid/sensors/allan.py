"""Allan deviation of a static recording: random walk, bias instability and rate random walk (paper V.A, eq. 15, Figs 1-2).

The curve is the overlapping Allan deviation of allantools. ``allan_fit`` fits to it a random walk N, a first-order Gauss-Markov bias
(standard deviation B, time T) and a rate random walk K together. The bias makes a hump that peaks at 0.617 B near tau = 1.89 T. The
lowest point of the curve divided by 0.664 is the classical flicker coefficient.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import allantools
import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from ivsid.errors import IvsidError
from ivsid.sensors.allan_fit import covariance, fit_noise, octaves, variance
from ivsid.sensors.noise import sigma_published

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
        random_walk: N [unit/sqrt(s)].
        bias_instability: B, the standard deviation of the Gauss-Markov bias [unit].
        bias_time: T [s].
        rate_random_walk: K [unit/s/sqrt(s)]; 0 if the record shows none.
        bands: the 95 % band of each of these four numbers by its name here; ends that the record leaves open are 0 or infinite.
        resolved: whether the hump of the bias is inside the record; else B is the largest that the fit tolerates, not a measurement.
        floor: lowest deviation over 0.664, the classical flicker coefficient [unit].
        floor_time: averaging time of the lowest deviation [s].
        sigma_c: eq. 15 with the record's period and T [unit].
        mean: mean reading [unit].
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
    resolved: bool
    floor: float
    floor_time: float
    sigma_c: float
    mean: float

    def model(self, taus: NDArray[np.float64]) -> NDArray[np.float64]:
        """The fitted deviation at averaging times [s], in the channel's unit."""
        return np.sqrt(variance(taus, self.random_walk, self.bias_instability, self.bias_time, self.rate_random_walk))


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
    shown = usable & (samples <= longest)
    taus, deviation, samples = taus[shown], deviation[shown], samples[shown]
    model = variance(taus, n, b, t, k)
    spread = np.diag(covariance(found.values, samples, values.size, period)) / model**2
    freedom = 2 / spread
    error = deviation * np.sqrt(spread) / 2
    band = deviation * np.sqrt(np.stack([freedom / chi2.ppf(0.975, freedom), freedom / chi2.ppf(0.025, freedom)]))
    lowest = int(np.argmin(deviation))
    hump = 1.89 * t
    visible = b * 0.617 > 0.5 * n / np.sqrt(hump) and 2 * taus[0] < hump < taus[-1]
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
        bool(visible),
        float(deviation[lowest]) / FLICKER,
        float(taus[lowest]),
        sigma_published(n, b, period, t),
        float(values.mean()),
    )
