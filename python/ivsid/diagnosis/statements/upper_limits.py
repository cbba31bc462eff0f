"""What the log allows of each cause that is no finding: how large it may be beside what was found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import SAME, SIGMAS, Bound, intervals, scatter
from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.effects import Terms

# Of a tether's columns only the pull itself is a number of the catalogue.
_PULL: Final = 1


def allowed(last: Fit, left: Sequence[Scored], unnamed: Sequence[str] = ()) -> dict[str, Bound]:
    """Intervals of the numbers of causes that are no findings, by name, each cause alone beside the last model.

    They are linear and statistical: 3.3 times the larger of the standard deviation by the noise model and that from the scatter of
    half-minutes. A tether counts at the place where it would explain most. Limits, dead bands, times, waves and claims have none here.

    Args:
        last: the model with all that was found.
        left: scores of what was not found, in its columns.
        unnamed: causes that the model holds and nothing proves.
    """
    found: dict[str, Bound] = {}
    for id_ in unnamed:
        found |= intervals(last, id_, last.fixed)
    for s in left:
        if s.family.kind not in ("linear", "tether") or not _seen(last, s):
            continue
        p = Projection(last.gram, [*last.base, *s.columns])
        covariance = np.linalg.inv(p.total[np.ix_(p.base, p.base)] + np.diag(last.gram.prior[p.base] + 1e-9))
        variance = np.maximum(np.diag(covariance), scatter(p, covariance))
        effect = s.family.effect
        count = _PULL if s.family.kind == "tether" else len(s.columns)
        for j in range(count):
            parameter, k = effect.parameters[j], len(last.base) + j
            unit = float(last.gram.unit[s.columns[j]])
            none = 0.0 if isinstance(effect.acts, Terms) else parameter.none
            value, reach = none + float(p.coefficients[k]) / unit, SIGMAS * float(np.sqrt(variance[k])) / unit
            found[effect.parts[j]] = Bound(value - reach, value + reach, parameter.unit, parameter.symbol)
    return found


def _seen(last: Fit, s: Scored) -> bool:
    """Whether anything of its signature is left beside the model."""
    at = list(s.columns)
    own = np.diag(last.projection.total)[at]
    return bool((np.diag(last.projection.information(at)) > SAME * own).all())
