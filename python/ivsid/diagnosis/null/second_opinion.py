"""Second opinion: the chance of a fall of chi-squared from the scatter of half-minutes, without a noise model.

The scores of half-minutes give the sandwich covariance of the effect's numbers. Their Wald statistic is Hotelling's T², whose distribution
is Fisher's F.

Source: White, "Maximum likelihood estimation of misspecified models", Econometrica 50, 1982; Hotelling, "The generalization of Student's
ratio", Annals of Mathematical Statistics 2, 1931.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.special import fdtrc

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored

# Blocks of the Gram matrix side by side that make half a minute.
# Source: definition: three blocks of 10 s
BLOCKS: Final = 3
# Singular values below this share of the largest belong to dependent directions.
# Source: measured: make constants
DEPENDENT: Final = 1e-9


def second_opinion(fit: Fit, s: Scored) -> float:
    """Probability of a fall of chi-squared without the effect, from the scatter of half-minutes and without a noise model.

    Args:
        fit: of the model without the effect.
        s: the effect with its score.
    """
    p = fit.projection
    g = fit.gram
    at = list(s.columns)
    keep = np.arange(len(g.blocks)) >= s.first_block(g, fit.noise.predictor.log)
    # Scores of the projected columns block by block, at the fit of the base.
    own = g.blocks[:, at][:, :, at] * keep[:, None, None]
    cross = g.blocks[:, at][:, :, p.base] * keep[:, None, None]
    inner = g.blocks[:, p.base][:, :, p.base]
    # A step in time has no column before its start, so that the base takes another share of it.
    solved = np.linalg.solve(g.normal(p.base), cross.sum(axis=0).T)
    score = (g.score[:, at] - cross @ p.coefficients) * keep[:, None]
    base_score = g.score[:, p.base] - inner @ p.coefficients
    score = score - base_score @ solved
    # Of the projected columns with themselves: block by block they are not orthogonal to the base.
    both = cross @ solved
    H = own - both - both.transpose(0, 2, 1) + solved.T @ inner @ solved
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
    return float(fdtrc(k, n - k, max(wald, 0.0) * (n - k) / (n * k)))
