"""Allan deviation of a static recording -> random walk, bias instability, bounds (paper V.A, eq. 15, Figs 1-2).

The curve is the overlapping Allan deviation of allantools. Random walk N and a first-order Gauss-Markov bias (standard deviation
B, time T) are fitted to it together:

    sigma^2(tau) = N^2 / tau + (2 B^2 T / tau) (1 - T / (2 tau) (3 - 4 exp(-tau/T) + exp(-2 tau/T)))

whose hump peaks at 0.617 B near tau = 1.89 T. The lowest point of the curve over 0.664 is the classical flicker coefficient.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import allantools
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ivsid.errors import IvsidError
from ivsid.sensors import sigma_published

FLICKER: Final = 0.664
POINTS: Final = 40
MINIMUM_SAMPLES: Final = 100


@dataclass(frozen=True)
class AllanDeviation:
    """The curve of one channel and what was read off it.

    Attributes:
        channel: its name.
        taus: averaging times [s].
        deviation: overlapping Allan deviation, in the channel's unit.
        error: standard error of each point.
        random_walk: N [unit/sqrt(s)].
        bias_instability: B, the standard deviation of the Gauss-Markov bias [unit].
        bias_time: T [s].
        resolved: whether the hump of the bias stands inside the record; else B is what the fit tolerates, not a measurement.
        floor: lowest deviation over 0.664, the classical flicker coefficient [unit].
        floor_time: where the curve is lowest [s].
        sigma_c: eq. 15 with the record's period and T [unit].
        mean: mean reading [unit].
    """

    channel: str
    taus: NDArray[np.float64]
    deviation: NDArray[np.float64]
    error: NDArray[np.float64]
    random_walk: float
    bias_instability: float
    bias_time: float
    resolved: bool
    floor: float
    floor_time: float
    sigma_c: float
    mean: float

    def model(self, taus: NDArray[np.float64]) -> NDArray[np.float64]:
        """The fitted deviation at averaging times [s]."""
        return np.sqrt(_variance(taus, self.random_walk, self.bias_instability, self.bias_time))


def allan_deviation(channel: str, values: NDArray[np.float64], period: float) -> AllanDeviation:
    """Analyses one channel of a static recording.

    Args:
        channel: its name, for messages.
        values: readings at a steady rate, shape (n,), n >= 100.
        period: of the readings [s].

    Raises:
        IvsidError: too few samples, missing ones, or a constant channel.
    """
    if values.size < MINIMUM_SAMPLES:
        raise IvsidError(
            f"channel {channel} has {values.size} samples; an Allan deviation needs at least {MINIMUM_SAMPLES}"
        )
    if np.isnan(values).any():
        raise IvsidError(f"channel {channel} misses samples; an Allan deviation needs a gap-free record: cut one out")
    if np.ptp(values) == 0:
        raise IvsidError(f"channel {channel} is constant at {values[0]:g}; a live sensor is needed")
    longest = values.size * period / 5
    wanted = np.unique(np.round(np.geomspace(1, longest / period, POINTS)).astype(int)) * period
    taus, deviation, _, counts = allantools.oadev(values, rate=1 / period, data_type="freq", taus=wanted)
    usable = np.isfinite(deviation) & (deviation > 0) & (counts > 1)
    taus, deviation = taus[usable], deviation[usable]
    # Overlapping estimates have about n tau0 / tau independent averages (Riley, NIST SP 1065, 5.4).
    error = deviation / np.sqrt(2 * np.maximum(values.size * period / taus - 1, 1))
    n, b, t = _fit(taus, deviation, error)
    lowest = int(np.argmin(deviation))
    hump = 1.89 * t
    visible = b * 0.617 > 0.5 * n / np.sqrt(hump) and 2 * taus[0] < hump < taus[-1]
    return AllanDeviation(
        channel,
        taus,
        deviation,
        error,
        n,
        b,
        t,
        bool(visible),
        float(deviation[lowest]) / FLICKER,
        float(taus[lowest]),
        sigma_published(n, b, period, t),
        float(values.mean()),
    )


def _variance(tau: NDArray[np.float64], n: float, b: float, t: float) -> NDArray[np.float64]:
    x = tau / t
    # 1 - (3 - 4 exp(-x) + exp(-2x)) / (2x) loses all digits for small x; its series is x^2/3.
    hump = np.where(x > 1e-3, 1 - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / (2 * np.maximum(x, 1e-3)), x * x / 3)
    return np.asarray(n * n / tau + 2 * b * b / x * hump, dtype=np.float64)


def _fit(
    taus: NDArray[np.float64], deviation: NDArray[np.float64], error: NDArray[np.float64]
) -> tuple[float, float, float]:
    """N, B, T by weighted least squares on the logarithm of the curve, from several starts."""
    weight = deviation / error
    n0 = float(np.median(deviation[:3] * np.sqrt(taus[:3])))

    def residual(p: NDArray[np.float64]) -> NDArray[np.float64]:
        n, b, t = np.exp(p)
        return np.asarray(weight * (0.5 * np.log(_variance(taus, n, b, t)) - np.log(deviation)), dtype=np.float64)

    floor = float(deviation.min())
    low = np.log([n0 * 1e-3, floor * 1e-3, taus[0]])
    high = np.log([n0 * 1e3, float(deviation.max()) * 1e2, 20 * taus[-1]])
    starts = [np.log([n0, floor, t]) for t in np.geomspace(4 * taus[0], taus[-1], 4)]
    fits: list[Any] = [least_squares(residual, np.clip(s, low, high), bounds=(low, high)) for s in starts]
    best = min(fits, key=lambda f: f.cost)
    n, b, t = np.exp(best.x)
    return float(n), float(b), float(t)
