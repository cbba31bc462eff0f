"""Admission of a cause: the candidates that pass are fitted in full, the noise is learnt beside the best, and all are fitted again."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.profile import moved, refined, sought
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.learning import learn
from ivsid.diagnosis.estimation.noise import Noise, quick_enough
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.null.family_wise import Screened, Threshold
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.null.screening import IMITATED
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.diagnosis.selection.rivals import (
    FAR,
    FAR_SHARE,
    FINALISTS,
    FULL_STEPS,
    Found,
    Rival,
    contenders,
    fitted_inside,
    in_place_of,
    possible,
    starts,
)
from ivsid.diagnosis.selection.rules import FINALIST, NUMBERS, Place, compared, full_refused, refused_by

# Multiples of the best limit from which a fit restarts: chi-squared has several minima along the scale of masses and drags.
# Source: measured: make constants
RESTARTS: Final = (0.8, 0.92, 1.0, 1.1, 1.25, 1.5)
# Rounds in which the filters are made quicker for a cause that damps an axis.
# Source: resource: the noise is learnt again in each
QUICKENED: Final = 3


@dataclass(frozen=True)
class Admission:
    """Outcome of an admission.

    Attributes:
        refused: refusals of causes that were fitted in full, by id.
        waiting: refusals of causes that come after those that were fitted in full, by id; a further round may say more.
        found: the cause with its rivals; None if no fit gives possible numbers.
        best: its fit.
        noise: learnt beside it.
    """

    refused: Mapping[str, Refusal]
    waiting: Mapping[str, Refusal]
    found: Found | None = None
    best: Rival | None = None
    noise: Noise | None = None


def admit(
    fit: Fit,
    screened: Screened,
    passed: Sequence[Scored],
    test: Threshold,
    beside: Sequence[str] = (),
    outsiders: Collection[str] = (),
) -> Admission:
    """The best of the causes that pass, with its rivals, fitted in full under a noise that no longer holds the cause.

    Args:
        fit: of the model so far.
        screened: all causes.
        passed: causes that pass, the best first.
        test: of the log.
        beside: causes that the model holds already.
        outsiders: causes that are not fitted unless they pass.
    """
    scored = screened.round.scored
    # A cause that does not pass by its score may do as well in a full fit, but a change over minutes has no start in any.
    near = contenders(scored, passed[0].merit)
    every = sorted(
        {
            s.id: s
            for s in (*(q for q in near if q.id not in outsiders), *passed)
            if s.physical and test.eligible(s) and screened.round.abrupt(s)
        }.values(),
        key=lambda s: -s.merit,
    )
    finalists = every[:FINALISTS]
    ranked = {s.id: FINALIST.refuses(Place(every[0].id, k + 1), beside) for k, s in enumerate(every)}
    waiting = {i: r for i, r in ranked.items() if r is not None}
    refused: dict[str, Refusal] = {}
    models = partial(starts, fit, finalists)
    tried = side_by_side([partial(fitted_inside, fit.problem, fit, s) for s in finalists], models)
    if any(r is not None for r in tried):
        leader = max((r for r in tried if r is not None), key=lambda r: r.place)
        pairs = zip(finalists, tried, strict=True)
        tried = side_by_side([partial(in_place_of, fit.problem, fit, s, r, leader) for s, r in pairs], models)
    rivals = [r for r in tried if r is not None and r.fall > 0]
    for s, r in zip(finalists, tried, strict=True):
        refusal = refused_by(NUMBERS, beside) if r is None else full_refused(test, s, min(r.fall, 0.0), beside)
        if refusal is not None and (r is None or r.fall <= 0):
            refused[s.id] = refusal
    if not rivals:
        return Admission(refused, waiting)
    best = max(rivals, key=lambda r: r.place)
    # All are fitted once more under the better noise.
    problem = Problem.at(_learnt(fit, best.states), fit.fixed, best.states)
    asked = sorted(rivals, key=lambda r: -r.merit)
    asked = [r for r in asked if best.merit - r.merit <= max(FAR, FAR_SHARE * best.merit)]
    tasks = [(fit.states, ""), *((r.states, r.id) for r in asked)]
    (_, base), *done = side_by_side(
        [partial(_exact, problem, *task) for task in tasks], lambda: (s.h for s, _ in tasks)
    )
    again = []
    for r, (states, chi2) in zip(asked, done, strict=True):
        if possible(states.h, r.id, problem.noise.predictor):
            again.append(replace(r, states=states, chi2=chi2, fall=base - chi2))
        else:
            refused[r.id] = refused_by(NUMBERS, beside)
    # Falls under one noise are no measure of those under another.
    far = [r for r in rivals if r not in asked]
    behind = {r.id: r.fall for r in far}
    refused |= compared(best, far, beside)[1]
    if not again:
        return Admission(refused, waiting)
    again.sort(key=lambda r: -r.place)
    close: tuple[Rival, ...] = ()
    worse: dict[str, Refusal] = {}
    while again:
        best = again[0]
        close, worse = compared(best, again, beside, screened.round)
        unfounded = _unfounded(best, close, (*again, *far), screened, test)
        if unfounded is None:
            break
        refused[best.id] = unfounded
        again = again[1:]
    else:
        return Admission(refused, waiting)
    behind |= {r.id: r.fall for r in again if r not in close}
    own = next(s for s in scored if s.id == best.id)
    first = screened.measured(own)
    found = Found(best.id, close, behind, best.fall, first.chance, first, screened.round.lingers(own))
    return Admission(worse | refused, waiting, found, best, problem.noise)


def _unfounded(
    best: Rival, close: Sequence[Rival], tried: Sequence[Rival], screened: Screened, test: Threshold
) -> Refusal | None:
    """The refusal by its score of the cause that fits best, where no cause that passed bears it out; None otherwise.

    A cause that passed does so if it holds in its full fit, and fits about as well where what the log holds without a cause explains the best one.
    One whose evidence is that thrust errors would have to leave their bounds bears out none that does not bring them back.

    Args:
        best: the cause.
        close: causes that the log does not tell from it.
        tried: all causes that were fitted in full.
        screened: all causes with their scores.
        test: of the log.
    """
    refusal = screened.refused.get(best.id)
    if refusal is None:
        return None
    own = next(s for s in screened.round.scored if s.id == best.id)
    passed = {s.id: s for s in screened.passed if s.boxed <= s.fall or own.boxed > own.fall}
    asked = close if refusal.rule in {r.name for r in IMITATED} else tried
    holds = any(r.id in passed and full_refused(test, passed[r.id], r.fall) is None for r in asked)
    return None if holds else refusal


def _exact(problem: Problem, states: FilteredStates, id_: str) -> tuple[FilteredStates, float]:
    """States of a hypothesis fitted to the end, with its chi-squared; numbers of the effect ``id_`` that bend are searched again."""
    problem = problem.under(states)
    states = improve(problem, states, FULL_STEPS)
    # Gauss-Newton steps do not cross a jump of the errors, as where a delay is a sample long.
    bends = [g for g in states.h.given if g.effect.id == id_ and sought(g)]
    for given in bends:
        states = refined(problem, states, given, wide=False)
    if bends:
        states = improve(problem, problem.noise.predictor.settle(states, 2))
    chi2 = problem.chi2(states)
    for given in [g for g in states.h.given if g.effect.id == id_ and g.effect.form.limits]:
        for share in RESTARTS:
            # Fitted errors of the thrust keep a wrong scale of the parameters in place, so the fit restarts without them.
            start = moved(states.h, problem.fixed, given, [share * given.values[0]])
            there = improve(problem, states.under(replace(start, declared_errors={})), FULL_STEPS)
            if (better := problem.chi2(there)) < chi2:
                states, chi2 = there, better
    if (own := problem.under(states)) is not problem:
        # An edge that has moved takes the errors beside it along.
        states = improve(own, states)
        chi2 = own.chi2(states)
    return states, chi2


def _learnt(fit: Fit, states: FilteredStates) -> Noise:
    """The noise beside a hypothesis, with filters that are quick enough for its damping: a cause may be most of the damping of an axis."""
    predictor, left_out = fit.noise.predictor, fit.noise.left_out
    for _ in range(QUICKENED):
        quicker = quick_enough(predictor, predictor.slopes(states))
        if quicker is predictor:
            break
        predictor = quicker
        _, states = learn(predictor, states, everything, fit.fixed, left_out, rounds=1)
    return learn(predictor, states, everything, fit.fixed, left_out)[0]
