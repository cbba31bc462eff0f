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
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.kinds.grid import LOOKS_A_VALUE, GridCandidate
from ivsid.diagnosis.estimation.projection import Projection

Array = NDArray[np.float64]
# Fall of chi-squared at the best value of the grid from which values beside it are tried.
# Source: definition: two standard deviations
WORTH_A_LOOK: Final = 4.0
# Values that are tried between the best one and each of its neighbours, and once more between those.
# Source: geometry: a seventh of the grid's factor of 1.5 is 6 %, a third of that 2 %. A dead band whose fall was 387 kept 80 at the nearest value of
# the grid, and 300 four per cent beside its own
BETWEEN: Final = (6, 2)
# Distance of the values that are tried all over, in that of the knots of the thrust errors.
# Source: measured: a dead band of 13 of 100 whose knots were 3.3 apart explained 4625 in full from 12.99 on, 84 at 12 and less than nothing at 14
EDGE: Final = 0.25
# Most of them, and as many between which the same share of the demands lies: where a feedback keeps a demand near an edge, it crosses that all the time.
# Source: resource: each is a column of the search
SPREAD: Final = 24


def with_finer(fit: Fit, scored: list[Scored]) -> tuple[Fit, list[Scored]]:
    """The fit with columns at finer values, and the scores with the best of them.

    Args:
        fit: of the model.
        scored: scores of its candidates.
    """
    best = [_finest(fit, s) if _jumps(s) else s for s in scored]
    finer = [k for k, s in enumerate(scored) if best[k].values != s.values]
    for column, k in enumerate(finer, len(fit.gram.names)):
        best[k] = replace(best[k], columns=(column,))
    if finer:
        # A column of each cause joins: those that explain less would take as many directions of the noise.
        made = [_columns(fit, best[k], best[k].values) for k in finer]
        names, arrays = [n for names, _ in made for n in names], [x for _, arrays in made for x in arrays]
        fit = replace(fit, gram=fit.gram.extended(names, arrays))
    return fit, best


def _jumps(s: Scored) -> bool:
    c = s.candidate
    return isinstance(c, GridCandidate) and c.effect.form.jumps and s.fall >= WORTH_A_LOOK and len(c.values) > 1


def _finest(fit: Fit, s: Scored) -> Scored:
    """The score at the best value; its columns are still those of the grid's best one."""
    c = s.candidate
    assert isinstance(c, GridCandidate)
    spread = _all_over(fit, s)
    best = _tried(fit, s, spread) if spread else s
    values = sorted({c.idle or min(c.values), *c.values, *best.values})
    for turn, count in enumerate(BETWEEN):
        if turn:
            # There are other peaks between two values of the grid, and the best of them may lie between two of all others.
            values = sorted({*values, *spread})
        k = values.index(best.values[0])
        low, high = values[max(k - 1, 0)], values[min(k + 1, len(values) - 1)]
        ends = [(a, b) for a, b in ((low, values[k]), (values[k], high)) if a < b]
        tried = [float(v) for a, b in ends for v in np.geomspace(a, b, count + 2)[1:-1]]
        best = _tried(fit, best, tried)
        values = sorted([*values, *tried])
    return best


def _tried(fit: Fit, best: Scored, values: Sequence[float]) -> Scored:
    """The best score of further values and the one before.

    Args:
        fit: of the model.
        best: the score.
        values: that are tried.
    """
    # The base alone: products with the columns of other causes are asked of the best value, and of no other.
    g, base = fit.bare, range(len(fit.base))
    wide = g.extended(*_columns(fit, best, values), sums=True)
    p, first = Projection(wide, base), len(base)
    looks = best.looks + LOOKS_A_VALUE * len(values)
    for j, value in enumerate(values):
        theta, fall = p.solve([first + j])
        real = float(theta[0] / wide.unit[first + j])
        if real > 0 and _once(fall, real) > _once(best.fall, best.theta[0]):
            best = replace(best, fall=fall, theta=(real,), values=(value,), physical=True)
    return replace(best, looks=looks)


def _columns(fit: Fit, s: Scored, values: Sequence[float]) -> tuple[list[str], list[Array]]:
    """Names and secants of a cause at some values."""
    given = s.candidate.given
    return [f"{given((v,)).parts[0]}@{v!r}" for v in values], [fit.signatures.secant(given((v,))) for v in values]


def _once(fall: float, times: float) -> float:
    """Fall of chi-squared by a cause once, where its column is best taken more than once: a band takes the whole thrust, and no more.

    The few samples of the lowest demands, taken twice, follow a band that ends above them.

    Args:
        fall: by the best multiple of the column.
        times: that multiple.
    """
    return fall * (2.0 * times - 1.0) / times**2 if times > 1.0 else fall


def _all_over(fit: Fit, s: Scored) -> list[float]:
    """Values up to the largest of the grid: as dense as knots of the thrust errors let an edge be seen, and as demands stand between."""
    assert isinstance(s.candidate, GridCandidate)
    alone, propulsion = s.candidate.alone, fit.noise.predictor.propulsion
    own = [k for k, t in enumerate(fit.noise.predictor.vehicle.thrusters) if alone in (None, t.name)]
    apart = [np.diff(propulsion.errors[k].places).min() for k in own if propulsion.errors[k].places.size > 1]
    # Between the least demand and the least value of the grid a band may take little, and show more than one beyond it.
    low, high = s.candidate.idle or 0.0, max(s.candidate.values)
    if not apart or high <= low:
        # Exact thrusts have no knots, and any value of a band shows.
        return []
    count = min(int((high - low) / (EDGE * min(apart))) + 1, SPREAD)
    used = np.abs(np.concatenate([propulsion.demands[k] for k in own]))
    used = used[(used > low) & (used < high)]
    between = np.quantile(used, (np.arange(SPREAD) + 0.5) / SPREAD).tolist() if used.size else []
    return sorted({*np.linspace(low, high, count + 2)[1:-1].tolist(), *between} - {*s.candidate.values})
