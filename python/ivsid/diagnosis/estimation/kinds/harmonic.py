"""Sines in time, a swell or a tide: their periods by one Fourier transform of the errors taken back through the filters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.kinds.searched import PEAKS, SearchedCandidate
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.effects import Harmonic

Array = NDArray[np.float64]
# Fewest samples in a period of a swell.
# Source: geometry: the forces of a step are evaluated at one moment, and a fifth of a period turns a wave by 72 degrees
SAMPLES_A_PERIOD: Final = 5.0
# Longest period of a swell, and shortest of a tide [s].
# Source: physics: gravity waves have periods up to 30 s, infragravity waves longer ones (Munk 1951)
LONGEST_SWELL: Final = 30.0
# Fewest periods of a swell in a log.
# Source: measured: make constants
PERIODS_A_LOG: Final = 20
# Longest period of a tide, in logs.
# Source: geometry: half a period of it passes in the log
LOGS_A_TIDE: Final = 2
# Factor by which the transform is padded with zeros.
# Source: geometry: the best of the padded frequencies is within an eighth of the log's own resolution of any frequency
PADDING: Final = 4
# Frequencies on either side of a peak that belong to it.
# Source: geometry: the main lobe of a log reaches PADDING of the padded frequencies to either side, and one more is none of its own
LOBE: Final = 5


@dataclass(frozen=True)
class HarmonicCandidate(SearchedCandidate):
    """A sine in time along one direction over ground."""

    @property
    def _flow(self) -> bool:
        """Whether the water moves; else a force acts."""
        return isinstance(self.effect.form, Harmonic) and self.effect.form.of == "flow"

    def search(self, s: Signatures, white: Whitening, back: Array) -> tuple[list[tuple[float, ...]], float]:
        """Periods [s]."""
        log, p = s.predictor.log, s.states.points
        n, h = log.n, log.h
        duration = n * h
        if self._flow:
            unit = s.flow_columns()
            low, high = LONGEST_SWELL, LOGS_A_TIDE * duration
        else:
            cosine, sine = np.cos(p.psi[:n]), np.sin(p.psi[:n])
            unit = np.stack(
                [
                    s.mass.solve(np.stack([cosine, -sine, 0 * cosine])),
                    s.mass.solve(np.stack([sine, cosine, 0 * cosine])),
                ]
            )
            low, high = SAMPLES_A_PERIOD * h, min(LONGEST_SWELL, duration / PERIODS_A_LOG)
        if high <= low:
            return [], 1.0
        padded = PADDING * n
        spectrum = np.zeros(padded // 2 + 1)
        for k in range(2):
            q = np.einsum("in,in->n", unit[k], back)
            spectrum += np.abs(np.fft.rfft(q, padded)) ** 2
        frequency = np.fft.rfftfreq(padded, h)
        inside = (frequency >= 1 / high) & (frequency <= 1 / low)
        weight = spectrum / np.maximum(_sensitivity(s, white, padded, unit), 1e-300)
        weight = np.where(inside, weight, 0.0)
        found: list[tuple[float, ...]] = []
        for _ in range(PEAKS):
            k = int(np.argmax(weight))
            if weight[k] <= 0:
                break
            found.append((float(1 / frequency[k]),))
            weight[max(0, k - LOBE) : k + LOBE + 1] = 0.0
        return found, float(max(1.0, inside.sum() / PADDING))

    def exact(self, s: Signatures, value: tuple[float, ...]) -> list[Array]:
        """Sine north, sine east, cosine north and cosine east."""
        return s.earth_flow(self.effect, value[0]) if self._flow else s.earth_wave(value[0])

    def numbers(self, value: tuple[float, ...], theta: tuple[float, ...]) -> tuple[float, ...]:
        """The numbers of the one wave closest to the four coefficients."""
        matrix = np.array([[theta[0], theta[2]], [theta[1], theta[3]]])
        left, size, right = np.linalg.svd(matrix)
        along = left[:, 0] * size[0]
        known = {
            "amplitude": float(size[0]),
            "direction": math.atan2(left[1, 0], left[0, 0]),
            "north": float(along[0]),
            "east": float(along[1]),
            "period": value[0],
            "phase": math.atan2(right[0, 1], right[0, 0]),
        }
        return tuple(known[p.part] for p in self.effect.parameters)


def _sensitivity(s: Signatures, white: Whitening, padded: int, unit: Array) -> Array:
    """Squared whitened errors that an acceleration of each frequency leaves, over the axes that the cause moves."""
    n = s.predictor.log.n
    impulse = np.zeros((3, 2 * n))
    total = np.zeros(padded // 2 + 1)
    for k in range(2):
        impulse[:] = 0.0
        impulse[k, 0] = impulse[k, n] = 1.0
        response = white(s.predictor.answer(impulse)[None])[0]
        total += np.mean(unit[:, k] ** 2) * (np.abs(np.fft.rfft(response, padded, axis=1)) ** 2).sum(axis=0)
    return total
