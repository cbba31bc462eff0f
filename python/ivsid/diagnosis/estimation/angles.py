"""Whether the angles of thrusters and rudders run from one sample to the next, or hold.

A demand holds until the next one comes. An angle that is measured cannot jump, and one that is commanded does: a log tells the two apart, where
samples are slow beside the turning.

Source: docs/theory.md, "Angles between samples".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit, Search, survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.noise import Noise
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.prediction.innovations import Predictor

# Fall of chi-squared from which on angles are taken to run.
# Source: definition: the fall that counts for a cause
COUNTS: Final = 25.0
# What is said where they do.
RUNS: Final = (
    "angles of thrusters and rudders are taken to run from one row to the next: the log shows that they do not hold"
)
# Passes of the filters under other angles.
# Source: resource: filtered states forget their start within some rounds
PASSES: Final = 4


def run(fit: Fit, search: Search) -> bool:
    """Whether a log whose angles hold is followed better by angles that run on straight lines, and no worse beside the best cause of either.

    An angle that runs is half a row late beside one that holds, and so is the thrust of a shaft that lags: a log with that cause is followed
    better by angles that run, and better still by the cause and angles that hold.

    Args:
        fit: of the model to the log, with angles that hold.
        search: adds the columns of searched causes.
    """
    predictor, noise = fit.noise.predictor, fit.noise
    log = predictor.log
    moves = bool(np.any(np.diff(log.angles)) or np.any(np.diff(log.rudders)))
    if not (log.held and moves and log.between is None):
        return False
    other = Predictor(
        predictor.vehicle,
        replace(log, running=True),
        predictor.ambient,
        axes=predictor.axes,
        turning=predictor.rate is None,
    )
    there = Noise(other, noise.whitening, noise.good, noise.left_out)
    try:
        states = other.settle(other.start(fit.h), PASSES)
        states = improve(Problem.at(there, fit.fixed, states), states)
        gained = fit.problem.chi2(fit.states) - Problem.at(there, fit.fixed, states).chi2(states)
        if gained <= COUNTS:
            return False
        other_way = _beside_best(search(survey(there, states, fit.fixed))) - _beside_best(search(fit))
    except (np.linalg.LinAlgError, ValueError, FloatingPointError):
        # Numbers that follow the log with angles that hold stand.
        return False
    return bool(other_way <= 0.0)


def _beside_best(fit: Fit) -> float:
    """Chi-squared that is left beside the column of a cause that takes most of it."""
    p = fit.projection
    return p.chi2 - max((p.solve([k])[1] for k in set(range(len(fit.gram.names))) - {*fit.base}), default=0.0)
