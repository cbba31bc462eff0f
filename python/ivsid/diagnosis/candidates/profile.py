"""Numbers in which the errors bend or jump: a limit, a dead band, a delay, the start of something. Chi^2 itself says how far they go.

A slope at the best value says little of them: between two demands that were sent a dead band may stand anywhere. So chi^2 is worked out
at other values of the one number, everything else fitted beside it, and the interval ends where it has risen too far.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Noise, crossed
from ivsid.diagnosis.estimation.gauss_newton import DeclaredColumns
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import BENT
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.effects import Given

LIMITED: Final = "thruster.saturation"
# The place of its anchor is searched on a grid; a hull that sails around it has no slope that leads there.
MOORED: Final = "tether.tension"
COMPASS: Final = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7))
# The first step of a search for an anchor, in extents of the track, and how often it is halved.
ANCHOR_STEP: Final = 0.25
ANCHOR_HALVINGS: Final = 5
# Shares of the first value that are tried before it is refined: its score came from a column of another value.
SHARES: Final = tuple(np.geomspace(0.2, 2.5, 16).tolist())
# Bisections of an end, and doublings of the first step until chi^2 has risen.
HALVINGS: Final = 7
DOUBLINGS: Final = 12
# A start is looked for within this many first steps.
AROUND: Final = 6


def bent(given: Given) -> list[int]:
    """The places of an effect's numbers that are to be profiled."""
    if given.effect.id in BENT:
        return [0]
    return [j for j, p in enumerate(given.effect.parameters) if p.draw == "time"]


def sought(given: Given) -> bool:
    """Whether an effect has numbers whose first values come from a coarse search, and are to be refined before slopes are followed."""
    return bool(bent(given)) or given.effect.id == MOORED


def first_step(noise: Noise, given: Given, j: int) -> float:
    """A small change of the number: two seconds, or a fiftieth."""
    if given.effect.parameters[j].draw == "time":
        return max(2.0, 4 * noise.predictor.log.h)
    return 0.02 * max(abs(given.values[j]), 1e-9)


def profile(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    fixed: Mapping[str, float],
    known: DeclaredColumns,
    given: Given,
    *places: int,
) -> Callable[..., float]:
    """Chi^2 as a function of one number of an effect that the hypothesis has, or of several.

    Args:
        noise: filters and whitening.
        h: the hypothesis.
        states: its states.
        fixed: parameters that are not fitted.
        known: signatures of what is declared.
        given: the effect as it stands in the hypothesis.
        places: of the numbers among the effect's.
    """
    g = crossed(noise, h, states, fixed, known)
    own = {given.effect.parts[j] if given.thruster is None else next(iter(given.named)) for j in places}
    base = [k for k, name in enumerate(g.names) if name not in own]
    errors = noise.predictor.errors(h, states)

    def chi2(*numbers: float) -> float:
        values = list(given.values)
        for j, value in zip(places, numbers, strict=True):
            values[j] = value
        gone = noise.predictor.difference(h, states, moved(h, fixed, given, values))
        return Projection(g.of(errors - gone), base).chi2

    return chi2


def moved(h: Hypothesis, fixed: Mapping[str, float], given: Given, values: Sequence[float]) -> Hypothesis:
    """The hypothesis with other numbers of an effect.

    Masses and drags that are fitted follow a limit: where most thrusts stand at it, little else tells it from their scale.
    """
    other = h.with_effect(replace(given, values=tuple(values)))
    if given.effect.id != LIMITED:
        return other
    share = values[0] / given.values[0]
    return replace(other, values={k: x if k in fixed else x * share for k, x in other.values.items()})


def refined(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    fixed: Mapping[str, float],
    known: DeclaredColumns,
    given: Given,
    *,
    wide: bool,
) -> Hypothesis:
    """The hypothesis with the numbers of an effect that are to be profiled where chi^2 is least nearby, or with ``wide`` anywhere."""
    if given.effect.id == MOORED:
        return _moored(noise, h, states, fixed, known, given)
    for j in bent(given):
        chi2 = profile(noise, h, states, fixed, known, given, j)
        step, best = first_step(noise, given, j), given.values[j]
        tried = {best: chi2(best)}
        if wide and given.effect.id in BENT:
            tried |= {best * share: chi2(best * share) for share in SHARES}
            best = min(tried, key=lambda q: tried[q])
        for _ in range(2):
            for k in range(-AROUND, AROUND + 1):
                value = best + k * step
                if value > 0 and value not in tried:
                    tried[value] = chi2(value)
            best = min(tried, key=lambda q: tried[q])
            step /= AROUND
        values = list(given.values)
        values[j] = best
        h = moved(h, fixed, given, values)
        given = replace(given, values=tuple(values))
    return h


def _moored(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    fixed: Mapping[str, float],
    known: DeclaredColumns,
    given: Given,
) -> Hypothesis:
    """The hypothesis with a tether's anchor where chi^2 is least, by a search in eight directions."""
    log = noise.predictor.log
    if log.place is None:
        return h
    chi2 = profile(noise, h, states, fixed, known, given, 1, 2)
    here = (float(given.values[1]), float(given.values[2]))
    least = chi2(*here)
    step = ANCHOR_STEP * max(float(np.ptp(log.place[0])), float(np.ptp(log.place[1])), 1.0)
    for _ in range(ANCHOR_HALVINGS):
        for _ in range(DOUBLINGS):
            tried = {(here[0] + a * step, here[1] + b * step) for a, b in COMPASS}
            worth, best = min((chi2(*q), q) for q in tried)
            if worth >= least:
                break
            least, here = worth, best
        step /= 2
    return h.with_effect(replace(given, values=(given.values[0], *here, *given.values[3:])))


def rise(given: Given, j: int, sigmas: float, worse: float) -> float:
    """How far chi^2 may rise inside the interval: a start carries along what the size of its effect is off."""
    return sigmas**2 * worse * (2.0 if given.effect.parameters[j].draw == "time" else 1.0)


def slack(noise: Noise, given: Given, j: int) -> float:
    """What a number is off beside its errors: a start cannot be told within a few samples, nor within the memory of the filters."""
    return max(1.0, 3 * noise.predictor.log.h) if given.effect.parameters[j].draw == "time" else 0.0


def ends(chi2: Callable[[float], float], best: float, step: float, most: float) -> tuple[float, float]:
    """The interval around the best value outside of which chi^2 has risen by more than ``most``."""
    least = chi2(best)
    found = []
    for sign in (-1.0, 1.0):
        inside, reach = 0.0, step
        for _ in range(DOUBLINGS):
            here = chi2(best + sign * reach) if best + sign * reach > 0 else np.inf
            if here - least > most:
                break
            least = min(least, here)
            inside, reach = reach, 2 * reach
        outside = reach
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            here = chi2(best + sign * middle) if best + sign * middle > 0 else np.inf
            if here - least > most:
                outside = middle
            else:
                inside = middle
        found.append(best + sign * outside)
    return max(found[0], 0.0), found[1]
