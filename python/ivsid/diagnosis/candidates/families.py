"""Stage 4: what each family of causes gains in chi^2 beyond the model and all that is declared."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import PAPER_TERMS, PLAIN_TERMS, Given, Terms

Array = NDArray[np.float64]
# Waves: from this many samples a period to a twentieth of the log; slower ones are currents.
FASTEST: Final = 5.0
SLOWEST: Final = 30.0
PEAKS: Final = 3
# Blocks at either end of a log within which no step is looked for.
EDGE: Final = 3


@dataclass(frozen=True)
class Scored:
    """A family at its best.

    Attributes:
        family: the cause.
        fall: fall of chi^2.
        count: numbers that are fitted for it, searched ones included.
        looks: how many independent values were searched.
        columns: indices in the Gram.
        theta: coefficients in their units.
        values: the effect's numbers, in the catalogue's order.
        physical: the sign is one that the cause can have.
    """

    family: Family
    fall: float
    count: int
    looks: float
    columns: tuple[int, ...]
    theta: tuple[float, ...]
    values: tuple[float, ...]
    physical: bool = True

    @property
    def id(self) -> str:
        """Of the effect."""
        return self.family.id

    def share(self, mass: float) -> float:
        """The largest of its numbers in units of what is usual for a vehicle of this mass [kg]; 1 for those that have no such size."""
        effect = self.family.effect
        if self.family.kind == "claim" or effect.id == "thruster.deadband":
            return 1.0
        sizes = [
            abs(v - q.none) / abs(q.scaled(mass) - q.none)
            for q, v in zip(effect.parameters, self.values, strict=True)
            if q.draw in ("size", "north", "east") and not q.inverse and q.scaled(mass) != q.none
        ]
        return max(sizes, default=1.0)

    @property
    def merit(self) -> float:
        """The gain with a price for each number beyond the first."""
        return self.fall - 3.0 * (self.count - 1)

    @property
    def chance(self) -> float:
        """The probability of such a gain without the effect, over the values that were searched; of one sign where it has one."""
        one = chi2.sf(self.fall, self.count) * self.looks
        sided = (
            self.family.kind != "claim"
            and len(self.family.effect.parameters) == 1
            and not self.family.effect.parameters[0].signed
        )
        return float(min(1.0, one * (0.5 if sided else 1.0)))


def score(fit: Fit, base: Projection | None = None) -> tuple[Fit, list[Scored]]:
    """All families, best first; the fit with the columns that were made on the way."""
    p = base or fit.projection
    found: list[Scored] = []
    for family in fit.families:
        if family.kind in ("linear", "claim"):
            found += _linear(fit, p, family)
        elif family.kind == "secant":
            found += _secant(fit, p, family)
        elif family.kind == "step":
            found += _step(fit, p, family)
    fit, found = _searched(fit, p, found)
    return fit, sorted((_merged(found)), key=lambda s: -s.merit)


def _merged(found: list[Scored]) -> list[Scored]:
    """One entry an effect: the best of its thrusters."""
    best: dict[str, Scored] = {}
    for s in found:
        if s.id not in best or s.merit > best[s.id].merit:
            best[s.id] = s
    return list(best.values())


def _physical(family: Family, theta: tuple[float, ...]) -> bool:
    p = family.effect.parameters
    return p[0].signed or len(p) > 1 or theta[0] > 0


def _linear(fit: Fit, p: Projection, family: Family) -> list[Scored]:
    at = fit.gram.at(family.variants[0])
    theta, fall = p.solve(at)
    real = tuple((theta / fit.gram.unit[at]).tolist())
    if family.kind == "claim":
        value = float(fit.h.values[family.id]) + real[0]
        return [Scored(family, fall, 1, 1.0, tuple(at), real, (value,), value > 0)]
    if isinstance(family.effect.acts, Terms):
        values = real
    else:
        values = tuple(q.none + x for q, x in zip(family.effect.parameters, real, strict=True))
    return [Scored(family, fall, len(at), 1.0, tuple(at), real, values, _physical(family, real))]


def _secant(fit: Fit, p: Projection, family: Family) -> list[Scored]:
    best: Scored | None = None
    for names, value in zip(family.variants, family.values, strict=True):
        at = fit.gram.at(names)
        theta, fall = p.solve(at)
        real = float(theta[0] / fit.gram.unit[at[0]])
        if real <= 0:
            fall = 0.0
        if best is None or fall > best.fall:
            scaled = value[0]
            if family.effect.parameters[0].unit == "s":
                scaled *= float(np.clip(real, 0.3, 3.0))
            best = Scored(family, fall, 1, 1.0 + 0.3 * len(family.variants), tuple(at), (real,), (scaled,), real > 0)
    return [] if best is None else [best]


def _step(fit: Fit, p: Projection, family: Family) -> list[Scored]:
    """A column that starts at the beginning of a block: cross-products of its later blocks are sums."""
    g = fit.gram
    j = g.at(family.variants[0])[0]
    later = np.cumsum(g.blocks[::-1, j, :], axis=0)[::-1]
    score = np.cumsum(g.score[::-1, j])[::-1]
    own = later[:, j]
    cross = later[:, p.base]
    H = own - np.einsum("bi,bi->b", cross, np.linalg.solve(_inner(p), cross.T).T)
    s = score - cross @ p.coefficients
    usable = H / max(float(own[0]), 1e-300) > 1e-6
    usable[:EDGE] = usable[len(usable) - EDGE :] = False
    if not usable.any():
        return []
    fall = np.where(usable, s**2 / np.where(usable, H, 1.0), 0.0)
    if family.thruster is not None:
        fall = np.where(s > 0, fall, 0.0)
    b = int(np.argmax(fall))
    theta = float(s[b] / max(H[b], 1e-300) / g.unit[j])
    time = float(fit.noise.predictor.log.t[0] + b * g.length * fit.noise.predictor.log.h)
    values = (theta, time) if family.thruster is None else (float(family.thruster), min(theta, 1.0), time)
    return [Scored(family, float(fall[b]), 2, len(fall) / 6.0, (j,), (theta,), values)]


def _inner(p: Projection) -> Array:
    return np.asarray(p.total[np.ix_(p.base, p.base)] + np.diag(p.g.prior[p.base] + 1e-9))


def _searched(fit: Fit, p: Projection, found: list[Scored]) -> tuple[Fit, list[Scored]]:
    """Families whose column is found by a search: the best few values get exact columns."""
    wanted = [f for f in fit.families if f.kind in ("wave", "tether")]
    if not wanted:
        return fit, found
    # The errors that the base leaves, taken back to the accelerations that would explain them.
    g, predictor = fit.gram, fit.noise.predictor
    n, rows = predictor.log.n, len(predictor.labels)
    left = g.y - g.explained(p.base, p.coefficients)
    used = left.shape[0] * g.length
    errors = np.zeros((rows, n))
    errors[:, :used] = left.reshape(-1, rows, g.length).transpose(1, 0, 2).reshape(rows, used)
    back = fit.signatures.backward(_unwhiten(fit, errors))
    names: list[str] = []
    arrays: list[Array] = []
    plans: list[tuple[Family, list[tuple[float, ...]], int, float]] = []
    for family in wanted:
        values, looks = _anchors(fit, back) if family.kind == "tether" else _periods(fit, family, back)
        for value in values:
            for j, x in enumerate(_made(fit, family, value)):
                names.append(f"{family.id}@{value!r}.{j}")
                arrays.append(x)
        plans.append((family, values, 2 if family.kind == "tether" else 4, looks))
    if not names:
        return fit, found
    at = len(g.names)
    fit = replace(fit, gram=g.extended(names, arrays))
    wide = Projection(fit.gram, p.base)
    for family, values, size, looks in plans:
        best: Scored | None = None
        for value in values:
            columns = tuple(range(at, at + size))
            at += size
            theta, fall = wide.solve(columns)
            real = tuple((theta / fit.gram.unit[list(columns)]).tolist())
            if best is None or fall > best.fall:
                numbers = _wave_numbers(family, value[0], real) if size == 4 else _pull_numbers(value, real)
                ok = size == 4 or real[0] > 0
                # A far anchor is a wind: the two numbers of its place are paid for, too.
                best = Scored(family, fall if ok else 0.0, 4, looks, columns, real, numbers, ok)
        if best is not None:
            found.append(best)
    return fit, found


def _made(fit: Fit, family: Family, value: tuple[float, ...]) -> list[Array]:
    """The columns of a searched cause at a value."""
    if family.kind == "tether":
        return fit.signatures.pull((value[0], value[1]))
    return fit.signatures.earth_wave(value[0]) if family.id == "wave.force" else fit.signatures.earth_flow(value[0])


def _unwhiten(fit: Fit, errors: Array) -> Array:
    """The transpose of the whitening."""
    out = np.zeros_like(errors)
    for rows, taps in zip(fit.noise.whitening.groups, fit.noise.whitening.taps, strict=True):
        here = errors[list(rows)]
        for lag, tap in enumerate(taps):
            part = tap.T @ here
            if lag:
                part = np.concatenate([part[:, lag:], np.zeros((len(rows), lag))], axis=1)
            out[list(rows)] += part
    return out


def _periods(fit: Fit, family: Family, back: Array) -> tuple[list[tuple[float, ...]], float]:
    """The periods [s] at which a wave would explain most, and how many were independent."""
    log = fit.noise.predictor.log
    p = fit.states.points
    n, h = log.n, log.h
    c, s = np.cos(p.psi[:n]), np.sin(p.psi[:n])
    duration = n * h
    if family.id == "wave.force":
        force = fit.signatures.mass.solve
        unit = np.stack([force(np.stack([c, -s, 0 * c])), force(np.stack([s, c, 0 * c]))])
        low, high = FASTEST * h, min(SLOWEST, duration / 20)
    else:
        unit = fit.signatures.flow_columns()
        low, high = SLOWEST, 2 * duration
    if high <= low:
        return [], 1.0
    padded = 4 * n
    spectrum = np.zeros(padded // 2 + 1)
    for k in range(2):
        q = np.einsum("in,in->n", unit[k], back)
        spectrum += np.abs(np.fft.rfft(q, padded)) ** 2
    frequency = np.fft.rfftfreq(padded, h)
    inside = (frequency >= 1 / high) & (frequency <= 1 / low)
    weight = spectrum / np.maximum(_sensitivity(fit, padded, unit), 1e-300)
    weight = np.where(inside, weight, 0.0)
    found: list[tuple[float, ...]] = []
    for _ in range(PEAKS):
        k = int(np.argmax(weight))
        if weight[k] <= 0:
            break
        found.append((float(1 / frequency[k]),))
        weight[max(0, k - 5) : k + 6] = 0.0
    return found, float(max(1.0, inside.sum() / 4))


def _sensitivity(fit: Fit, padded: int, unit: Array) -> Array:
    """How much whitened energy an acceleration of each frequency leaves, over the axes that the cause moves."""
    predictor = fit.noise.predictor
    n = predictor.log.n
    impulse = np.zeros((3, 2 * n))
    total = np.zeros(padded // 2 + 1)
    for k in range(2):
        impulse[:] = 0.0
        impulse[k, 0] = impulse[k, n] = 1.0
        response = fit.noise.whitening(predictor.answer(impulse)[None])[0]
        total += np.mean(unit[:, k] ** 2) * (np.abs(np.fft.rfft(response, padded, axis=1)) ** 2).sum(axis=0)
    return total


def _anchors(fit: Fit, back: Array) -> tuple[list[tuple[float, ...]], float]:
    """Where a tether would have to be made fast to explain most."""
    log = fit.noise.predictor.log
    if log.place is None:
        return [], 1.0
    p = fit.states.points
    n = log.n
    x, y = p.place[0, :n], p.place[1, :n]
    reach = max(float(np.ptp(x)), float(np.ptp(y)), 20.0)
    mass = fit.signatures.mass
    inverse = mass.inverse[0]
    force = inverse.T @ back
    north = force[0] * np.cos(p.psi[:n]) - force[1] * np.sin(p.psi[:n])
    east = force[0] * np.sin(p.psi[:n]) + force[1] * np.cos(p.psi[:n])
    middle = (0.5 * (float(x.min()) + float(x.max())), 0.5 * (float(y.min()) + float(y.max())))
    every = []
    thin = slice(None, None, max(1, n // 1500))
    for a in np.linspace(-1.0, 1.0, 15):
        for b in np.linspace(-1.0, 1.0, 15):
            states = (middle[0] + a * reach, middle[1] + b * reach)
            dn, de = states[0] - x[thin], states[1] - y[thin]
            d = np.sqrt(dn**2 + de**2 + 1e-4)
            every.append((float(np.sum((dn * north[thin] + de * east[thin]) / d)), states))
    every.sort(key=lambda q: -q[0])
    return [states for _, states in every[:PEAKS]], 20.0


def _wave_numbers(family: Family, period: float, theta: tuple[float, ...]) -> tuple[float, ...]:
    """The one wave closest to four coefficients: sine north, sine east, cosine north, cosine east."""
    matrix = np.array([[theta[0], theta[2]], [theta[1], theta[3]]])
    left, size, right = np.linalg.svd(matrix)
    phase = math.atan2(right[0, 1], right[0, 0])
    along = left[:, 0] * size[0]
    if family.id == "wave.force":
        return float(size[0]), period, phase, math.atan2(left[1, 0], left[0, 0])
    return float(along[0]), float(along[1]), period, phase


def _pull_numbers(states: tuple[float, ...], theta: tuple[float, ...]) -> tuple[float, ...]:
    pull = theta[0] if abs(theta[0]) > 1e-12 else 1e-12
    return pull, states[0], states[1], float(np.clip(theta[1] / pull, -3.0, 3.0))


def adopted(h: Hypothesis, s: Scored, fit: Fit) -> Hypothesis:
    """The hypothesis with a family's effect in it, at the values of its score."""
    effect = s.family.effect
    if s.family.kind == "claim":
        return replace(h, values={**h.values, s.id: s.values[0]}, freed=h.freed | {s.id})
    if not isinstance(effect.acts, Terms):
        values = list(s.values)
        for j, p in enumerate(effect.parameters):
            if p.lowest is not None:
                values[j] = max(values[j], p.lowest + (1e-6 if p.exclusive else 0.0))
        return h.with_effect(Given(effect, tuple(values)))
    terms, numbers = list(h.terms), dict(h.values)
    shared = {"mass.sway": "mass.surge", "drag.sway.quadratic": "drag.surge.quadratic"}
    for term, value in zip(effect.acts.terms, s.values, strict=True):
        other = shared.get(term.id)
        if other is not None and any(t.id == other and t in PAPER_TERMS for t in terms):
            # A value of its own ends the sharing of the paper's column.
            plain: Mapping[str, Any] = {t.id: t for t in PLAIN_TERMS}
            terms = [plain[other] if t.id == other else t for t in terms]
            value += numbers[other]  # noqa: PLW2901
        terms.append(fit.signatures.fitting(term))
        numbers[term.id] = float(value)
    return replace(h, terms=tuple(terms), values=numbers)


def everything(fit: Fit) -> Fit:
    """The fit with the columns of searched causes at their best values, steps in time among them."""
    fit, scored = score(fit)
    g = fit.gram
    steps = [s for s in scored if s.family.kind == "step"]
    if not steps:
        return fit
    predictor = fit.noise.predictor
    x = g.columns([s.columns[0] for s in steps])
    names = []
    for one, s in zip(x, steps, strict=True):
        one[: round((s.values[-1] - float(predictor.log.t[0])) / (g.length * predictor.log.h))] = 0.0
        names.append(f"{s.id}@{s.values[-1]!r}")
    unit = np.sqrt(np.maximum(np.einsum("cbi,cbi->c", x, x), 1e-300))
    return replace(fit, gram=g.joined(names, x / unit[:, None, None], unit))
