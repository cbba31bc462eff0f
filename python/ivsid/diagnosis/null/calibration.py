"""Parametric bootstrap of the largest score: null logs are simulated, examined like the log, and give the threshold of a finding or of structure.

Null logs are examined on all processors, in forked processes, until those that are done decide.

Source: Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, section 6.5.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.learning import remaining
from ivsid.diagnosis.estimation.noise import Noise, ambient_of, usable_rows
from ivsid.diagnosis.estimation.whitening import Whitening, plain_scale, whiten
from ivsid.diagnosis.null.closed_loop import Programme
from ivsid.diagnosis.null.examination import Examination
from ivsid.diagnosis.null.feedback import feedback_of
from ivsid.diagnosis.null.simulated_logs import null_logs, thinned
from ivsid.diagnosis.null.tail import NullTest, null_test
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.axes import motion_axes, track_axes
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.kalman import Axis
from ivsid.intervals.apart import end_with_parent

Array = NDArray[np.float64]
# Numbers of null logs after which their scores may decide; all of them are examined only where these leave doubt.
# Source: resource: each look costs about twice as much as those before it
LOOKS: Final = (20, 50, 100, 200)
# Null logs from which the whitening is learnt.
# Source: resource: each takes as long as a null log that is examined
LEARN: Final = 2
# First number of the null logs from which the whitening is learnt: none of them is examined.
# Source: definition: beyond any number of an examined log
APART: Final = 1_000_000
# Null logs that are simulated together share the steps of the integration.
# Source: resource: 0.6 GB a process for logs of 600 s at 20 Hz
TOGETHER: Final = 200
# Rounds of filtering until the states are those of the hypothesis: after two rounds a delay seemed to be there, after four nothing changes.
# Source: measured: make constants
SETTLED: Final = 6


@dataclass(frozen=True)
class Trial:
    """The null logs of a fit, and their examination.

    Attributes:
        programme: from which they are simulated.
        noise: of the log: null logs have its ambient force, its axes that are left out, and its whitening where they teach none.
        axes: the filters: all null logs have the same clock and the same noise.
        fixed: parameters that are not fitted, with their values.
        library: ids of the effects whose signatures are taken out of the errors from which the whitening is learnt.
        examination: what is asked of each.
    """

    programme: Programme
    noise: Noise
    axes: tuple[Axis, ...]
    fixed: Mapping[str, float]
    library: frozenset[str]
    examination: Examination

    def strengths(self, seed: int, parts: Iterable[Sequence[int]]) -> Iterator[tuple[float, bool]]:
        """The largest strength of each null log, and whether it passed the threshold of theory, in the order of the numbers.

        Args:
            seed: of the draws.
            parts: numbers of the null logs; those of a part are simulated together.
        """
        whitening: Whitening | None = None
        for numbers in parts:
            # The null logs that teach the whitening are simulated with the first: the steps of the integration cost the same for all.
            learn = range(APART, APART + (LEARN if whitening is None else 0))
            made = null_logs(self.programme, seed, [*learn, *numbers])
            taught, asked = made[: len(learn)], made[len(learn) :]
            if whitening is None:
                whitening = self._learnt([one for one in taught if one is not None])
            for one in asked:
                yield (float("nan"), False) if one is None else self._one(*one, whitening)

    def _learnt(self, made: Sequence[tuple[Channels, Hypothesis]]) -> Whitening:
        """The whitening that null logs teach as the log did."""
        fits = [surveyed(self, *one, None, self.library) for one in made]
        if not fits:
            return self.noise.whitening
        left = np.concatenate([remaining(f) for f in fits], axis=1)
        good = np.concatenate([f.noise.good for f in fits])
        return whiten(fits[0].noise.predictor, left, good, self.noise.left_out)

    def _one(self, log: Channels, h: Hypothesis, whitening: Whitening) -> tuple[float, bool]:
        """Strength of one null log, and whether it passed the threshold of theory; NaN if it cannot be fitted."""
        try:
            fit = surveyed(self, log, h, whitening, self.examination.surveyed)
        except (np.linalg.LinAlgError, ValueError):
            return float("nan"), False
        return self.examination(fit)


def surveyed(trial: Trial, log: Channels, h: Hypothesis, whitening: Whitening | None, only: frozenset[str]) -> Fit:
    """The model on a null log, with the signatures of some effects.

    The fit is one linear step from the true parameters, which are known.

    Args:
        trial: of the null logs.
        log: a null log.
        h: the hypothesis that is true of it.
        whitening: of the innovations; None takes the robust size of each.
        only: ids of the effects whose signatures are made.
    """
    p = trial.programme
    predictor = Predictor(
        p.vehicle, log, trial.noise.predictor.ambient, axes=trial.axes, turning=not trial.noise.left_out
    )
    # Filtered states forget the noisy readings from which they start within some rounds.
    states = predictor.settle(predictor.start(h), SETTLED)
    good, left_out = usable_rows(predictor), trial.noise.left_out
    white = whitening or plain_scale(predictor.errors(states), good, predictor, left_out)
    return survey(Noise(predictor, white, good, left_out), states, trial.fixed, only)


def trial_of(fit: Fit, library: frozenset[str], examination: Examination) -> Trial:
    """The null logs of a fitted model, with a whitening that is learnt from two of them as from a log.

    Args:
        fit: of the model to the log.
        library: ids of the effects whose signatures are taken out of the errors from which the whitening is learnt.
        examination: what is asked of each null log.
    """
    predictor, log = fit.noise.predictor, fit.noise.predictor.log
    g = fit.gram
    declared_errors = {
        n: float(1.0 / np.sqrt(g.prior[k]) / g.unit[k]) for k, n in enumerate(g.names) if g.prior[k] > 0 and n[0] == "~"
    }
    thin, q = thinned(log, predictor.vehicle)
    back = feedback_of(log, fit.states, predictor.axes[2].spread)
    n = log.n
    heading = np.zeros(n) if log.psi is None else fit.states.points.psi[:n]
    felt = np.concatenate([fit.states.points.nu[:, :n], heading[None]])
    if back.reads:
        felt = np.concatenate([log.nu, (heading if log.psi is None else log.psi)[None]])
    # On a slower clock a command under a zero-order hold is a mean, and so is the motion to which it answers.
    reference = felt[:, : thin.n * q].reshape(4, thin.n, q).mean(axis=2) if log.held else felt[:, : thin.n * q : q]
    programme = Programme(
        predictor.vehicle,
        thin,
        replace(fit.h, declared_errors={}),
        ambient_of(predictor, remaining(fit), fit.noise.good, fit.h.values),
        declared_errors,
        fit.states.points.nu[:, 0],
        replace(back, at=back.at[:, : thin.n * q : q]),
        reference,
        thinned=thin is not log,
    )
    axes = (*motion_axes(thin, predictor.ambient), *track_axes(thin))
    return Trial(programme, fit.noise, axes, fit.fixed, library, examination)


def examined(trial: Trial, seed: int, numbers: Sequence[int], told: Callable[[int], None] = lambda _: None) -> NullTest:
    """Scores of null logs by number, on all processors.

    Args:
        trial: of the null logs.
        seed: of the draws.
        numbers: of the null logs.
        told: called with the number of null logs that are done.
    """
    every = []
    for one in scores(trial, seed, numbers):
        every.append(one)
        told(len(every))
    return null_test(every, trial.examination.level)


def scores(trial: Trial, seed: int, numbers: Sequence[int]) -> Generator[tuple[float, bool]]:
    """Scores of null logs in the order of their numbers, each as soon as it is there; processes end when nobody asks for more.

    The scores do not depend on the number of processors.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    cores = min(cores, len(numbers))
    if cores < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from _in_parts(trial, seed, numbers)
        return
    context = multiprocessing.get_context("fork")
    workers: list[BaseProcess] = []
    found = []
    try:
        # A term's function cannot be pickled, so processes are copies of this one.
        for w in range(cores):
            reader, writer = context.Pipe(duplex=False)
            mine = numbers[w::cores]
            worker = context.Process(target=_work, args=(trial, seed, mine, writer), daemon=True)
            worker.start()
            writer.close()
            workers.append(worker)
            found.append(_received(reader, trial, seed, mine))
        for k in range(len(numbers)):
            yield next(found[k % cores])
    finally:
        for started in workers:
            started.terminate()
            started.join()


def _in_parts(trial: Trial, seed: int, numbers: Sequence[int]) -> Iterator[tuple[float, bool]]:
    """Scores of null logs, of which some are simulated together: first as many as few findings ask for, since a step costs the same for all."""
    edges = [0, *range(LOOKS[1], len(numbers), TOGETHER), len(numbers)]
    yield from trial.strengths(seed, [numbers[first:end] for first, end in pairwise(edges)])


def _received(reader: Connection, trial: Trial, seed: int, mine: Sequence[int]) -> Iterator[tuple[float, bool]]:
    """Scores that another process sends; those that it did not come to are worked out here."""
    for k in range(len(mine)):
        try:
            yield reader.recv()
        except EOFError:
            yield from _in_parts(trial, seed, mine[k:])
            return


def _work(trial: Trial, seed: int, mine: Sequence[int], writer: Connection) -> None:
    """Work of one process: the scores of its null logs in turn."""
    # A collection would write to every object of the parent, and so copy all of its memory.
    gc.freeze()
    end_with_parent()
    for one in _in_parts(trial, seed, mine):
        writer.send(one)
    writer.close()
