"""Review of the causes: each is taken out again beside the later ones, and dropped or swapped if it is no longer the best.

The first cause is chosen while the others are missing, so it may stand for two.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.families import score
from ivsid.diagnosis.estimation.fit import Noise, chi2_of, survey
from ivsid.diagnosis.estimation.gauss_newton import declared_columns, improve
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.diagnosis.selection.rivals import FINALISTS, MARGIN, Found, Rival, Test, contenders, fitted

# Merit by which another cause has to be better to take the place of one that was found.
# Source: measured: make constants
SWAP: Final = 1.0


def reviewed(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    found: list[Found],
    asked: int,
    passes: Test,
    plain: Hypothesis,
    fixed: Mapping[str, float],
) -> tuple[bool, list[Found], Hypothesis, FilteredStates]:
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

    Returns:
        Whether a cause was dropped or swapped; the causes with their rivals beside the others; the hypothesis and its states.
    """
    known = declared_columns(noise.predictor, h, states, noise.whitening, noise.good)
    now = chi2_of(noise, h, states, fixed, known)
    found = list(found)
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
        if not passes.stands(one.first, mine.fall):
            return True, [f for f in found if f is not one], bare_h, bare_states
        taken = {f.id for f in found}
        near = contenders(scored, mine.merit)
        near = [s for s in near if s.id not in taken and s.physical and passes.eligible(s)][: FINALISTS - 1]
        tried = side_by_side([partial(fitted, bare, s, noise, fixed, known) for s in near])
        rivals = sorted(
            [mine, *(replace(r, fall=base - r.chi2) for r in tried if r is not None)], key=lambda r: -r.merit
        )
        best = rivals[0]
        close = tuple(r for r in rivals if best.merit - r.merit <= MARGIN)
        rejected = tuple((r.id, r.fall) for r in rivals if r not in close)
        if best is mine or best.merit < mine.merit + SWAP:
            found[i] = replace(
                one, rivals=(mine, *(r for r in close if r is not mine)), rejected=rejected, fall=mine.fall
            )
            continue
        first = next(s for s in near if s.id == best.id)
        found[i] = Found(best.id, close, rejected, best.fall, first.chance, first)
        return True, found, best.h, best.states
    return False, found, h, states
