"""Search for causes: the plain model fitted to a log, what is asked of it in processes beside, and the causes that the log names.

A model with causes may damp its turns within rows where the plain one does not: a late thrust looks like inertia. Then all of it is done again without yaw.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TypeAlias

from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import Channels, on_one_origin
from ivsid.diagnosis.data.one_run import one_run
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.learning import of_yaw, plain_fit, within_rows
from ivsid.diagnosis.null.detection import detection_limits
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.levels import NAMES
from ivsid.diagnosis.null.thresholds import Calibration, calibrate
from ivsid.diagnosis.null.visibility import Visibility, visibility
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.select import Selection, in_place, select
from ivsid.diagnosis.selection.shared_structure import with_other
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.statements.comparison import Gain
from ivsid.diagnosis.statements.findings import nameless
from ivsid.diagnosis.statements.motion import motion_of
from ivsid.diagnosis.statements.proved import Proof, proof_of, upheld
from ivsid.diagnosis.statements.trial import unchanged
from ivsid.errors import IvsidError
from ivsid.intervals.apart import Apart, in_turn
from ivsid.log import Log
from ivsid.setup import SetupFinding, examined
from ivsid.tubes.reached import TubeCheck
from ivsid.vehicle import Vehicle

# The other log, and the same if it is of another run.
Others: TypeAlias = "tuple[Channels, Channels | None]"


def fitted(
    vehicle: Vehicle, train: Log, test: Log, progress: Callable[[str], None]
) -> tuple[Channels, Channels | None, Fit, Proof, tuple[SetupFinding, ...]]:
    """The other log on its clock, the same if it is of another run, the vehicle file's model fitted to the first, and beside the fit what is proved of it, and doubts of the set-up.

    Raises:
        IvsidError: a wrong set-up that is beyond doubt, which comes before all other reasons and before any fit, or a log that no numbers follow.
    """
    examining = Apart(partial(examined, vehicle, (train, test)), begun=False)
    proving = Apart(partial(proof_of, vehicle, train), begun=False)
    in_turn(examining, proving)
    doubts: list[SetupFinding] = []

    def looked_for(fit: Fit) -> Fit:
        # A wrong set-up that is beyond doubt ends the work before any cause is looked for.
        doubts[:] = examining.result()
        return everything(fit)

    progress("fitting the model")
    try:
        log, other = on_one_origin(train, test, vehicle)
        fit = plain_fit(vehicle, log, looked_for)
        proof = upheld(proving.result(), running=fit.noise.predictor.log.running)
    except IvsidError:
        # Its sentence comes before one that follows from it.
        if not doubts:
            examining.result()
        raise
    finally:
        examining.end()
        proving.end()
    for one in doubts:
        progress(f"set-up: {one.sentence}")
    other = replace(other, running=fit.noise.predictor.log.running)
    # Samples of one run say nothing of one another.
    return other, None if one_run(train, test) else other, fit, proof, tuple(doubts)


@dataclass(frozen=True)
class Searched:
    """A plain fit, the causes found beside it, and what is asked of it meanwhile.

    Attributes:
        fit: the vehicle file's model.
        scored: the same with the columns of searched causes, and the scores of all.
        visible: effects that the log can show, by id.
        test: of the causes.
        selection: the causes.
        nothing: the gain if no cause is found.
        judging: adequacy of the model as it was.
        moving: the motion that it allows, or None: an adequate model is asked by its rows alone.
        limits: of detection.
    """

    fit: Fit
    scored: tuple[Fit, list[Scored]]
    visible: Mapping[str, Visibility]
    test: Threshold
    selection: Selection
    nothing: Apart[Gain]
    judging: Apart[Adequacy]
    moving: Apart[tuple[TubeCheck, ...] | None]
    limits: Apart[dict[str, Mapping[str, float]]]

    def end(self) -> None:
        """Ends what is asked meanwhile: another search stands."""
        for task in (self.nothing, self.judging, self.moving, self.limits):
            task.end()


def searched(
    fit: Fit, logs: tuple[Log, Log], others: Others, proof: Proof, seed: int, progress: Callable[[str], None]
) -> Searched:
    """The causes of what a plain model leaves, without yaw where the model with them damps its turns within rows of the log.

    A cause that acts by its moment alone shows in yaw or nowhere: where nothing is found without yaw, what is found with it stands.

    Args:
        fit: the vehicle file's model.
        logs: both, as they were read.
        others: the other log.
        proof: what is proved of the model.
        seed: of the random draws.
        progress: told of each step.
    """
    visible = visibility(fit)
    calibrating, nothing, judging, moving, limits = _asked_of(fit, visible, logs, others, proof, seed)
    scored = score(fit)
    test = Threshold(calibrating.result(), visible)
    progress("looking for causes")
    selection = named(fit, scored, test, others[1], progress)
    first = Searched(fit, scored, visible, test, selection, nothing, judging, moving, limits)
    if not (selection.found and within_rows(selection.last)):
        return first
    progress("looking again, without yaw: beside these causes its turns are over within rows of the log")
    predictor = fit.noise.predictor
    unseen = plain_fit(predictor.vehicle, predictor.log, everything, yaw=of_yaw(selection.last.states))
    again = searched(unseen, logs, others, proof, seed, progress)
    if again.selection.found:
        first.end()
        return again
    again.end()
    progress("looking further, with yaw: without it the log shows none of these causes")
    return replace(first, selection=named(fit, scored, test, others[1], progress, whole=True))


def _asked_of(
    fit: Fit, visible: Mapping[str, Visibility], logs: tuple[Log, Log], others: Others, proof: Proof, seed: int
) -> tuple[
    Apart[Calibration],
    Apart[Gain],
    Apart[Adequacy],
    Apart[tuple[TubeCheck, ...] | None],
    Apart[dict[str, Mapping[str, float]]],
]:
    """What is asked of the plain model, in a process beside the search for causes, in the order in which it is asked for.

    Returns:
        The test's calibration, the gain if no cause is found, the adequacy of the model as it was, the motion that it allows, and the limits of detection.
    """
    tested = frozenset(i for i, v in visible.items() if v.tested)
    # One process has both, so that the second knows what the first found.
    judged = cache(partial(_judged, fit, logs[1].name, *others))
    tasks = (
        Apart(partial(calibrate, fit, tested, NAMES, seed), begun=False),
        Apart(partial(unchanged, others[0], fit, seed), begun=False),
        Apart(judged, begun=False),
        Apart(partial(_moved, judged, proof, logs), begun=False, late=True),
    )
    in_turn(*tasks)
    # The limits are asked for last and by nothing else: they fill what the other processes leave of the processors from now on.
    return (*tasks, Apart(partial(detection_limits, fit), late=True))


def named(
    fit: Fit,
    scored: tuple[Fit, list[Scored]],
    test: Threshold,
    other: Channels | None,
    progress: Callable[[str], None],
    *,
    whole: bool = False,
) -> Selection:
    """The causes; one whose numbers may all be none, and that others came close to, makes place for them and stands beside.

    Args:
        fit: of the model without causes.
        scored: the same with the columns of searched causes, and the scores of all.
        test: of the causes.
        other: the log of another run, or None.
        progress: told of each step.
        whole: whether the search goes on where a model with causes damps its turns within rows.
    """
    selection = select(fit, scored, test, other, progress, whole=whole)
    barred = nameless(selection)
    if not barred or (not whole and within_rows(selection.last)):
        return selection
    progress("looking again, without causes whose numbers may all be none")
    again = select(fit, scored, replace(test, barred=barred), other, progress, whole=True)
    return in_place(selection, again, frozenset(barred))


def _moved(judged: Callable[[], Adequacy], proof: Proof, logs: tuple[Log, Log]) -> tuple[TubeCheck, ...] | None:
    """The motion that the model as it was allows, or None: an adequate model is asked by its rows alone."""
    return None if judged().quiet else motion_of(proof, *logs)


def _judged(fit: Fit, name: str, other: Channels, run: Channels | None) -> Adequacy:
    """Adequacy of the model as it was, beside what the other log says of it."""
    before = adequacy(fit)
    again = cache(lambda: adequacy(plain_fit(fit.noise.predictor.vehicle, other, everything)))
    if before.strained:
        # What is no more than chance on one log need not be on both.
        with suppress(IvsidError):
            before = before.with_thrusts_of(again(), name)
    return before if run is None else with_other(before, fit, run, name, again)
