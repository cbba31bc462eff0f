"""Upper limits: intervals of causes that are no findings, each alone beside the extended model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ivsid.diagnosis.candidates.intervals import SAME, SIGMAS, Bound, intervals, scatter
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.beside import Beside


def allowed(
    last: Fit, left: Sequence[Scored], unnamed: Sequence[str] = (), beside: Sequence[Beside] = ()
) -> dict[str, Bound]:
    """Intervals of the parameters of causes that are no findings, by name, each cause alone beside the extended model.

    The intervals are linear and statistical: 3.3 times the larger of the standard deviation by the noise model and the one from the scatter
    of half-minutes, and what is asked beside the model moves them. A tether stands at the place where it explains most. Limits, dead bands, times, waves and claims have no interval here.

    Args:
        last: fit of the model with all causes that were found.
        left: scores of the other causes beside them.
        unnamed: causes of the model that are no findings.
        beside: what else may have moved the numbers.
    """
    found: dict[str, Bound] = {}
    for id_ in unnamed:
        found |= intervals(last, id_)
    for s in left:
        if not s.candidate.limited or not _seen(last, s):
            continue
        p = Projection(last.gram, [*last.base, *s.columns])
        variance = np.maximum(np.diag(p.covariance), scatter(p))
        effect = s.candidate.effect
        moved = [np.zeros(len(s.columns)), *(b.moved(s) for b in beside)]
        down, up = np.min(moved, axis=0), np.max(moved, axis=0)
        for j in range(s.candidate.limited):
            parameter, k = effect.parameters[j], len(last.base) + j
            unit = float(last.gram.unit[s.columns[j]])
            value, reach = parameter.none + float(p.coefficients[k]) / unit, SIGMAS * float(np.sqrt(variance[k])) / unit
            found[effect.parts[j]] = Bound(
                value - reach + float(down[j]) / unit,
                value + reach + float(up[j]) / unit,
                parameter.unit,
                parameter.symbol,
            )
    return found


def _seen(last: Fit, s: Scored) -> bool:
    """Whether the model leaves enough of a cause's signature."""
    at = list(s.columns)
    own = np.diag(last.projection.total)[at]
    return bool((np.diag(last.projection.information(at)) > SAME * own).all())
