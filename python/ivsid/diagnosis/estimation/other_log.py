"""A fitted hypothesis on another log of the same vehicle, under the noise of the first.

Source: docs/theory.md, "Statements", shallow water.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.noise import Noise, usable_rows
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.plant.driving import Driving
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor

# Declared errors that two logs of one vehicle share, by the first words of their names: those of thrust curves and blades, which are static.
SHARED: Final = ("~thrust.", "~hysteresis.", "~cell.", "~rudder.")
# Relative difference of the clocks of two logs that counts as none.
# Source: definition: rounding of time stamps
SAME_CLOCK: Final = 1e-6


def carried_to(last: Fit, other: Channels) -> tuple[Noise, FilteredStates] | None:
    """The last hypothesis fitted to the other log: its noise, and its states there; None if the logs differ in channels or clock.

    Args:
        last: fit of a log.
        other: the other log.

    Raises:
        numpy.linalg.LinAlgError: the other log does not determine the numbers.
    """
    here = last.noise.predictor
    # The thrusters are the same, and so are the errors of their curves: one set of errors serves both logs.
    driving = Driving(here.vehicle, other, here.propulsion.errors)
    predictor = Predictor(here.vehicle, other, here.ambient, driving=driving, turning=not last.noise.left_out)
    if predictor.labels != here.labels or abs(other.h / here.log.h - 1) > SAME_CLOCK:
        return None
    noise = Noise(predictor, last.noise.whitening, usable_rows(predictor), last.noise.left_out)
    # Biases belong to one log, so they are fitted again from zero.
    first = replace(last.h, declared_errors={k: e for k, e in last.h.declared_errors.items() if k.startswith(SHARED)})
    states = predictor.settle(predictor.start(first), 2)
    return noise, improve(Problem.at(noise, last.fixed, states), states)
