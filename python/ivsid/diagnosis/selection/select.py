"""Selection: causes are added while one passes the test, and the earlier ones are reviewed after each.

Source: docs/theory.md, "Diagnosis"; forward selection with backward elimination after Efroymson, "Multiple regression analysis", 1960.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Final

from ivsid.diagnosis.candidates.families import score
from ivsid.diagnosis.candidates.intervals import Reach
from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.learning import within_rows
from ivsid.diagnosis.estimation.noise import Noise
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.family_wise import Screened, Threshold
from ivsid.diagnosis.null.rule import Refusal, first_refusal
from ivsid.diagnosis.null.screening import chance
from ivsid.diagnosis.null.slewed import lags, slewed
from ivsid.diagnosis.null.slow_force import slow_force
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.admission import admit
from ivsid.diagnosis.selection.both_logs import on_other_log
from ivsid.diagnosis.selection.dictionary import regressors
from ivsid.diagnosis.selection.force_rules import SLEWED, SLOW_FORCE, Slewed, Slow
from ivsid.diagnosis.selection.one_force import Forces, imitating, imitating_on_both
from ivsid.diagnosis.selection.review import Reviewed, reviewed
from ivsid.diagnosis.selection.rivals import FULL_STEPS, Found
from ivsid.diagnosis.selection.rules import (
    LATE,
    MOST,
    OWN,
    SETTLED,
    USUAL,
    Late,
    full_refused,
    refused_by,
)
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.intervals.apart import Apart

# Reviews after a cause is added, and causes that may fail their full fit.
# Source: resource: a review takes a survey for each cause
REVIEWS: Final = 3
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Selection:
    """Outcome of the selection.

    Attributes:
        plain: fit of the model without causes.
        last: fit of the model with every cause that was found.
        found: the causes, in the order in which they were found.
        screened: scores of the first round, the best first.
        leftover: scores beside all causes, the best first.
        refused: for each cause that was not found, the refusal by the first rule that it did not keep, by id.
        curves: what any thrust curve inside its accuracy makes of each number of the last fit, by column; empty where nothing was found.
        left: structure that the last fit leaves, where it is known.
        imitating: causes that passed every test but that one force explains as well, or better: the log holds something that the model lacks.
    """

    plain: Fit
    last: Fit
    found: tuple[Found, ...]
    screened: tuple[Scored, ...]
    leftover: tuple[Scored, ...] = field(default=())
    refused: Mapping[str, Refusal] = field(default_factory=dict)
    imitating: tuple[Found, ...] = ()
    curves: Mapping[str, Reach] = field(default_factory=dict)
    left: Adequacy | None = None

    @cached_property
    def after(self) -> Adequacy:
        """Structure that the model with every cause leaves."""
        return self.left or adequacy(self.last)


def select(
    plain: Fit,
    first: tuple[Fit, list[Scored]],
    passes: Threshold,
    other: Channels | None,
    progress: Progress = lambda _: None,
    *,
    whole: bool = True,
) -> Selection:
    """Adds causes while one passes the test, and reviews the earlier ones after each.

    Args:
        plain: fit of the model without causes.
        first: the same with the columns of searched causes, and the scores of all (``score``).
        passes: the test.
        other: the log of another run, which is asked of causes that this one shows; None asks none.
        progress: told of each candidate.
        whole: whether the search goes on where a model with causes damps its turns within rows, and yaw is not left out.
    """
    fit, scored = first
    every = tuple(scored)
    found: list[Found] = []
    refused: dict[str, Refusal] = {}
    waiting: dict[str, Refusal] = {}
    before: set[frozenset[str]] = set()
    tops: set[frozenset[str]] = set()
    outsiders, again = frozenset[str](), 0
    while True:
        ids = tuple(f.id for f in found)
        screened = passes(fit, scored, ids)
        late, passed = _late(fit, screened, ids)
        # The first rule that refuses a cause is the reason, whatever later rounds say.
        gone = {q.id for q in every} - {q.id for q in scored} - {*ids}
        refused = {**screened.refused, **late, **{i: refused_by(OWN, ids) for i in gone}, **refused}
        if not passed:
            break
        progress(f"{passed[0].id}?")
        made = admit(fit, screened, passed, passes, ids, outsiders)
        refused = {**made.refused, **refused}
        waiting |= made.waiting
        if made.found is None or made.best is None or made.noise is None:
            break
        one, best, noise = made.found, made.best, made.noise
        if (refusal := full_refused(passes, one.first, one.fall, ids)) is not None:
            # The model explains by itself what the cause seemed to explain, once it is fitted to the end.
            refused = {**dict.fromkeys((r.id for r in one.rivals), refusal), **refused}
            # What passes neither by its score nor in full is no rival of what does.
            new = {r.id for r in one.rivals} - {q.id for q in passed} - outsiders
            outsiders |= new
            if (again := again + (not new)) > REVIEWS:
                break
            problem = Problem.at(noise, plain.fixed, fit.states)
            fit, scored = score(survey(noise, improve(problem, fit.states, FULL_STEPS), plain.fixed))
            continue
        one, states = _late_or_slewed(Problem.at(noise, plain.fixed, best.states), best.states, one, plain.h)
        review = Reviewed(True, [*found, one], states, {})
        if one.slewed is None:
            review = _reviews(noise, review, passes, plain, before)
        found = review.found
        refused = {i: r for i, r in {**review.refused, **refused}.items() if i not in {f.id for f in found}}
        fit, scored = score(survey(noise, review.states, plain.fixed))
        if not whole and within_rows(fit):
            # What else the search finds beside such a yaw is its errors.
            return Selection(plain, fit, tuple(found), every, tuple(scored), refused)
        if one.slewed is not None:
            # What a limit of a rate leaves beside a lag is no cause.
            break
        if (now := frozenset(f.id for f in found)) in tops:
            screened = passes(fit, scored, tuple(now))
            back = refused_by(SETTLED, tuple(now))
            refused = {**dict.fromkeys((q.id for q in screened.passed), back), **screened.refused, **refused}
            break
        tops.add(now)
    chosen = Selection(plain, fit, tuple(found), every, tuple(scored), {**waiting, **refused})
    return _kept(chosen, screened, passes.level, other)


def _kept(chosen: Selection, screened: Screened, level: float, other: Channels | None) -> Selection:
    """The selection without causes that imitate something which the catalogue lacks, and what its curves reach.

    Args:
        chosen: the causes.
        screened: the last screening, which has made the curves of its fit.
        level: threshold of the log.
        other: the log of another run of the same vehicle, or None.
    """
    if not chosen.found:
        return chosen
    # The other log is asked in a process of its own, while this one is.
    there = Apart(partial(on_other_log, chosen.last, chosen.found, other))
    known = regressors(chosen.last)
    asked = Forces.of(chosen.last, chosen.found, known=known)
    said = {**imitating(asked, chosen.found), **{f.id: f.slewed for f in chosen.found if f.slewed is not None}}
    if said:
        there.end()
        chosen = _without(chosen, said, level)
        answer = on_other_log(chosen.last, chosen.found, other)
        asked = Forces.of(chosen.last, chosen.found)
    else:
        curves = (screened.round.curve or AnyCurve(chosen.last)).reach()
        chosen = replace(chosen, curves=curves, left=adequacy(chosen.last, known=known))
        answer = there.result()
    said = {**answer.changed, **imitating_on_both(asked, chosen.found, answer.in_place)}
    return _without(chosen, said, level) if said else chosen


def _without(s: Selection, said: Mapping[str, Refusal], level: float) -> Selection:
    """The selection without causes that imitate something which the catalogue lacks.

    Args:
        s: with them.
        said: their refusals, by id.
        level: threshold of the log.
    """
    h = s.last.h
    for id_ in said:
        h = h.without(id_, s.plain.h)
    noise, fixed = s.last.noise, s.plain.fixed
    bereft = s.last.states.under(h)
    states = improve(s.last.problem.under(bereft), bereft, FULL_STEPS)
    fit, scored = score(survey(noise, states, fixed))
    slow = _of_slow_force(fit, {q.id: q for q in scored if q.id in said}, level)
    refused = {r.id: slow.get(f.id, said[f.id]) for f in s.found if f.id in said for r in f.rivals}
    found = tuple(f for f in s.found if f.id not in said)
    gone = tuple(f for f in s.found if f.id in said and f.id not in slow)
    curves = AnyCurve(fit).reach() if found else {}
    left = replace(
        s, last=fit, found=found, leftover=tuple(scored), refused={**refused, **s.refused}, curves=curves, left=None
    )
    return replace(left, imitating=(*s.imitating, *gone))


def _late_or_slewed(
    problem: Problem, first: FilteredStates, one: Found, plain: Hypothesis
) -> tuple[Found, FilteredStates]:
    """A cause fitted to the end, with its refusal if thrusts whose rate is limited follow late better than by it, and its states.

    Args:
        problem: the log.
        first: states of the hypothesis with the cause.
        one: the cause.
        plain: the hypothesis without any cause.
    """
    states = improve(problem, first)
    if not lags(one.first):
        return one, states
    return replace(one, slewed=SLEWED.refuses(Slewed(one.fall, slewed(problem, states, one.first, plain)))), states


def _of_slow_force(fit: Fit, gone: Mapping[str, Scored], level: float) -> dict[str, Refusal]:
    """Refusals, by id, of causes that a slow force inside the declared ambient force explains as well.

    Args:
        fit: of the model without them.
        gone: their scores, by id.
        level: threshold of the log.
    """
    slow = slow_force(fit)
    if slow is None:
        return {}
    beside = {i: Slow(chance(replace(q, fall=slow.fall(q), boxed=0.0)), level) for i, q in gone.items()}
    said = {i: SLOW_FORCE.refuses(case) for i, case in beside.items()}
    return {i: r for i, r in said.items() if r is not None}


def _reviews(noise: Noise, last: Reviewed, passes: Threshold, plain: Fit, before: set[frozenset[str]]) -> Reviewed:
    """Reviews of the earlier causes until none changes or a set of causes comes back.

    Args:
        noise: filters and whitening.
        last: the causes, the newest last.
        passes: the test.
        plain: fit of the model without causes.
        before: sets of causes that were reviewed; those of this call join them.
    """
    refused: dict[str, Refusal] = {}
    for turn in range(REVIEWS if len(last.found) > 1 else 0):
        asked = len(last.found) if turn else len(last.found) - 1
        last = reviewed(Problem.at(noise, plain.fixed, last.states), last, asked, passes, plain.h)
        refused = {**last.refused, **refused}
        now = frozenset(f.id for f in last.found)
        if not last.changed or now in before:
            break
        before.add(now)
    return replace(last, refused=refused)


def _late(fit: Fit, screened: Screened, found: tuple[str, ...]) -> tuple[dict[str, Refusal], list[Scored]]:
    """Refusals by the rules on further causes, and the causes that keep those as well.

    Args:
        fit: of the model so far.
        screened: its causes.
        found: ids of the causes that were found.
    """
    if len(found) < min(USUAL, MOST) or not screened.passed:
        return {}, list(screened.passed)
    left = adequacy(fit)
    cases = [(s, Late(s, len(found), left.beside(fit, s.columns))) for s in screened.passed]
    said = {s.id: first_refusal(LATE, case, found) for s, case in cases}
    return {i: r for i, r in said.items() if r is not None}, [s for s in screened.passed if said[s.id] is None]


def in_place(first: Selection, other: Selection, barred: frozenset[str]) -> Selection:
    """A selection without some causes, each of which stands as an alternative beside the one that took its place; the first one if none did.

    Args:
        first: with them.
        other: without them.
        barred: their ids.
    """
    left = [f for f in first.found if f.id in barred]
    if not any(one.id in f.others for one in other.found for f in left) or not other.after.quiet:
        return first
    found = []
    for one in other.found:
        beside = [f for f in left if one.id in f.others]
        rivals = [
            replace(r, chi2=max(r.chi2, one.rivals[0].chi2), fall=min(r.fall, one.rivals[0].fall))
            for r in (f.rivals[0] for f in beside)
        ]
        known = {r.id for r in one.rivals}
        found.append(replace(one, rivals=(*one.rivals, *(r for r in rivals if r.id not in known))))
    return replace(other, found=tuple(found))
