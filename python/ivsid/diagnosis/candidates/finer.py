"""Finer values of causes whose errors jump with their number: between two values of a grid their fall of chi-squared has a sharp peak.

A dead band moves the thrust at the very demands at which a command crosses its edge. A band that is wrong by a fifth crosses elsewhere.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.kinds.grid import LOOKS_A_VALUE, GridCandidate
from ivsid.diagnosis.estimation.projection import Projection

# Fall of chi-squared at the best value of the grid from which values beside it are tried.
# Source: definition: two standard deviations
WORTH_A_LOOK: Final = 4.0
# Values that are tried between the best one and each of its neighbours, and once more between those.
# Source: geometry: a seventh of the grid's factor of 1.5 is 6 %, a third of that 2 %. A dead band whose fall was 387 kept 80 at the nearest value of
# the grid, and 300 four per cent beside its own
BETWEEN: Final = (6, 2)


def with_finer(fit: Fit, scored: list[Scored]) -> tuple[Fit, list[Scored]]:
    """The fit with columns at finer values, and the scores with the best of them.

    Args:
        fit: of the model.
        scored: scores of its candidates.
    """
    out = []
    for s in scored:
        fit, best = _finer(fit, s) if _jumps(s) else (fit, s)
        out.append(best)
    return fit, out


def _jumps(s: Scored) -> bool:
    c = s.candidate
    return isinstance(c, GridCandidate) and c.effect.form.jumps and s.fall >= WORTH_A_LOOK and len(c.values) > 1


def _finer(fit: Fit, s: Scored) -> tuple[Fit, Scored]:
    c = s.candidate
    assert isinstance(c, GridCandidate)
    base, values, best = fit.projection.base, sorted(c.values), s
    looks = s.looks
    for count in BETWEEN:
        k = values.index(best.values[0])
        low, high = values[max(k - 1, 0)], values[min(k + 1, len(values) - 1)]
        ends = [(a, b) for a, b in ((low, values[k]), (values[k], high)) if a < b]
        tried = [float(v) for a, b in ends for v in np.geomspace(a, b, count + 2)[1:-1]]
        first = len(fit.gram.names)
        names = [f"{c.given((v,)).parts[0]}@{v!r}" for v in tried]
        fit = replace(fit, gram=fit.gram.extended(names, [fit.signatures.secant(c.given((v,))) for v in tried]))
        p = Projection(fit.gram, base)
        looks += LOOKS_A_VALUE * len(tried)
        for j, value in enumerate(tried):
            theta, fall = p.solve([first + j])
            real = float(theta[0] / fit.gram.unit[first + j])
            if real > 0 and fall > best.fall:
                best = replace(best, fall=fall, columns=(first + j,), theta=(real,), values=(value,), physical=True)
        values = sorted([*values, *tried])
    return fit, replace(best, looks=looks)
