"""A force that repeats with the way that the vehicle makes through the water, and not with the time.

Vortices that a frame or a strut sheds come once in five of its widths, whatever the speed, and push with its square. Their spectrum over time is as
wide as that of the speed, so that they look like ambient force. Over the way it is a line. A swell is a line over time: at a steady speed it is one over the way
as well, so that a line counts where it stands out farther over the way than any does over time.

Source: docs/theory.md, "Rhythms"; Blevins, *Flow-Induced Vibration*, 1990, chapter 3 (Strouhal numbers); Fisher, "Tests of significance in harmonic
analysis", Proceedings of the Royal Society A 125, 1929.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.estimation.declared_errors import through_water
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.effects import CHANNELS

Array = NDArray[np.float64]
# Lengths of a repeat, in those of the hull.
# Source: geometry: five times the width of what sheds vortices, from a strut of a twenty-fifth of the hull's length to all of it
LENGTHS: Final = (0.2, 5.0)
# Fewest repeats in a log.
# Source: geometry: a mean of the spectrum is taken over half as many on either side
FEWEST: Final = 20
# Samples of a repeat at the speed that one sample in twenty exceeds.
# Source: geometry: twice as many as a sampled sine needs
SAMPLES: Final = 4.0
SWIFT: Final = 95.0
# Places in the shortest repeat.
# Source: geometry: a sine that holds over an eighth of its period keeps 0.97 of its size
PLACES: Final = 8
# Lines over which the mean of a spectrum is taken.
# Source: geometry: a mean of a hundred has an error of a tenth
WIDTH: Final = 101
# Height over that of the highest line over time from which on a line is one of the way.
# Source: measured: the examination; 29 sound logs of two strangers, swells among them, reached 1.6, and vortices 5.1
FARTHER: Final = 2.0


@dataclass(frozen=True)
class Rhythm:
    """The line of the way that stands out most.

    Attributes:
        channel: in which it acts.
        length: of a repeat [m].
        height: power over that of its neighbours.
        chance: probability of such a height over all lines and rows of white noise; 1 where a line over time is nearly as high.
    """

    channel: str = CHANNELS[0]
    length: float = 0.0
    height: float = 0.0
    chance: float = 1.0


def rhythm(fit: Fit) -> Rhythm:
    """The line of the way that stands out most of what a model leaves.

    Args:
        fit: of the model.
    """
    g, predictor = fit.gram, fit.noise.predictor
    rows, h = len(predictor.labels), predictor.log.h
    base = list(fit.base)
    errors = g.left(base, Projection(g, base).coefficients)
    u, v, _ = through_water(fit.signatures)
    speed = np.hypot(u, v)[: errors.shape[1]]
    way = h * np.cumsum(speed)
    hull = hull_length(predictor.vehicle)
    least = max(LENGTHS[0] * hull, SAMPLES * h * float(np.percentile(speed, SWIFT)))
    most = min(LENGTHS[1] * hull, float(way[-1]) / FEWEST)
    if not least < most:
        return Rhythm()
    step = least / PLACES
    place = (way / step).astype(np.int64)
    best = Rhythm()
    for (k, _), row in zip(predictor.labels, errors, strict=True):
        if k >= len(CHANNELS):
            continue
        pushed = row * speed**2
        at, heights = _heights(np.bincount(place, weights=pushed).astype(np.float64))
        at = at / step
        heights = np.where((at >= 1.0 / most) & (at <= 1.0 / least), heights, 0.0)
        j = int(np.argmax(heights))
        high = float(heights[j])
        if high > max(best.height, FARTHER * float(_heights(pushed)[1].max(initial=0.0))):
            count = rows * float(way[-1]) * (1.0 / least - 1.0 / most)
            best = Rhythm(CHANNELS[k], float(1.0 / at[j]), high, float(min(1.0, count * np.exp(-high))))
    return best


def _heights(x: Array) -> tuple[Array, Array]:
    """Frequencies of a series [1/sample], and its power over that of its neighbours at each: exponential in white noise."""
    power = np.abs(np.fft.rfft(x)) ** 2
    mean = uniform_filter1d(power, WIDTH, mode="mirror")
    return np.asarray(np.fft.rfftfreq(x.size)), np.asarray(power / np.maximum(mean, 1e-300))
