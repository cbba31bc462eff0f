"""How much rougher a log is than its declared ambient force, beyond any thrust curve inside its accuracy.

``estimation.roughness`` counts the whole accuracy of all thrusts as declared, because its columns follow no curve exactly. A force of the time that
is several times the declared ambient one may hide in that. Beside any curve (``null.any_curve``) what is left is no error of a thrust that
follows the demand or the inflow, and the declared ambient force alone stands against it.

Source: docs/theory.md, "Noise" and "Any thrust curve inside its accuracy".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.noise import declared_ambient, lightest
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.roughness import least_ambient, roughness
from ivsid.diagnosis.null.any_curve import AnyCurve

Array = NDArray[np.float64]


def rougher_beyond(curve: AnyCurve) -> tuple[float, float, float]:
    """Ambient acceleration at the least over the declared one, beyond any thrust curve inside its accuracy, by axis; 0 where none is declared.

    Args:
        curve: the base of a fit beside any curve.
    """
    fit = curve.fit
    predictor, g = fit.noise.predictor, curve.g
    if predictor.vehicle.ambient is None:
        return 0.0, 0.0, 0.0
    left = g.y - g.explained(range(len(g.names)), curve.projection.coefficients)
    found = least_ambient(predictor, _unwhitened(fit, left), fit.noise.good, fit.noise.left_out)
    said = declared_ambient(predictor.vehicle, lightest(predictor.vehicle, fit.h.values))
    x, y, n = (found / np.array(said.deviation)).tolist()
    return x, y, n


def rougher_still(fit: Fit) -> tuple[float, float, float]:
    """How much rougher than declared a log is by a fit, by axis: that of its noise, or beside all columns at its numbers, whichever is less.

    Noise is learnt beside the model without causes, where the column of one that is not linear takes a part of it.
    """
    g, noise = fit.gram, fit.noise
    every = range(len(g.names))
    left = g.y - g.explained(every, Projection(g, []).solve(every)[0])
    here, _ = roughness(noise.predictor, _unwhitened(fit, left), noise.good, noise.left_out, fit.signatures.states)
    x, y, n = np.minimum(noise.rougher, here).tolist()
    return x, y, n


def _unwhitened(fit: Fit, left: Array) -> Array:
    """Prediction errors of whitened ones in blocks, shape (rows, n)."""
    rows = len(fit.noise.predictor.labels)
    whole = left.reshape(-1, rows, fit.gram.length).transpose(1, 0, 2).reshape(rows, -1)
    errors = np.zeros((rows, fit.noise.good.size))
    errors[:, : whole.shape[1]] = fit.noise.whitening.undone(whole)
    return errors
