"""Rivals: causes that are fitted in full in the place of one another, and compared by their merit.

The merit is the fall of chi-squared less a price for each parameter beyond the first, as in an information criterion.

Source: Akaike, "A new look at the statistical model identification", IEEE Transactions on Automatic Control 19, 1974.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.families import adopted
from ivsid.diagnosis.candidates.profile import refined, sought
from ivsid.diagnosis.estimation.first_values import first_values
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.kinds.candidate import PRICE, Scored
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.signatures import of_file
from ivsid.diagnosis.null import leaving
from ivsid.diagnosis.null.boxed import outside
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.effects import EFFECTS, terms_of

# Price of the less simple of two causes that fit exactly alike.
# Source: definition: any positive number breaks the tie
TIE: Final = 1.0
# Causes whose merits differ by less are not told apart: three standard deviations.
# Source: definition: 0.3 % of normal errors lie beyond
MARGIN: Final = 9.0
# Candidates that are fitted in full.
# Source: resource: the time of a round grows with its full fits
FINALISTS: Final = 6
# A candidate whose merit is this far behind the best is not fitted in full.
# Source: measured: make constants
FAR: Final = 60.0
# A candidate that is behind the best by less than this share of its merit is fitted in full in any case.
# Source: measured: make constants
FAR_SHARE: Final = 0.5
# A fall of chi-squared of two standard deviations or less makes no candidate.
# Source: definition: 5 % of normal errors lie beyond
WEAK: Final = 4.0
# A full fit that reaches less than this share of the score's fall of chi-squared is given more steps.
# Source: measured: make constants
SLOW: Final = 0.8
# Gauss-Newton steps of a fit that has to be finished.
# Source: resource: twice the steps of any other fit
FULL_STEPS: Final = 6
# A number this close to its bound, in typical sizes, stands at the bound.
# Source: measured: make constants
AT_BOUND: Final = 1e-4


@dataclass(frozen=True)
class Rival:
    """A cause that is fitted in full in the place of another.

    Attributes:
        id: of the effect.
        states: of the hypothesis with it.
        chi2: of the log under the hypothesis, priors included.
        count: number of its parameters.
        fall: fall of chi-squared against the hypothesis without either.
    """

    id: str
    states: FilteredStates
    chi2: float
    count: int
    fall: float

    @property
    def merit(self) -> float:
        """Fall of chi-squared less a price for each parameter beyond the first."""
        # A gain of all thrusts fits exactly as a single wrong claim does, by moving everything else: the claim is the simpler cause.
        return self.fall - PRICE * (self.count - 1) - (TIE if EFFECTS[self.id].one_factor else 0.0)

    @property
    def place(self) -> float:
        """Merit by which the first of several causes is chosen."""
        # A rough outline bends to a drag of a known shape, which comes first wherever the log does not tell the two apart.
        return self.merit - (MARGIN if EFFECTS[self.id].form.rough else 0.0)


@dataclass(frozen=True)
class Found:
    """A cause that was found.

    Attributes:
        id: of the effect.
        rivals: the causes whose merit is within ``MARGIN`` of the best, the best first.
        tried: falls of chi-squared of the other causes that were fitted in full in its place, by id.
        fall: fall of chi-squared against the model without the cause.
        chance: probability of such a fall without the cause, over all of its values that were searched.
        first: the score by which the cause was found.
        lingers: whether it starts at a time, and the log does not tell it from the same force that comes gradually.
        slewed: the refusal of a cause by which thrusts follow late, if thrusts whose rate is limited do so better.
    """

    id: str
    rivals: tuple[Rival, ...]
    tried: Mapping[str, float]
    fall: float
    chance: float
    first: Scored
    lingers: bool = False
    slewed: Refusal | None = None

    @property
    def others(self) -> frozenset[str]:
        """Ids of the causes that were fitted in full in its place, whether or not the log tells them from it."""
        return frozenset((*self.tried, *(r.id for r in self.rivals))) - {self.id}


def swapped(found: Sequence[Found], id_: str = "") -> dict[str, tuple[float, float]]:
    """Largest shifts down and up of each number if a cause that the log does not tell from one that was found acts in its place, by name.

    A gain of all thrusts in the place of a wrong claim moves every force by its factor.

    Args:
        found: the causes with their rivals beside all others.
        id_: of a cause that stays.
    """
    span: dict[str, tuple[float, float]] = {}
    for one in found:
        others = [r for r in one.rivals if r.id != one.id]
        if one.id == id_ or not others:
            continue
        here = next(r for r in one.rivals if r.id == one.id).states.h.numbers
        for r in others:
            for name, there in r.states.h.numbers.items():
                shift = there - here.get(name, there)
                down, up = span.get(name, (0.0, 0.0))
                span[name] = min(down, shift), max(up, shift)
    return span


def contenders(scored: Sequence[Scored], best: float) -> list[Scored]:
    """Scored causes that a full fit may bring up to the best, in the given order.

    Args:
        scored: causes with their scores.
        best: merit of the best cause.
    """
    return [s for s in scored if best - s.merit <= max(FAR, FAR_SHARE * best) and s.fall > WEAK]


def starts(fit: Fit, causes: Sequence[Scored]) -> list[Hypothesis]:
    """Hypotheses from which causes are fitted in full."""
    return [adopted(fit.h, s, fit) for s in causes]


def fitted(problem: Problem, fit: Fit, s: Scored, start: FilteredStates | None = None) -> Rival | None:
    """A cause fitted in full by Gauss-Newton steps from the values of its score; None if the fit fails or its numbers are not possible.

    Args:
        problem: the log.
        fit: of the model without the cause.
        s: the cause with its score.
        start: states of another hypothesis without it, from whose masses and drags the steps start; those of ``fit`` by default.
    """
    base, predictor = fit.projection.chi2, problem.noise.predictor
    states = start or fit.states
    states = states.under(adopted(states.h, s, fit))
    try:
        states = predictor.settle(states)
        for turn in range(2):
            own = [g for g in states.h.given if g.effect.id == s.id and sought(g)]
            for given in own:
                states = predictor.settle(refined(problem, states, given, wide=not turn), 2)
            problem = problem.under(states)
            if turn and not own:
                break
            states = improve(problem, states)
        chi2 = problem.chi2(states)
        if chi2 > base - SLOW * s.fall:
            # States that follow a hypothesis slowly hide the fall of chi-squared for some steps.
            states = improve(problem, states, FULL_STEPS)
            chi2 = problem.chi2(states)
    except (np.linalg.LinAlgError, ValueError, FloatingPointError):
        return None
    if not np.isfinite(chi2) or not possible(states.h, s.id, predictor):
        return None
    return Rival(s.id, states, chi2, s.count, base - chi2)


def in_place_of(problem: Problem, fit: Fit, s: Scored, own: Rival | None, best: Rival) -> Rival | None:
    """A cause fitted once more from the masses and drags of the best one, where both have a number that bends the errors; its better fit.

    Two lags of a thrust hide in the same masses and drags, far from those of the model without either, where chi-squared has other minima.

    Args:
        problem: the log.
        fit: of the model without the causes.
        s: the cause with its score.
        own: its fit.
        best: the best cause.
    """
    bent = all(i in EFFECTS and EFFECTS[i].form.bends for i in (s.id, best.id))
    if s.id == best.id or not bent or (own is not None and best.merit - own.merit < MARGIN):
        return own
    again = fitted(problem, fit, s, best.states.under(best.states.h.without(best.id, fit.h)))
    return max((r for r in (own, again) if r is not None), key=lambda r: r.merit, default=None)


def fitted_inside(problem: Problem, fit: Fit, s: Scored) -> Rival | None:
    """A cause fitted in full, from inside the limits of hulls as well, and a cause at a thruster from inside the accuracy of the curves.

    Thrusts that come late by many rows ask for a hull of any mass. Steps that start at a limit stay there, and chi-squared has another minimum inside.
    A shaft that lags had thrust errors of thirty times the accuracy between rising and falling demands, on which a time of its own changes nothing
    for the better.

    Args:
        problem: the log.
        fit: of the model without the cause.
        s: the cause with its score.
    """
    starts: list[Hypothesis] = []
    if at_limits(fit):
        predictor = problem.noise.predictor
        # Terms of causes that the model holds beside its own may ask for columns that a regression has not.
        first = first_values(predictor.vehicle, predictor.log, terms_of(predictor.vehicle), dict(fit.fixed))
        starts.append(replaced(fit.h, {i: x for i, x in first.values.items() if i in fit.free}))
    if s.candidate.effect.acts.at_thruster and max((most for _, most in outside(fit)), default=0.0) > leaving.FAR:
        starts.append(of_file(starts[-1] if starts else fit.h))
    tried = [fitted(problem, fit, s), *(fitted(problem, fit, s, fit.states.under(h)) for h in starts)]
    return max((r for r in tried if r is not None), key=lambda r: r.merit, default=None)


def at_limits(fit: Fit) -> bool:
    """Whether a mass or a drag of a fit is the least or the most that a hull may have."""
    limits = hull_limits(fit.noise.predictor.vehicle, fit.h.terms)
    return any(fit.h.values[i] in ends for i, ends in limits.items() if i in fit.free and fit.h.values[i] != 0)


def possible(h: Hypothesis, id_: str, predictor: Predictor) -> bool:
    """Whether the fitted numbers of a cause are ones that it can have.

    A drag that drives, a delay of zero, a tide whose period exceeds several logs, a hump that no flank shows and a swell inside the declared ambient
    force are not possible.

    Args:
        h: the fitted hypothesis.
        id_: of the effect.
        predictor: of the log.
    """
    for term in h.terms:
        if term.id == id_ and id_ in EFFECTS and id_ not in h.freed:
            numbers = EFFECTS[id_].parameters
            if len(numbers) == 1 and not numbers[0].signed and h.values[id_] <= 0:
                return False
    for g in h.given:
        if g.effect.id == id_:
            said = {p.part: value for p, value in zip(g.effect.parameters, g.values, strict=True)}
            log = predictor.log
            if not g.effect.form.shown(said, log.n * log.h, float(np.abs(log.nu[0]).max())):
                return False
            ambient = predictor.vehicle.ambient
            if ambient is not None and g.effect.form.over_declared(said, ambient.force, lambda: np.inf) <= 1.0:
                return False
            for p, value in zip(g.effect.parameters, g.values, strict=True):
                if (
                    p.draw == "size"
                    and not p.inverse
                    and p.lowest is not None
                    and value <= p.lowest + AT_BOUND * p.typical
                ):
                    return False
    return True
