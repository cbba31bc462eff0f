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

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import NOTHING_LEFT, Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.declared_readings import FIXED
from ivsid.diagnosis.plant.physics import acceleration
from ivsid.linear.filters import decaying

Array = NDArray[np.float64]
# An effect is tested if it stands out by this many standard deviations at its typical size: at least 95 % of such effects are named.
# Source: measured: make exam
VISIBLE: Final = 8.0
# A signature is used if it is larger than the part that errors of the filtered states make of it, by this factor.
# Source: measured: make constants
EXCITED: Final = 4.0
# Share of a signature from which on it is one of turning.
# Source: geometry: half of the length
TURNED: Final = 0.5
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
    """Size of each signature beside the model over the size of its error, by column.

    The columns are made again at states that differ from the filtered ones by an error with the deviation and memory of the filter. A
    regressor that is mostly noise cannot be tested. What the model's columns take of a signature they take of its error as well: beside r and
    r|r| the slope of r^3 with r is a small part of its own. They also bring errors of their own, so that the smaller of both errors counts,
    alone and beside the model.

    Args:
        fit: of the plain model.
        seed: of the drawn error of the states.
    """
    predictor, n = fit.noise.predictor, fit.noise.predictor.log.n
    rng = np.random.default_rng(seed)
    shift = np.empty((3, n))
    for k, here in enumerate(predictor.axes[:3]):
        if k == 2 and predictor.rate is not None:
            shift[k] = predictor.rate.drawn(rng)
            continue
        pole = float(np.exp(-predictor.log.h / here.memory))
        shift[k] = decaying(np.sqrt(1 - pole**2) * rng.standard_normal(n), pole) * here.spread
    there = _elsewhere(fit, np.concatenate([shift, shift], axis=1))
    names, d = _change(fit, _causes(fit, there))
    if not names:
        return {}
    g, at = fit.gram, fit.gram.at(names)
    own, model = _change(fit, there.fitted(fit.fixed))
    # A declared error of a reading may be the cause itself, and takes of its error what it takes of its signature.
    p = Projection(g, [k for k in fit.base if not g.names[k].startswith(FIXED)])
    part = p.taken(g.at(own), at)
    signal = np.diag(p.information(at)) * g.unit[at] ** 2
    alone, beside = (np.einsum("cbi,cbi->c", e, e) for e in (d, d - np.tensordot(part.T, model, 1)))
    # Where nothing is left of a signature, nothing is left of its error either.
    some = signal > NOTHING_LEFT * g.unit[at] ** 2
    ratio = np.sqrt(signal / np.maximum(np.where(some, np.minimum(alone, beside), alone), 1e-300))
    # Effects on axes that are left out have no signature and no error of one.
    return {n: float(q) for n, q, s in zip(names, ratio, signal, strict=True) if s > NOTHING}


def due_to_turning(fit: Fit) -> dict[str, float]:
    """Share of each signature that is gone where the vehicle does not turn at all, by column: the distance over the length.

    Args:
        fit: of the plain model.
    """
    stopped = np.zeros_like(fit.states.points.nu)
    stopped[2] = -fit.states.points.nu[2]
    names, d = _change(fit, _causes(fit, _elsewhere(fit, stopped, still=True)))
    if not names:
        return {}
    g = fit.gram
    gone = np.einsum("cbi,cbi->c", d, d)
    return {n: float(np.sqrt(q) / u) for n, q, u in zip(names, gone, g.unit[g.at(names)], strict=True)}


def _elsewhere(fit: Fit, shift: Array, *, still: bool = False) -> Signatures:
    """Signatures at velocities that differ from the filtered ones."""
    predictor = fit.noise.predictor
    points = fit.states.points.moved(shift)
    nudot = acceleration(predictor.vehicle, fit.h, points)
    if still:
        nudot[2] = 0.0
    return Signatures(predictor, replace(fit.states, points=points, nudot=nudot))


def _causes(fit: Fit, there: Signatures) -> Columns:
    """The candidates' columns made again."""
    out = Columns()
    for candidate in fit.candidates:
        for name, array in candidate.shifted(there):
            if name in fit.gram.index and name not in out.names:
                out.add(name, array)
    return out


def _change(fit: Fit, columns: Columns) -> tuple[list[str], Array]:
    """Names of columns that were made again, and by how much these differ from those of the fit, whitened, shape (columns, blocks, numbers)."""
    g = fit.gram
    if not columns.names:
        return [], np.zeros((0, *g.y.shape))
    at = g.at(columns.names)
    x = g.white.blocks(columns.arrays, g.good, g.length, unit=False)[0]
    return list(columns.names), x - g.columns(at) * g.unit[at][:, None, None]


def visibility(fit: Fit, excited: Mapping[str, float] | None = None) -> dict[str, Visibility]:
    """Visibility of every candidate with columns of its own, by id.

    Args:
        fit: of the plain model.
        excited: the excitation by column, if it is known already.
    """
    if excited is None:
        excited = excitation(fit)
    turned = due_to_turning(fit) if fit.noise.left_out else {}
    p = fit.projection
    found: dict[str, Visibility] = {}
    for candidate in fit.candidates:
        if candidate.searched:
            continue
        z, sizes = candidate.size(p, fit.signatures)
        blind = min((excited[n] for n in candidate.variants[0] if n in excited), default=np.inf) < EXCITED
        # Without turning, such an effect is seen by what the yaw rate's errors make of it, unless it acts by drift as well.
        due = max((turned[n] for n in candidate.variants[0] if n in turned), default=0.0)
        blind = blind or (candidate.effect.turning and due > TURNED)
        if candidate.id in found and found[candidate.id].z >= z:
            continue
        found[candidate.id] = Visibility(z, sizes, candidate.detectable(p, VISIBLE, z, sizes), blind)
    return found
