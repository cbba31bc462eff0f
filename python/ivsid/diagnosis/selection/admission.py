"""Admission of a cause: the candidates that pass are fitted in full, the noise is learnt beside the best, and all are fitted again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Final

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.profile import LIMITED, moved, refined, sought
from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit, Noise, chi2_of
from ivsid.diagnosis.estimation.gauss_newton import DeclaredColumns, declared_columns, improve
from ivsid.diagnosis.estimation.learning import learn
from ivsid.diagnosis.estimation.noise import quick_enough
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.diagnosis.selection.rivals import (
    FAR,
    FAR_SHARE,
    FINALISTS,
    FULL_STEPS,
    MARGIN,
    Found,
    Rival,
    contenders,
    fitted,
    possible,
)

# Multiples of the best limit from which a fit restarts: chi-squared has several minima along the scale of masses and drags.
# Source: measured: make constants
RESTARTS: Final = (0.8, 0.92, 1.0, 1.1, 1.25, 1.5)
# Rounds in which the filters are made quicker for a cause that damps an axis.
# Source: resource: the noise is learnt again in each
QUICKENED: Final = 3
# Rejected candidates that are kept with a cause.
# Source: resource: the length of a list in the report
REJECTED: Final = 8


def admit(
    fit: Fit, passed: list[Scored], scored: list[Scored], fixed: Mapping[str, float], eligible: Callable[[Scored], bool]
) -> tuple[Found, Rival, Noise] | None:
    """The best of the causes that pass, with its rivals, fitted in full under a noise that no longer holds the cause.

    Args:
        fit: of the model so far.
        passed: causes that pass the test, the best first.
        scored: all causes.
        fixed: parameters that are not fitted.
        eligible: whether a cause may be named in this log.

    Returns:
        The cause, its fit and the noise beside it; None if no fit gives possible numbers.
    """
    # A cause that does not pass by its score may do as well in a full fit.
    near = contenders(scored, passed[0].merit)
    finalists = sorted(
        {s.id: s for s in (*near, *passed) if s.physical and eligible(s)}.values(), key=lambda s: -s.merit
    )
    finalists = finalists[:FINALISTS]
    known = declared_columns(fit.noise.predictor, fit.h, fit.states, fit.noise.whitening, fit.noise.good)
    tried = side_by_side([partial(fitted, fit, s, fit.noise, fixed, known) for s in finalists])
    rivals = [r for r in tried if r is not None and r.fall > 0]
    if not rivals:
        return None
    best = max(rivals, key=lambda r: r.merit)
    noise = _learnt(fit.noise.predictor, best.h, best.states, fixed, fit.noise.left_out)
    # All are fitted once more under the better noise.
    known = declared_columns(noise.predictor, best.h, best.states, noise.whitening, noise.good)

    asked = sorted(rivals, key=lambda r: -r.merit)
    asked = [r for r in asked if best.merit - r.merit <= max(FAR, FAR_SHARE * best.merit)]
    starts = [(fit.h, fit.states, ""), *((r.h, r.states, r.id) for r in asked)]
    (_, _, base), *done = side_by_side([partial(_exact, noise, fixed, known, *start) for start in starts])
    again = []
    for r, (h, states, chi2) in zip(asked, done, strict=True):
        if possible(h, r.id, noise.predictor):
            again.append(replace(r, h=h, states=states, chi2=chi2, fall=base - chi2))
    if not again:
        return None
    again.sort(key=lambda r: -r.merit)
    best = again[0]
    close = tuple(r for r in again if best.merit - r.merit <= MARGIN)
    # Those that passed know what declared errors may make of their score.
    first = next(s for s in (*passed, *scored) if s.id == best.id)
    others = {s.id: s.fall for s in scored if s.id not in {r.id for r in close}}
    others |= {r.id: r.fall for r in again if r not in close}
    rejected = tuple(sorted(others.items(), key=lambda q: -q[1])[:REJECTED])
    return Found(best.id, close, rejected, best.fall, first.chance, first), best, noise


def _exact(
    noise: Noise, fixed: Mapping[str, float], known: DeclaredColumns, h: Hypothesis, states: FilteredStates, id_: str
) -> tuple[Hypothesis, FilteredStates, float]:
    """A hypothesis fitted to the end, with its states and chi-squared; numbers of the effect ``id_`` that bend are searched again."""
    h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed, FULL_STEPS, known)
    # Gauss-Newton steps do not cross a jump of the errors, as where a delay is a sample long.
    bends = [g for g in h.given if g.effect.id == id_ and sought(g)]
    for given in bends:
        h = refined(noise, h, states, fixed, known, given, wide=False)
    if bends:
        states = noise.predictor.settle(h, states, 2)
        h, states = improve(noise.predictor, h, states, noise.whitening, noise.good, fixed, known=known)
    chi2 = chi2_of(noise, h, states, fixed, known)
    for given in [g for g in h.given if g.effect.id == id_ == LIMITED]:
        for share in RESTARTS:
            # Fitted errors of the thrust keep a wrong scale of the parameters in place, so the fit restarts without them.
            start = replace(moved(h, fixed, given, [share * given.values[0]]), declared_errors={})
            there, there_states = improve(
                noise.predictor, start, states, noise.whitening, noise.good, fixed, FULL_STEPS, known
            )
            if (better := chi2_of(noise, there, there_states, fixed, known)) < chi2:
                h, states, chi2 = there, there_states, better
    return h, states, chi2


def _learnt(
    predictor: Predictor, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float], left_out: frozenset[int]
) -> Noise:
    """The noise beside a hypothesis, with filters that are quick enough for its damping: a cause may be most of the damping of an axis."""
    for _ in range(QUICKENED):
        quicker = quick_enough(predictor, predictor.damping(h, states))
        if quicker is predictor:
            break
        predictor = quicker
        _, h, states = learn(predictor, h, states, everything, fixed, left_out, rounds=1)
    return learn(predictor, h, states, everything, fixed, left_out, rounds=1)[0]
