"""Structure that the other log shows: a regressor of the dictionary that stands out of it alone, or of both logs together.

A model without causes that leaves only chance on TRAIN is fitted to TEST under the noise of TRAIN. What stands out there beyond doubt does so beside
the noise of TEST as well, to which the model is fitted once more. Falls by one regressor on two runs add, with
one number of each. It has to stand out of either log with the same sign, and of both together far enough beside what may take it on one:
any thrust curve inside its accuracy, noise of another spectrum than the whitening knows, past errors, and slow forces inside the declared one.

Source: docs/theory.md, "Structure on both logs"; Fisher, *Statistical Methods for Research Workers*, 1932, section 21.1 (tests of independent data together).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import zip_longest
from typing import Final

import numpy as np
from scipy.special import chdtrc

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.other_log import carried_to
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.frequencies import excess, spectrum
from ivsid.diagnosis.null.leaving import Others
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.dictionary import in_words, regressors
from ivsid.diagnosis.selection.in_their_place import same_forces
from ivsid.diagnosis.selection.standing import Standing
from ivsid.diagnosis.selection.structure import ALONE, Adequacy
from ivsid.errors import IvsidError

# Probability of the best single fall on either log, over the whole dictionary, from which on both logs are asked together.
# Source: resource: 13 of 191 sound logs are asked for their first log, which takes some seconds; of 18 whose chance was below 0.02 no regressor stood out of both
DOUBTED: Final = 2e-3
# Least fall of chi-squared on either log.
# Source: definition: 0.3 % of normal errors lie beyond three standard deviations
EACH: Final = 9.0


def with_other(before: Adequacy, fit: Fit, other: Channels, name: str, again: Callable[[], Adequacy]) -> Adequacy:
    """The adequacy of a model that one log leaves, with the structure that the other one or both show, if they do.

    Args:
        before: of the model fitted to the first log.
        fit: that fit.
        other: the other log.
        name: of the other log.
        again: the adequacy of the model fitted to the other log as if that were the first.
    """
    if not before.quiet:
        return before
    # A log on which the numbers cannot be fitted says nothing of the structure.
    with suppress(np.linalg.LinAlgError, IvsidError):
        carried = carried_to(fit, other)
        there = None if carried is None else survey(*carried, fit.fixed, frozenset())
        # A log of another clock or other channels has a noise of its own alone.
        beside = again() if there is None else adequacy(there)
        # A sea of another day has noise of its own, by which the structure has to stand out as well.
        if beside.alone and (own := again()).alone:
            return replace(before, strongest=own.strongest, chance_of_one=own.chance_of_one, alone=True, only=name)
        doubted = min(before.chance_of_one, beside.chance_of_one) <= DOUBTED
        if doubted and there is not None and (found := _lasting(fit, there)) is not None:
            force, fall, chance = found
            function, channel = force.rsplit(" in ", 1)
            strongest = ((function, channel, fall), *before.strongest[:2])
            return replace(before, strongest=strongest, chance_of_one=chance, alone=True, shared=name)
    return before


def _lasting(here: Fit, there: Fit) -> tuple[str, float, float] | None:
    """The regressor that stands out of both logs whatever takes it on either, with its fall and the probability of that, or None.

    Args:
        here: fit of the model to a log.
        there: of the same model to the other.
    """
    best: tuple[str, float, float] | None = None
    last: list[Mapping[str, float]] = [{}, {}]
    # Each step costs more than the one before, and mostly the first leaves nothing. A log has steps of its own.
    for step in zip_longest(_standing(here), _standing(there)):
        last = [before if now is None else now for now, before in zip(step, last, strict=True)]
        best = together(*last)
        if best is None:
            break
    return best


def together(first: Mapping[str, float], second: Mapping[str, float]) -> tuple[str, float, float] | None:
    """The regressor that stands out of two logs together, with its fall and the probability of that over the dictionary, or None.

    Args:
        first: falls on a log, with the sign of the regressor, by ``function in channel``.
        second: on the other.
    """
    pairs = ((f, first[f], second[g]) for f, g in same_forces(first, second).items())
    falls = {f: abs(x) + abs(y) for f, x, y in pairs if x * y > 0 and min(abs(x), abs(y)) >= EACH}
    if not falls:
        return None
    best = max(falls, key=falls.__getitem__)
    # Of pairs that chance makes half have one sign, whatever their falls.
    chance = float(min(1.0, chdtrc(2, falls[best]) / 2 * len(first)))
    return (best, falls[best], chance) if chance <= ALONE else None


def _standing(fit: Fit) -> Iterator[Mapping[str, float]]:
    """Falls by each regressor with its sign, the least so far, beside one after the other of what may take it."""
    known, x, unit = regressors(fit)
    names = [in_words(n) for n in known]
    others = Others(fit)
    free = others.curve
    wide = free.g.joined(names, x, unit)
    own, at = Projection(wide, free.projection.base), range(len(free.g.names), len(wide.names))
    found = Standing.of(own, at, free.worst, excess(fit, own, at, spectrum(fit, wide)))
    least, sign = found.falls, np.sign(found.scores)
    yield dict(zip(names, (sign * least).tolist(), strict=True))
    for other in others.beside():
        colour = other.spectrum(wide)
        beside = Projection(other.beside(wide), own.base)
        q = Standing.of(beside, at, free.worst, None if colour is None else excess(fit, own, at, colour))
        least = np.where(np.sign(q.scores) == sign, np.minimum(least, q.falls), 0.0)
        yield dict(zip(names, (sign * least).tolist(), strict=True))
