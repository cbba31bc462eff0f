"""Finer values of causes whose errors jump with their number: between two values of a grid their fall of chi-squared has a sharp peak.

A dead band moves the thrust at the very demands at which a command crosses its edge. A band that is wrong by a fifth crosses elsewhere. Beside any
thrust error that bends at knots all that is left of a band is its edge, so that the peak is a share of the distance of the knots wide, wherever
the grid's own values stand.
"""

from __future__ import annotations

from collections.abc import Sequence
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
# Distance of the values that are tried all over, in that of the knots of the thrust errors.
# Source: measured: a dead band of 13 of 100 whose knots were 3.3 apart explained 1012 at its own edge, 82 at 12 and nothing at 14
EDGE: Final = 0.25
# Most of them.
# Source: resource: each is a column of the fit
SPREAD: Final = 48


def with_finer(fit: Fit, scored: list[Scored]) -> tuple[Fit, list[Scored]]:
    """The fit with columns at finer values, and the scores with the best of them.

    Args:
        fit: of the model.
        scored: scores of its candidates.
    """
    out = []
    for s in scored:
        fit, best = _finer(fit, s) if _jumps(fit, s) else (fit, s)
        out.append(best)
    return fit, out


def _jumps(fit: Fit, s: Scored) -> bool:
    """Whether finer values of a cause are asked for: it jumps, and something of it shows, or a fitted error has left its bound and may stand for it."""
    c = s.candidate
    if not isinstance(c, GridCandidate) or not c.effect.form.jumps or len(c.values) < 2:
        return False
    return s.fall >= WORTH_A_LOOK or fit.signatures.hidden


def _finer(fit: Fit, s: Scored) -> tuple[Fit, Scored]:
    c = s.candidate
    assert isinstance(c, GridCandidate)
    tried = _all_over(fit, s)
    fit, best = _tried(fit, s, tried) if tried else (fit, s)
    values = sorted({*c.values, *best.values})
    for count in BETWEEN:
        k = values.index(best.values[0])
        low, high = values[max(k - 1, 0)], values[min(k + 1, len(values) - 1)]
        ends = [(a, b) for a, b in ((low, values[k]), (values[k], high)) if a < b]
        tried = [float(v) for a, b in ends for v in np.geomspace(a, b, count + 2)[1:-1]]
        fit, best = _tried(fit, best, tried)
        values = sorted([*values, *tried])
    return fit, best


def _tried(fit: Fit, best: Scored, values: Sequence[float]) -> tuple[Fit, Scored]:
    """The fit with columns at further values, and the best score of these and the one before.

    Args:
        fit: of the model.
        best: the score.
        values: that are tried.
    """
    given, first, base = best.candidate.given, len(fit.gram.names), fit.projection.base
    names = [f"{given((v,)).parts[0]}@{v!r}" for v in values]
    fit = replace(fit, gram=fit.gram.extended(names, [fit.signatures.secant(given((v,))) for v in values]))
    p = Projection(fit.gram, base)
    looks = best.looks + LOOKS_A_VALUE * len(values)
    for j, value in enumerate(values):
        theta, fall = p.solve([first + j])
        real = float(theta[0] / fit.gram.unit[first + j])
        if real > 0 and fall > best.fall:
            best = replace(best, fall=fall, columns=(first + j,), theta=(real,), values=(value,), physical=True)
    return fit, replace(best, looks=looks)


def _all_over(fit: Fit, s: Scored) -> list[float]:
    """Values between the least and the largest of the grid, a share of the distance of the knots of the thrust errors apart, without the grid's own."""
    assert isinstance(s.candidate, GridCandidate)
    alone = s.candidate.alone
    propulsion = zip(fit.noise.predictor.vehicle.thrusters, fit.noise.predictor.propulsion.errors, strict=True)
    apart = [np.diff(e.places).min() for t, e in propulsion if alone in (None, t.name) and e.places.size > 1]
    low, high = min(s.candidate.values), max(s.candidate.values)
    if not apart or high <= low:
        return []
    count = min(int((high - low) / (EDGE * min(apart))) + 1, SPREAD)
    return [float(v) for v in np.linspace(low, high, count + 2)[1:-1] if v not in s.candidate.values]
