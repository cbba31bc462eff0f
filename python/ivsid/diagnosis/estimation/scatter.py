"""How far the readings of a sensor scatter beyond its stated accuracy: their prediction errors, at the least, over the accuracy.

The noise of a log is learnt from its readings, so that a position that jumps by metres in spells is a noisy one, and hides itself. A stated accuracy is a
bound all the same: three standard deviations of the noise beside errors that change slowly, of which a prediction over one step holds next to nothing.
What such a prediction cannot know, an ambient force between two rows above all, counts as stated.

Source: docs/theory.md, "Scatter".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.roughness import BLOCK, FEWEST, at_the_least
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]


def scattered(
    predictor: Predictor, residual: Array, rows: NDArray[np.bool_], left_out: frozenset[int]
) -> dict[str, float]:
    """Root mean square of prediction errors at the least over the stated accuracy, by channel.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that any column explains, shape (rows, n).
        rows: samples that count, shape (n,).
        left_out: indices of the axes that are left out of a fit, which have none.
    """
    stated, moved = _stated(predictor.vehicle), _unforeseen(predictor)
    block = round(BLOCK / predictor.log.h)
    edges = np.arange(0, rows.size - block + 1, block)
    count = np.add.reduceat(rows.astype(float), edges) if edges.size else np.zeros(0)
    whole = count > 0.5 * block
    found: dict[str, float] = {}
    if whole.sum() < FEWEST:
        return found
    for error, (k, channel) in zip(residual, predictor.labels, strict=True):
        if channel in stated and k not in left_out:
            each = np.add.reduceat(np.where(rows, error, 0.0)[: edges[-1] + block] ** 2, edges)[whole] / count[whole]
            # Readings on a coarse scale are off by their rounding as well.
            allowed = stated[channel] ** 2 + predictor.log.steps.get(channel, 0.0) ** 2 + moved[channel] ** 2
            found[channel] = float(np.sqrt(max(at_the_least(each)[0], 0.0) / allowed))
    return found


def _unforeseen(predictor: Predictor) -> dict[str, float]:
    """What a prediction over one step cannot know of each reading, in its unit: errors of filtered velocities, and what the ambient force moves."""
    h = predictor.log.h
    spreads = np.array([a.spread for a in predictor.axes[:3]])
    u, v, r = np.hypot(spreads, h * np.array(predictor.ambient.deviation)).tolist()
    over = h * float(np.hypot(u, v))
    return {"u": u, "v": v, "psi": h * r, "x": over, "y": over}


def _stated(vehicle: Vehicle) -> dict[str, float]:
    """Stated accuracies of readings, in their units, by channel."""
    sensors = vehicle.sensors
    of = {"uv": sensors.velocity, ("psi",): sensors.heading, "xy": sensors.position}
    return {name: s.accuracy for names, s in of.items() if s is not None and s.accuracy for name in names}
