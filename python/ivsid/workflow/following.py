"""``ivsid follow``: parameter intervals as they narrow along a log, and changes that are proved."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ivsid import identification
from ivsid.identification import Following, Moment
from ivsid.identification.following import START
from ivsid.intervals import shown
from ivsid.log import read_log
from ivsid.log.growing import growing
from ivsid.report import figures, page
from ivsid.report.page import First, Report, Section
from ivsid.rows import WINDOW
from ivsid.vehicle import read_vehicle
from ivsid.workflow.growing import watched
from ivsid.workflow.log_files import log_series
from ivsid.workflow.parameters import brief
from ivsid.workflow.progress import Progress, silent
from ivsid.workflow.set_up import with_setup

# Statuses in words.
MEANING = {
    "enclosed": "every parameter that the rows allow lies in these intervals",
    "unbounded": "the rows leave some ends open; the ends that are given hold",
    "empty": "no parameters explain the rows: the model, the thrust accuracy or a sensor bound is wrong",
}


def follow(
    vehicle: str | Path,
    log: str | Path,
    *,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    physical: bool = False,
    start: float | None = None,
    drift: Mapping[str, float] | None = None,
    changes: float | None = None,
    every: float | None = None,
    wait: float | None = None,
    watch: Callable[[Moment], None] = lambda _: None,
    say: Callable[[str], None] = lambda _: None,
    progress: Progress = silent,
) -> Report:
    """Reads a vehicle file and a log, follows the log and reports; the options are those of ``ivsid.follow``.

    Args:
        vehicle: a vehicle file.
        log: a log.
        form: as for ``ivsid.follow``, as the other options are.
        rows: likewise.
        window: likewise.
        physical: likewise.
        start: likewise.
        drift: likewise.
        changes: likewise.
        every: likewise; of a log that is being written the least time between two moments.
        wait: seconds without a new row after which a text log that is being written has ended; None for a finished log.
        watch: shown each moment as it comes.
        say: told why the rows so far are no log yet.
        progress: told of each step.

    Raises:
        IvsidError: an unusable file or option, in one sentence.
    """
    progress("reading")
    checked = read_vehicle(vehicle)
    followed = partial(
        identification.follow,
        checked,
        form=form,
        rows=rows,
        window=window,
        physical=physical,
        start=START if start is None else start,
        drift=drift,
        changes=changes,
    )
    if wait is None:
        data = read_log(log, checked.log)
        found = followed(data, every=every, watch=watch, progress=progress)
    else:
        with growing(log) as lines:
            shown_until = -np.inf

            def latest() -> Moment | None:
                nonlocal shown_until
                so_far = read_log(lines.copy, checked.log)
                if every is not None and so_far.t[-1] - shown_until < every:
                    return None
                shown_until = so_far.t[-1]
                return followed(so_far, every=so_far.t[-1] - so_far.t[0], examine=False).moments[-1]

            watched(lines, wait, latest, watch, say)
            data = read_log(lines.copy, checked.log)
            found = followed(data, every=every, progress=progress)
    progress("drawing")
    drawing = figures.narrowing(found)
    sections = [
        Section("Parameters", (_table(found), page.drawing(drawing))),
        Section("Assumptions", (page.bullets(found.assumes),)),
        Section("The log", (log_series(data), *((page.bullets(found.notes),) if found.notes else ()))),
    ]
    if found.changes:
        title = "Changes" if changes is not None else "Why no parameters fit"
        sections.insert(1, Section(title, (page.bullets(c.sentence for c in found.changes),)))
    summary = summary_of(found)
    report = Report(
        f"Parameters of {found.vehicle.name} along {found.log_name}",
        summary,
        found.record(),
        tuple(sections),
        (drawing,),
        {},
        tuple(lines_of(found)),
        _first(found),
    )
    return with_setup(report, found.setup)


def summary_of(found: Following) -> str:
    """The verdict in a sentence or two."""
    word = "guaranteed under the stated assumptions" if found.guaranteed else "not guaranteed"
    text = f"{found.vehicle.name}, {sum(found.rows.values())} rows one by one: {found.status} ({MEANING[found.status]}); {word}."
    if found.options["changes"] is not None:
        count = len(found.changes)
        text += f" {count or 'No'} change{'' if count == 1 else 's'} of the parameters {'is' if count == 1 else 'are'} proved."
    return text


def lines_of(found: Following) -> list[str]:
    """Intervals after the last row, and proofs, for the terminal."""
    lines = [f"  {id_:<24} {shown(p.lower, p.upper):>32} {p.unit}" for id_, p in found.parameters.items()]
    return [*lines, *(f"  {c.sentence}" for c in found.changes), *(f"  note: {n}" for n in found.notes)]


def _table(found: Following) -> page.Part:
    rows = [[id_, p.unit, brief(p.lower, p.upper)] for id_, p in found.parameters.items()]
    return page.table(["parameter", "unit", "interval after the last row"], rows)


def _first(found: Following) -> First:
    verdict = {
        "enclosed": f"{len(found.parameters)} parameters are enclosed",
        "unbounded": "The log leaves some parameters open",
        "empty": "No parameters explain this log",
    }[found.status]
    if found.status != "empty" and found.changes:
        verdict = "The parameters changed"
    following = {
        "enclosed": "Compare with the whole log at once, with a certificate for each bound: ivsid identify.",
        "unbounded": "Sail what the open directions lack: ivsid isolability names the manoeuvre.",
        "empty": "Look for the cause: ivsid diagnose VEHICLE LOG OTHER_LOG.",
    }[found.status]
    tone = "bad" if found.changes else "good" if found.status == "enclosed" and found.guaranteed else "open"
    return First(verdict, tone, "", (), (following,), ())
