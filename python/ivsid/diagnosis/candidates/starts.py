"""Starts of a cause to a sample: chi-squared has a valley one sample wide where demands change often, and steps of seconds pass it by.

Prediction errors of a cause that starts at a sample are about those without it up to there, and those with it afterwards. So running sums
of their squares, each in its own variance, tell every start at once. The filters' memory blurs them, so that the least are proposals,
whose chi-squared is worked out.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.effects import Given

# Starts that are proposed, each more than a second from the others.
# Source: resource: three chi-squared each
PROPOSED: Final = 4
# Least distance of two proposals [s].
# Source: geometry: longer than the memory of the filters
APART: Final = 1.0
# A start acts from within a step of its sample: shares of a step at which chi-squared is worked out.
# Source: geometry: the steps before and after
BESIDE: Final = (-0.5, 0.5, 1.5)
# Median of the square of a standard normal number.
# Source: theorem: chi-squared of one degree of freedom
MEDIAN: Final = 0.4549


def proposed_starts(problem: Problem, states: FilteredStates, given: Given, j: int) -> list[float]:
    """Starts [s] at which chi-squared may be least.

    Args:
        problem: the log.
        states: of the hypothesis.
        given: the effect as it stands in the hypothesis.
        j: index of the start among its numbers.
    """
    predictor = problem.noise.predictor
    log = predictor.log
    errors = predictor.errors(states)

    def beside(start: float) -> NDArray[np.float64]:
        values = list(given.values)
        values[j] = start
        return errors - predictor.difference(states, states.h.with_effect(replace(given, values=tuple(values))))

    variance = np.nanmedian(errors**2, axis=1, keepdims=True) / MEDIAN
    without, within = (
        np.nansum(beside(start) ** 2 / np.maximum(variance, np.finfo(float).tiny), axis=0)
        for start in (float(log.t[-1]) + 1.0, float(log.t[0]) - 1.0)
    )
    total = np.r_[0.0, np.cumsum(without)] + np.r_[np.cumsum(within[::-1])[::-1], 0.0]
    found: list[float] = []
    for k in np.argsort(total, kind="stable"):
        start = float(log.t[min(k, log.n - 1)])
        if all(abs(start - other) > APART for other in found):
            found.append(start)
        if len(found) == PROPOSED:
            break
    return [start + share * log.h for start in found for share in BESIDE]
