"""Stages 5 to 8: which causes are there, one after the other, with those that could be taken for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import adopted, everything, score
from ivsid.diagnosis.candidates.profile import LIMITED, moved, refined, sought
from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit, Noise, chi2_of, survey
from ivsid.diagnosis.estimation.gauss_newton import DeclaredColumns, declared_columns, improve
from ivsid.diagnosis.estimation.learning import learn
from ivsid.diagnosis.estimation.noise import quick_enough
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.effects import EFFECTS

Array = NDArray[np.float64]
MOST: Final = 6
# Beyond so many, a cause is added only where it explains such a share of what is left in its channels.
USUAL: Final = 4
WORTH: Final = 0.5
# Candidates that are fitted in full, and chi^2 within which two cannot be told apart.
FINALISTS: Final = 6
MARGIN: Final = 9.0
# A candidate this far behind under the first noise is not fitted again.
FAR: Final = 60.0
# A full fit with less than this share of the score's gain is given more steps.
SLOW: Final = 0.8
LATE: Final = 6
# Limits that are tried beside the best, in it.
RESTARTS: Final = (0.8, 0.92, 1.0, 1.1, 1.25, 1.5)
# How often the causes are looked at again after each that is added.
REVIEWS: Final = 3
# A number this close to its least possible value, in typical sizes, stands there.
TINY: Final = 1e-4
# The longest period that a log may speak of, in lengths of the log.
PERIODS: Final = 3.0
# How often the filters are made quicker for a cause that damps an axis.
QUICKENED: Final = 3
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Rival:
    """A cause in place of another, fitted in full.

    Attributes:
        id: of the effect.
        h: the hypothesis with it.
        chi2: of the log under it, priors included.
        count: its numbers.
        fall: fall of chi^2 against the hypothesis without either.
    """

    id: str
    h: Hypothesis
    states: FilteredStates
    chi2: float
    count: int
    fall: float

    @property
    def merit(self) -> float:
        """With a price for each number beyond the first."""
        # A gain of all thrusts fits exactly as a single wrong claim does, by moving everything else: the claim says it more simply.
        return self.fall - 3.0 * (self.count - 1) - (1.0 if self.id == "thruster.gain" else 0.0)


@dataclass(frozen=True)
class Found:
    """A cause that was found.

    Attributes:
        id: of the effect.
        rivals: every cause that does as well within the margin, the best first.
        rejected: the others that were fitted in full, or scored, with their gains.
        fall: fall of chi^2 against the model without it.
        chance: of such a gain without it, over the whole library.
        first: the score that it was found by.
    """

    id: str
    rivals: tuple[Rival, ...]
    rejected: tuple[tuple[str, float], ...]
    fall: float
    chance: float
    first: Scored


@dataclass(frozen=True)
class Selection:
    """The outcome.

    Attributes:
        plain: the model as it was, under the last noise.
        last: the model with every cause that was found.
        found: the causes.
        screened: the scores of the first round.
        untested: ids that this log could not show, with z at their typical size.
        leftover: the scores that remain beside the causes.
    """

    plain: Fit
    last: Fit
    found: tuple[Found, ...]
    screened: tuple[Scored, ...]
    untested: Mapping[str, float]
    leftover: tuple[Scored, ...] = field(default=())


class Test(Protocol):
    """Which families pass, and which may be named at all."""

    def __call__(self, fit: Fit, scored: list[Scored]) -> list[Scored]:
        """Those that pass, best first."""

    def eligible(self, s: Scored) -> bool:
        """Whether the log can say anything of a family."""

    def stands(self, s: Scored, fall: float) -> bool:
        """Whether a gain in a full fit is more than chance for the family."""


def select(plain: Fit, passes: Test, fixed: Mapping[str, float], progress: Progress = lambda _: None) -> Selection:
    """Adds causes while one passes the test; after each, looks whether another would do in place of one that is there."""
    fit, scored = score(plain)
    screened = tuple(scored)
    found: list[Found] = []
    before: set[frozenset[str]] = set()
    tops: set[frozenset[str]] = set()
    again = 0
    while len(found) < MOST:
        passed = passes(fit, scored)
        if len(found) >= USUAL and passed:
            left = adequacy(fit)
            passed = [s for s in passed if s.fall >= WORTH * left.beside(fit, s.columns)]
        if not passed:
            break
        progress(f"{passed[0].id}?")
        made = _admit(fit, passed, scored, fixed, passes.eligible)
        if made is None:
            break
        one, best, noise = made
        if not passes.stands(one.first, one.fall):
            # What it seemed to explain, the model explains by itself once it is fitted to the end.
            again += 1
            if again > REVIEWS:
                break
            h, states = improve(noise.predictor, fit.h, fit.states, noise.whitening, noise.good, fixed, 6)
            fit, scored = score(survey(noise, h, states, fixed))
            continue
        found.append(one)
        h, states = improve(noise.predictor, best.h, best.states, noise.whitening, noise.good, fixed)
        # What was found before more was known is looked at again, until nothing changes or what was there comes back.
        for turn in range(REVIEWS if len(found) > 1 else 0):
            asked = len(found) if turn else len(found) - 1
            changed, found, h, states = _reviewed(noise, h, states, found, asked, passes, plain.h, fixed)
            ids = frozenset(f.id for f in found)
            if not changed or ids in before:
                break
            before.add(ids)
        fit, scored = score(survey(noise, h, states, fixed))
        ids = frozenset(f.id for f in found)
        if ids in tops:
            break
        tops.add(ids)
    return Selection(plain, fit, tuple(found), screened, {}, tuple(scored))


def _reviewed(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    found: list[Found],
    asked: int,
    passes: Test,
    plain: Hypothesis,
    fixed: Mapping[str, float],
) -> tuple[bool, list[Found], Hypothesis, FilteredStates]:
    """Each of the first ``asked`` causes taken out again: is it still needed beside the others, and would another do better in its place?

    Returns whether a cause was dropped or swapped, the causes with their sets as they are beside the others, and the hypothesis.
    """
    known = declared_columns(noise.predictor, h, states, noise.whitening, noise.good)
    now = chi2_of(noise, h, states, fixed, known)
    found = list(found)
    for i, one in enumerate(found[:asked]):
        try:
            bare_h = h.without(one.id, plain)
            bare_h, bare_states = improve(noise.predictor, bare_h, states, noise.whitening, noise.good, fixed, 3, known)
            bare, scored = score(survey(noise, bare_h, bare_states, fixed))
            base = chi2_of(noise, bare_h, bare_states, fixed, known)
        except np.linalg.LinAlgError:
            continue
        mine = Rival(one.id, h, states, now, one.first.count, base - now)
        if not passes.stands(one.first, mine.fall):
            return True, [f for f in found if f is not one], bare_h, bare_states
        taken = {f.id for f in found}
        near = [s for s in scored if mine.merit - s.merit <= max(FAR, 0.5 * mine.merit) and s.fall > 4.0]
        near = [s for s in near if s.id not in taken and s.physical and passes.eligible(s)][: FINALISTS - 1]
        tried = side_by_side([partial(_fitted, bare, s, noise, fixed, known) for s in near])
        rivals = sorted(
            [mine, *(replace(r, fall=base - r.chi2) for r in tried if r is not None)], key=lambda r: -r.merit
        )
        best = rivals[0]
        close = tuple(r for r in rivals if best.merit - r.merit <= MARGIN)
        rejected = tuple((r.id, r.fall) for r in rivals if r not in close)
        if best is mine or best.merit < mine.merit + 1.0:
            found[i] = replace(
                one, rivals=(mine, *(r for r in close if r is not mine)), rejected=rejected, fall=mine.fall
            )
            continue
        first = next(s for s in near if s.id == best.id)
        found[i] = Found(best.id, close, rejected, best.fall, first.chance, first)
        return True, found, best.h, best.states
    return False, found, h, states


def _admit(
    fit: Fit, passed: list[Scored], scored: list[Scored], fixed: Mapping[str, float], eligible: Callable[[Scored], bool]
) -> tuple[Found, Rival, Noise] | None:
    """The best of the causes that pass, fitted in full under a noise that no longer holds it, and its rivals."""
    # What does not pass by itself may still do as well in full as what does.
    near = [s for s in scored if passed[0].merit - s.merit <= max(FAR, 0.5 * passed[0].merit) and s.fall > 4.0]
    finalists = sorted(
        {s.id: s for s in (*near, *passed) if s.physical and eligible(s)}.values(), key=lambda s: -s.merit
    )
    finalists = finalists[:FINALISTS]
    known = declared_columns(fit.noise.predictor, fit.h, fit.states, fit.noise.whitening, fit.noise.good)
    tried = side_by_side([partial(_fitted, fit, s, fit.noise, fixed, known) for s in finalists])
    rivals = [r for r in tried if r is not None and r.fall > 0]
    if not rivals:
        return None
    best = max(rivals, key=lambda r: r.merit)
    noise = _learnt(fit.noise.predictor, best.h, best.states, fixed, fit.noise.left_out)
    # Under the better noise, once more: who is best, and who cannot be told from it.
    known = declared_columns(noise.predictor, best.h, best.states, noise.whitening, noise.good)

    def exact(h: Hypothesis, states: FilteredStates, id_: str = "") -> tuple[Hypothesis, FilteredStates, float]:
        h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed, 6, known)
        # Gauss-Newton steps do not cross where the errors jump, as they do where a delay is a sample long.
        bends = [g for g in h.given if g.effect.id == id_ and sought(g)]
        for given in bends:
            h = refined(noise, h, states, fixed, known, given, wide=False)
        if bends:
            states = noise.predictor.settle(h, states, 2)
            h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed, 3, known)
        chi2 = chi2_of(noise, h, states, fixed, known)
        for given in [g for g in h.given if g.effect.id == id_ == LIMITED]:
            for share in RESTARTS:
                # Declared errors of the thrust hold a scale that is wrong in place: from none of them once more.
                start = replace(moved(h, fixed, given, [share * given.values[0]]), declared_errors={})
                there, there_states = improve(
                    noise.predictor, start, states, noise.whitening, noise.good, fixed, LATE, known
                )
                if (worth := chi2_of(noise, there, there_states, fixed, known)) < chi2:
                    h, states, chi2 = there, there_states, worth
        return h, states, chi2

    asked = sorted(rivals, key=lambda r: -r.merit)
    asked = [r for r in asked if best.merit - r.merit <= max(FAR, 0.5 * best.merit)]
    starts = [(fit.h, fit.states, ""), *((r.h, r.states, r.id) for r in asked)]
    (_, _, base), *done = side_by_side([partial(exact, *start) for start in starts])
    again = []
    for r, (h, states, chi2) in zip(asked, done, strict=True):
        if _possible(h, r.id, noise.predictor):
            again.append(replace(r, h=h, states=states, chi2=chi2, fall=base - chi2))
    if not again:
        return None
    again.sort(key=lambda r: -r.merit)
    best = again[0]
    close = tuple(r for r in again if best.merit - r.merit <= MARGIN)
    first = next(s for s in scored if s.id == best.id)
    others = {s.id: s.fall for s in scored if s.id not in {r.id for r in close}}
    others |= {r.id: r.fall for r in again if r not in close}
    rejected = tuple(sorted(others.items(), key=lambda q: -q[1])[:8])
    return Found(best.id, close, rejected, best.fall, first.chance, first), best, noise


def _learnt(
    predictor: Predictor, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float], left_out: frozenset[int]
) -> Noise:
    """The noise beside a hypothesis, with filters that are quick enough for its damping: a cause may be most of what slows an axis."""
    for _ in range(QUICKENED):
        quicker = quick_enough(predictor, predictor.damping(h, states))
        if quicker is predictor:
            break
        predictor = quicker
        _, h, states = learn(predictor, h, states, everything, fixed, left_out, rounds=1)
    return learn(predictor, h, states, everything, fixed, left_out, rounds=1)[0]


def _fitted(fit: Fit, s: Scored, noise: Noise, fixed: Mapping[str, float], known: DeclaredColumns) -> Rival | None:
    """A family's effect in the hypothesis, by Gauss-Newton from the values of its score."""
    base = fit.projection.chi2
    h = adopted(fit.h, s, fit)
    try:
        states = noise.predictor.settle(h, fit.states)
        for turn in range(2):
            own = [g for g in h.given if g.effect.id == s.id and sought(g)]
            for given in own:
                h = refined(noise, h, states, fixed, known, given, wide=not turn)
                states = noise.predictor.settle(h, states, 2)
            if turn and not own:
                break
            h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed, 3, known)
        chi2 = chi2_of(noise, h, states, fixed, known)
        if chi2 > base - SLOW * s.fall:
            # States that follow a hypothesis slowly hide for some steps what it explains.
            h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed, LATE, known)
            chi2 = chi2_of(noise, h, states, fixed, known)
    except (np.linalg.LinAlgError, ValueError, FloatingPointError):
        return None
    if not np.isfinite(chi2) or not _possible(h, s.id, noise.predictor):
        return None
    return Rival(s.id, h, states, chi2, s.count, base - chi2)


def _possible(h: Hypothesis, id_: str, predictor: Predictor) -> bool:
    """Whether a fit has left a cause with numbers that it can have: a drag that drives, a delay of nothing, or a tide that lasts many logs, is no cause."""
    for term in h.terms:
        if term.id == id_ and id_ in EFFECTS and id_ not in h.freed:
            numbers = EFFECTS[id_].parameters
            if len(numbers) == 1 and not numbers[0].signed and h.values[id_] <= 0:
                return False
    for g in h.given:
        if g.effect.id == id_:
            for p, value in zip(g.effect.parameters, g.values, strict=True):
                if p.part == "period" and value > PERIODS * predictor.log.n * predictor.log.h:
                    return False
                if p.draw == "size" and not p.inverse and p.lowest is not None and value <= p.lowest + TINY * p.typical:
                    return False
    return True
