"""Shallow water: masses and drags that change by one factor from TRAIN to TEST.

Added masses and drags grow together where the water is shallow.

Source: docs/theory.md, "The catalogue of effects".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, Noise, fitted_gram, survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.noise import usable_rows
from ivsid.diagnosis.estimation.projection import Gram, Projection
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.selection.adequacy import RISK, adequacy
from ivsid.effects.environment import SHALLOW_SCALED
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Parameters that have to be fitted and to change: a factor of fewer may be chance.
# Source: measured: make constants
MEMBERS: Final = 3
# Standard deviations that the common change has to exceed.
# Source: definition: 6e-7 of normal errors lie beyond
SIGMAS: Final = 5.0
# Standard deviations within which each change has to agree with the common one.
# Source: definition: 6e-5 of normal errors lie beyond
AGREE: Final = 4.0
# Standard deviations that a change of one parameter has to exceed.
# Source: definition: 0.3 % of normal errors lie beyond
MOVED: Final = 3.0
# Least relative change that counts.
# Source: measured: make constants
LEAST: Final = 0.02
# Thrust errors of two logs differ by twice the declared accuracy at most.
# Source: definition: one error at either end of its bound
TWO_LOGS: Final = 2.0
# Relative difference of the clocks of two logs that counts as none.
# Source: definition: rounding of time stamps
SAME_CLOCK: Final = 1e-6
# Relative variance that is added to that of each parameter, so that their covariance can be inverted.
# Source: measured: make constants
FLOOR: Final = 1e-8


@dataclass(frozen=True)
class Change:
    """Change of the model between two logs.

    Attributes:
        ratio: TEST over TRAIN of each parameter, with its relative standard deviation.
        factor: the common factor with its standard deviation; None without a common factor.
    """

    ratio: dict[str, tuple[float, float]]
    factor: tuple[float, float] | None


def change(vehicle: Vehicle, last: Fit, test: Channels) -> Change | None:
    """Fits the last hypothesis to the other log, under the noise of the first.

    Args:
        vehicle: of the file.
        last: fit of the extended model to TRAIN.
        test: the other log.

    Returns:
        The change; None if the logs differ in channels or clock, if too few parameters are fitted, or if the fit fails.
    """
    fixed = last.fixed
    wanted = [i for i in SHALLOW_SCALED if i in last.h.values and i not in fixed]
    if len(wanted) < MEMBERS:
        return None
    predictor = Predictor(vehicle, test, last.noise.predictor.ambient)
    if predictor.labels != last.noise.predictor.labels or abs(test.h / last.noise.predictor.log.h - 1) > SAME_CLOCK:
        return None
    noise = Noise(predictor, last.noise.whitening, usable_rows(predictor), last.noise.left_out)
    # Biases and thrust errors belong to one log, so they are fitted again from zero.
    first = replace(last.h, declared_errors={})
    try:
        states = predictor.settle(first, predictor.start(first), 2)
        h, states = improve(predictor, first, states, noise.whitening, noise.good, fixed)
        g = fitted_gram(noise, h, states, fixed)
    except np.linalg.LinAlgError:
        return None
    before, after = (np.array([q.values[i] for i in wanted]) for q in (last.h, h))
    if (before <= 0).any() or (after <= 0).any():
        return None
    # An error of the thrust moves all parameters alike, so their covariance counts.
    spread = _covariance(last.gram, last.base, wanted) / np.outer(before, before)
    spread += _covariance(g, range(len(g.names)), wanted) / np.outer(after, after) + FLOOR * np.eye(len(wanted))
    sigma = np.sqrt(np.diag(spread))
    ratio = {i: (float(b / a), float(s)) for i, a, b, s in zip(wanted, before, after, sigma, strict=True)}
    factor = _common(np.log(after / before), spread, _declared(predictor, h))
    if factor is not None and adequacy(survey(noise, h, states, fixed)).chance < RISK:
        # The other log has further structure, which may move the parameters.
        factor = None
    return Change(ratio, factor)


def _declared(predictor: Predictor, h: Hypothesis) -> float:
    """Relative change of masses and drags that the declared accuracy of the thrusters allows between two logs with other demands."""
    found = 0.0
    thrusts = predictor.propulsion.thrusts(h.given).mean
    for thruster, thrust in zip(predictor.vehicle.thrusters, thrusts, strict=True):
        usual = float(np.sqrt(np.mean(thrust**2)))
        found = max(found, thruster.accuracy.relative + thruster.accuracy.absolute / max(usual, 1e-9))
    return TWO_LOGS * found


def _common(logs: Array, spread: Array, declared: float) -> tuple[float, float] | None:
    """Common factor by generalised least squares, with its standard deviation; None if the declared accuracy explains it."""
    sigma = np.sqrt(np.diag(spread))
    weight = np.linalg.solve(spread, np.ones(len(logs)))
    mean = float(weight @ logs / weight.sum())
    # The correlations are an estimate, so the error is at least that without them.
    error = max(float(1 / np.sqrt(weight.sum())), float(1 / np.sqrt(np.sum(sigma**-2.0))))
    agree = bool((np.abs(logs - mean) < AGREE * sigma).all())
    # Enough parameters have to change by themselves, and not only their mean.
    moved = bool((np.abs(logs) > MOVED * sigma).sum() >= MEMBERS)
    if abs(mean) < max(SIGMAS * error, LEAST) + declared or not agree or not moved:
        return None
    return float(np.exp(mean)), float(np.exp(mean) * (error + declared / 3))


def _covariance(g: Gram, base: Sequence[int], ids: Sequence[str]) -> Array:
    """Covariance of fitted parameters, shape (ids, ids)."""
    p = Projection(g, base)
    inverse = np.linalg.inv(p.normal)
    at = [p.base.index(k) for k in g.at(ids)]
    unit = g.unit[g.at(ids)]
    return np.asarray(inverse[np.ix_(at, at)] / np.outer(unit, unit))
