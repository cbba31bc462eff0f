"""Ambient forces of several spectra, all of them with the rms of the vehicle file.

Random ones, long gusts, bands and lines of a swell, single gusts, one wave of minutes, gusts that never turn, a square wave, and gusts that push
and turn at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from tests.exam.simulator import gauss_markov

# Correlation time of long gusts, in that of the vehicle file.
LONGER = 4.0
# Components of a swell, and its band in cycles per correlation time.
COMPONENTS, BAND = 200, (0.03, 0.5)
# Lines of a regular swell, at least and below, and their periods in correlation times.
LINES, PERIODS = (2, 13), (1.5, 8.0)
# Period of one wave: in correlation times at least, in lengths of the log at most.
SLOW_PERIODS = (8.0, 2.0)
# Width of a single gust, and the mean time between two of them, in correlation times.
GUST, BETWEEN = 1.0, 6.0
# Strengths of gusts that begin and end at once, each as often as the others.
STRENGTHS = (0.0, 0.0, 1.0, 1.6)


def _slow(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    return gauss_markov(n, h, deviation, LONGER * time, rng)


def _band(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """A flat spectrum between two frequencies, and nothing beside it, shape (n,)."""
    t = h * np.arange(n)
    low, high = BAND
    found = np.zeros(n)
    for w, phase in zip(rng.uniform(low, high, COMPONENTS), rng.uniform(0.0, 2 * math.pi, COMPONENTS), strict=True):
        found += np.sin(2 * math.pi * w / time * t + phase)
    return deviation * math.sqrt(2 / COMPONENTS) * found


def _lines(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """A few sines of random periods and equal height, shape (n,)."""
    t, count = h * np.arange(n), int(rng.integers(*LINES))
    waves = [
        np.sin(2 * math.pi * t / (time * period) + phase)
        for period, phase in zip(rng.uniform(*PERIODS, count), rng.uniform(0.0, 2 * math.pi, count), strict=True)
    ]
    return deviation * math.sqrt(2 / count) * np.sum(waves, axis=0)


def _gusts(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """Bumps of random height at random times, shape (n,)."""
    t, found = h * np.arange(n), np.zeros(n)
    for at in rng.uniform(0.0, n * h, max(round(n * h / (BETWEEN * time)), 1)):
        found += rng.standard_normal() * np.exp(-(((t - at) / (GUST * time)) ** 2))
    # A bump has the energy sqrt(pi / 2) of its width.
    return deviation * found / math.sqrt(math.sqrt(math.pi / 2) * GUST / BETWEEN)


def _minutes(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """One sine of a period between some correlation times and twice the log, shape (n,)."""
    shortest, longest = SLOW_PERIODS[0] * time, SLOW_PERIODS[1] * n * h
    period = math.exp(rng.uniform(math.log(shortest), math.log(longest)))
    return _to(np.sin(2 * math.pi * h * np.arange(n) / period + rng.uniform(0.0, 2 * math.pi)), deviation)


def _one_sided(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """Gusts that never turn, shape (n,)."""
    return float(rng.choice([-1.0, 1.0])) * _to(np.abs(gauss_markov(n, h, 1.0, time, rng)), deviation)


def _square(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """A force that jumps between two values, shape (n,)."""
    period = time * rng.uniform(*PERIODS)
    return deviation * np.where((h * np.arange(n) / period + rng.uniform()) % 1.0 < 0.5, 1.0, -1.0)


def _blown(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """Gusts of a few strengths that begin and end at once, with lulls between them, shape (n,)."""
    found, at = np.zeros(n), 0
    while at < n:
        count = 1 + round(rng.exponential(time) / h)
        found[at : at + count] = rng.choice(STRENGTHS)
        at += count
    return _to(found, deviation) if np.any(found) else found


def _to(x: np.ndarray, deviation: float) -> np.ndarray:
    """A force of another rms."""
    return deviation * x / math.sqrt(float(np.mean(x**2)))


SEAS: Mapping[str, Callable[[int, float, float, float, np.random.Generator], np.ndarray]] = {
    "markov": gauss_markov,
    "slow": _slow,
    "band": _band,
    "gusts": _gusts,
    "lines": _lines,
    "minutes": _minutes,
    "one-sided": _one_sided,
    "square": _square,
    "at once": _blown,
}
# Seas of which one series pushes ahead and sideways and turns.
AT_ONCE = frozenset({"at once"})
# Seed from which on a sea of lines is drawn: cases of earlier seeds, which pages name, stay what they were.
LINES_SINCE = 181000
# The same of waves of minutes and of gusts that never turn.
SLOW_SINCE = 235000
# The same of a square wave, and of gusts that push and turn at once.
JUMPS_SINCE = 250000


def drawn_sea(seed: int) -> str:
    """The sea of a seed, each as often as the others."""
    since = {
        "lines": LINES_SINCE,
        "minutes": SLOW_SINCE,
        "one-sided": SLOW_SINCE,
        "square": JUMPS_SINCE,
        "at once": JUMPS_SINCE,
    }
    known = [name for name in SEAS if seed >= since.get(name, 0)]
    return str(np.random.default_rng([seed, 6]).choice(known))


def drawn_force(
    sea: str, n: int, h: float, deviations: tuple[float, float, float], time: float, rng: np.random.Generator
) -> np.ndarray:
    """Force ahead and sideways, and moment, of a sea, shape (n, 3).

    Args:
        sea: its name.
        n: number of moments.
        h: time between two of them [s].
        deviations: rms of the forces [N] and of the moment [N m].
        time: correlation time of the vehicle file [s].
        rng: draws it.
    """
    if sea in AT_ONCE:
        sides = rng.choice([-1.0, 1.0], 3)
        return SEAS[sea](n, h, 1.0, time, rng)[:, None] * np.array(deviations) * sides
    return np.stack([SEAS[sea](n, h, deviation, time, rng) for deviation in deviations], axis=1)
