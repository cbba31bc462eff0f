"""Advice: the manoeuvre that tells causes apart which a log does not, by the joint information of both."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, TypeAlias

import numpy as np

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.visibility import VISIBLE, Visibility, excitation, visibility
from ivsid.diagnosis.planning.isolability import APART, Advice, Choice, Isolability, separability
from ivsid.diagnosis.planning.joint_information import joined, manoeuvre_fit, turning_fit
from ivsid.diagnosis.statements.diagnosis import inputs_of
from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.vehicle import Vehicle

# Pairs within this multiple of ``APART`` get advice too: at a third of their typical size they would not be told apart.
# Source: definition: a distance is proportional to the size
CLOSE: Final = 3.0
# Pairs that get advice.
# Source: resource: the length of a list in the report
PAIRS: Final = 6
# From the fitted parameters, the rate [Hz] and whether a noisy manoeuvre is needed: logs of manoeuvres by name, and the noisy one or None.
Sail: TypeAlias = "Callable[[Mapping[str, float], float, bool], tuple[Mapping[str, Log], Log | None]]"


def advised(vehicle: Vehicle, log: Log, sail: Sail, *, progress: Callable[[str], None] = lambda _: None) -> Isolability:
    """Isolability of a log's programme, with the manoeuvres that would improve it.

    Args:
        vehicle: with the model.
        log: of the programme.
        sail: simulates the manoeuvres.
        progress: told of each step.

    Raises:
        IvsidError: a log that the model cannot be diagnosed with.
    """
    progress("fitting the model")
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    made = separability(fit, inputs_of(vehicle, log))
    logs, turning = sail(fit.h.values, 1.0 / fit.noise.predictor.log.h, bool(fit.noise.left_out))
    if not logs:
        return made
    sets = [ids for ids, _ in made.classes]
    found, shown = advise(fit, [*sets, *_near(made, sets)], logs, turning, progress)
    return replace(made, advice=found, shown=shown)


def _near(made: Isolability, sets: Sequence[tuple[str, ...]]) -> Sequence[tuple[str, ...]]:
    """Pairs that are barely told apart, the closest first."""
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
    """Advice by the information that each manoeuvre adds to a log.

    Args:
        fit: to the log.
        sets: of causes that the log does not tell apart.
        logs: of manoeuvres by name, on the same clock and with the same channels.
        turning: a manoeuvre with the noise of the sensors, for the axes that a straight log leaves out.
        progress: told of each manoeuvre.

    Returns:
        The advice for each set; and for each cause that the log does not test, the manoeuvre that shows it best, with z.
    """
    here = excitation(fit)
    alone = visibility(fit, here)
    wanted = {i for s in sets for i in s}
    weak = [i for i, v in alone.items() if not v.tested]
    fallback: Fit | None = None
    results: dict[str, tuple[dict[frozenset[str], float], dict[str, float]]] = {}
    for k, (name, log) in enumerate(logs.items()):
        progress(f"trying {k} of {len(logs)}: {name}")
        try:
            if fit.noise.left_out and fallback is None:
                fallback = turning_fit(fit, turning)
            more = manoeuvre_fit(fit, log, fallback)
            there = excitation(more) if weak else {}
            both = joined(fit, more)
            excited = {n: max(here.get(n, 0.0), there.get(n, 0.0)) for n in {*here, *there}}
            seen = visibility(both, excited)
            pairs = _pairs(both, seen, wanted)
        except (IvsidError, np.linalg.LinAlgError):
            # A manoeuvre that the model cannot follow is left out of the advice.
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
    """Advice for a set of causes: the manoeuvres by the groups that they leave and by their smallest distance, the best first."""
    choices = []
    for name, pairs in results.items():
        groups = _groups(ids, pairs)
        choices.append(Choice(name, _smallest(ids, pairs), groups))
    # Most groups first, then the largest smallest distance; if a pair is never told apart, the sum of all distances decides.
    choices.sort(key=lambda c: (-len(c.groups), -c.d, -_total(ids, results[c.trial]), c.trial))
    return Advice(ids, _smallest(ids, here), tuple(choices))


def _smallest(ids: Sequence[str], pairs: Mapping[frozenset[str], float]) -> float:
    """Smallest distance of any two causes of a set."""
    return min((pairs.get(frozenset({a, b}), 0.0) for k, a in enumerate(ids) for b in ids[:k]), default=0.0)


def _total(ids: Sequence[str], pairs: Mapping[frozenset[str], float]) -> float:
    """Sum of the distances of all pairs of a set, each counted up to ``APART``."""
    return sum(min(pairs.get(frozenset({a, b}), 0.0), APART) for k, a in enumerate(ids) for b in ids[:k])


def _groups(ids: Sequence[str], pairs: Mapping[frozenset[str], float]) -> tuple[tuple[str, ...], ...]:
    """Groups of causes that are linked by distances below ``APART``."""
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
    """Distances of all pairs of the causes, the smaller of both directions."""
    made = separability(fit, visible=visible, wanted=wanted)
    return {
        frozenset({a, b}): float(min(made.distance[i, j], made.distance[j, i]))
        for i, a in enumerate(made.ids)
        for j, b in enumerate(made.ids[:i])
    }
