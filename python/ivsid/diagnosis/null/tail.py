"""Scores of null logs: the threshold that their tail gives, and whether they decide about a finding.

Source: Pickands, "Statistical inference using extreme order statistics", Annals of Statistics 3, 1975.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtrc, ndtri

from ivsid.diagnosis.null.thresholds import TAIL, TAIL_SLOPE

Array = NDArray[np.float64]
# From this number of logs on the tail starts at the last tenth, whose mean excess is then known to a third.
# Source: definition: standard error of the mean of ten exponential excesses
MANY: Final = 100
# Share of the scores that lie in the tail where there are fewer logs.
# Source: measured: make constants
TAIL_OF_FEW: Final = 0.5
# Fewest null logs that give a threshold.
# Source: definition: standard error of the mean of ten exponential excesses
FEWEST: Final = 10
# Probability that a look decides wrongly, over all looks and on each side.
# Source: definition: 2.3 % of normal errors lie beyond two standard deviations on one side
UNSURE: Final = 0.023
# Share of null logs that leave the programme beyond which null logs give no threshold.
# Source: measured: make constants
MOST_LOST: Final = 0.2


@dataclass(frozen=True)
class NullTest:
    """Scores of null logs.

    Attributes:
        strengths: minus the natural logarithm of the smallest chance, by null log, shape (logs,); NaN for a lost motion.
        passed: whether the null log passed the threshold of theory, by null log, shape (logs,).
        level: probability with which a null log may exceed the threshold.
        cached: number of these null logs that were read from the cache.
        first: threshold of the chance by theory: of the Gaussian draws for names, of chi-squared for structure.
    """

    strengths: Array
    passed: NDArray[np.bool_]
    level: float
    cached: int = 0
    first: float = 1.0

    def joined(self, more: NullTest) -> NullTest:
        """These null logs and further ones."""
        return replace(self, strengths=np.r_[self.strengths, more.strengths], passed=np.r_[self.passed, more.passed])

    def first_of(self, count: int) -> NullTest:
        """The first ``count`` null logs."""
        return replace(self, strengths=self.strengths[:count], passed=self.passed[:count])

    @property
    def kept(self) -> Array:
        """Strengths of the logs that stayed near the programme, shape (kept,)."""
        return self.strengths[np.isfinite(self.strengths)]

    @property
    def usable(self) -> bool:
        """Whether enough logs stayed near the programme for a threshold."""
        return self.kept.size >= max(FEWEST, (1 - MOST_LOST) * self.strengths.size)

    def threshold(self, sigmas: float = 0.0) -> float:
        """Strength that a null log exceeds with the probability ``level``, by an exponential tail.

        Args:
            sigmas: standard deviations of the tail's slope that are added, to the safe side.
        """
        x = self.kept
        share = TAIL if x.size >= MANY else TAIL_OF_FEW
        start = float(np.quantile(x, 1 - share))
        excess = x[x >= start] - start
        slope = max(float(excess.mean()), TAIL_SLOPE)
        slope *= 1.0 + sigmas / np.sqrt(max(excess.size, 1))
        return float(start + slope * np.log(share / self.level))

    @property
    def least(self) -> float:
        """Strength below which a finding is no rarer than null logs, by the exact binomial probability, if lost ones lie below all others; 0 if there is none."""
        x = np.sort(self.kept)[::-1]
        too_many = bdtrc(np.arange(x.size), self.strengths.size, self.level) <= UNSURE
        return float(x[np.argmax(too_many)]) if too_many.any() else 0.0

    @property
    def chance(self) -> float:
        """Threshold of the chance, never looser than that of theory: by the tail of the scores, or by their number where too many logs are lost for a tail."""
        return min(self.first, float(np.exp(-(self.threshold() if self.usable else self.least))))

    def decides(self, strength: float, looks: int) -> bool:
        """Whether these null logs decide about a finding, so that further ones need not be examined.

        It stands if it exceeds the threshold by more than the threshold may be too low. It falls if null logs exceed it more often than the
        level allows, by the exact binomial probability.

        Args:
            strength: of the finding, or of the structure.
            looks: number of looks among which the probability of a wrong decision is divided.
        """
        chance = UNSURE / looks
        if strength >= self.threshold(-float(ndtri(chance))):
            return True
        beyond = int((self.kept > strength).sum())
        return strength < self.threshold() and float(bdtrc(beyond - 1, self.kept.size, self.level)) <= chance

    def record(self) -> dict[str, object]:
        """The entry ``calibration.simulated`` of result.json."""
        return {
            "logs": int(self.kept.size),
            "lost": int(self.strengths.size - self.kept.size),
            "achieved": float(self.passed.sum() / max(self.kept.size, 1)),
            "threshold": float(np.exp(-self.threshold())) if self.usable else None,
            "cached": self.cached,
        }


def null_test(every: Sequence[tuple[float, bool]], level: float) -> NullTest:
    """The scores of null logs, and whether each passed, in order."""
    return NullTest(np.array([s for s, _ in every]), np.array([p for _, p in every], dtype=bool), level)
