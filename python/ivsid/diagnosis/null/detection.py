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

    A cause that starts at a time starts in the middle of the log.

    Args:
        fit: of the plain model.
    """
    asked = [c for c in fit.candidates if not c.searched]
    names = list(dict.fromkeys(n for c in asked for v in c.variants for n in v))
    late = {n for c in asked if c.starts for v in c.variants for n in v}
    free = AnyCurve(fit)
    p = Projection(free.joined(names, late), free.projection.base)
    found: dict[str, tuple[float, Mapping[str, float]]] = {}
    for candidate in asked:
        z, sizes = candidate.size(p, fit.signatures)
        off = max(_taken(p, free, names, list(sizes.values())) for names in candidate.variants)
        multiple = (VISIBLE + off) / z if z > 0.0 else np.inf
        # Of thrusters that show the usual size the one that shows it least counts, of others the one that shows it most.
        rank = multiple if z >= VISIBLE else -multiple
        if candidate.id not in found or rank > found[candidate.id][0]:
            found[candidate.id] = (rank, candidate.detectable(p, VISIBLE + off, z, sizes))
    return {id_: sizes for id_, (_, sizes) in found.items()}


def _taken(p: Projection, free: AnyCurve, names: tuple[str, ...], sizes: list[float]) -> float:
    """Standard deviations that the worst declared errors take of a cause in the direction of its typical size."""
    at = p.g.at(names)
    theta = np.array(sizes) * p.g.unit[at] if len(sizes) == len(at) else np.ones(len(at))
    size = float(np.sqrt(max(float(theta @ p.information(at) @ theta), 0.0)))
    return float(free.worst(p.held_back(at) @ theta)) / size if size > 0 else 0.0
