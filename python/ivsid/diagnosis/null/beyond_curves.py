"""How much rougher a log is than its declared ambient force, beyond any thrust curve inside its accuracy.

``estimation.roughness`` counts the whole accuracy of all thrusts as declared, because its columns follow no curve exactly. A force of the time that
is several times the declared ambient one may hide in that. Beside any curve (``null.any_curve``) what is left is no error of a thrust that
follows the demand or the inflow, and the declared ambient force alone stands against it.

Source: docs/theory.md, "Noise" and "Any thrust curve inside its accuracy".
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.roughness import rougher_alone
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.curve_errors import cells_of

# Jumps of a thrust's error inside cells of its demand: in such a cell a constant leaves all of it.
# Source: definition: as many levels as an error may have beside the edges of cells
JUMPS: Final = 4.0


def rougher_beyond(curve: AnyCurve, least: float) -> tuple[float, float, float]:
    """Ambient acceleration at the least over the declared one, beyond any thrust curve inside its accuracy, by axis; 0 where none is declared.

    Args:
        curve: the base of a fit beside any curve.
        least: what errors of thrusts and the ambient force together have to be in the declared ambient force for an axis to be asked.
    """
    fit = curve.fit
    predictor = fit.noise.predictor
    if predictor.vehicle.ambient is None:
        return 0.0, 0.0, 0.0
    share = np.sqrt(JUMPS / cells_of(len(predictor.vehicle.thrusters)))
    found = rougher_alone(predictor, curve.errors, fit.noise.good, fit.noise.left_out, fit.states, share)
    # Errors of thrusts that come in spells are told by neither of both alone.
    x, y, n = np.where(np.array(fit.noise.alone) > least, found, 0.0).max(axis=0).tolist()
    return x, y, n
