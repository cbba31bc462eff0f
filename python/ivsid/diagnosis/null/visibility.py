"""Stage 5: what a log can show at all, and which gains are more than chance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.stats import f as fisher

from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.null.thresholds import HIGH_SIDE, Calibration
from ivsid.diagnosis.plant.physics import acceleration
from ivsid.effects import Reading, Terms

Array = NDArray[np.float64]
VISIBLE: Final = 8.0
# A signature is used where it is so many times the part that the states' errors make of it.
EXCITED: Final = 4.0
# Causes that nothing shows where the vehicle does not turn.
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
# Blocks of the bootstrap: as many blocks of the Gram side by side as make half a minute.
SIDE: Final = 3
# The second opinion has few blocks: it is asked for less.
SECOND: Final = 5e-3
# A gain like this is none of the noise model's; its blocks may disagree only because the fit is not finished, or because they are few.
# Without a hidden effect the largest gain of a hundred turning logs was 14; where axes are left out it was 90, and more is asked.
BEYOND_DOUBT: Final = 40.0
BEYOND_DOUBT_AXES_LEFT_OUT: Final = 60.0
# An effect that would not show at its typical size needs this gain.
STRONG: Final = 40.0
# A smaller fall of chi^2 is no finding, whatever its chance: below five standard deviations the model of the noise is not to be trusted.
FAINT: Final = 25.0
# Below this share of its usual size a cause is nothing that the equations of a diagnosis are good for.
NEGLIGIBLE: Final = 0.01
# No cause is so many times its usual size.
IMPOSSIBLE: Final = 50.0


@dataclass(frozen=True)
class Visibility:
    """How far an effect of its typical size would stand out.

    Attributes:
        z: in standard deviations.
        typical: the size that this is for, by parameter.
        detectable: the smallest size that would have shown, by parameter.
        blind: the signature is mostly made of the states' own errors.
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
    """How much stronger a signature is than the part of it that only the states' own errors make, by column.

    The columns are made again at states that differ from the filtered ones by an error of the size and memory that the filter believes.
    Where a regressor is mostly its own noise, no test of it means anything.
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
    # What acts on an axis that is left out has neither.
    return {n: float(q) for n, q, s in zip(names, ratio, signal, strict=True) if s > 1e-12}


def visibility(fit: Fit, excited: Mapping[str, float] | None = None) -> dict[str, Visibility]:
    """For every family with columns of its own, by id; ``excited`` is the excitation where it is known already."""
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
        # Without turning, what is known of sway and yaw is the noise of their sensors.
        blind = blind or (bool(fit.noise.left_out) and family.id.startswith(TURNING))
        if family.id in found and found[family.id].z >= z:
            continue
        if family.idle is None:
            # Without any signature there is no size that would show.
            least = {k: v * VISIBLE / z for k, v in sizes.items() if v} if z > 1e-6 else {}
        else:
            least = _first(levels(fit, family), next(iter(sizes)))
        found[family.id] = Visibility(z, sizes, least, blind)
    return found


def levels(fit: Fit, family: Family) -> list[tuple[float, float]]:
    """Of a dead band or limit: the values tried and their z, from the one that does nothing on; z is not proportional to the value."""
    g = fit.gram
    found = [] if family.idle is None else [(family.idle, 0.0)]
    for names, (value,) in zip(family.variants, family.values, strict=True):
        at = g.at(names)
        found.append((value, float(np.sqrt(max(fit.projection.information(at)[0, 0], 0.0)) * g.unit[at[0]])))
    return sorted(found, key=lambda q: abs(q[0] - found[0][0]))


def _first(found: list[tuple[float, float]], name: str) -> dict[str, float]:
    """Where z first reaches what a log must show, between two levels; empty where none does."""
    for (a, low), (b, high) in pairwise(found):
        if low < VISIBLE <= high:
            return {name: a + (b - a) * (VISIBLE - low) / (high - low)}
    return {}


def _size(fit: Fit, p: Projection, family: Family, mass: float) -> tuple[float, dict[str, float]]:
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
        size = parameters[0].scaled(mass) if family.thruster is None else 0.15
        half = len(g.blocks) // 2
        later = g.blocks[half:, j, :].sum(axis=0)
        cross = later[p.base]
        inner = p.total[np.ix_(p.base, p.base)] + np.diag(g.prior[p.base] + 1e-9)
        H = float(later[j] - cross @ np.linalg.solve(inner, cross))
        name = family.effect.parts[0] if family.thruster is None else family.effect.parts[1]
        return size * float(g.unit[j]) * float(np.sqrt(max(H, 0.0))), {name: size}
    information = p.information(at)
    sizes = np.array([q.scaled(mass) - q.none for q in parameters])
    theta = sizes * g.unit[at]
    named = dict(zip(family.effect.parts, sizes.tolist(), strict=True))
    return float(np.sqrt(max(float(theta @ information @ theta), 0.0))), named


def second_opinion(fit: Fit, s: Scored) -> float:
    """The probability of a gain without the effect, from how much the blocks of the log agree on it: no noise model stands in it."""
    p = fit.projection
    g = fit.gram
    at = list(s.columns)
    if s.family.kind == "step":
        first = round((s.values[-1] - float(fit.noise.predictor.log.t[0])) / (g.length * fit.noise.predictor.log.h))
        keep = np.arange(len(g.blocks)) >= first
    else:
        keep = np.ones(len(g.blocks), dtype=bool)
    solved = np.linalg.solve(
        p.total[np.ix_(p.base, p.base)] + np.diag(g.prior[p.base] + 1e-9), p.total[np.ix_(p.base, at)]
    )
    # Scores of the projected columns block by block, at the fit of the base.
    own = g.blocks[:, at][:, :, at] * keep[:, None, None]
    cross = g.blocks[:, at][:, :, p.base] * keep[:, None, None]
    score = (g.score[:, at] - cross @ p.coefficients) * keep[:, None]
    base_score = g.score[:, p.base] - g.blocks[:, p.base][:, :, p.base] @ p.coefficients
    score = score - base_score @ solved
    H = own - cross @ solved
    theta = np.linalg.lstsq(H.sum(axis=0), score.sum(axis=0), rcond=1e-9)[0]
    left = score - H @ theta
    blocks = left.shape[0] // SIDE * SIDE
    left = left[:blocks].reshape(-1, SIDE, len(at)).sum(axis=1)
    whole = score.sum(axis=0)
    n, k = left.shape[0], len(at)
    if n <= k + 1:
        return 1.0
    V = left.T @ left
    wald = float(whole @ np.linalg.pinv(V, rcond=1e-9) @ whole)
    return float(fisher.sf(wald * (n - k) / (n * k), k, n - k))


def _beside(fit: Fit, s: Scored, other: Scored) -> float:
    """The fall of chi^2 that is left of one family's beside another; infinite where they cannot stand side by side."""
    if not other.physical or "step" in (s.family.kind, other.family.kind) or set(s.columns) & set(other.columns):
        return float(np.inf)
    return Projection(fit.gram, [*fit.base, *other.columns]).solve(s.columns)[1]


@dataclass(frozen=True)
class Threshold:
    """The test of a round: every family's chance is held against one threshold.

    Attributes:
        calibration: the threshold of this programme.
        visible: ids that the log can show.
        blind: ids whose signature is made of the states' own errors.
    """

    calibration: Calibration
    visible: frozenset[str]
    blind: frozenset[str] = frozenset()

    def __call__(self, fit: Fit, scored: list[Scored]) -> list[Scored]:
        """Those that pass both the calibrated test and the second opinion, best first."""
        found = []
        for s in scored:
            # Far larger than typical: what is hidden in the noise that a very wrong model leaves may still stand out.
            strong = s.id not in self.blind and s.fall >= STRONG
            if s.id not in self.visible and s.family.kind not in ("wave", "tether") and not strong:
                continue
            if not s.physical or s.fall < FAINT or self.chance(s) > self.calibration.chance:
                continue
            share = s.share(fit.noise.predictor.vehicle.hull.mass)
            if (s.fall < STRONG and share < NEGLIGIBLE) or share > IMPOSSIBLE:
                continue
            if any(_beside(fit, s, q) < FAINT for q in scored if q.id in self.blind and q.fall > s.fall):
                # A cause that cannot be named here explains it as well, and more beside.
                continue
            doubtful = s.fall < (BEYOND_DOUBT_AXES_LEFT_OUT if fit.noise.left_out else BEYOND_DOUBT)
            if doubtful and second_opinion(fit, s) > SECOND:
                continue
            found.append(s)
        return found

    def eligible(self, s: Scored) -> bool:
        """Whether a family may stand in a set: all but those that the log is blind to."""
        return s.id not in self.blind

    def stands(self, s: Scored, fall: float) -> bool:
        """Whether a gain in a full fit is more than chance for the family."""
        return self.chance(replace(s, fall=fall)) <= self.calibration.chance

    def chance(self, s: Scored) -> float:
        """Of one family's gain."""
        return replace(s, fall=s.fall / HIGH_SIDE).chance
