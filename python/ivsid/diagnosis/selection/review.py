"""Review of the causes: each is taken out again beside the later ones, and dropped or swapped if it is no longer the best.

The first cause is chosen while the others are missing, so it may stand for two.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.families import score
from ivsid.diagnosis.estimation.fit import survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.rule import Refusal, first_refusal
from ivsid.diagnosis.null.screening import ABRUPT, IMITATED, Case
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.diagnosis.selection.rivals import FINALISTS, Found, Rival, contenders, fitted, possible, starts
from ivsid.diagnosis.selection.rules import NUMBERS, compared, full_refused, refused_by

# Merit by which another cause has to be better to take the place of one that was found.
# Source: measured: make constants
SWAP: Final = 1.0


@dataclass(frozen=True)
class Reviewed:
    """Outcome of a review.

    Attributes:
        changed: whether a cause was dropped or swapped.
        found: the causes with their rivals beside the others.
        states: of the hypothesis with them.
        refused: refusals of the causes that were dropped or compared, by id.
    """

    changed: bool
    found: list[Found]
    states: FilteredStates
    refused: Mapping[str, Refusal]


def reviewed(problem: Problem, last: Reviewed, asked: int, passes: Threshold, plain: Hypothesis) -> Reviewed:
    """Review of the first ``asked`` causes, until one is dropped or swapped.

    Args:
        problem: the log.
        last: the causes, and the hypothesis with all of them.
        asked: number of the causes that are reviewed, from the first on.
        passes: the test.
        plain: the hypothesis without any cause.
    """
    states, found = last.states, list(last.found)
    now = problem.chi2(states)
    refused: dict[str, Refusal] = {}
    for i, one in enumerate(found[:asked]):
        try:
            bereft = states.under(states.h.without(one.id, plain))
            beside = problem.under(bereft)
            without = improve(beside, bereft)
            bare, scored = score(survey(problem.noise, without, problem.fixed))
            base = beside.chi2(without)
        except np.linalg.LinAlgError:
            continue
        mine = Rival(one.id, states, now, one.first.count, base - now)
        others = tuple(f.id for f in found if f is not one)
        again = next((s for s in scored if s.id == one.id), None)
        alone = Round(bare, scored, passes.level, passes.seen)
        first = one.first
        if again is not None and first.boxed > first.fall:
            # That errors would have to leave their bounds may be another cause's doing, which came in later.
            first = passes(bare, [again], others).measured(again)
        refusal = full_refused(passes, first, mine.fall, others)
        if refusal is not None and again is not None and first is one.first:
            # What declared errors may take of a cause is less where other causes leave it fewer directions.
            refusal = full_refused(passes, passes(bare, [again], others).measured(again), mine.fall, others)
        if refusal is None and again is not None:
            # Beside the later causes it may come gradually.
            refusal = ABRUPT.refuses(Case(alone, again), others)
        if refusal is None and not possible(states.h, one.id, problem.noise.predictor):
            # Beside the later causes it has numbers that make another cause of it, which the next round finds.
            refusal = refused_by(NUMBERS, others)
        if refusal is not None:
            return Reviewed(True, [f for f in found if f is not one], without, refused | {one.id: refusal})
        near = contenders(scored, mine.merit)
        near = [s for s in near if s.id not in others and s.id != one.id and s.physical and passes.eligible(s)]
        near = [s for s in near if alone.abrupt(s)]
        near = near[: FINALISTS - 1]
        tried = side_by_side([partial(fitted, beside, bare, s) for s in near], partial(starts, bare, near))
        rivals = sorted(
            [mine, *(replace(r, fall=base - r.chi2) for r in tried if r is not None)], key=lambda r: -r.place
        )
        best = rivals[0]
        close, worse = compared(best, rivals, others, alone)
        refused |= worse
        behind = {r.id: r.fall for r in rivals if r not in close}
        swapped = best is not mine and best.place >= mine.place + SWAP
        if swapped:
            case = Case(alone, next(s for s in near if s.id == best.id))
            swapped = first_refusal(IMITATED, case, others) is None
        if not swapped:
            rest = (r for r in close if r is not mine)
            lingers = one.lingers if again is None else alone.lingers(again)
            found[i] = replace(one, rivals=(mine, *rest), tried=behind, fall=mine.fall, lingers=lingers)
            continue
        own = next(s for s in near if s.id == best.id)
        first = passes(bare, scored, others).measured(own)
        found[i] = Found(best.id, close, behind, best.fall, first.chance, first, alone.lingers(own))
        return Reviewed(True, found, best.states, refused)
    return Reviewed(False, found, states, refused)
