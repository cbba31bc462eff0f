"""Gauss-Newton steps of a hypothesis, with the declared errors beside its free parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import free_parameters
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.effects import Parameter

# Most steps of a fit.
# Source: measured: make constants
STEPS: Final = 3
# Shares of a step that are tried, one after the other, until chi-squared does not rise.
# Source: resource: each costs two passes of the filters
SHORTER: Final = (1.0, 0.4, 0.1)
# Rise of chi-squared that is no worsening.
# Source: geometry: a number one standard deviation off its best value costs 1
WORSE: Final = 1.0
# A fit has converged if no parameter moves by more than this share of its standard deviation.
# Source: geometry: such a move changes chi-squared by a hundredth
CONVERGED: Final = 0.1
# Largest factor by which a step changes a mass.
# Source: measured: make constants
MASS_FACTOR: Final = 3
# Largest step of an effect's number, as a share of it.
# Source: measured: make constants
MOST_STEP: Final = 0.5
# Least size of an effect's number in such a step, in its usual size.
# Source: measured: make constants
LEAST_SIZE: Final = 0.2
# Distance of a number from a limit that its physics excludes, in its unit.
# Source: geometry: above rounding, and below any size that matters
EXCLUDED: Final = 1e-6


def improve(problem: Problem, states: FilteredStates, steps: int = STEPS) -> FilteredStates:
    """Gauss-Newton steps of all free parameters, with the declared errors beside them; a step that raises chi-squared is made shorter.

    Args:
        problem: the log.
        states: of the hypothesis to start from.
        steps: at most.

    Returns:
        The states of the best hypothesis found.
    """
    predictor = problem.noise.predictor

    def cost(states: FilteredStates) -> tuple[float, Gram]:
        errors = predictor.errors(states)
        g = problem.bare(states.h, errors)
        # A step that goes much too far leaves states that run away.
        finite = bool(np.isfinite(errors).all())
        return Projection(g, range(problem.count)).chi2 if finite else float(np.inf), g

    # Chi-squared belongs to a hypothesis only at its own states.
    states = predictor.settle(states.under(_of_hulls(states.h, problem)), 2)
    here, base = cost(states)
    for _ in range(steps):
        for p in _movable(problem.beside(base, states), states.h):
            at = np.array(p.base)
            moves = dict(zip((p.g.names[k] for k in at), (p.coefficients / p.g.unit[at]).tolist(), strict=True))
            for share in SHORTER:
                other = stepped(states.h, {k: share * m for k, m in moves.items()}, predictor)
                there = predictor.settle(states.under(other), 2)
                now, there_base = cost(there)
                if now < here + WORSE:
                    break
            else:
                continue
            break
        else:
            return states
        states, here, base = there, now, there_base
        sigma = np.sqrt(np.diag(p.covariance))
        if (np.abs(p.coefficients) < CONVERGED * sigma)[problem.count :].all():
            break
    return states


def _of_hulls(h: Hypothesis, problem: Problem) -> Hypothesis:
    """The hypothesis with every fitted number inside the limits of hulls: a start may be a multiple of another fit."""
    limits = hull_limits(problem.noise.predictor.vehicle, h.terms)
    inside = {i: float(np.clip(h.values[i], *ends)) for i, ends in limits.items() if i not in problem.fixed}
    return replaced(h, {i: x for i, x in inside.items() if x != h.values[i]})


def _movable(g: Gram, h: Hypothesis) -> Iterator[Projection]:
    """Steps of all numbers, then of all but those in which the errors may jump: chi-squared can be a wall beside one, and stop the others."""
    yield Projection(g, range(len(g.names)))
    jumps = {name for given in h.given if given.effect.form.bends for name, _, _ in free_parameters(given)}
    if jumps:
        yield Projection(g, [k for k, name in enumerate(g.names) if name not in jumps])


def within(value: float, p: Parameter) -> float:
    """A number at the lower limit of its physics, or above."""
    return value if p.lowest is None else max(value, p.lowest + (EXCLUDED if p.exclusive else 0.0))


def stepped(h: Hypothesis, moves: Mapping[str, float], predictor: Predictor) -> Hypothesis:
    """The hypothesis with its parameters moved: masses within a factor, and every number inside the limits of its physics and of hulls.

    Args:
        h: the hypothesis.
        moves: changes of its parameters and declared errors, by name.
        predictor: of the log.
    """
    values = {}
    limits = hull_limits(predictor.vehicle, h.terms)
    for term in h.terms:
        if term.id in moves:
            new = h.values[term.id] + moves[term.id]
            least, most = limits.get(term.id, (-np.inf, np.inf))
            if least > 0:
                new = float(np.clip(new, h.values[term.id] / MASS_FACTOR, h.values[term.id] * MASS_FACTOR))
            values[term.id] = float(np.clip(new, least, most))
    h = replaced(h, values)
    known = {n: h.declared_errors.get(n, 0.0) + m for n, m in moves.items() if n.startswith("~")}
    h = replace(h, declared_errors={**h.declared_errors, **known})
    for g in h.given:
        numbers = list(g.values)
        for name, p, j in free_parameters(g):
            step = moves.get(name, 0.0)
            most = MOST_STEP * max(abs(numbers[j]), LEAST_SIZE * abs(p.scaled(predictor.vehicle.hull.mass)), 1e-9)
            if p.unit != "rad":
                step = float(np.clip(step, -most, most))
            new = numbers[j] + step
            numbers[j] = float(within(new, p))
        kept = g.effect.form.inside(tuple(numbers), float(np.abs(predictor.log.nu[0]).max()))
        h = h.with_effect(replace(g, values=kept))
    return h
