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
from ivsid.diagnosis.estimation.fit import Noise, chi2_of, survey
from ivsid.diagnosis.estimation.gauss_newton import declared_columns, improve
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.diagnosis.selection.rivals import FINALISTS, Found, Rival, contenders, fitted
from ivsid.diagnosis.selection.rules import compared, full_refused

# Merit by which another cause has to be better to take the place of one that was found.
# Source: measured: make constants
SWAP: Final = 1.0


@dataclass(frozen=True)
class Reviewed:
    """Outcome of a review.

    Attributes:
        changed: whether a cause was dropped or swapped.
        found: the causes with their rivals beside the others.
        h: the hypothesis with them.
        states: filtered under it.
        refused: refusals of the causes that were dropped or compared, by id.
    """

    changed: bool
    found: list[Found]
    h: Hypothesis
    states: FilteredStates
    refused: Mapping[str, Refusal]


def reviewed(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    found: list[Found],
    asked: int,
    passes: Threshold,
    plain: Hypothesis,
    fixed: Mapping[str, float],
) -> Reviewed:
    """Review of the first ``asked`` causes, until one is dropped or swapped.

    Args:
        noise: filters and whitening.
        h: the hypothesis with all causes.
        states: filtered under the hypothesis.
        found: the causes.
        asked: number of the causes that are reviewed, from the first on.
        passes: the test.
        plain: the hypothesis without any cause.
        fixed: parameters that are not fitted.
    """
    known = declared_columns(noise.predictor, h, states, noise.whitening, noise.good)
    now = chi2_of(noise, h, states, fixed, known)
    found = list(found)
    refused: dict[str, Refusal] = {}
    for i, one in enumerate(found[:asked]):
        try:
            bare_h = h.without(one.id, plain)
            bare_h, bare_states = improve(
                noise.predictor, bare_h, states, noise.whitening, noise.good, fixed, known=known
            )
            bare, scored = score(survey(noise, bare_h, bare_states, fixed))
            base = chi2_of(noise, bare_h, bare_states, fixed, known)
        except np.linalg.LinAlgError:
            continue
        mine = Rival(one.id, h, states, now, one.first.count, base - now)
        others = tuple(f.id for f in found if f is not one)
        if (refusal := full_refused(passes, one.first, mine.fall, others)) is not None:
            return Reviewed(True, [f for f in found if f is not one], bare_h, bare_states, refused | {one.id: refusal})
        near = contenders(scored, mine.merit)
        near = [s for s in near if s.id not in others and s.id != one.id and s.physical and passes.eligible(s)]
        near = near[: FINALISTS - 1]
        tried = side_by_side([partial(fitted, bare, s, noise, fixed, known) for s in near])
        rivals = sorted(
            [mine, *(replace(r, fall=base - r.chi2) for r in tried if r is not None)], key=lambda r: -r.merit
        )
        best = rivals[0]
        close, worse = compared(best, rivals, others)
        refused |= worse
        behind = {r.id: r.fall for r in rivals if r not in close}
        if best is mine or best.merit < mine.merit + SWAP:
            found[i] = replace(one, rivals=(mine, *(r for r in close if r is not mine)), tried=behind, fall=mine.fall)
            continue
        first = passes(bare, scored, others).measured(next(s for s in near if s.id == best.id))
        found[i] = Found(best.id, close, behind, best.fall, first.chance, first)
        return Reviewed(True, found, best.h, best.states, refused)
    return Reviewed(False, found, h, states, refused)
