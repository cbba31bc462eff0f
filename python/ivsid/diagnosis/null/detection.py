"""Detection limits beside the worst declared errors: the sizes at which a cause stands out of any thrust curve inside its accuracy.

A cause of size q stands out by q sqrt(H) standard deviations, and declared errors inside their bounds take at most w = W / sqrt(F) of them,
whatever the size. The limit is the size at which ``VISIBLE`` are left.

Source: docs/theory.md, "Any thrust curve inside its accuracy".
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.visibility import VISIBLE


def detection_limits(fit: Fit) -> dict[str, Mapping[str, float]]:
    """The size of each effect that is detected beside the worst declared errors, by id and parameter, in its unit; empty if there is none.

    Steps in time are left out: their columns are sums over later blocks.

    Args:
        fit: of the plain model.
    """
    if not fit.noise.predictor.vehicle.thrusters:
        return {}
    asked = [c for c in fit.candidates if not c.searched and not c.starts]
    names = list(dict.fromkeys(n for c in asked for v in c.variants for n in v))
    free = AnyCurve(fit)
    p = Projection(free.joined(names), free.projection.base)
    found: dict[str, tuple[float, Mapping[str, float]]] = {}
    for candidate in asked:
        z, sizes = candidate.size(p, fit.signatures)
        if candidate.id in found and found[candidate.id][0] >= z:
            continue
        off = max(_taken(p, free, names, list(sizes.values())) for names in candidate.variants)
        found[candidate.id] = (z, candidate.detectable(p, VISIBLE + off, z, sizes))
    return {id_: least for id_, (_, least) in found.items()}


def _taken(p: Projection, free: AnyCurve, names: tuple[str, ...], sizes: list[float]) -> float:
    """Standard deviations that the worst declared errors take of a cause in the direction of its typical size."""
    at = p.g.at(names)
    theta = np.array(sizes) * p.g.unit[at] if len(sizes) == len(at) else np.ones(len(at))
    size = float(np.sqrt(max(float(theta @ p.information(at) @ theta), 0.0)))
    return float(free.worst(p.held_back(at) @ theta)) / size if size > 0 else 0.0
