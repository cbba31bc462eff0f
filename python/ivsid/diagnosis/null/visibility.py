"""Visibility of causes: how far an effect of typical size stands out in a log, and whether its signature is more than noise.

The size z of an effect is the square root of the fall of chi-squared that it makes at its typical size, beside the model and the declared
errors.

Source: docs/theory.md, "Isolability".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import acceleration

Array = NDArray[np.float64]
# An effect is tested if it stands out by this many standard deviations at its typical size: at least 95 % of such effects are named.
# Source: measured: make exam
VISIBLE: Final = 8.0
# A signature is used if it is larger than the part that errors of the filtered states make of it, by this factor.
# Source: measured: make constants
EXCITED: Final = 4.0
# Below this energy a signature acts on axes that are left out, and has no excitation.
# Source: definition: whitened signatures of such axes are zero up to rounding
NOTHING: Final = 1e-12


@dataclass(frozen=True)
class Visibility:
    """Visibility of an effect in a log.

    Attributes:
        z: standard deviations by which the effect stands out at its typical size.
        typical: the typical size, by parameter, in its unit.
        detectable: the size at which z reaches ``VISIBLE``, by parameter, in its unit; empty if there is none.
        blind: whether the signature is mostly made of the errors of the filtered states.
    """

    z: float
    typical: Mapping[str, float]
    detectable: Mapping[str, float]
    blind: bool = False

    @property
    def tested(self) -> bool:
        """Whether the log can show the effect."""
        return self.z >= VISIBLE and not self.blind


def excitation(fit: Fit, seed: int = 0) -> dict[str, float]:
    """Size of each signature over the size of its error, by column.

    The columns are made again at states that differ from the filtered ones by an error with the deviation and memory of the filter. A
    regressor that is mostly noise cannot be tested.

    Args:
        fit: of the plain model.
        seed: of the drawn error of the states.
    """
    predictor, n = fit.noise.predictor, fit.noise.predictor.log.n
    rng = np.random.default_rng(seed)
    shift = np.empty((3, n))
    for k, here in enumerate(predictor.axes[:3]):
        pole = float(np.exp(-predictor.log.h / here.memory))
        shift[k] = lfilter([np.sqrt(1 - pole**2)], [1, -pole], rng.standard_normal(n)) * here.spread
    points = fit.states.points.moved(np.concatenate([shift, shift], axis=1))
    other = replace(fit.states, points=points, nudot=acceleration(predictor.vehicle, fit.h, points))
    signatures = Signatures(predictor, other)
    names: list[str] = []
    arrays: list[Array] = []
    index = fit.gram.index
    for candidate in fit.candidates:
        for name, array in candidate.shifted(signatures):
            if name in index:
                names.append(name)
                arrays.append(array)
    if not names:
        return {}
    at = fit.gram.at(names)
    g = fit.gram
    x, _ = g.white.blocks(arrays, g.good, g.length, unit=False)
    difference = np.einsum("cbi,cbi->c", d := x - g.columns(at) * g.unit[at][:, None, None], d)
    signal = np.diag(fit.projection.information(at)) * g.unit[at] ** 2
    ratio = np.sqrt(signal / np.maximum(difference, 1e-300))
    # Effects on axes that are left out have no signature and no error of one.
    return {n: float(q) for n, q, s in zip(names, ratio, signal, strict=True) if s > NOTHING}


def visibility(fit: Fit, excited: Mapping[str, float] | None = None) -> dict[str, Visibility]:
    """Visibility of every candidate with columns of its own, by id.

    Args:
        fit: of the plain model.
        excited: the excitation by column, if it is known already.
    """
    if excited is None:
        excited = excitation(fit)
    p = fit.projection
    found: dict[str, Visibility] = {}
    for candidate in fit.candidates:
        if candidate.searched:
            continue
        z, sizes = candidate.size(p, fit.signatures)
        blind = min((excited[n] for n in candidate.variants[0] if n in excited), default=np.inf) < EXCITED
        # Without turning, sway and yaw hold the noise of their sensors and nothing else.
        blind = blind or (bool(fit.noise.left_out) and candidate.effect.turning)
        if candidate.id in found and found[candidate.id].z >= z:
            continue
        found[candidate.id] = Visibility(z, sizes, candidate.detectable(p, VISIBLE, z, sizes), blind)
    return found
