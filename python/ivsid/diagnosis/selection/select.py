"""Selection: causes are added while one passes the test, and the earlier ones are reviewed after each.

Source: docs/theory.md, "Diagnosis"; forward selection with backward elimination after Efroymson, "Multiple regression analysis", 1960.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from ivsid.diagnosis.candidates.families import score
from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.admission import admit
from ivsid.diagnosis.selection.review import reviewed
from ivsid.diagnosis.selection.rivals import FULL_STEPS, Found, Test

# Causes at most.
# Source: resource: a review takes a survey for each cause
MOST: Final = 6
# From this number of causes on, another one is added only where it explains enough of the rest.
# Source: measured: make constants
USUAL: Final = 4
# Share of the unexplained chi-squared in its channels that such a cause has to explain.
# Source: measured: make constants
WORTH: Final = 0.5
# Reviews after a cause is added, and causes that may fail their full fit.
# Source: resource: a review takes a survey for each cause
REVIEWS: Final = 3
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Selection:
    """Outcome of the selection.

    Attributes:
        plain: fit of the model without causes.
        last: fit of the model with every cause that was found.
        found: the causes, in the order in which they were found.
        screened: scores of the first round, the best first.
        leftover: scores beside all causes, the best first.
    """

    plain: Fit
    last: Fit
    found: tuple[Found, ...]
    screened: tuple[Scored, ...]
    leftover: tuple[Scored, ...] = field(default=())


def select(plain: Fit, passes: Test, fixed: Mapping[str, float], progress: Progress = lambda _: None) -> Selection:
    """Adds causes while one passes the test, and reviews the earlier ones after each.

    Args:
        plain: fit of the model without causes.
        passes: the test.
        fixed: parameters that are not fitted.
        progress: told of each candidate.
    """
    fit, scored = score(plain)
    screened = tuple(scored)
    found: list[Found] = []
    before: set[frozenset[str]] = set()
    tops: set[frozenset[str]] = set()
    again = 0
    while len(found) < MOST:
        passed = passes(fit, scored)
        if len(found) >= USUAL and passed:
            left = adequacy(fit)
            passed = [s for s in passed if s.fall >= WORTH * left.beside(fit, s.columns)]
        if not passed:
            break
        progress(f"{passed[0].id}?")
        made = admit(fit, passed, scored, fixed, passes.eligible)
        if made is None:
            break
        one, best, noise = made
        if not passes.stands(one.first, one.fall):
            # The model explains by itself what the cause seemed to explain, once it is fitted to the end.
            again += 1
            if again > REVIEWS:
                break
            h, states = improve(noise.predictor, fit.h, fit.states, noise.whitening, noise.good, fixed, FULL_STEPS)
            fit, scored = score(survey(noise, h, states, fixed))
            continue
        found.append(one)
        h, states = improve(noise.predictor, best.h, best.states, noise.whitening, noise.good, fixed)
        # Earlier causes are reviewed until none changes or a set of causes comes back.
        for turn in range(REVIEWS if len(found) > 1 else 0):
            asked = len(found) if turn else len(found) - 1
            changed, found, h, states = reviewed(noise, h, states, found, asked, passes, plain.h, fixed)
            ids = frozenset(f.id for f in found)
            if not changed or ids in before:
                break
            before.add(ids)
        fit, scored = score(survey(noise, h, states, fixed))
        ids = frozenset(f.id for f in found)
        if ids in tops:
            break
        tops.add(ids)
    return Selection(plain, fit, tuple(found), screened, tuple(scored))
