"""Causes that imitate a force of another shape: any function of one velocity through the water, in that velocity's own equation.

A hump of the wave resistance is no drag of the catalogue, and a linear, a dry and a cubic one that take its place stand out all the same. A
function of the velocity is free between up to ``SPEEDS`` values, with as many samples between any two, farther apart than the velocity is known:
where it explains more in the place of a cause than its numbers gain by chance, the force is of a shape that the cause has not.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.declared_errors import through_water
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.selection.dictionary import LEAST_AMBIENT
from ivsid.effects import CHANNELS

Array = NDArray[np.float64]
# Speeds between which a function of a velocity is linear.
# Source: geometry: a hump over a quarter of the speeds has a speed on either side and one at its top
SPEEDS: Final = 9
# Fewest of them.
# Source: definition: a hump has a speed on either side and one at its top
FEWEST: Final = 3
# Least distance of two of them, in standard deviations of the filtered velocity's error: a function that changes over less follows that error, which the
# innovations hold as well.
# Source: geometry: the errors of two velocities that far apart do not overlap
APART: Final = 6.0
# The same, in distances of as many equally far ones. Most samples of a sway velocity stand on straight stretches, where quantiles lie within millimetres a second.
# Source: geometry: half and half, as the cells of a demand
EVENLY: Final = 0.5
# Names of the velocities in the words of a rule.
VELOCITIES: Final = ("u", "v", "r")


def speed_curves(fit: Fit) -> tuple[list[str], Array, Array, list[range]]:
    """Columns of functions of a velocity, whitened and in unit length, with their lengths, and the columns of each velocity.

    Args:
        fit: with the states at which the functions are taken.

    Returns:
        Names, columns of shape (columns, blocks, numbers), their lengths, and a range of columns for each velocity that varies.
    """
    g, predictor = fit.gram, fit.noise.predictor
    relative = through_water(fit.signatures)
    names: list[str] = []
    arrays: list[Array] = []
    groups: list[range] = []
    for k, (channel, velocity) in enumerate(zip(CHANNELS, relative, strict=True)):
        if k in fit.noise.left_out:
            continue
        places = _places(velocity, APART * predictor.axes[k].spread)
        if len(places) < FEWEST:
            continue
        first = len(names)
        for j, hat in enumerate(np.eye(len(places))):
            process = np.zeros((3, velocity.size))
            process[k] = max(predictor.ambient.deviation[k], LEAST_AMBIENT) * np.interp(velocity, places, hat)
            names.append(f"{channel}|{VELOCITIES[k]} {j}")
            arrays.append(process)
        groups.append(range(first, len(names)))
    if not arrays:
        return [], np.zeros((0, *g.y.shape)), np.zeros(0), []
    x, unit = g.white.blocks([predictor.answer(a) for a in arrays], g.good, g.length)
    return names, x.reshape(-1, *g.y.shape), unit, groups


def _places(velocity: Array, least: float) -> Array:
    """Values of a velocity with as many samples between any two, without those that lie closer than a least distance to the one below."""
    least = max(least, EVENLY * float(np.ptp(velocity)) / (SPEEDS - 1))
    found: list[float] = []
    for x in np.quantile(velocity, np.linspace(0.0, 1.0, SPEEDS)).tolist():
        if not found or x - found[-1] > least:
            found.append(x)
    return np.array(found)


def words(names: Sequence[str], group: range) -> str:
    """A group of columns in the words of a rule."""
    channel, function = names[group[0]].split("|", 1)
    return f"any function of {function.split()[0]} in {channel}"
