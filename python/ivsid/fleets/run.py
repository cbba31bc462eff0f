"""A fleet in its steps: each log by itself, what all say together, what changed between them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from functools import lru_cache
from importlib.metadata import version
from os import PathLike, fspath
from typing import Final

import numpy as np

from ivsid.diagnosis import NULL_LOGS
from ivsid.effects import Term, own_files, terms_of
from ivsid.errors import IvsidError
from ivsid.fleets.consistency import Model, Pooled, pooled
from ivsid.fleets.crew import Crew, LostError, crew_of
from ivsid.fleets.drift import MOST_PAIRS, Drift, Logs, drift
from ivsid.fleets.finished import Finished
from ivsid.fleets.log_rows import of_certificates
from ivsid.fleets.one_log import Options, Outcome, Settings, certificates_of, diagnosed, identified, rows_of, scanned
from ivsid.fleets.places import Place, below, check, logs_of
from ivsid.fleets.result import Entry, Fleet, Traffic
from ivsid.fleets.scan import Question, Violated, together
from ivsid.fleets.working_set import linked
from ivsid.linear.spread import Client
from ivsid.rows import WINDOW
from ivsid.vehicle import GivenVehicle, Vehicle, vehicle_of
from ivsid.verification.result import Stored

# Logs whose rows one task holds and scans. It does not depend on the number of workers, so that results do not.
# Source: resource: tasks at the scheduler, an eighth of the logs, and memory of a worker for the rows of eight logs
BATCH: Final = 8
# Logs whose certificates are kept in memory.
# Source: resource: a thousand files of about 10 kB
KEPT: Final = 1000
# Probability that all sensor bounds hold at once below which nothing that rests on all of them is called guaranteed.
# Source: definition: more likely than not
LIKELY: Final = 0.5


def fleet(
    logs: str | PathLike[str] | Sequence[str | PathLike[str]],
    vehicle: GivenVehicle,
    out: str | PathLike[str],
    *,
    scheduler: str | Client | None = None,
    workers: int | None = None,
    diagnose: bool = True,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    seed: int = 1,
    null_logs: int = NULL_LOGS,
    pairs: int = MOST_PAIRS,
    progress: Callable[[str], None] = lambda _: None,
) -> Fleet:
    """What the logs of a vehicle say, one by one and together.

    Each log is identified and diagnosed by itself. Then the parameters that are consistent with all rows of all logs are enclosed, and what
    must have changed between the logs is proved. Finished logs are kept in ``out`` and not done again. The accelerometer's bias is bounded at every
    sample: as one unknown of a log it would be an unknown for each log.

    Args:
        logs: paths, folders, patterns, or URLs of an object store.
        vehicle: a checked vehicle, the path of its file, or the name of a shipped one.
        out: folder or URL, in which finished logs are kept under ``done``.
        scheduler: address or client of a cluster of Dask; None for a local cluster that is started and ended here.
        workers: number of local processes; 0 for this process alone.
        diagnose: whether each log is diagnosed, tried on the next one by date.
        form: as for ``identify``.
        rows: as for ``identify``.
        window: as for ``identify``.
        seed: of the diagnoses.
        null_logs: of the diagnoses, as for ``diagnose``.
        pairs: largest number of pairs of logs that are held against each other on all of their rows, where logs contradict each other.
        progress: told of each step.

    Raises:
        IvsidError: no log, an unusable vehicle file or folder, or a missing package, in one sentence.

    Source: docs/theory.md, "Many logs".
    """
    given = [fspath(x) for x in ([logs] if isinstance(logs, str | PathLike) else logs)]
    folder = fspath(out)
    checked = vehicle_of(vehicle)
    if own_files():
        raise IvsidError(
            "effects of your own do not reach the workers of a fleet; leave out --own-effects, and use ivsid diagnose on single logs"
        )
    terms = terms_of(checked, form)
    check(folder)
    places = logs_of(given)
    options: Options = {
        "form": form,
        "rows": rows,
        "window": window if isinstance(window, float | int) else list(window),
    }
    settings = Settings(
        checked.text,
        checked.source or "vehicle.toml",
        options,
        {"seed": seed, "null_logs": null_logs} if diagnose else None,
        Finished(below(folder, "done")),
        version("ivsid"),
    )
    clock = _Clock()
    with crew_of(scheduler, workers) as crew:
        with clock.step("identify"):
            outcomes = _all(
                crew, identified, [(p, settings) for p in places], [p.name for p in places], "identifying", progress
            )
        entries = [Entry(p, o) for p, o in zip(places, outcomes, strict=True)]
        order, dated = _order(entries)
        if diagnose:
            with clock.step("diagnose"):
                entries = _with_diagnoses(entries, crew, settings, progress)
        found, drifted, traffic = None, None, Traffic()
        proofs: dict[int, Sequence[Stored]] = {}
        if order:
            found, drifted, traffic, proofs = _together(entries, order, terms, crew, settings, clock, pairs, progress)
    assumes, joint = _assumptions(entries, order, checked)
    proved = found is not None and found.solved.status in ("enclosed", "empty", "unbounded")
    sure = proved and all(entries[k].record["guaranteed"] for k in order) and joint is not None and joint >= LIKELY
    said = {**options, "bias": "sample", "diagnose": diagnose, "seed": seed, "null_logs": null_logs, "pairs": pairs}
    return Fleet(
        checked,
        tuple(entries),
        order,
        dated,
        tuple(terms),
        found,
        drifted,
        assumes,
        sure,
        joint,
        said,
        Traffic(traffic.passes, traffic.sent, traffic.received, traffic.rows, clock.seconds),
        proofs,
    )


class _Clock:
    """Time of each step [s]."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        begin = time.monotonic()
        yield
        self.seconds[name] = time.monotonic() - begin


def _all(
    crew: Crew,
    task: Callable[..., Outcome],
    inputs: Sequence[tuple[object, ...]],
    names: Sequence[str],
    word: str,
    progress: Callable[[str], None],
) -> list[Outcome]:
    """The outcomes of a task in the order of the inputs, whatever the order in which they come."""
    found: dict[int, Outcome] = {}
    progress(f"{word} 0 of {len(inputs)}")
    for k, outcome in crew.each(task, inputs):
        found[k] = Outcome(None, str(outcome), False, 0, 0.0) if isinstance(outcome, LostError) else outcome
        progress(f"{word} {len(found)} of {len(inputs)}: {names[k]}")
    return [found[k] for k in range(len(inputs))]


def _order(entries: Sequence[Entry]) -> tuple[tuple[int, ...], bool]:
    """The logs that hold in themselves by date, or by name where one has no date."""
    usable = [k for k, e in enumerate(entries) if e.usable]
    dated = all(entries[k].record["began"] is not None for k in usable)

    def when(k: int) -> tuple[float, str]:
        began = entries[k].record["began"] if dated else 0.0
        return float(began), entries[k].place.name

    return tuple(sorted(usable, key=when)), dated and bool(usable)


def _with_diagnoses(
    entries: Sequence[Entry], crew: Crew, settings: Settings, progress: Callable[[str], None]
) -> list[Entry]:
    """The logs with their diagnoses; each is tried on the next one by date, the last one on the one before it."""
    known = [k for k, e in enumerate(entries) if e.error is None]
    dated = all(entries[k].record["began"] is not None for k in known)
    known.sort(key=lambda k: (float(entries[k].record["began"] or 0.0) if dated else 0.0, entries[k].place.name))
    if len(known) < 2:
        lone = Outcome(None, "a diagnosis needs another log to be tried on", False, 0, 0.0)
        return [Entry(e.place, e.outcome, lone if e.error is None else None) for e in entries]
    inputs = []
    for i, k in enumerate(known):
        other = known[i + 1] if i + 1 < len(known) else known[i - 1]
        digests = (entries[k].record["sha256"], entries[other].record["sha256"])
        inputs.append((entries[k].place, entries[other].place, digests, settings))
    names = [entries[k].place.name for k in known]
    found = dict(zip(known, _all(crew, diagnosed, inputs, names, "diagnosing", progress), strict=True))
    return [Entry(e.place, e.outcome, found.get(k)) for k, e in enumerate(entries)]


def _together(
    entries: Sequence[Entry],
    order: Sequence[int],
    terms: Sequence[Term],
    crew: Crew,
    settings: Settings,
    clock: _Clock,
    pairs: int,
    progress: Callable[[str], None],
) -> tuple[Pooled, Drift, Traffic, dict[int, Sequence[Stored]]]:
    """What the logs say together, and what changed between them."""
    ids = [t.id for t in terms]
    column = {id_: j for j, id_ in enumerate(ids)}
    sets = [[column[i] for i in block] for k in order for block in entries[k].record["blocks"]]
    model = Model(tuple(terms), linked(sets, len(ids)))
    held = Held(entries, sorted(order), crew, settings, len(ids))
    bounds = np.array([[e.bound(i) if e.usable else (-np.inf, np.inf) for i in ids] for e in entries])

    @lru_cache(maxsize=KEPT)
    def certificates(k: int) -> Sequence[Stored]:
        return certificates_of(entries[k].record, settings.finished)

    known = Logs(
        tuple(order),
        tuple(e.place.name for e in entries),
        bounds[:, :, 0],
        bounds[:, :, 1],
        lambda k: of_certificates(certificates(k), ids, k),
    )
    with clock.step("pool"):
        progress("all logs together")
        found = pooled(known.start(order), model, held.ask)
    with clock.step("drift"):
        if found.solved.empty:
            drifted = drift(known, model, held.ask, progress, pairs)
        else:
            # One parameter for all rows of all logs: no period ends, and no logs contradict each other.
            drifted = Drift((tuple(order),), (), {}, 0, 0)
    proofs = {k: certificates(k) for c in drifted.changes for pair in c.between.values() for k in pair}
    return found, drifted, held.traffic, proofs


class Held:
    """The rows of all logs, held by the workers in batches.

    Args:
        entries: all logs.
        logs: numbers of those whose rows are held.
        crew: of processes.
        settings: of the run.
        columns: number of parameters.
    """

    def __init__(
        self, entries: Sequence[Entry], logs: Sequence[int], crew: Crew, settings: Settings, columns: int
    ) -> None:
        self._crew, self._columns = crew, columns
        self._batches = [tuple(logs[k : k + BATCH]) for k in range(0, len(logs), BATCH)]
        self._inputs: list[tuple[list[tuple[int, Place, str]], Settings]] = [
            ([(k, entries[k].place, entries[k].record["sha256"]) for k in batch], settings) for batch in self._batches
        ]
        self._held: list[object] | None = None
        self.traffic = Traffic(rows=sum(sum(entries[k].record["rows"].values()) for k in logs))

    def ask(self, questions: Sequence[Question]) -> list[Violated]:
        """Tries points on all rows; only the rows that they violate most come back."""
        if self._held is None:
            self._held = self._crew.hold(rows_of, self._inputs)
        asked, inputs, handles = [], [], []
        for batch, handle in zip(self._batches, self._held, strict=True):
            mine = [(k, _part(q, batch)) for k, q in enumerate(questions) if q.logs is None or q.logs & set(batch)]
            if mine:
                asked.append([k for k, _ in mine])
                inputs.append([q for _, q in mine])
                handles.append(handle)
        answers: list[list[Violated]] = [[] for _ in questions]
        found = self._crew.on(scanned, handles, inputs)
        for numbers, each in zip(asked, found, strict=True):
            for k, answer in zip(numbers, each, strict=True):
                answers[k].append(answer)
        t = self.traffic
        sent = t.sent + sum(_size(q) for each in inputs for q in each)
        received = t.received + sum(a.rows.nbytes for each in found for a in each)
        self.traffic = Traffic(t.passes + 1, sent, received, t.rows)
        return [together(each, self._columns) for each in answers]


def _part(question: Question, batch: Sequence[int]) -> Question:
    """A question with the points of some logs alone."""
    if not isinstance(question.points, Mapping):
        return question
    return Question({k: question.points[k] for k in batch if k in question.points}, question.logs, question.block)


def _size(question: Question) -> int:
    points = question.points.values() if isinstance(question.points, Mapping) else [question.points]
    return sum(int(p.nbytes) for p in points)


def _assumptions(
    entries: Sequence[Entry], order: Sequence[int], vehicle: Vehicle
) -> tuple[tuple[str, ...], float | None]:
    """The sentences that hold for all logs, and the probability that all sensor bounds hold at once, at least."""
    each = dict.fromkeys(s for k in order for s in entries[k].record["assumes"])
    confidence = vehicle.sensors.confidence if vehicle.sensors.sigmas is None else None
    joint = None
    if confidence is not None:
        whole = max(Fraction(0), 1 - len(order) * (1 - Fraction(repr(confidence))))
        # Rounded down: a probability of 0 never shows as a positive one.
        joint = float(whole) if Fraction(float(whole)) <= whole else math.nextafter(float(whole), 0.0)
    lines = [
        f"the {len(order)} logs are of one vehicle, whose parameters have the same values in all of them and whose file describes it in each",
    ]
    if joint is not None:
        lines.append(
            f"sensor bounds hold in all {len(order)} logs at once (probability >= {joint:.6g}, by Boole's inequality)"
        )
    return (*lines, *each), joint
