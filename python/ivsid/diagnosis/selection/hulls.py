"""Numbers that no hull has: what a log asks for beyond the limits of hulls, where the fit has stopped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.leaving import Others
from ivsid.diagnosis.plant.usual_hull import hull_limits

# Standard deviations beyond a limit from which a number is none that a hull has.
# Source: definition: below five standard deviations the model of the noise is not trusted
BEYOND: Final = 5.0


@dataclass(frozen=True)
class Asked:
    """A number that a log asks for and that no hull of this mass and length has.

    Attributes:
        id: of the parameter.
        estimate: the number without the limit, in its unit.
        limit: of hulls of this mass and length, in its unit.
        deviations: standard deviations between them.
    """

    id: str
    estimate: float
    limit: float
    deviations: float


def asked_of_hulls(others: Others) -> tuple[Asked, ...]:
    """Numbers that a log asks for beyond the limits of hulls, the farthest first.

    The estimate is one linear step from the fit, without limits. It has to lie beyond them beside all else that may have moved it.

    Args:
        others: of a fit whose parameters lie inside the limits.
    """
    fit = others.fit
    found = _beyond(fit, fit.projection)
    for other in others.beside():
        if not found:
            break
        moved = {a.id: a for a in _beyond(fit, Projection(other.base, range(len(fit.base))))}
        found = [min(a, moved[a.id], key=lambda q: q.deviations) for a in found if a.id in moved]
    return tuple(sorted(found, key=lambda a: -a.deviations))


def _beyond(fit: Fit, p: Projection) -> list[Asked]:
    """The numbers by one projection, whose columns are those of the fit's base.

    Args:
        fit: of the log.
        p: least squares on its base.
    """
    g, deviation = fit.gram, np.sqrt(np.diag(p.covariance))
    found = []
    for id_, (least, most) in hull_limits(fit.noise.predictor.vehicle, fit.h.terms).items():
        if id_ not in fit.free:
            continue
        j = fit.base.index(g.index[id_])
        unit = float(g.unit[g.index[id_]])
        estimate, sigma = fit.h.values[id_] + float(p.coefficients[j]) / unit, float(deviation[j]) / unit
        limit = least if estimate < least else most
        off = max(least - estimate, estimate - most) / max(sigma, 1e-300)
        if off > BEYOND:
            found.append(Asked(id_, estimate, limit, off))
    return found
