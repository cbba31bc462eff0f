"""TRAIN against TEST: masses and drags that scale together between two logs are shallow water."""

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
from ivsid.diagnosis.selection.adequacy import LEVEL, adequacy
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
SCALED: Final = ("mass.surge", "mass.sway", "drag.surge.quadratic", "drag.sway.quadratic")
# Errors of two fits that a change has to exceed, and the least change that counts.
SIGMAS: Final = 5.0
LEAST: Final = 0.02


@dataclass(frozen=True)
class Change:
    """How the model differs between two logs.

    Attributes:
        ratio: TEST over TRAIN of each parameter, with its standard deviation.
        factor: the common one with its standard deviation, or None where there is none.
    """

    ratio: dict[str, tuple[float, float]]
    factor: tuple[float, float] | None


def change(vehicle: Vehicle, last: Fit, test: Channels) -> Change | None:
    """Fits the last hypothesis to the other log, too, under the noise of the first; None where the logs have other channels."""
    fixed = last.fixed
    wanted = [i for i in SCALED if i in last.h.values and i not in fixed]
    if len(wanted) < 3:
        return None
    predictor = Predictor(vehicle, test, last.noise.predictor.ambient)
    if predictor.labels != last.noise.predictor.labels or abs(test.h / last.noise.predictor.log.h - 1) > 1e-6:
        return None
    noise = Noise(predictor, last.noise.whitening, usable_rows(predictor), last.noise.left_out)
    # Biases and thrust errors are those of a log: they start anew.
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
    # An error of the thrust moves all of them alike: their errors are not independent.
    spread = _covariance(last.gram, last.base, wanted) / np.outer(before, before)
    spread += _covariance(g, range(len(g.names)), wanted) / np.outer(after, after) + 1e-8 * np.eye(len(wanted))
    sigma = np.sqrt(np.diag(spread))
    ratio = {i: (float(b / a), float(s)) for i, a, b, s in zip(wanted, before, after, sigma, strict=True)}
    factor = _common(np.log(after / before), spread, _declared(predictor, h))
    if factor is not None and adequacy(survey(noise, h, states, fixed)).chance < LEVEL:
        # Something else is wrong in the other log, and may be what moves the parameters.
        factor = None
    return Change(ratio, factor)


def _declared(predictor: Predictor, h: Hypothesis) -> float:
    """How far the accuracy of the thrusts alone may move masses and drags between two logs, which use other demands."""
    found = 0.0
    thrusts = predictor.propulsion.thrusts(h.given).mean
    for thruster, thrust in zip(predictor.vehicle.thrusters, thrusts, strict=True):
        usual = float(np.sqrt(np.mean(thrust**2)))
        found = max(found, thruster.accuracy.relative + thruster.accuracy.absolute / max(usual, 1e-9))
    return 2.0 * found


def _common(logs: Array, spread: Array, declared: float) -> tuple[float, float] | None:
    """The factor that all share, by generalised least squares; None where the declared accuracy explains it."""
    sigma = np.sqrt(np.diag(spread))
    weight = np.linalg.solve(spread, np.ones(len(logs)))
    mean = float(weight @ logs / weight.sum())
    # No less than the errors without any of their correlations, which are an estimate.
    error = max(float(1 / np.sqrt(weight.sum())), float(1 / np.sqrt(np.sum(sigma**-2.0))))
    agree = bool((np.abs(logs - mean) < 4 * sigma).all())
    # Each parameter has to have moved by itself, not only their mean.
    moved = bool((np.abs(logs) > 3 * sigma).sum() >= 3)
    if abs(mean) < max(SIGMAS * error, LEAST) + declared or not agree or not moved:
        return None
    return float(np.exp(mean)), float(np.exp(mean) * (error + declared / 3))


def _covariance(g: Gram, base: Sequence[int], ids: Sequence[str]) -> Array:
    p = Projection(g, base)
    inverse = np.linalg.inv(p.total[np.ix_(p.base, p.base)] + np.diag(g.prior[p.base] + 1e-9))
    at = [p.base.index(k) for k in g.at(ids)]
    unit = g.unit[g.at(ids)]
    return np.asarray(inverse[np.ix_(at, at)] / np.outer(unit, unit))
