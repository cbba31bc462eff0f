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
from scipy.stats import chi2

from ivsid.diagnosis.candidates.families import EDGE, LOOKS_A_VALUE, STARTS_A_LOOK
from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit

Array = NDArray[np.float64]
# Probability of a false finding in a round: half of the 1 % of a diagnosis, since waves and tethers are searched beside it.
# Source: definition: at most 1 % of logs without an effect give a finding
LEVEL: Final = 0.005
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
# Share of its own signature that a step must keep beside the base to be scored.
# Source: measured: make constants
LEAST_SHARE: Final = 1e-6
# Eigenvalues of the information below this share of the largest belong to directions that the base explains.
# Source: definition: square root of the rounding unit of doubles
DEPENDENT: Final = 1e-8


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
    tested = [f for f in fit.families if f.variants and f.id in visible]
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

    def __init__(self, fit: Fit, families: Sequence[Family], rng: np.random.Generator) -> None:
        self.fit, self.families, self.rng = fit, families, rng
        g, self.p = fit.gram, fit.projection
        p = self.p
        self.base, self.inner = np.array(fit.base, dtype=int), p.normal
        names = [n for f in families if f.kind != "step" for v in f.variants for n in v]
        self.columns: list[int] = sorted({*fit.base, *g.at(names)})
        self.place = {k: i for i, k in enumerate(self.columns)}
        self.steps = [g.at(f.variants[0])[0] for f in families if f.kind == "step"]
        blocks, c = len(g.blocks), len(self.columns)
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
        """Smallest chance over the families in each of some draws, shape (draws,)."""
        drawn = self.rng.standard_normal((draws, len(self.root))) @ self.root
        # Declared errors scatter by their priors, and that scatter belongs to the draw of a score.
        drawn += (self.rng.standard_normal((draws, self.known.size)) * self.deviation) @ self.spread
        c, p, blocks = len(self.columns), self.p, len(self.fit.gram.blocks)
        fitted = np.linalg.solve(self.inner, drawn[:, [self.place[k] for k in self.base]].T).T
        left = drawn[:, :c] - fitted @ p.total[self.base][:, self.columns]
        # Families of the same number of columns and the same number of looks share the largest fall: the chance is monotone in it.
        best: dict[tuple[int, float], Array] = {}
        step = 0
        for family in self.families:
            if family.kind == "step":
                here = drawn[:, c + step * blocks : c + (step + 1) * blocks]
                kind, fall = (2, blocks / STARTS_A_LOOK), self._step(self.steps[step], self.later[step], here, fitted)
                step += 1
            else:
                kind, fall = _looks(family), self._family(family, left)
            best[kind] = np.maximum(best[kind], fall) if kind in best else fall
        chances = [np.minimum(1.0, chi2.sf(fall, k) * looks) for (k, looks), fall in best.items()]
        return np.asarray(np.min(chances, axis=0), dtype=np.float64)

    def _step(self, j: int, later: Array, score: Array, fitted: Array) -> Array:
        """Fall of chi-squared by the best step in each draw, shape (draws,)."""
        cross = later[:, self.base]
        H = later[:, j] - np.einsum("bi,bi->b", cross, np.linalg.solve(self.inner, cross.T).T)
        usable = H / max(float(later[0, j]), 1e-300) > LEAST_SHARE
        usable[:EDGE] = usable[len(usable) - EDGE :] = False
        s = score - fitted @ cross.T
        return np.asarray(np.where(usable, s**2 / np.where(usable, H, 1.0), 0.0).max(axis=1))

    def _family(self, family: Family, left: Array) -> Array:
        """Fall of chi-squared by the best variant of a family in each draw, shape (draws,)."""
        g, p = self.fit.gram, self.p
        parameters = family.effect.parameters
        best = np.zeros(len(left))
        for names in family.variants:
            columns = g.at(names)
            at = [self.place[k] for k in columns]
            values, vectors = np.linalg.eigh(p.information(columns))
            keep = values > DEPENDENT * max(float(values.max()), 1e-300)
            z = left[:, at] @ vectors[:, keep] / np.sqrt(values[keep])
            fall = (z**2).sum(axis=1)
            if len(at) == 1 and not parameters[0].signed and family.kind != "claim":
                fall = np.where(left[:, at[0]] > 0, fall, 0.0)
            best = np.maximum(best, fall)
        return best


def _looks(family: Family) -> tuple[int, float]:
    """Number of columns of a family that is no step, and the factor of its chance by the values that are searched and by its sign."""
    parameters = family.effect.parameters
    looks = 1.0 + LOOKS_A_VALUE * len(family.variants) if family.kind == "secant" else 1.0
    count = 1 if family.kind == "secant" else len(family.variants[0])
    sided = family.kind != "claim" and len(parameters) == 1 and not parameters[0].signed
    return count, looks * (0.5 if sided else 1.0)
