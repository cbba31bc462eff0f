"""Which further manoeuvre would tell causes apart that a log does not: the information of both logs together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import Fit, Noise, survey
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import usable_rows
from ivsid.diagnosis.estimation.projection import Gram
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.diagnosis.null.visibility import VISIBLE, Visibility, excitation, visibility
from ivsid.diagnosis.planning.isolability import APART, Advice, Choice, Isolability, separability
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# What two logs do not share: each has its own slow sensor biases, and its own pattern of what is random.
OWN: Final = "~bias."
# Pairs that are told apart, and would not be at a third of their typical size, and how many of them.
CLOSE: Final = 3.0
PAIRS: Final = 6
# From the numbers of the fitted model, the rate [Hz] and whether a noisy one is wanted, to logs of manoeuvres and the noisy one.
Sail: TypeAlias = "Callable[[Mapping[str, float], float, bool], tuple[Mapping[str, Log], Log | None]]"


def advised(vehicle: Vehicle, log: Log, sail: Sail, *, progress: Callable[[str], None] = lambda _: None) -> Isolability:
    """What this log's programme can detect and tell apart, and what a further manoeuvre would add.

    Args:
        vehicle: whose model is held against the log.
        log: of the programme.
        sail: makes the logs of the manoeuvres.
        progress: told of each step.

    Raises:
        IvsidError: a log that the model cannot be held against.
    """
    progress("fitting the model")
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    inputs = ((vehicle.source.rsplit("/", 1)[-1] or vehicle.name, vehicle.sha256), (log.name, log.sha256))
    made = separability(fit, inputs)
    logs, turning = sail(fit.h.values, 1.0 / fit.noise.predictor.log.h, bool(fit.noise.left_out))
    if not logs:
        return made
    sets = [ids for ids, _ in made.classes]
    found, shown = advise(fit, [*sets, *_near(made, sets)], logs, turning, progress)
    return replace(made, advice=found, shown=shown)


def _near(made: Isolability, sets: Sequence[tuple[str, ...]]) -> Sequence[tuple[str, ...]]:
    """The pairs that are barely told apart, the closest first."""
    together = [set(s) for s in sets]
    pairs = [
        (float(min(made.distance[i, j], made.distance[j, i])), (b, a))
        for i, a in enumerate(made.ids)
        for j, b in enumerate(made.ids[:i])
        if not any({a, b} <= s for s in together)
    ]
    return [ids for d, ids in sorted(pairs) if d < CLOSE * APART][:PAIRS]


def advise(
    fit: Fit,
    sets: Sequence[tuple[str, ...]],
    logs: Mapping[str, Log],
    turning: Log | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[tuple[Advice, ...], dict[str, tuple[str, float]]]:
    """What each manoeuvre's log would add to the log of a fit.

    Both logs are taken as one: the parameters of the model, the causes and the declared thrust errors are the same in both, the biases of the
    sensors are not. A manoeuvre counts as sailed by the fitted model, under the noise of the log.

    Args:
        fit: the model on the log that is there.
        sets: of causes that it does not tell apart.
        logs: of manoeuvres, on the same clock and with the same channels.
        turning: one of them with the sensors' noise, for the axes that a straight log says nothing of.
        progress: told of each.

    Returns:
        The advice for each set, and for each cause that the log does not test the manoeuvre that shows it best, with z.
    """
    here = excitation(fit)
    alone = visibility(fit, here)
    wanted = {i for s in sets for i in s}
    weak = [i for i, v in alone.items() if not v.tested]
    fallback: Fit | None = None
    results: dict[str, tuple[dict[frozenset[str], float], dict[str, float]]] = {}
    for name, log in logs.items():
        progress(name)
        try:
            if fit.noise.left_out and fallback is None:
                fallback = _turning(fit, turning)
            more = _added(fit, log, fallback)
            there = excitation(more) if weak else {}
            both = _together(fit, more)
            excited = {n: max(here.get(n, 0.0), there.get(n, 0.0)) for n in {*here, *there}}
            seen = visibility(both, excited)
            pairs = _pairs(both, seen, wanted)
        except (IvsidError, np.linalg.LinAlgError):
            # A manoeuvre that the model cannot sail, or that shows nothing, is no advice.
            continue
        results[name] = pairs, {i: seen[i].z for i in weak if i in seen and not seen[i].blind}
    now = _pairs(fit, alone, wanted)
    found = tuple(_ranked(ids, now, {n: p for n, (p, _) in results.items()}) for ids in sets)
    shown: dict[str, tuple[str, float]] = {}
    for i in weak:
        best = max(((z[i], n) for n, (_, z) in results.items() if i in z), default=None)
        if best is not None and best[0] >= VISIBLE:
            shown[i] = (best[1], best[0])
    return found, shown


def _ranked(
    ids: tuple[str, ...], here: Mapping[frozenset[str], float], results: Mapping[str, Mapping[frozenset[str], float]]
) -> Advice:
    choices = []
    for name, pairs in results.items():
        groups = _groups(ids, pairs)
        choices.append(Choice(name, _smallest(ids, pairs), groups))
    # Most sets, then the widest gap; where some pair is algebra, the sum of what is left decides.
    choices.sort(key=lambda c: (-len(c.groups), -c.d, -_total(ids, results[c.trial]), c.trial))
    return Advice(ids, _smallest(ids, here), tuple(choices))


def _smallest(ids: Sequence[str], pairs: Mapping[frozenset[str], float]) -> float:
    return min((pairs.get(frozenset({a, b}), 0.0) for k, a in enumerate(ids) for b in ids[:k]), default=0.0)


def _total(ids: Sequence[str], pairs: Mapping[frozenset[str], float]) -> float:
    return sum(min(pairs.get(frozenset({a, b}), 0.0), APART) for k, a in enumerate(ids) for b in ids[:k])


def _groups(ids: Sequence[str], pairs: Mapping[frozenset[str], float]) -> tuple[tuple[str, ...], ...]:
    """Causes that are linked by a distance below the limit."""
    left, found = list(ids), []
    while left:
        group = [left.pop(0)]
        for one in group:
            near = [j for j in left if pairs.get(frozenset({one, j}), 0.0) < APART]
            group += near
            left = [j for j in left if j not in near]
        found.append(tuple(group))
    return tuple(found)


def _pairs(fit: Fit, visible: Mapping[str, Visibility], wanted: set[str]) -> dict[frozenset[str], float]:
    """The distance of any two of the causes, the smaller of both ways."""
    made = separability(fit, visible=visible, wanted=wanted)
    return {
        frozenset({a, b}): float(min(made.distance[i, j], made.distance[j, i]))
        for i, a in enumerate(made.ids)
        for j, b in enumerate(made.ids[:i])
    }


def _turning(fit: Fit, log: Log | None) -> Fit:
    """A fit to a manoeuvre in which the vehicle turns, for the noise of axes that the log leaves out."""
    if log is not None:
        made = plain_fit(fit.noise.predictor.vehicle, channels(log, fit.noise.predictor.vehicle), everything)
        if not made.noise.left_out:
            return made
    raise IvsidError("no manoeuvre of the library turns this vehicle")


def _added(fit: Fit, log: Log, turning: Fit | None) -> Fit:
    """All signatures of a manoeuvre, at the fitted model and under the log's noise."""
    vehicle = fit.noise.predictor.vehicle
    # What the sensors are worth was learnt from the log; the manoeuvre has none of their noise.
    data = replace(channels(log, vehicle), noise=fit.noise.predictor.log.noise)
    white, fixed, ambient = fit.noise.whitening, fit.fixed, fit.noise.predictor.ambient
    if turning is not None:
        white, fixed, ambient = _joined(fit, turning), turning.fixed, _moving(fit, turning)
    predictor = Predictor(vehicle, data, ambient)
    if predictor.labels != fit.noise.predictor.labels:
        raise IvsidError("the manoeuvre has other channels than the log")
    # What is declared was fitted to the other log; here it is nothing yet.
    h = replace(fit.h, declared_errors={})
    states = predictor.settle(h, predictor.start(h), 2)
    return survey(Noise(predictor, white, usable_rows(predictor), frozenset()), h, states, fixed)


def _moving(fit: Fit, turning: Fit) -> Ambient:
    """The ambient acceleration: of the log where it moves, of the other elsewhere."""
    own, other = fit.noise.predictor.ambient, turning.noise.predictor.ambient
    one = [other if k in fit.noise.left_out else own for k in range(3)]
    deviation, time = ([q[k] for k, q in enumerate(x)] for x in ([a.deviation for a in one], [a.time for a in one]))
    return Ambient((deviation[0], deviation[1], deviation[2]), (time[0], time[1], time[2]))


def _joined(fit: Fit, turning: Fit) -> Whitening:
    """The whitening: of the log where it moves, of the other elsewhere; all of the other's where it couples both."""
    own, other = fit.noise.whitening, turning.noise.whitening
    left_out = {i for i, (k, _) in enumerate(fit.noise.predictor.labels) if k in fit.noise.left_out}
    theirs = {g: t for g, t in zip(other.groups, other.taps, strict=True) if left_out & set(g)}
    mine = {g: t for g, t in zip(own.groups, own.taps, strict=True) if not left_out & set(g)}
    if any(set(g) - left_out for g in theirs):
        return other
    both = {**mine, **theirs}
    return Whitening(tuple(both), tuple(both.values()))


def _together(fit: Fit, more: Fit) -> Fit:
    """Both logs as one: blocks side by side, columns matched by name."""
    a, b = fit.gram, more.gram
    if a.length != b.length:
        raise IvsidError("the manoeuvre has another clock than the log")
    base_a = [a.names[k] for k in fit.base]
    base_b = [_apart(b.names[k]) for k in more.base]
    names_b = [_apart(n) for n in b.names]
    # Dead bands and limits stand at levels of each log's own: each level of the log takes the nearest one.
    names_b = _matched(fit, more, names_b)
    base = list(dict.fromkeys([*base_a, *base_b]))
    names = tuple(dict.fromkeys([*base, *a.names, *names_b]))
    index = {n: k for k, n in enumerate(names)}
    scale_a, scale_b = np.zeros(len(names)), np.zeros(len(names))
    at_a, at_b = [index[n] for n in a.names], [index[n] for n in names_b]
    scale_a[at_a], scale_b[at_b] = a.unit, b.unit
    unit = np.hypot(scale_a, scale_b)
    blocks = np.concatenate(
        [_placed(g, at, s / unit, len(names)) for g, at, s in ((a, at_a, scale_a), (b, at_b, scale_b))]
    )
    prior = np.zeros(len(names))
    for g, at in ((b, at_b), (a, at_a)):
        prior[at] = g.prior * (unit[at] / g.unit) ** -2
    count = len(blocks)
    g = replace(
        a,
        names=names,
        parts=(),
        y=np.zeros((count, 0)),
        blocks=blocks,
        score=np.zeros((count, len(names))),
        energy=np.zeros(count),
        rows=np.r_[a.rows, b.rows],
        prior=prior,
        centre=np.zeros(len(names)),
        unit=unit,
    )
    fixed = {k: v for k, v in fit.fixed.items() if k in more.fixed}
    return replace(
        fit, gram=g, base=tuple(range(len(base))), noise=replace(fit.noise, left_out=frozenset()), fixed=fixed
    )


def _placed(g: Gram, at: list[int], scale: Array, size: int) -> Array:
    """Cross-products of one log among the columns of both."""
    out = np.zeros((len(g.blocks), size, size))
    out[np.ix_(range(len(g.blocks)), at, at)] = g.blocks
    return np.asarray(out * scale[:, None] * scale[None, :])


def _apart(name: str) -> str:
    return f"{name}'" if name.startswith(OWN) else name


def _matched(fit: Fit, more: Fit, names: list[str]) -> list[str]:
    """Names of the second log's columns, with those of dead bands and limits renamed after the nearest level of the first."""
    out = list(names)
    own = set(fit.gram.names)
    for family in more.families:
        if family.kind != "secant":
            continue
        levels = {v[0][0]: n[0] for f in fit.families if f.id == family.id for n, v in _each(f)}
        used = {n[0] for n in family.variants}
        free = {v: n for v, n in levels.items() if n not in used}
        for (name,), (value,) in zip(family.variants, family.values, strict=True):
            if name in own or not free:
                continue
            near = min(free, key=lambda q: abs(np.log(max(q, 1e-12) / max(value, 1e-12))))
            out[out.index(name)] = free.pop(near)
    return out


def _each(family: Any) -> list[tuple[tuple[str, ...], tuple[tuple[float, ...], ...]]]:
    return [(n, (v,)) for n, v in zip(family.variants, family.values, strict=True)]
