"""Stage 5: how small the chance of the best family gets on this log's programme when no effect is there.

The prediction errors of a true model are white, and signatures are made of the past alone, so under no effect the scores of all columns
are jointly Gaussian with the Gram matrix of this very log as covariance. Drawing them costs next to nothing, and the largest of all
families, over their grids and step times, comes with its own correlations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from ivsid.diagnosis.candidates.families import EDGE
from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit

Array = NDArray[np.float64]
DRAWS: Final = 400
# Gains are divided by this before they are held against the threshold: the noise is estimated, not known.
HIGH_SIDE: Final = 1.15


@dataclass(frozen=True)
class Calibration:
    """The threshold of a round.

    Attributes:
        level: probability of any false finding.
        chance: a family passes whose own chance is below this.
        draws: null scores that it was made from.
        seed: of the draws.
        smallest: the smallest chance over the families of each draw, sorted, for reports.
    """

    level: float
    chance: float
    draws: int
    seed: int
    smallest: Array

    def record(self) -> dict[str, object]:
        """As in result.json."""
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
    """Draws null scores of every visible family, and takes the quantile of the smallest chance with an exponential tail."""
    g, base = fit.gram, list(fit.base)
    rng = np.random.default_rng(seed)
    c = len(g.names)
    p = fit.projection
    inner = p.total[np.ix_(base, base)] + np.diag(g.prior[base] + 1e-9)
    # What is declared scatters as its prior says: its own part of the score belongs to the draw.
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
    start = float(np.quantile(strength, 0.9))
    slope = max(float(np.mean(strength[strength >= start] - start)), 1e-6)
    # Waves and tethers are searched apart from this: one more share for them.
    threshold = float(np.exp(-(start + max(slope, 1.0) * np.log(0.1 / level))))
    return Calibration(level, threshold, draws, seed, smallest)


def _family(fit: Fit, family: Family, scores: Array, left: Array, fitted: Array, inner: Array) -> Array:
    """The chance of a family's gain in each draw, shape (draws,)."""
    g, p = fit.gram, fit.projection
    parameters = family.effect.parameters
    if family.kind == "step":
        j = g.at(family.variants[0])[0]
        later = np.cumsum(g.blocks[::-1, j, :], axis=0)[::-1]
        cross = later[:, list(fit.base)]
        H = later[:, j] - np.einsum("bi,bi->b", cross, np.linalg.solve(inner, cross.T).T)
        s = np.cumsum(scores[:, ::-1, j], axis=1)[:, ::-1] - fitted @ cross.T
        usable = H / max(float(later[0, j]), 1e-300) > 1e-6
        usable[:EDGE] = usable[len(usable) - EDGE :] = False
        fall = np.where(usable, s**2 / np.where(usable, H, 1.0), 0.0).max(axis=1)
        return np.asarray(np.minimum(1.0, chi2.sf(fall, 2) * len(H) / 6.0))
    best = np.zeros(len(left))
    for names in family.variants:
        at = g.at(names)
        H = p.information(at)
        values, vectors = np.linalg.eigh(H)
        keep = values > 1e-8 * max(float(values.max()), 1e-300)
        z = left[:, at] @ vectors[:, keep] / np.sqrt(values[keep])
        fall = (z**2).sum(axis=1)
        if len(at) == 1 and not parameters[0].signed and family.kind != "claim":
            fall = np.where(left[:, at[0]] > 0, fall, 0.0)
        best = np.maximum(best, fall)
    looks = 1.0 + 0.3 * len(family.variants) if family.kind == "secant" else 1.0
    count = 1 if family.kind == "secant" else len(family.variants[0])
    sided = family.kind != "claim" and len(parameters) == 1 and not parameters[0].signed
    return np.asarray(np.minimum(1.0, chi2.sf(best, count) * looks * (0.5 if sided else 1.0)))
