"""Stage 2: a hypothesis fitted to a log by generalised least squares of its prediction errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.declared_errors import nuisances
from ivsid.diagnosis.estimation.first_values import first_values
from ivsid.diagnosis.estimation.noise import (
    Whitening,
    ambient_of,
    axes_left_out,
    declared_ambient,
    quick_enough,
    usable_rows,
    whiten,
)
from ivsid.diagnosis.estimation.projection import Gram, Projection, gram
from ivsid.diagnosis.estimation.signatures import BENT, Columns, Family, Signatures, free_parameters
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
STEPS: Final = 3
# Seconds that count, at least.
LEAST: Final = 40.0
# Shares of a step that are tried, and the rise of chi^2 that is no worsening.
SHORTER: Final = (1.0, 0.4, 0.1)
WORSE: Final = 1.0


@dataclass(frozen=True)
class Noise:
    """What was learnt of a log's noise: its filters, its whitening, the samples that count, and axes that are left out."""

    predictor: Predictor
    whitening: Whitening
    good: NDArray[np.bool_]
    left_out: frozenset[int] = frozenset()


Search: TypeAlias = "Callable[[Fit], Fit]"


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis with all signatures around it.

    Attributes:
        noise: filters and whitening.
        h: the hypothesis with its numbers.
        states: its states.
        signatures: what made the columns, for further ones.
        gram: cross-products of everything below.
        base: columns that are fitted: free parameters, then what is declared.
        free: names of the free parameters.
        families: candidates.
        refused: ids that the log cannot show, and why.
        fixed: parameters that are not fitted: claims, and what axes that are left out do not determine.
    """

    noise: Noise
    h: Hypothesis
    states: FilteredStates
    signatures: Signatures
    gram: Gram
    base: tuple[int, ...]
    free: tuple[str, ...]
    families: tuple[Family, ...]
    refused: Mapping[str, str]
    fixed: Mapping[str, float]

    @property
    def projection(self) -> Projection:
        """On the base, over the whole log."""
        return Projection(self.gram, self.base)


def learn(
    predictor: Predictor,
    h: Hypothesis,
    states: FilteredStates,
    search: Search,
    fixed: Mapping[str, float],
    left_out: frozenset[int],
    rounds: int = 2,
) -> tuple[Noise, Hypothesis, FilteredStates]:
    """The noise of a log from what the whole library leaves unexplained, and the hypothesis fitted on the way.

    An effect that is taken for noise would hide itself, so everything that the catalogue can explain is taken out first, whether it
    is there or not: the ``search`` adds the columns of waves, tethers and steps that explain most.
    """
    good = usable_rows(predictor)
    if good.sum() * predictor.log.h < LEAST:
        raise IvsidError(
            f"{predictor.log.name}: between its gaps {good.sum() * predictor.log.h:.0f} s can be used, and a diagnosis needs {LEAST:.0f} s; give a "
            "log with fewer missing samples"
        )
    for turn in range(rounds):
        scale = plain_scale(predictor.errors(h, states), good, predictor, left_out)
        h, states = improve(predictor, h, states, scale, good, fixed)
        scale = plain_scale(predictor.errors(h, states), good, predictor, left_out)
        fit = search(survey(Noise(predictor, scale, good, left_out), h, states, fixed))
        left = remaining(fit)
        if turn == rounds - 1:
            return Noise(predictor, whiten(predictor, left, good, left_out), good, left_out), h, states
        predictor = predictor.adopt(ambient_of(predictor, left, good, left_out))
        predictor = quick_enough(predictor, predictor.damping(h, states))
        states = predictor.settle(h, states)
    raise AssertionError("rounds must be positive")


def remaining(fit: Fit) -> Array:
    """The errors, in their own units, without all that any column explains; shape (rows, n)."""
    g = fit.gram
    theta, _ = Projection(g, []).solve(range(len(g.names)))
    left = g.y - g.explained(range(len(g.names)), theta)
    rows = len(fit.noise.predictor.labels)
    count = left.shape[0] * g.length
    out = np.zeros((rows, fit.noise.good.size))
    out[:, :count] = left.reshape(-1, rows, g.length).transpose(1, 0, 2).reshape(rows, count)
    for group, taps in zip(fit.noise.whitening.groups, fit.noise.whitening.taps, strict=True):
        scale = np.diag(taps[0])[:, None]
        out[list(group)] /= np.where(scale > 0, scale, 1.0)
    return out


def plain_scale(
    errors: Array, good: NDArray[np.bool_], predictor: Predictor, left_out: frozenset[int] = frozenset()
) -> Whitening:
    """Each row divided by its usual size: a start. Still axes are left out."""
    size = np.maximum(np.median(np.abs(errors[:, good]), axis=1) / 0.6745, 1e-12)
    groups: dict[int, list[int]] = {}
    for i, (k, _) in enumerate(predictor.labels):
        groups.setdefault(k, []).append(i)
    return Whitening(
        tuple(tuple(r) for r in groups.values()),
        tuple(np.diag((0.0 if k in left_out else 1.0) / size[r])[None] for k, r in groups.items()),
    )


def _joined(*parts: Columns) -> Columns:
    out = Columns()
    for part in parts:
        for name, array in zip(part.names, part.arrays, strict=True):
            out.add(name, array, part.prior.get(name))
    return out


@dataclass(frozen=True)
class DeclaredColumns:
    """Whitened signatures of what the vehicle file declares; they hardly depend on the hypothesis, and are made once for many."""

    gram: Gram

    @property
    def count(self) -> int:
        """How many there are: they stand first among the columns of a fit."""
        return len(self.gram.names)


def declared_columns(
    predictor: Predictor, h: Hypothesis, states: FilteredStates, white: Whitening, good: NDArray[np.bool_]
) -> DeclaredColumns:
    """Those around a hypothesis."""
    c = nuisances(Signatures(predictor, h, states))
    none = np.zeros((len(predictor.labels), predictor.log.n))
    return DeclaredColumns(
        gram(c.names, c.arrays, none, white, good, predictor.log.h, c.prior, h.declared_errors).whole()
    )


def improve(
    predictor: Predictor,
    h: Hypothesis,
    states: FilteredStates,
    white: Whitening,
    good: NDArray[np.bool_],
    fixed: Mapping[str, float],
    steps: int = STEPS,
    known: DeclaredColumns | None = None,
) -> tuple[Hypothesis, FilteredStates]:
    """Gauss-Newton steps of all free parameters, with what is declared beside them; shorter ones where a step makes it worse.

    Args:
        predictor: of the log.
        h: where to start.
        states: its states.
        white: the whitening.
        good: samples that count.
        fixed: parameters that are not fitted.
        steps: at most.
        known: signatures of what is declared, for the same whitening.
    """
    known = known or declared_columns(predictor, h, states, white, good)

    def cost(h: Hypothesis, errors: Array) -> tuple[float, Gram]:
        g = _expected(known.gram.of(errors), h)
        # A step that goes far too far leaves states that run away.
        finite = bool(np.isfinite(errors).all())
        return Projection(g, range(known.count)).chi2 if finite else float(np.inf), g

    # States that are not those of the hypothesis would make it look better or worse than it is.
    states = predictor.settle(h, states, 2)
    errors = predictor.errors(h, states)
    here, base = cost(h, errors)
    for _ in range(steps):
        g = _beside(base, predictor, h, states, fixed)
        for p in _movable(g, h):
            at = np.array(p.base)
            moves = dict(zip((g.names[k] for k in at), (p.coefficients / g.unit[at]).tolist(), strict=True))
            for share in SHORTER:
                other = stepped(h, {k: share * m for k, m in moves.items()}, predictor)
                there = predictor.settle(other, states, 2)
                errors = predictor.errors(other, there)
                now, there_base = cost(other, errors)
                if now < here + WORSE:
                    break
            else:
                continue
            break
        else:
            return h, states
        h, states, here, base = other, there, now, there_base
        sigma = np.sqrt(np.diag(np.linalg.inv(p.total[np.ix_(at, at)] + np.diag(g.prior[at] + 1e-9))))
        if (np.abs(p.coefficients) < 0.1 * sigma)[known.count :].all():
            break
    return h, states


def _movable(g: Gram, h: Hypothesis) -> Iterator[Projection]:
    """Steps of all numbers, then of all but those where the errors may jump: chi^2 can be a wall beside one, and stop the others."""
    yield Projection(g, range(len(g.names)))
    jumps = {name for given in h.given if given.effect.id in BENT for name, _, _ in free_parameters(given)}
    if jumps:
        yield Projection(g, [k for k, name in enumerate(g.names) if name not in jumps])


def _small_gram(
    predictor: Predictor,
    h: Hypothesis,
    states: FilteredStates,
    fixed: Mapping[str, float],
    known: DeclaredColumns,
    errors: Array,
    *,
    sums: bool = True,
) -> Gram:
    """What is declared first, then what is fitted."""
    return _beside(_expected(known.gram.of(errors), h), predictor, h, states, fixed, sums=sums)


def _beside(
    g: Gram,
    predictor: Predictor,
    h: Hypothesis,
    states: FilteredStates,
    fixed: Mapping[str, float],
    *,
    sums: bool = True,
) -> Gram:
    """With the signatures of what is fitted."""
    fitted = Signatures(predictor, h, states).fitted(fixed)
    return g.extended(fitted.names, fitted.arrays, sums=sums) if fitted.names else g


def _expected(g: Gram, h: Hypothesis) -> Gram:
    """With how much of each declared error the hypothesis holds."""
    return replace(g, centre=np.array([h.declared_errors.get(n, 0.0) for n in g.names]) * g.unit)


def crossed(
    noise: Noise, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float], known: DeclaredColumns
) -> Gram:
    """Cross-products of what is declared and what is fitted, with the columns themselves."""
    errors = noise.predictor.errors(h, states)
    return _small_gram(noise.predictor, h, states, fixed, known, errors, sums=False)


def fitted_gram(noise: Noise, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float]) -> Gram:
    """Cross-products of what is fitted and what is declared alone."""
    known = declared_columns(noise.predictor, h, states, noise.whitening, noise.good)
    errors = noise.predictor.errors(h, states)
    return _small_gram(noise.predictor, h, states, fixed, known, errors)


def chi2_of(
    noise: Noise, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float], known: DeclaredColumns
) -> float:
    """Of the log under a hypothesis, what is declared fitted beside it."""
    errors = noise.predictor.errors(h, states)
    g = _small_gram(noise.predictor, h, states, fixed, known, errors)
    return Projection(g, range(len(g.names))).chi2


def stepped(h: Hypothesis, moves: Mapping[str, float], predictor: Predictor) -> Hypothesis:
    """The hypothesis with its parameters moved, no mass to less than a third and none outside what its physics allows."""
    values = {}
    for term in h.terms:
        if term.id in moves:
            new = h.values[term.id] + moves[term.id]
            if term.id in ("mass.surge", "mass.sway", "inertia.yaw"):
                new = float(np.clip(new, h.values[term.id] / 3, h.values[term.id] * 3))
            values[term.id] = float(new)
    h = replaced(h, values)
    known = {n: h.declared_errors.get(n, 0.0) + m for n, m in moves.items() if n.startswith("~")}
    h = replace(h, declared_errors={**h.declared_errors, **known})
    for g in h.given:
        numbers = list(g.values)
        for name, p, j in free_parameters(g):
            step = moves.get(name, 0.0)
            most = 0.5 * max(abs(numbers[j]), 0.2 * abs(p.scaled(predictor.vehicle.hull.mass)), 1e-9)
            if p.unit != "rad":
                step = float(np.clip(step, -most, most))
            new = numbers[j] + step
            if p.lowest is not None:
                new = max(new, p.lowest + (1e-6 if p.exclusive else 0.0))
            numbers[j] = float(new)
        h = h.with_effect(replace(g, values=tuple(numbers)))
    return h


def survey(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    claimed: Mapping[str, float],
    only: frozenset[str] | None = None,
) -> Fit:
    """All signatures at a fitted hypothesis, or those of ``only`` some effects, whitened and crossed."""
    predictor = noise.predictor
    signatures = Signatures(predictor, h, states)
    fitted, stated = signatures.fitted(claimed), nuisances(signatures)
    extra, families, refused = signatures.candidates(only)
    every = _joined(fitted, stated, extra)
    # The same name twice would be a parameter of the model beside its claim.
    errors = predictor.errors(h, states)
    g = gram(
        every.names, every.arrays, errors, noise.whitening, noise.good, predictor.log.h, every.prior, h.declared_errors
    )
    count = len(fitted.names) + len(stated.names)
    return Fit(
        noise,
        h,
        states,
        signatures,
        g,
        tuple(range(count)),
        tuple(fitted.names),
        tuple(families),
        dict(refused),
        dict(claimed),
    )


def plain_fit(vehicle: Vehicle, log: Channels, search: Search) -> Fit:
    """The vehicle file's model on a log.

    Raises:
        IvsidError: the log has too little between its gaps, or no numbers of the model follow it at all.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            return _plain(vehicle, log, search)
    except (np.linalg.LinAlgError, ValueError, FloatingPointError) as error:
        if isinstance(error, IvsidError):
            raise
        raise IvsidError(
            f"{log.name}: no numbers of the model follow this log; check the units, signs and clock of its columns, and whether its "
            "velocities are good enough to show the motion"
        ) from None


def _plain(vehicle: Vehicle, log: Channels, search: Search) -> Fit:
    claimed = dict(vehicle.model.values)
    h = first_values(vehicle, log, terms_of(vehicle), claimed)
    predictor = Predictor(vehicle, log, declared_ambient(vehicle))
    left_out = axes_left_out(predictor)
    usual = _usual(h, vehicle, left_out)
    h = replaced(h, usual)
    predictor = quick_enough(predictor, predictor.damping(h, predictor.start(h)))
    # The sway mass still acts in surge, through turning.
    fixed = {**claimed, **{i: x for i, x in usual.items() if i != "mass.sway"}}
    noise, h, states = learn(predictor, h, predictor.settle(h, predictor.start(h), 2), search, fixed, left_out)
    h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed)
    return survey(noise, h, states, fixed)


def _usual(h: Hypothesis, vehicle: Vehicle, left_out: frozenset[int]) -> dict[str, float]:
    """Parameters of the axes that are left out, at what a hull of this mass and length has: nothing in the log says more of them."""
    if not left_out:
        return {}
    m = vehicle.hull.mass
    length = vehicle.hull.length or (m / 60.0) ** (1 / 3)
    usual = {"mass.sway": 1.4 * m, "inertia.yaw": 0.12 * m * length**2, "drag.sway.quadratic": 2.5 * m / length}
    return {i: x for i, x in usual.items() if any(t.id == i for t in h.terms) and i not in vehicle.model.values}
