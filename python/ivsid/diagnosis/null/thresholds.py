"""Threshold of the smallest chance over all families without an effect, by Gaussian draws of all scores.

The innovations of a true model are white, and signatures depend on the past alone. Without an effect the scores of all columns are
therefore jointly Gaussian, and their covariance is the Gram matrix of this log. A draw of all scores keeps the correlations between
families, their grids and their step times, and costs no simulation.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, erfc

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Candidate
from ivsid.diagnosis.estimation.kinds.step import beside
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.levels import split

Array = NDArray[np.float64]
# Gaussian draws of all scores.
# Source: resource: a third of a second; the tail of 1200 gives the threshold to 9 %, ln(0.1 / 0.005) / sqrt(1200)
DRAWS: Final = 12_000
# Draws that are made together.
# Source: resource: 20 MB of scores
BATCH: Final = 6_000
# Share of the scores in the tail whose mean excess extrapolates to the level.
# Source: definition: 1200 of 12,000 draws, whose mean excess is known to 3 %
TAIL: Final = 0.1
# Least slope of the tail: minus the logarithm of a uniform chance is exponential with slope 1.
# Source: definition: logarithm of a uniform variable
TAIL_SLOPE: Final = 1.0
# A fall of chi-squared is divided by this before the test: the noise is estimated, and fresh logs exceed the draws of a known noise.
# Source: measured: make null-logs
HIGH_SIDE: Final = 1.15


@dataclass(frozen=True)
class Calibration:
    """Threshold of a round.

    Attributes:
        level: probability of any false finding.
        chance: threshold below which the chance of a family passes.
        draws: number of Gaussian draws.
        seed: of the draws.
        smallest: smallest chance over the families by draw, sorted, shape (draws,).
    """

    level: float
    chance: float
    draws: int
    seed: int
    smallest: Array

    def record(self) -> dict[str, object]:
        """The entry ``calibration`` of result.json."""
        return {
            "family_wise": self.level,
            "method": "simulated null scores of this programme: Gaussian with the covariance of the log's own signatures, maximum over families",
            "logs": self.draws,
            "seed": self.seed,
            "threshold": self.chance,
            "achieved": float(np.mean(self.smallest <= self.chance)) if self.draws else None,
            "simulated": None,
            "verdict": split(),
        }


def calibrate(fit: Fit, visible: frozenset[str], level: float, seed: int, draws: int = DRAWS) -> Calibration:
    """Threshold of the smallest chance from Gaussian draws of the scores, with an exponential tail.

    Args:
        fit: of the plain model.
        visible: ids of the families that the log can show.
        level: probability of any false finding.
        seed: of the draws.
        draws: their number.
    """
    tested = [c for c in fit.candidates if c.variants and c.id in visible]
    if not tested:
        return Calibration(level, level, 0, seed, np.zeros(0))
    scores = _Scores(fit, tested, np.random.default_rng(seed))
    smallest = np.concatenate([scores.smallest(min(BATCH, draws - k)) for k in range(0, draws, BATCH)])
    smallest.sort()
    strength = -np.log(np.maximum(smallest, 1e-300))
    start = float(np.quantile(strength, 1 - TAIL))
    slope = max(float(np.mean(strength[strength >= start] - start)), TAIL_SLOPE)
    threshold = float(np.exp(-(start + slope * np.log(TAIL / level))))
    return Calibration(level, threshold, draws, seed, smallest)


class _Scores:
    """Gaussian draws of the scores of all columns over the log, and of steps from each block on, without any effect."""

    def __init__(self, fit: Fit, candidates: Sequence[Candidate], rng: np.random.Generator) -> None:
        self.candidates, self.rng = candidates, rng
        g, self.p = fit.gram, fit.projection
        p = self.p
        self.base, self.inner = np.array(fit.base, dtype=int), p.normal
        names = [n for c in candidates for n in c.names()]
        self.columns: list[int] = sorted({*fit.base, *g.at(names)})
        self.place = {k: i for i, k in enumerate(self.columns)}
        self.steps = [g.at(c.variants[0])[0] for c in candidates if c.starts]
        blocks, c = len(g.blocks), len(self.columns)
        self.blocks = blocks
        size = c + len(self.steps) * blocks
        covariance = np.empty((size, size))
        covariance[:c, :c] = p.total[np.ix_(self.columns, self.columns)]
        # A step's score sums the blocks from its start on, and two steps share the blocks after the later of them.
        self.later = [np.cumsum(g.blocks[::-1, j, :], axis=0)[::-1] for j in self.steps]
        start = np.maximum.outer(np.arange(blocks), np.arange(blocks))
        for a, _ in enumerate(self.steps):
            here = slice(c + a * blocks, c + (a + 1) * blocks)
            covariance[here, :c] = self.later[a][:, self.columns]
            covariance[:c, here] = covariance[here, :c].T
            for b, other in enumerate(self.steps):
                covariance[here, c + b * blocks : c + (b + 1) * blocks] = self.later[a][start, other]
        values, vectors = np.linalg.eigh(covariance)
        # The symmetric root: it is the same whatever the signs of the eigenvectors.
        self.root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
        known = g.prior[self.base] > 0
        self.known = self.base[known]
        self.deviation = 1.0 / np.sqrt(g.prior[self.known])
        # What one unit of a declared error adds to each score.
        at = [self.place[k] for k in self.known]
        self.spread = covariance[at]

    def smallest(self, draws: int) -> Array:
        """Smallest chance over the candidates in each of some draws, shape (draws,)."""
        drawn = self.rng.standard_normal((draws, len(self.root))) @ self.root
        # Declared errors scatter by their priors, and that scatter belongs to the draw of a score.
        drawn += (self.rng.standard_normal((draws, self.known.size)) * self.deviation) @ self.spread
        fitted = np.linalg.solve(self.inner, drawn[:, [self.place[k] for k in self.base]].T).T
        batch = _Batch(self, drawn, fitted)
        # Candidates of the same number of columns and the same number of looks share the largest fall: the chance is monotone in it.
        best: dict[tuple[int, float], Array] = {}
        for candidate in self.candidates:
            looks, fall = candidate.looks(self.blocks), candidate.null_fall(batch)
            best[looks] = np.maximum(best[looks], fall) if looks in best else np.asarray(fall)
        chances = [np.minimum(1.0, _chance(k, fall) * looks) for (k, looks), fall in best.items()]
        return np.asarray(np.min(chances, axis=0), dtype=np.float64)


def _chance(k: int, fall: Array) -> Array:
    """Probability that chi-squared exceeds falls; for one and two degrees of freedom in closed form, which takes a tenth of the time."""
    if k == 1:
        return np.asarray(erfc(np.sqrt(0.5 * fall)))
    return np.asarray(np.exp(-0.5 * fall) if k == 2 else chdtrc(k, fall))


class _Batch:
    """Some draws of all scores, as a candidate asks for them (``NullScores``)."""

    def __init__(self, scores: _Scores, drawn: Array, fitted: Array) -> None:
        self.p: Projection = scores.p
        self._scores, self._drawn, self._fitted = scores, drawn, fitted
        self._left = drawn[:, : len(scores.columns)] - fitted @ scores.p.total[scores.base][:, scores.columns]

    def of(self, names: Sequence[str]) -> Array:
        """Scores of columns over the log beside the base, shape (draws, columns)."""
        found: Array = self._left[:, [self._scores.place[k] for k in self.p.g.at(names)]]
        return found

    def since(self, name: str) -> tuple[Array, Array]:
        """Scores of a column from each block on beside the base, shape (draws, blocks), and their information, shape (blocks,)."""
        s = self._scores
        k = s.steps.index(self.p.g.at([name])[0])
        H, cross = beside(self.p, s.steps[k], s.later[k])
        first = len(s.columns) + k * s.blocks
        return self._drawn[:, first : first + s.blocks] - self._fitted @ cross.T, H
