"""Extended model without some of its causes, with the rest fitted again."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.selection.rivals import FULL_STEPS


def same_causes(h: Hypothesis, plain: Hypothesis) -> bool:
    """Whether a hypothesis has no cause beside the plain model, whatever its numbers."""
    return {t.id for t in h.terms} == {t.id for t in plain.terms} and h.given == plain.given and h.freed == plain.freed


def without(plain: Fit, last: Fit, ids: Collection[str]) -> FilteredStates:
    """States on TRAIN of the extended model without some causes; those of the plain model if no cause is left.

    Where the rest cannot be fitted again, its numbers are those of the plain model.

    Args:
        plain: fit of the model without causes.
        last: fit of the extended model.
        ids: of the causes that are taken out.
    """
    if not ids:
        return last.states
    h = last.h
    for id_ in ids:
        h = h.without(id_, plain.h)
    if same_causes(h, plain.h):
        return plain.states
    # The fit starts from the plain model's numbers: those beside a cause may be far from the best ones without it.
    own = {t.id for t in h.terms}
    start = plain.states.under(replace(h, values={**h.values, **{k: v for k, v in plain.h.values.items() if k in own}}))
    try:
        return improve(Problem.at(last.noise, last.fixed, start), start, FULL_STEPS)
    except np.linalg.LinAlgError:
        # The numbers as they were without the causes are a model still.
        return start


def handed_out(plain: Fit, last: Fit, ids: Collection[str]) -> Fit:
    """Fit on TRAIN of the extended model without some causes; that of the plain model if no cause is left.

    Args:
        plain: fit of the model without causes.
        last: fit of the extended model.
        ids: of the causes that are taken out.
    """
    states = without(plain, last, ids)
    return plain if states is plain.states else survey(last.noise, states, last.fixed)
