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
    declared,
    quick_enough,
    still_axes,
    usable_rows,
    whiten,
)
from ivsid.diagnosis.estimation.projection import Gram, Projection, gram
from ivsid.diagnosis.estimation.signatures import BENT, Columns, Family, Signatures, free_parameters
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Anchor, Bench, replaced
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

    bench: Bench
    whitening: Whitening
    good: NDArray[np.bool_]
    still: frozenset[int] = frozenset()


Search: TypeAlias = "Callable[[Fit], Fit]"


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis with all signatures around it.

    Attributes:
        noise: filters and whitening.
        h: the hypothesis with its numbers.
        anchor: its states.
        signatures: what made the columns, for further ones.
        gram: cross-products of everything below.
        base: columns that are fitted: free parameters, then what is declared.
        free: names of the free parameters.
        families: candidates.
        refused: ids that the log cannot show, and why.
        held: parameters that are not fitted: claims, and what axes that are left out do not determine.
    """

    noise: Noise
    h: Hypothesis
    anchor: Anchor
    signatures: Signatures
    gram: Gram
    base: tuple[int, ...]
    free: tuple[str, ...]
    families: tuple[Family, ...]
    refused: Mapping[str, str]
    held: Mapping[str, float]

    @property
    def projection(self) -> Projection:
        """On the base, over the whole log."""
        return Projection(self.gram, self.base)


def learn(
    bench: Bench,
    h: Hypothesis,
    anchor: Anchor,
    search: Search,
    held: Mapping[str, float],
    still: frozenset[int],
    rounds: int = 2,
) -> tuple[Noise, Hypothesis, Anchor]:
    """The noise of a log from what the whole library leaves unexplained, and the hypothesis fitted on the way.

    An effect that is taken for noise would hide itself, so everything that the catalogue can explain is taken out first, whether it
    is there or not: the ``search`` adds the columns of waves, tethers and steps that explain most.
    """
    good = usable_rows(bench)
    if good.sum() * bench.log.h < LEAST:
        raise IvsidError(
            f"{bench.log.name}: between its gaps {good.sum() * bench.log.h:.0f} s can be used, and a diagnosis needs {LEAST:.0f} s; give a "
            "log with fewer missing samples"
        )
    for turn in range(rounds):
        scale = plain_scale(bench.errors(h, anchor), good, bench, still)
        h, anchor = improve(bench, h, anchor, scale, good, held)
        scale = plain_scale(bench.errors(h, anchor), good, bench, still)
        fit = search(survey(Noise(bench, scale, good, still), h, anchor, held))
        left = remaining(fit)
        if turn == rounds - 1:
            return Noise(bench, whiten(bench, left, good, still), good, still), h, anchor
        bench = bench.adopt(ambient_of(bench, left, good, still))
        bench = quick_enough(bench, bench.damping(h, anchor))
        anchor = bench.settle(h, anchor)
    raise AssertionError("rounds must be positive")


def remaining(fit: Fit) -> Array:
    """The errors, in their own units, without all that any column explains; shape (rows, n)."""
    g = fit.gram
    theta, _ = Projection(g, []).solve(range(len(g.names)))
    left = g.y - g.explained(range(len(g.names)), theta)
    rows = len(fit.noise.bench.labels)
    count = left.shape[0] * g.length
    out = np.zeros((rows, fit.noise.good.size))
    out[:, :count] = left.reshape(-1, rows, g.length).transpose(1, 0, 2).reshape(rows, count)
    for group, taps in zip(fit.noise.whitening.groups, fit.noise.whitening.taps, strict=True):
        scale = np.diag(taps[0])[:, None]
        out[list(group)] /= np.where(scale > 0, scale, 1.0)
    return out


def plain_scale(errors: Array, good: NDArray[np.bool_], bench: Bench, still: frozenset[int] = frozenset()) -> Whitening:
    """Each row divided by its usual size: a start. Still axes are left out."""
    size = np.maximum(np.median(np.abs(errors[:, good]), axis=1) / 0.6745, 1e-12)
    groups: dict[int, list[int]] = {}
    for i, (k, _) in enumerate(bench.labels):
        groups.setdefault(k, []).append(i)
    return Whitening(
        tuple(tuple(r) for r in groups.values()),
        tuple(np.diag((0.0 if k in still else 1.0) / size[r])[None] for k, r in groups.items()),
    )


def _joined(*parts: Columns) -> Columns:
    out = Columns()
    for part in parts:
        for name, array in zip(part.names, part.arrays, strict=True):
            out.add(name, array, part.prior.get(name))
    return out


@dataclass(frozen=True)
class Declared:
    """Whitened signatures of what the vehicle file declares; they hardly depend on the hypothesis, and are made once for many."""

    gram: Gram

    @property
    def count(self) -> int:
        """How many there are: they stand first among the columns of a fit."""
        return len(self.gram.names)


def declared_columns(
    bench: Bench, h: Hypothesis, anchor: Anchor, white: Whitening, good: NDArray[np.bool_]
) -> Declared:
    """Those around a hypothesis."""
    c = nuisances(Signatures(bench, h, anchor))
    none = np.zeros((len(bench.labels), bench.log.n))
    return Declared(gram(c.names, c.arrays, none, white, good, bench.log.h, c.prior, h.declared).whole())


def improve(
    bench: Bench,
    h: Hypothesis,
    anchor: Anchor,
    white: Whitening,
    good: NDArray[np.bool_],
    held: Mapping[str, float],
    steps: int = STEPS,
    known: Declared | None = None,
) -> tuple[Hypothesis, Anchor]:
    """Gauss-Newton steps of all free parameters, with what is declared beside them; shorter ones where a step makes it worse.

    Args:
        bench: the log.
        h: where to start.
        anchor: its states.
        white: the whitening.
        good: samples that count.
        held: parameters that are not fitted.
        steps: at most.
        known: signatures of what is declared, for the same whitening.
    """
    known = known or declared_columns(bench, h, anchor, white, good)

    def cost(h: Hypothesis, errors: Array) -> tuple[float, Gram]:
        g = _expected(known.gram.of(errors), h)
        # A step that goes far too far leaves states that run away.
        finite = bool(np.isfinite(errors).all())
        return Projection(g, range(known.count)).chi2 if finite else float(np.inf), g

    # States that are not those of the hypothesis would make it look better or worse than it is.
    anchor = bench.settle(h, anchor, 2)
    errors = bench.errors(h, anchor)
    here, base = cost(h, errors)
    for _ in range(steps):
        g = _beside(base, bench, h, anchor, held)
        for p in _movable(g, h):
            at = np.array(p.base)
            moves = dict(zip((g.names[k] for k in at), (p.coefficients / g.unit[at]).tolist(), strict=True))
            for share in SHORTER:
                other = stepped(h, {k: share * m for k, m in moves.items()}, bench)
                there = bench.settle(other, anchor, 2)
                errors = bench.errors(other, there)
                now, there_base = cost(other, errors)
                if now < here + WORSE:
                    break
            else:
                continue
            break
        else:
            return h, anchor
        h, anchor, here, base = other, there, now, there_base
        sigma = np.sqrt(np.diag(np.linalg.inv(p.total[np.ix_(at, at)] + np.diag(g.prior[at] + 1e-9))))
        if (np.abs(p.coefficients) < 0.1 * sigma)[known.count :].all():
            break
    return h, anchor


def _movable(g: Gram, h: Hypothesis) -> Iterator[Projection]:
    """Steps of all numbers, then of all but those where the errors may jump: chi^2 can be a wall beside one, and stop the others."""
    yield Projection(g, range(len(g.names)))
    jumps = {name for given in h.given if given.effect.id in BENT for name, _, _ in free_parameters(given)}
    if jumps:
        yield Projection(g, [k for k, name in enumerate(g.names) if name not in jumps])


def _small_gram(
    bench: Bench,
    h: Hypothesis,
    anchor: Anchor,
    held: Mapping[str, float],
    known: Declared,
    errors: Array,
    *,
    sums: bool = True,
) -> Gram:
    """What is declared first, then what is fitted."""
    return _beside(_expected(known.gram.of(errors), h), bench, h, anchor, held, sums=sums)


def _beside(
    g: Gram, bench: Bench, h: Hypothesis, anchor: Anchor, held: Mapping[str, float], *, sums: bool = True
) -> Gram:
    """With the signatures of what is fitted."""
    fitted = Signatures(bench, h, anchor).fitted(held)
    return g.extended(fitted.names, fitted.arrays, sums=sums) if fitted.names else g


def _expected(g: Gram, h: Hypothesis) -> Gram:
    """With how much of each declared error the hypothesis holds."""
    return replace(g, centre=np.array([h.declared.get(n, 0.0) for n in g.names]) * g.unit)


def crossed(noise: Noise, h: Hypothesis, anchor: Anchor, held: Mapping[str, float], known: Declared) -> Gram:
    """Cross-products of what is declared and what is fitted, with the columns themselves."""
    errors = noise.bench.errors(h, anchor)
    return _small_gram(noise.bench, h, anchor, held, known, errors, sums=False)


def fitted_gram(noise: Noise, h: Hypothesis, anchor: Anchor, held: Mapping[str, float]) -> Gram:
    """Cross-products of what is fitted and what is declared alone."""
    known = declared_columns(noise.bench, h, anchor, noise.whitening, noise.good)
    errors = noise.bench.errors(h, anchor)
    return _small_gram(noise.bench, h, anchor, held, known, errors)


def chi2_of(noise: Noise, h: Hypothesis, anchor: Anchor, held: Mapping[str, float], known: Declared) -> float:
    """Of the log under a hypothesis, what is declared fitted beside it."""
    errors = noise.bench.errors(h, anchor)
    g = _small_gram(noise.bench, h, anchor, held, known, errors)
    return Projection(g, range(len(g.names))).chi2


def stepped(h: Hypothesis, moves: Mapping[str, float], bench: Bench) -> Hypothesis:
    """The hypothesis with its parameters moved, no mass to less than a third and none outside what its physics allows."""
    values = {}
    for term in h.terms:
        if term.id in moves:
            new = h.values[term.id] + moves[term.id]
            if term.id in ("mass.surge", "mass.sway", "inertia.yaw"):
                new = float(np.clip(new, h.values[term.id] / 3, h.values[term.id] * 3))
            values[term.id] = float(new)
    h = replaced(h, values)
    known = {n: h.declared.get(n, 0.0) + m for n, m in moves.items() if n.startswith("~")}
    h = replace(h, declared={**h.declared, **known})
    for g in h.given:
        numbers = list(g.values)
        for name, p, j in free_parameters(g):
            step = moves.get(name, 0.0)
            most = 0.5 * max(abs(numbers[j]), 0.2 * abs(p.scaled(bench.vehicle.hull.mass)), 1e-9)
            if p.unit != "rad":
                step = float(np.clip(step, -most, most))
            new = numbers[j] + step
            if p.lowest is not None:
                new = max(new, p.lowest + (1e-6 if p.exclusive else 0.0))
            numbers[j] = float(new)
        h = h.with_effect(replace(g, values=tuple(numbers)))
    return h


def survey(
    noise: Noise, h: Hypothesis, anchor: Anchor, claimed: Mapping[str, float], only: frozenset[str] | None = None
) -> Fit:
    """All signatures at a fitted hypothesis, or those of ``only`` some effects, whitened and crossed."""
    bench = noise.bench
    signatures = Signatures(bench, h, anchor)
    fitted, declared_ones = signatures.fitted(claimed), nuisances(signatures)
    extra, families, refused = signatures.candidates(only)
    every = _joined(fitted, declared_ones, extra)
    # The same name twice would be a parameter of the model beside its claim.
    errors = bench.errors(h, anchor)
    g = gram(every.names, every.arrays, errors, noise.whitening, noise.good, bench.log.h, every.prior, h.declared)
    count = len(fitted.names) + len(declared_ones.names)
    return Fit(
        noise,
        h,
        anchor,
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
    bench = Bench(vehicle, log, declared(vehicle))
    still = still_axes(bench)
    usual = _usual(h, vehicle, still)
    h = replaced(h, usual)
    bench = quick_enough(bench, bench.damping(h, bench.start(h)))
    # The sway mass still acts in surge, through turning.
    held = {**claimed, **{i: x for i, x in usual.items() if i != "mass.sway"}}
    noise, h, anchor = learn(bench, h, bench.settle(h, bench.start(h), 2), search, held, still)
    h, anchor = improve(noise.bench, h, anchor, noise.whitening, noise.good, held)
    return survey(noise, h, anchor, held)


def _usual(h: Hypothesis, vehicle: Vehicle, still: frozenset[int]) -> dict[str, float]:
    """Parameters of the axes that are left out, at what a hull of this mass and length has: nothing in the log says more of them."""
    if not still:
        return {}
    m = vehicle.hull.mass
    length = vehicle.hull.length or (m / 60.0) ** (1 / 3)
    usual = {"mass.sway": 1.4 * m, "inertia.yaw": 0.12 * m * length**2, "drag.sway.quadratic": 2.5 * m / length}
    return {i: x for i, x in usual.items() if any(t.id == i for t in h.terms) and i not in vehicle.model.values}
