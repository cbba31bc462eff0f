"""Threshold of the smallest chance over all families without an effect, by Gaussian draws of all scores.

The innovations of a true model are white, and signatures depend on the past alone. Without an effect the scores of all columns are
therefore jointly Gaussian, and their covariance is the Gram matrix of this log. A draw of all scores keeps the correlations between
families, their grids and their step times, and costs no simulation.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

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
# Source: resource: a tenth of a second for all families
DRAWS: Final = 400
# Share of the scores in the tail whose mean excess extrapolates to the level.
# Source: definition: forty of 400 draws, whose mean excess is known to 16 %
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
    g, base = fit.gram, list(fit.base)
    rng = np.random.default_rng(seed)
    c = len(g.names)
    p = fit.projection
    inner = p.normal
    # Declared errors scatter by their priors, and that scatter belongs to the draw of a score.
    spread = np.zeros((draws, len(base)))
    known = g.prior[base] > 0
    spread[:, known] = rng.standard_normal((draws, int(known.sum()))) / np.sqrt(g.prior[base][known])
    scores = np.empty((draws, len(g.blocks), c))
    for b, block in enumerate(g.blocks):
        values, vectors = np.linalg.eigh(block)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        scores[:, b] = rng.standard_normal((draws, c)) @ root.T + spread @ block[base]
    total = scores.sum(axis=1)
    fitted = np.linalg.solve(inner, total[:, base].T).T
    left = total - fitted @ p.total[base]
    chances = [
        _family(fit, family, scores, left, fitted, inner)
        for family in fit.families
        if family.variants and family.id in visible
    ]
    if not chances:
        return Calibration(level, level, 0, seed, np.zeros(0))
    smallest = np.sort(np.min(chances, axis=0))
    strength = -np.log(np.maximum(smallest, 1e-300))
    start = float(np.quantile(strength, 1 - TAIL))
    slope = max(float(np.mean(strength[strength >= start] - start)), TAIL_SLOPE)
    threshold = float(np.exp(-(start + slope * np.log(TAIL / level))))
    return Calibration(level, threshold, draws, seed, smallest)


def _family(fit: Fit, family: Family, scores: Array, left: Array, fitted: Array, inner: Array) -> Array:
    """Chance of a family's fall of chi-squared in each draw, shape (draws,)."""
    g, p = fit.gram, fit.projection
    parameters = family.effect.parameters
    if family.kind == "step":
        j = g.at(family.variants[0])[0]
        later = np.cumsum(g.blocks[::-1, j, :], axis=0)[::-1]
        cross = later[:, list(fit.base)]
        H = later[:, j] - np.einsum("bi,bi->b", cross, np.linalg.solve(inner, cross.T).T)
        s = np.cumsum(scores[:, ::-1, j], axis=1)[:, ::-1] - fitted @ cross.T
        usable = H / max(float(later[0, j]), 1e-300) > LEAST_SHARE
        usable[:EDGE] = usable[len(usable) - EDGE :] = False
        fall = np.where(usable, s**2 / np.where(usable, H, 1.0), 0.0).max(axis=1)
        return np.asarray(np.minimum(1.0, chi2.sf(fall, 2) * len(H) / STARTS_A_LOOK))
    best = np.zeros(len(left))
    for names in family.variants:
        at = g.at(names)
        H = p.information(at)
        values, vectors = np.linalg.eigh(H)
        keep = values > DEPENDENT * max(float(values.max()), 1e-300)
        z = left[:, at] @ vectors[:, keep] / np.sqrt(values[keep])
        fall = (z**2).sum(axis=1)
        if len(at) == 1 and not parameters[0].signed and family.kind != "claim":
            fall = np.where(left[:, at[0]] > 0, fall, 0.0)
        best = np.maximum(best, fall)
    looks = 1.0 + LOOKS_A_VALUE * len(family.variants) if family.kind == "secant" else 1.0
    count = 1 if family.kind == "secant" else len(family.variants[0])
    sided = family.kind != "claim" and len(parameters) == 1 and not parameters[0].signed
    return np.asarray(np.minimum(1.0, chi2.sf(best, count) * looks * (0.5 if sided else 1.0)))
