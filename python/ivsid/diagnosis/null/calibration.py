"""Stage 5 once more, for what is close: the largest score of every null log, refitted, and the threshold that follows."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import score
from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, Noise, survey
from ivsid.diagnosis.estimation.learning import remaining
from ivsid.diagnosis.estimation.noise import ambient_of, usable_rows
from ivsid.diagnosis.estimation.whitening import Whitening, plain_scale, whiten
from ivsid.diagnosis.null.feedback import feedback_of
from ivsid.diagnosis.null.null_logs import Programme, null_logs, thinned
from ivsid.diagnosis.null.visibility import Threshold
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor

Array = NDArray[np.float64]
# Null logs of the first look, and those that the noise is learnt from.
FEW: Final = 20
LEARN: Final = 2
APART: Final = 1_000_000
# Logs that are stepped together: enough to share the steps, few enough for the memory.
TOGETHER: Final = 40
# Of the few logs the tail starts at their middle, of many at their last tenth.
MANY: Final = 100
# Standard deviations that a threshold from few logs may be off.
UNSURE: Final = 2.0
# More than this share of lost motions, and null logs say nothing.
MOST_LOST: Final = 0.2


@dataclass(frozen=True)
class NullTest:
    """What null logs say of the test.

    Attributes:
        strengths: minus the logarithm of the smallest chance over all families, of each null log; NaN where the motion was lost.
        passed: whether a family of it passed the whole test, at the threshold of the Gaussian draws.
        level: of the test.
        cached: how many of them were made before.
        first: the chance that the Gaussian draws allow.
    """

    strengths: Array
    passed: NDArray[np.bool_]
    level: float
    cached: int = 0
    first: float = 1.0

    def joined(self, more: NullTest) -> NullTest:
        """With further logs."""
        return replace(self, strengths=np.r_[self.strengths, more.strengths], passed=np.r_[self.passed, more.passed])

    def first_of(self, count: int) -> NullTest:
        """The first so many."""
        return replace(self, strengths=self.strengths[:count], passed=self.passed[:count])

    @property
    def kept(self) -> Array:
        """Strengths of the logs that stayed near the programme."""
        return self.strengths[np.isfinite(self.strengths)]

    @property
    def usable(self) -> bool:
        """Whether enough logs are left to say anything."""
        return self.kept.size >= max(10, (1 - MOST_LOST) * self.strengths.size)

    def threshold(self, sigmas: float = 0.0) -> float:
        """Strength that a null log passes with the probability of the level, by an exponential tail; ``sigmas`` to the safe side."""
        x = self.kept
        share = 0.1 if x.size >= MANY else 0.5
        start = float(np.quantile(x, 1 - share))
        excess = x[x >= start] - start
        slope = max(float(excess.mean()), 1.0)
        slope *= 1.0 + sigmas / np.sqrt(max(excess.size, 1))
        return float(start + slope * np.log(share / self.level))

    def record(self) -> dict[str, object]:
        """As in result.json."""
        return {
            "logs": int(self.kept.size),
            "lost": int(self.strengths.size - self.kept.size),
            "achieved": float(self.passed.sum() / max(self.kept.size, 1)),
            "threshold": float(np.exp(-self.threshold())) if self.usable else None,
            "cached": self.cached,
        }


# Rounds of filtering until the states are those of the hypothesis: after two a delay seemed to be there, after four nothing changes.
SETTLED: Final = 6


@dataclass(frozen=True)
class Trial:
    """Null logs of a fit, and how each is examined."""

    programme: Programme
    filters: Ambient
    whitening: Whitening
    left_out: frozenset[int]
    fixed: dict[str, float]
    test: Threshold

    def strengths(self, seed: int, numbers: Sequence[int]) -> list[tuple[float, bool]]:
        """The largest strength of each null log, and whether it passed the test."""
        return [
            (float("nan"), False) if made is None else self._one(*made)
            for made in null_logs(self.programme, seed, numbers)
        ]

    def _one(self, log: Channels, h: Hypothesis) -> tuple[float, bool]:
        try:
            fit = surveyed(self, log, h, self.whitening)
        except (np.linalg.LinAlgError, ValueError):
            return float("nan"), False
        families = tuple(f for f in fit.families if f.variants and f.id in self.test.visible)
        fit, scored = score(replace(fit, families=families))
        chances = [s.chance for s in scored if s.physical]
        strength = -float(np.log(max(min(chances, default=1.0), 1e-300)))
        return strength, bool(self.test(fit, scored))


def surveyed(trial: Trial, log: Channels, h: Hypothesis, whitening: Whitening | None) -> Fit:
    """The plain model on a null log with the signatures of what is tested, about its true numbers: the fit is linear there."""
    p = trial.programme
    predictor = Predictor(p.vehicle, log, trial.filters)
    # States that start from noisy readings take some rounds to forget them.
    states = predictor.settle(h, predictor.start(h), SETTLED)
    good = usable_rows(predictor)
    white = whitening or plain_scale(predictor.errors(h, states), good, predictor, trial.left_out)
    return survey(Noise(predictor, white, good, trial.left_out), h, states, trial.fixed, trial.test.visible)


def trial_of(fit: Fit, test: Threshold, seed: int) -> Trial:
    """How null logs of a fitted model are made and examined; their noise is learnt from the first two as a log's is."""
    predictor, log = fit.noise.predictor, fit.noise.predictor.log
    g = fit.gram
    declared_errors = {
        n: float(1.0 / np.sqrt(g.prior[k]) / g.unit[k]) for k, n in enumerate(g.names) if g.prior[k] > 0 and n[0] == "~"
    }
    thin, q = thinned(log)
    back = feedback_of(log, fit.states, predictor.axes[2].spread)
    n = log.n
    heading = np.zeros(n) if log.psi is None else fit.states.points.psi[:n]
    felt = np.concatenate([fit.states.points.nu[:, :n], heading[None]])
    if back.reads:
        felt = np.concatenate([log.nu, (heading if log.psi is None else log.psi)[None]])
    # On a slower clock what is sent is a mean, and so is what it answers to.
    reference = felt[:, : thin.n * q].reshape(4, thin.n, q).mean(axis=2) if log.held else felt[:, : thin.n * q : q]
    programme = Programme(
        predictor.vehicle,
        thin,
        replace(fit.h, declared_errors={}),
        ambient_of(predictor, remaining(fit), fit.noise.good),
        declared_errors,
        fit.states.points.nu[:, 0],
        replace(back, at=back.at[:, : thin.n * q : q]),
        reference,
    )
    trial = Trial(programme, predictor.ambient, fit.noise.whitening, fit.noise.left_out, dict(fit.fixed), test)
    fits = [
        surveyed(trial, *made, None)
        for made in null_logs(programme, seed, range(APART, APART + LEARN))
        if made is not None
    ]
    if not fits:
        return trial
    left = np.concatenate([remaining(f) for f in fits], axis=1)
    good = np.concatenate([f.noise.good for f in fits])
    return replace(trial, whitening=whiten(fits[0].noise.predictor, left, good, fit.noise.left_out))


def examined(trial: Trial, seed: int, numbers: Sequence[int], told: Callable[[int], None] = lambda _: None) -> NullTest:
    """Null logs by number, on all cores."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    size = min(TOGETHER, max(1, -(-len(numbers) // cores)))
    parts = [numbers[k : k + size] for k in range(0, len(numbers), size)]
    found: dict[int, list[tuple[float, bool]]] = {}
    if cores > 1 and len(parts) > 1 and "fork" in multiprocessing.get_all_start_methods():
        for k, done in _forked(trial, seed, parts, cores):
            found[k] = done
            told(sum(map(len, found.values())))
    for k, part in enumerate(parts):
        # What no other process could do is done here.
        if k not in found:
            found[k] = trial.strengths(seed, part)
            told(sum(map(len, found.values())))
    every = [one for k in range(len(parts)) for one in found[k]]
    passed = np.array([p for _, p in every], dtype=bool)
    return NullTest(np.array([s for s, _ in every]), passed, trial.test.calibration.level)


def _forked(
    trial: Trial, seed: int, parts: Sequence[Sequence[int]], cores: int
) -> Iterator[tuple[int, list[tuple[float, bool]]]]:
    """Parts of the numbers on forked processes, as they are done; a term's function goes to a copy of this process, and to no other."""
    context = multiprocessing.get_context("fork")
    readers: list[Connection] = []
    workers = []
    for w in range(min(cores, len(parts))):
        reader, writer = context.Pipe(duplex=False)
        mine = list(range(w, len(parts), cores))
        worker = context.Process(target=_work, args=(trial, seed, parts, mine, writer), daemon=True)
        worker.start()
        writer.close()
        readers.append(reader)
        workers.append(worker)
    try:
        while readers:
            ready = wait(readers)
            for reader in [q for q in readers if q in ready]:
                try:
                    yield reader.recv()
                except EOFError:
                    readers.remove(reader)
    finally:
        for worker in workers:
            worker.terminate()
            worker.join()


def _work(trial: Trial, seed: int, parts: Sequence[Sequence[int]], mine: Sequence[int], writer: Connection) -> None:
    for k in mine:
        writer.send((k, trial.strengths(seed, parts[k])))
    writer.close()
