"""How much rougher a log is than its declared ambient force, beyond any thrust curve inside its accuracy.

``estimation.roughness`` counts the whole accuracy of all thrusts as declared, because its columns follow no curve exactly. A force of the time that
is several times the declared ambient one may hide in that. Beside any curve (``null.any_curve``) what is left is no error of a thrust that
follows the demand or the inflow, and the declared ambient force alone stands against it.

Source: docs/theory.md, "Noise" and "Any thrust curve inside its accuracy".
"""

from __future__ import annotations

import numpy as np

from ivsid.diagnosis.estimation.noise import declared_ambient, lightest
from ivsid.diagnosis.estimation.roughness import least_ambient
from ivsid.diagnosis.null.any_curve import AnyCurve


def rougher_beyond(curve: AnyCurve) -> tuple[float, float, float]:
    """Ambient acceleration at the least over the declared one, beyond any thrust curve inside its accuracy, by axis; 0 where none is declared.

    Args:
        curve: the base of a fit beside any curve.
    """
    fit = curve.fit
    predictor, g = fit.noise.predictor, curve.g
    if predictor.vehicle.ambient is None:
        return 0.0, 0.0, 0.0
    every = range(len(g.names))
    rows = len(predictor.labels)
    left = (g.y - g.explained(every, curve.projection.coefficients)).reshape(-1, rows, fit.gram.length)
    whole = left.transpose(1, 0, 2).reshape(rows, -1)
    errors = np.zeros((rows, fit.noise.good.size))
    errors[:, : whole.shape[1]] = fit.noise.whitening.undone(whole)
    _, found = least_ambient(predictor, errors, fit.noise.good, fit.noise.left_out)
    said = declared_ambient(predictor.vehicle, lightest(predictor.vehicle, fit.h.values))
    x, y, n = (found / np.array(said.deviation)).tolist()
    return x, y, n
