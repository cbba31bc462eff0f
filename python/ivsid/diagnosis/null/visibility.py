"""Visibility of causes: how far an effect of typical size stands out in a log, and whether its signature is more than noise.

The size z of an effect is the square root of the fall of chi-squared that it makes at its typical size, beside the model and the declared
errors.

Source: docs/theory.md, "Isolability".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import acceleration
from ivsid.effects import Reading, Terms

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
# Typical size of a step in one thruster, as a share of its thrust.
# Source: measured: make constants
TYPICAL_STEP: Final = 0.15
# Below this z no size of an effect is called detectable.
# Source: definition: signatures of no effect are zero up to rounding
NO_SIZE: Final = 1e-6
# Causes without a signature of their own where the vehicle does not turn.
TURNING: Final = (
    "drag.surge.sideslip",
    "drag.sway",
    "drag.yaw",
    "drag.cross_flow",
    "drag.lift",
    "coupling",
    "added_mass",
    "thruster.asymmetry",
    "sensor.yaw_rate",
    "sensor.velocity.misalignment",
    "sensor.velocity.lever_arm",
    "sensor.acceleration.lever_arm",
)


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
    signatures = Signatures(predictor, fit.h, other)
    names: list[str] = []
    arrays: list[Array] = []
    index = fit.gram.index
    for family in fit.families:
        acts = family.effect.acts
        if family.kind != "linear" or family.id == "wind.steady":
            continue
        if isinstance(acts, Reading):
            names += family.variants[0]
            arrays += signatures.reading(family.id)
        elif isinstance(acts, Terms):
            for term in acts.terms:
                if term.id in index:
                    names.append(term.id)
                    arrays.append(predictor.term(fit.h, other, signatures.mass, signatures.fitting(term)))
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
    """Visibility of every family with columns of its own, by id.

    Args:
        fit: of the plain model.
        excited: the excitation by column, if it is known already.
    """
    if excited is None:
        excited = excitation(fit)
    p = fit.projection
    mass = fit.noise.predictor.vehicle.hull.mass
    found: dict[str, Visibility] = {}
    for family in fit.families:
        if not family.variants:
            continue
        z, sizes = _size(fit, p, family, mass)
        blind = min((excited[n] for n in family.variants[0] if n in excited), default=np.inf) < EXCITED
        # Without turning, sway and yaw hold the noise of their sensors and nothing else.
        blind = blind or (bool(fit.noise.left_out) and family.id.startswith(TURNING))
        if family.id in found and found[family.id].z >= z:
            continue
        if family.idle is None:
            least = {k: v * VISIBLE / z for k, v in sizes.items() if v} if z > NO_SIZE else {}
        else:
            least = _first(levels(fit, family), next(iter(sizes)))
        found[family.id] = Visibility(z, sizes, least, blind)
    return found


def levels(fit: Fit, family: Family) -> list[tuple[float, float]]:
    """Values of a dead band or a limit with their z, which is not proportional to the value.

    Args:
        fit: of the plain model.
        family: of the dead band or limit.

    Returns:
        Pairs of value and z, from the value without effect on.
    """
    g = fit.gram
    found = [] if family.idle is None else [(family.idle, 0.0)]
    for names, (value,) in zip(family.variants, family.values, strict=True):
        at = g.at(names)
        found.append((value, float(np.sqrt(max(fit.projection.information(at)[0, 0], 0.0)) * g.unit[at[0]])))
    return sorted(found, key=lambda q: abs(q[0] - found[0][0]))


def _first(found: list[tuple[float, float]], name: str) -> dict[str, float]:
    """Value at which z first reaches ``VISIBLE``, by linear interpolation between levels; empty if no level reaches it."""
    for (a, low), (b, high) in pairwise(found):
        if low < VISIBLE <= high:
            return {name: a + (b - a) * (VISIBLE - low) / (high - low)}
    return {}


def _size(fit: Fit, p: Projection, family: Family, mass: float) -> tuple[float, dict[str, float]]:
    """The z of a family at its typical size, and that size by parameter."""
    g = fit.gram
    parameters = family.effect.parameters
    if family.idle is not None:
        typical = parameters[0].scaled(mass)
        if family.id == "thruster.deadband":
            typical = parameters[0].typical / 100 * float(np.abs(fit.noise.predictor.log.demands).max())
        values, shown = np.array(sorted(levels(fit, family))).T
        return float(np.interp(typical, values, shown)), {family.effect.parts[0]: typical}
    if family.kind == "secant":
        typical = parameters[0].scaled(mass)
        values = [v[0] for v in family.values]
        k = int(np.argmin([abs(np.log(max(v, 1e-9) / max(typical, 1e-9))) for v in values]))
        at = g.at(family.variants[k])
        z = typical / values[k] * float(np.sqrt(max(p.information(at)[0, 0], 0.0))) * float(g.unit[at[0]])
        return z, {family.effect.parts[0]: typical}
    at = g.at(family.variants[0])
    if family.kind == "step":
        j = at[0]
        size = parameters[0].scaled(mass) if family.thruster is None else TYPICAL_STEP
        half = len(g.blocks) // 2
        later = g.blocks[half:, j, :].sum(axis=0)
        cross = later[p.base]
        H = float(later[j] - cross @ np.linalg.solve(p.normal, cross))
        name = family.effect.parts[0] if family.thruster is None else family.effect.parts[1]
        return size * float(g.unit[j]) * float(np.sqrt(max(H, 0.0))), {name: size}
    information = p.information(at)
    sizes = np.array([q.scaled(mass) - q.none for q in parameters])
    theta = sizes * g.unit[at]
    named = dict(zip(family.effect.parts, sizes.tolist(), strict=True))
    return float(np.sqrt(max(float(theta @ information @ theta), 0.0))), named
