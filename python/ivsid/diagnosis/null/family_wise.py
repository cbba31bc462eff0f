"""Family-wise test: the causes whose fall of chi-squared is more than chance.

A family passes if its chance is below the threshold of the calibration and if half-minutes of the log agree on it. Falls that are too small
for any model of the noise, and sizes that no vehicle has, do not pass.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.stats import f as fisher

from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import AnyCurve, lost
from ivsid.diagnosis.null.thresholds import HIGH_SIDE, Calibration

# Blocks of the Gram matrix side by side that make half a minute.
# Source: definition: three blocks of 10 s
BLOCKS: Final = 3
# Chance that the second opinion may give: its blocks are few, so it is asked for less than the calibrated test.
# Source: measured: make constants
SECOND_OPINION: Final = 5e-3
# A fall of chi-squared from here on is no error of the noise model, and needs no second opinion: its few blocks may disagree because the
# fit is not finished. The largest fall in a hundred turning logs without an effect was 14.
# Source: measured: make constants
BEYOND_DOUBT: Final = 40.0
# The same where axes are left out: the largest fall without an effect was 90 there.
# Source: measured: make constants
BEYOND_DOUBT_AXES_LEFT_OUT: Final = 60.0
# A smaller fall of chi-squared is no finding, whatever its chance: below five standard deviations the model of the noise is not trusted, and
# fresh logs without an effect reach 19.
# Source: measured: make null-logs
FAINT: Final = 25.0
# Below this share of its typical size a cause is smaller than the errors of the equations.
# Source: measured: make constants
NEGLIGIBLE: Final = 0.01
# A cause beyond this multiple of its typical size is not possible.
# Source: measured: make constants
IMPOSSIBLE: Final = 50.0
# Singular values below this share of the largest belong to dependent directions.
# Source: measured: make constants
DEPENDENT: Final = 1e-9


def second_opinion(fit: Fit, s: Scored) -> float:
    """Probability of a fall of chi-squared without the effect, from the scatter of half-minutes and without a noise model.

    The scores of half-minutes give the sandwich covariance of the effect's numbers. Their Wald statistic is Hotelling's T², whose
    distribution is Fisher's F.

    Args:
        fit: of the model without the effect.
        s: the effect with its score.

    Source: White, "Maximum likelihood estimation of misspecified models", Econometrica 50, 1982; Hotelling, "The generalization of
    Student's ratio", Annals of Mathematical Statistics 2, 1931.
    """
    p = fit.projection
    g = fit.gram
    at = list(s.columns)
    if s.family.kind == "step":
        first = round((s.values[-1] - float(fit.noise.predictor.log.t[0])) / (g.length * fit.noise.predictor.log.h))
        keep = np.arange(len(g.blocks)) >= first
    else:
        keep = np.ones(len(g.blocks), dtype=bool)
    solved = np.linalg.solve(p.normal, p.total[np.ix_(p.base, at)])
    # Scores of the projected columns block by block, at the fit of the base.
    own = g.blocks[:, at][:, :, at] * keep[:, None, None]
    cross = g.blocks[:, at][:, :, p.base] * keep[:, None, None]
    score = (g.score[:, at] - cross @ p.coefficients) * keep[:, None]
    base_score = g.score[:, p.base] - g.blocks[:, p.base][:, :, p.base] @ p.coefficients
    score = score - base_score @ solved
    H = own - cross @ solved
    theta = np.linalg.lstsq(H.sum(axis=0), score.sum(axis=0), rcond=DEPENDENT)[0]
    left = score - H @ theta
    blocks = left.shape[0] // BLOCKS * BLOCKS
    left = left[:blocks].reshape(-1, BLOCKS, len(at)).sum(axis=1)
    whole = score.sum(axis=0)
    n, k = left.shape[0], len(at)
    if n <= k + 1:
        return 1.0
    V = left.T @ left
    wald = float(whole @ np.linalg.pinv(V, rcond=DEPENDENT) @ whole)
    return float(fisher.sf(wald * (n - k) / (n * k), k, n - k))


def _beside(fit: Fit, s: Scored, other: Scored) -> float:
    """Fall of chi-squared of one family beside another; infinite if the other is not physical, shares columns, or either is a step in time."""
    if not other.physical or "step" in (s.family.kind, other.family.kind) or set(s.columns) & set(other.columns):
        return float(np.inf)
    return Projection(fit.gram, [*fit.base, *other.columns]).solve(s.columns)[1]


@dataclass(frozen=True)
class Threshold:
    """Family-wise test of a round: the chance of every family against one threshold.

    Attributes:
        calibration: the threshold of this programme.
        visible: ids that the log can show.
        blind: ids whose signature is mostly made of the errors of the filtered states.
    """

    calibration: Calibration
    visible: frozenset[str]
    blind: frozenset[str] = frozenset()

    def __call__(self, fit: Fit, scored: list[Scored]) -> list[Scored]:
        """Families that pass the calibrated test and the second opinion, in the given order."""
        found = []
        for s in scored:
            # An effect far beyond its typical size may stand out of the noise that a very wrong model leaves.
            strong = s.id not in self.blind and s.fall >= BEYOND_DOUBT
            if s.id not in self.visible and s.family.kind not in ("wave", "tether") and not strong:
                continue
            if not s.physical or s.fall < FAINT or self.chance(s) > self.calibration.chance:
                continue
            share = s.share(fit.noise.predictor.vehicle.hull.mass)
            if (s.fall < BEYOND_DOUBT and share < NEGLIGIBLE) or share > IMPOSSIBLE:
                continue
            if any(_beside(fit, s, q) < FAINT for q in scored if q.id in self.blind and q.fall > s.fall):
                # A cause that cannot be named in this log explains the same and more.
                continue
            doubtful = s.fall < (BEYOND_DOUBT_AXES_LEFT_OUT if fit.noise.left_out else BEYOND_DOUBT)
            if doubtful and second_opinion(fit, s) > SECOND_OPINION:
                continue
            found.append(s)
        if not found or not fit.noise.predictor.vehicle.thrusters:
            return found
        free = AnyCurve(fit)
        beside = [replace(s, lost=lost(s.fall, free.of(s))) for s in found]
        return [s for s in beside if self.stands(s, s.fall)]

    def eligible(self, s: Scored) -> bool:
        """Whether a family may stand among alternatives; a blind family may not."""
        return s.id not in self.blind

    def stands(self, s: Scored, fall: float) -> bool:
        """Whether a family's fall of chi-squared in a full fit is more than chance, and than any declared error inside its bound makes."""
        left = max(float(np.sqrt(max(fall, 0.0))) - s.lost, 0.0) ** 2
        return self.chance(replace(s, fall=left)) <= self.calibration.chance

    def chance(self, s: Scored) -> float:
        """Probability of a family's fall of chi-squared without the effect, with the fall divided by ``HIGH_SIDE``."""
        return replace(s, fall=s.fall / HIGH_SIDE).chance
