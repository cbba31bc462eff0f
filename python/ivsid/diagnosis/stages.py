"""Stages of a diagnosis in turn: from two logs and a vehicle file to the causes, their proofs and the gain of the extended model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from ivsid.diagnosis.data.one_run import note
from ivsid.diagnosis.null.looks import Looks
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.null.visibility import Visibility
from ivsid.diagnosis.search import fitted, named, searched
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.confirmation import (
    NULL_LOGS,
    StructureConfirmation,
    beyond_doubt,
    confirmed,
    confirmed_structure,
)
from ivsid.diagnosis.selection.parallel import one_blas_thread
from ivsid.diagnosis.selection.rivals import Found
from ivsid.diagnosis.selection.rules import full_refused
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.selection.verdict import Left
from ivsid.diagnosis.statements.carried import failure, in_their_place
from ivsid.diagnosis.statements.claims import claims
from ivsid.diagnosis.statements.comparison import Gain
from ivsid.diagnosis.statements.diagnosis import Diagnosis, inputs_of
from ivsid.diagnosis.statements.findings import Finding, findings_of, shallow, verdict_of, weighed
from ivsid.diagnosis.statements.hints import hints
from ivsid.diagnosis.statements.motion import motion_of, sentences
from ivsid.diagnosis.statements.not_tested import left_out_note, not_tested
from ivsid.diagnosis.statements.proved import Proof, lasting, proved_findings
from ivsid.diagnosis.statements.residuals import before_and_after, unexplained
from ivsid.diagnosis.statements.rules import DOMINANT_RULE
from ivsid.diagnosis.statements.shallow_water import change, sounded
from ivsid.diagnosis.statements.trial import Trial
from ivsid.diagnosis.statements.unknown import unknown
from ivsid.diagnosis.statements.without import handed_out
from ivsid.intervals.apart import Apart
from ivsid.log import GivenLog, Log, log_of
from ivsid.tubes.reached import TubeCheck
from ivsid.vehicle import GivenVehicle, Vehicle, vehicle_of


# A candidate that runs away is rejected by its chi-squared, so its overflows are not reported.
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
@one_blas_thread
def diagnose(
    vehicle: GivenVehicle,
    train: GivenLog,
    test: GivenLog,
    *,
    seed: int = 1,
    progress: Callable[[str], None] = lambda _: None,
    null_logs: int = NULL_LOGS,
    cache: Path | None = None,
    tried: Callable[[Gain], None] = lambda _: None,
) -> Diagnosis:
    """Diagnosis of a vehicle file's model by two logs.

    Args:
        vehicle: whose ``[model]`` is diagnosed; the plain model by default. A checked vehicle, the path of its file, or a shipped one's name.
        train: log in which causes are looked for. A checked log, its path, or a table in memory.
        test: another log, which is asked of the causes that the first one shows, and on which the gain of the extended model is measured.
        seed: of the random draws.
        progress: told of each step.
        null_logs: largest number of null logs that a finding or structure close to its threshold has to pass; 0 leaves it to theory.
        cache: folder in which scores of null logs are kept, or None.
        tried: told of the gain on the other log while statements are made, and of another one if findings are withdrawn; the last one is the result's.

    Raises:
        IvsidError: a log that the model cannot be diagnosed with, or a wrong set-up that is beyond doubt, in one sentence.

    Source: docs/theory.md, "Diagnosis".
    """
    vehicle = vehicle_of(vehicle)
    train, test = log_of(train, vehicle.log), log_of(test, vehicle.log)
    other, run, fit, proof, doubts = fitted(vehicle, train, test, progress)
    search = searched(fit, (train, test), (other, run), proof, seed, progress)
    fit, selection, judging, visible = search.fit, search.selection, search.judging, search.visible
    looks = Looks(seed, null_logs, cache, progress)
    passed = _undecided(selection, judging)
    # A sufficient model is asked for its motion only where causes are named, and null logs leave time for it meanwhile.
    moving = Apart(
        partial(motion_of, proof, train, test),
        late=True,
        begun=bool(selection.found) and judging.result().quiet,
    )
    confirmation = confirmed(fit, search.test, passed, looks, selection.last)
    if confirmation.stricter and any(full_refused(confirmation.test, f.first, f.fall) for f in passed):
        progress("looking again, at the threshold of the null logs")
        selection = named(fit, search.scored, confirmation.test, run, progress, whole=True)
    # Most findings stand, so their model is tried while they are examined, and the other log is asked of its water.
    trial = Trial(other, selection, seed, tried, search.nothing)
    shoaling = Apart(partial(change, selection.last, other, sounded(train, test)))
    trial.look()
    before = judging.result()
    rest, structure = _left(selection, before, search.test.visible, looks)
    complete = _complete(rest, proof, vehicle, train)
    findings, withdrawn = findings_of(
        selection,
        before_and_after(vehicle, train, fit, selection.last) if selection.found else {},
        rest.after,
        complete=complete,
        louder=rest.louder,
    )
    trial = trial.of({f.effect for f in findings})
    faint = _not_dominant(selection, withdrawn) if complete else ()
    if complete and trial.out:
        # The verdict is on the model that is handed out, which leaves what the others took.
        after = adequacy(handed_out(fit, selection.last, trial.out))
        rest = replace(
            rest,
            after=replace(after, risk=structure.risk),
            findings=len(findings),
            imitated=(*rest.imitated, *(f.fall for f in faint)),
        )
        complete = _complete(rest, proof, vehicle, train)
    trial.look()
    proved, extended = (
        proved_findings(findings, vehicle, train, trial.model, running=fit.noise.predictor.log.running)
        if complete
        else (findings, None)
    )
    progress("trying both models on the other log")
    water = shoaling.result()
    gain, shown = trial.result()
    # What the first log leaves unexplained may move all of its parameters together.
    shoal = water if complete and water is not None and water.factor is not None else None
    # Masses that differ between the logs are a reason to fail on the other one.
    if shoal is None and (refusal := failure(gain, findings, trial.with_thrusts, complete=complete)) is not None:
        withdrawn = {**withdrawn, **{i: refusal for f in findings for i in (f.effect, *f.alternatives)}}
        extended = None
        rest, complete, findings = _refuted(findings, gain, selection, rest, (proof, vehicle, train), complete=complete)
        trial = trial.of(())
        gain, shown = trial.result()
    else:
        findings = (
            proved
            if complete
            else (
                *findings,
                unknown(
                    rest.after,
                    trial.out,
                    proved=proof.sentence("unknown") if rest.sufficient else "",
                    imitated=_no_findings(selection.imitating, selection.refused),
                    faint=_no_findings(faint, withdrawn),
                ),
            )
        )
    # The last fit holds causes that the other log refutes, and what they took is none of the claims' own.
    alone = rest.after.certain and complete == rest.sufficient and not (selection.found and rest.after is rest.before)
    claimed = claims(selection.last, selection.leftover, findings, unknown=None if alone else rest.after)
    visible = _limited(visible, search.limits.result())
    motion = _allowed(search.moving.result(), moving, findings)
    findings = weighed(findings if shoal is None else (*findings, shallow(shoal)), shown)
    verdict = verdict_of(findings)
    said = [
        n
        for n in (
            note(train, test),
            confirmation.note,
            structure.note,
            proof.sentence(verdict) if proof.refuted and complete == rest.sufficient else "",
            *sentences(motion, train.name, test.name),
        )
        if n
    ]
    return Diagnosis(
        verdict,
        findings,
        hints(selection.last),
        not_tested(fit, visible, {n for f in findings for n in (f.effect, *f.alternatives)}),
        visible,
        {**confirmation.record(), "structure": structure.record()},
        unexplained(selection.last),
        gain,
        (rest.before, rest.after),
        selection,
        trial.model,
        vehicle,
        inputs_of(vehicle, train, test),
        seed,
        (proof, extended),
        motion,
        (*fit.noise.predictor.log.notes, *train.notes, *left_out_note(fit), *said),
        claimed,
        withdrawn,
        water,
        doubts,
        trial.beside,
    )


def _rest(selection: Selection, before: Adequacy) -> Left:
    """What the model with all causes leaves beside what the plain one does."""
    after = selection.after if selection.found else before
    return Left(after, before, len(selection.found), bool(selection.plain.noise.left_out))


def _not_dominant(selection: Selection, withdrawn: Mapping[str, Refusal]) -> tuple[Found, ...]:
    """Causes that passed every test and do not dominate what is left."""
    rule = DOMINANT_RULE.name
    return tuple(f for f in selection.found if f.id in withdrawn and withdrawn[f.id].rule == rule)


def _no_findings(causes: Sequence[Found], refused: Mapping[str, Refusal]) -> dict[str, float]:
    """Why causes that passed every test are no findings, a clause each that begins with the cause, with their falls of chi-squared."""
    return {f"{f.id}: {refused[f.id].sentence}": f.fall for f in causes}


def _undecided(selection: Selection, judging: Apart[Adequacy]) -> tuple[Found, ...]:
    """Causes that passed and on which the verdict depends: beside structure beyond doubt it is unknown, and only strong ones keep their name."""
    passed = (*selection.found, *selection.imitating)
    if not passed or not beyond_doubt(rest := _rest(selection, judging.result())):
        return passed
    kept, _ = findings_of(selection, {}, rest.after, complete=False)
    return tuple(f for f in selection.found if f.id in {q.effect for q in kept})


def _left(
    selection: Selection, before: Adequacy, visible: frozenset[str], looks: Looks
) -> tuple[Left, StructureConfirmation]:
    """What the model with all causes leaves, with the risk that null logs confirm, and their confirmation.

    Args:
        selection: with the causes.
        before: adequacy of the plain model.
        visible: ids of the effects that the log can show.
        looks: null logs that may be looked at.
    """
    rest = _rest(selection, before)
    structure = confirmed_structure(selection.last, visible, rest, looks)
    before, after = (replace(a, risk=structure.risk) for a in (before, rest.after))
    imitated = tuple(f.fall for f in selection.imitating)
    return replace(rest, after=after, before=before, imitated=imitated), structure


def _allowed(
    motion: tuple[TubeCheck, ...] | None, moving: Apart[tuple[TubeCheck, ...]], findings: tuple[Finding, ...]
) -> tuple[TubeCheck, ...]:
    """The motion that the model allows, which of a sufficient model is asked for beside findings alone."""
    if motion is None:
        motion = moving.result() if findings else ()
    moving.end()
    return motion


def _refuted(
    findings: tuple[Finding, ...],
    gain: Gain,
    selection: Selection,
    rest: Left,
    log: tuple[Proof, Vehicle, Log],
    *,
    complete: bool,
) -> tuple[Left, bool, tuple[Finding, ...]]:
    """What is left, whether that is little enough, and the findings, where the other log refutes all causes."""
    bare = replace(rest, after=rest.before, findings=0)
    if _complete(bare, *log):
        # Causes that the first log does not ask for and the other one refutes are nothing.
        return bare, True, ()
    one = in_their_place(gain, findings, rest.after, [f.id for f in selection.found], complete=complete)
    return rest, complete, (one,)


def _complete(left: Left, proof: Proof, vehicle: Vehicle, train: Log) -> bool:
    """Whether little enough structure is left for a verdict, by the statistics and by what the rows of the log prove."""
    return left.sufficient and replace(left, wider=lasting(proof, vehicle, train)).sufficient


def _limited(visible: Mapping[str, Visibility], least: Mapping[str, Mapping[str, float]]) -> dict[str, Visibility]:
    """Effects with their detection limits beside the worst thrust curve, where those are known."""
    return {i: replace(v, detectable=least.get(i, v.detectable)) for i, v in visible.items()}
