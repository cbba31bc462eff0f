"""The fall of chi-squared that each family of causes brings beside the model and all declared errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.candidates.searched import with_searched
from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.gauss_newton import within
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import PAPER_TERMS, PLAIN_TERMS, Given, Terms

Array = NDArray[np.float64]
# Blocks at either end of a log in which no step is looked for.
# Source: geometry: half a minute before and after a step, the time over which coefficients are told apart from their scatter
EDGE: Final = 3
# Independent values that each further value of a number adds to a search: the columns of neighbours are alike.
# Source: measured: make constants
LOOKS_A_VALUE: Final = 0.3
# Neighbouring starts of a step that count as one independent start.
# Source: measured: make constants
STARTS_A_LOOK: Final = 6.0
# Least and largest factor between the value of a column and the value that its coefficient gives.
# Source: measured: make constants
SECANT: Final = (0.3, 3.0)
# A step's column has to keep this share of its squared length beside the base.
# Source: measured: make constants
STEP_LEFT: Final = 1e-6


def score(fit: Fit, base: Projection | None = None) -> tuple[Fit, list[Scored]]:
    """The scores of all families, best first.

    Args:
        fit: of the model.
        base: least squares beside which causes are scored; that of the fit by default.

    Returns:
        The fit with the columns of searched causes, and the scores.
    """
    p = base or fit.projection
    found: list[Scored] = []
    for family in fit.families:
        if family.kind in ("linear", "claim"):
            found += _linear(fit, p, family)
        elif family.kind == "secant":
            found += _secant(fit, p, family)
        elif family.kind == "step":
            found += _step(fit, p, family)
    fit, found = with_searched(fit, p, found)
    return fit, sorted((_merged(found)), key=lambda s: -s.merit)


def _merged(found: list[Scored]) -> list[Scored]:
    """One score an effect: the best of its thrusters."""
    best: dict[str, Scored] = {}
    for s in found:
        if s.id not in best or s.merit > best[s.id].merit:
            best[s.id] = s
    return list(best.values())


def _physical(family: Family, theta: tuple[float, ...]) -> bool:
    """Whether a coefficient has a sign that the cause can have."""
    p = family.effect.parameters
    return p[0].signed or len(p) > 1 or theta[0] > 0


def _linear(fit: Fit, p: Projection, family: Family) -> list[Scored]:
    """A cause that is linear in its numbers, or a claim that is fitted after all."""
    at = fit.gram.at(family.variants[0])
    theta, fall = p.solve(at)
    real = tuple((theta / fit.gram.unit[at]).tolist())
    if family.kind == "claim":
        value = float(fit.h.values[family.id]) + real[0]
        return [Scored(family, fall, 1, 1.0, tuple(at), real, (value,), value > 0)]
    if isinstance(family.effect.acts, Terms):
        values = real
    else:
        values = tuple(q.none + x for q, x in zip(family.effect.parameters, real, strict=True))
    return [Scored(family, fall, len(at), 1.0, tuple(at), real, values, _physical(family, real))]


def _secant(fit: Fit, p: Projection, family: Family) -> list[Scored]:
    """A cause with a column for each value that is tried: the best of them."""
    best: Scored | None = None
    for names, value in zip(family.variants, family.values, strict=True):
        at = fit.gram.at(names)
        theta, fall = p.solve(at)
        real = float(theta[0] / fit.gram.unit[at[0]])
        if real <= 0:
            fall = 0.0
        if best is None or fall > best.fall:
            scaled = value[0]
            if family.effect.parameters[0].unit == "s":
                scaled *= float(np.clip(real, *SECANT))
            best = Scored(
                family, fall, 1, 1.0 + LOOKS_A_VALUE * len(family.variants), tuple(at), (real,), (scaled,), real > 0
            )
    return [] if best is None else [best]


def _step(fit: Fit, p: Projection, family: Family) -> list[Scored]:
    """A step in time at the best block: the cross-products of a column from a block on are sums over the later blocks."""
    g = fit.gram
    j = g.at(family.variants[0])[0]
    later = np.cumsum(g.blocks[::-1, j, :], axis=0)[::-1]
    score = np.cumsum(g.score[::-1, j])[::-1]
    own = later[:, j]
    cross = later[:, p.base]
    H = own - np.einsum("bi,bi->b", cross, np.linalg.solve(p.normal, cross.T).T)
    s = score - cross @ p.coefficients
    usable = H / max(float(own[0]), 1e-300) > STEP_LEFT
    usable[:EDGE] = usable[len(usable) - EDGE :] = False
    if not usable.any():
        return []
    fall = np.where(usable, s**2 / np.where(usable, H, 1.0), 0.0)
    if family.thruster is not None:
        fall = np.where(s > 0, fall, 0.0)
    b = int(np.argmax(fall))
    theta = float(s[b] / max(H[b], 1e-300) / g.unit[j])
    time = float(fit.noise.predictor.log.t[0] + b * g.length * fit.noise.predictor.log.h)
    values = (theta, time) if family.thruster is None else (float(family.thruster), min(theta, 1.0), time)
    return [Scored(family, float(fall[b]), 2, len(fall) / STARTS_A_LOOK, (j,), (theta,), values)]


def adopted(h: Hypothesis, s: Scored, fit: Fit) -> Hypothesis:
    """The hypothesis with a family's effect in it, at the values of its score.

    Args:
        h: the hypothesis.
        s: the score.
        fit: in which it was found.
    """
    effect = s.family.effect
    if s.family.kind == "claim":
        return replace(h, values={**h.values, s.id: s.values[0]}, freed=h.freed | {s.id})
    if not isinstance(effect.acts, Terms):
        values = tuple(within(value, p) for value, p in zip(s.values, effect.parameters, strict=True))
        return h.with_effect(Given(effect, values))
    terms, numbers = list(h.terms), dict(h.values)
    shared = {"mass.sway": "mass.surge", "drag.sway.quadratic": "drag.surge.quadratic"}
    for term, value in zip(effect.acts.terms, s.values, strict=True):
        other = shared.get(term.id)
        if other is not None and any(t.id == other and t in PAPER_TERMS for t in terms):
            # A value of its own ends the sharing of the paper's column.
            plain = {t.id: t for t in PLAIN_TERMS}
            terms = [plain[other] if t.id == other else t for t in terms]
            value += numbers[other]  # noqa: PLW2901
        terms.append(fit.signatures.fitting(term))
        numbers[term.id] = float(value)
    return replace(h, terms=tuple(terms), values=numbers)


def everything(fit: Fit) -> Fit:
    """The fit with the columns of searched causes and of steps in time, at their best values."""
    fit, scored = score(fit)
    g = fit.gram
    steps = [s for s in scored if s.family.kind == "step"]
    if not steps:
        return fit
    predictor = fit.noise.predictor
    x = g.columns([s.columns[0] for s in steps])
    names = []
    for one, s in zip(x, steps, strict=True):
        one[: round((s.values[-1] - float(predictor.log.t[0])) / (g.length * predictor.log.h))] = 0.0
        names.append(f"{s.id}@{s.values[-1]!r}")
    unit = np.sqrt(np.maximum(np.einsum("cbi,cbi->c", x, x), 1e-300))
    return replace(fit, gram=g.joined(names, x / unit[:, None, None], unit))
