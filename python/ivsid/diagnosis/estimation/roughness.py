"""How much rougher a log is than its vehicle file declares: the ambient acceleration that it shows, at the least, over the declared one.

The noise of a log is learnt from what no cause explains, so that a force outside the catalogue is learnt as ambient force, and hides itself.
The declared ambient force is a bound all the same. So is the accuracy of the thrusts, whose errors a log holds that no declared function follows:
both count as declared.

Source: docs/theory.md, "Noise"; for means over blocks Künsch, "The jackknife and the bootstrap for general stationary observations",
Annals of Statistics 17, 1989.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.noise import LAGS, declared_ambient, lightest, slopes_of
from ivsid.diagnosis.prediction.innovations import Predictor

Array = NDArray[np.float64]
# Length of the blocks whose scatter tells how well a correlation is known [s].
# Source: geometry: several correlation times of an ambient force
BLOCK: Final = 20.0
# Blocks from which a scatter is told.
# Source: definition: fewer have hardly any
FEWEST: Final = 4
# Standard errors below the estimate that count as "at the least".
# Source: definition: of twelve normal estimates three in a thousand lie below, over three axes one in a hundred logs
ERRORS: Final = 3.0


def roughness(
    predictor: Predictor,
    residual: Array,
    rows: NDArray[np.bool_],
    left_out: frozenset[int],
    masses: Mapping[str, float],
) -> tuple[Array, Array]:
    """Ambient acceleration at the least over what is declared, by axis, and over the declared ambient force alone, shape (3,) each.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that any column explains, shape (rows, n).
        rows: samples that count, shape (n,).
        left_out: indices of the axes that are left out of a fit.
        masses: of the fitted model by id.
    """
    if predictor.vehicle.ambient is None:
        return np.zeros(3), np.zeros(3)
    least = lightest(predictor.vehicle, masses)
    said = declared_ambient(predictor.vehicle, least)
    found, declared = least_ambient(predictor, residual, rows, left_out), np.array(said.deviation)
    # An ambient force that forgets at the declared rate keeps this share of its deviation.
    kept = np.exp(-0.5 * LAGS[0] / np.array(said.time))
    return found / kept / np.hypot(declared, _of_thrusts(predictor) / np.array(list(least.values()))), found / declared


def least_ambient(predictor: Predictor, residual: Array, rows: NDArray[np.bool_], left_out: frozenset[int]) -> Array:
    """Ambient acceleration of each axis at the least [m/s^2, rad/s^2], shape (3,); 0 where an axis is left out or a rudder pushes.

    It is what lasts for two seconds: no force of any spectrum is less.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that is explained, shape (rows, n).
        rows: samples that count, shape (n,).
        left_out: indices of the axes that are left out of a fit.
    """
    out = np.zeros(3)
    lag, block = round(LAGS[0] / predictor.log.h), round(BLOCK / predictor.log.h)
    # The error of a rudder's force has no bound in newtons, and it pushes sideways.
    steered = any(t.rudder is not None for t in predictor.vehicle.thrusters)
    for k, (slope, good) in enumerate(slopes_of(predictor, residual, rows)):
        if k in left_out or (steered and k > 0) or not good.any():
            continue
        x = np.where(good, slope - slope[good].mean(), 0.0)
        both = (good[lag:] & good[:-lag]).astype(float)
        edges = np.arange(0, both.size - block + 1, block)
        count = np.add.reduceat(both, edges) if edges.size else np.zeros(0)
        whole = count > 0.5 * block
        if whole.sum() < FEWEST:
            continue
        each = np.add.reduceat(x[lag:] * x[:-lag], edges)[whole] / count[whole]
        # Readings on a coarse scale are off by what the motion makes of it: a slope over a second by as much as two independent ones.
        rounded = predictor.log.steps.get("uvr"[k], 0.0) ** 2 / 6
        least = each.mean() - rounded - ERRORS * each.std(ddof=1) / np.sqrt(each.size)
        out[k] = np.sqrt(max(least, 0.0))
    return out


def _of_thrusts(predictor: Predictor) -> Array:
    """Forces X, Y [N] and moment N [N m] that errors of all thrusts together make at their bounds, rms, shape (3,)."""
    vehicle, propulsion = predictor.vehicle, predictor.propulsion
    out = np.zeros(3)
    for k, (thruster, errors) in enumerate(zip(vehicle.thrusters, propulsion.errors, strict=True)):
        size = errors.bound(propulsion.demands[k])
        angle, (x, y) = predictor.driving.turned[k, : size.size], thruster.position
        c, s = np.cos(angle), np.sin(angle)
        out += np.sqrt(np.mean((np.stack([c, s, x * s - y * c]) * size) ** 2, axis=1))
    return out
