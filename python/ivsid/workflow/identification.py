"""``ivsid identify``: parameter intervals with their assumptions, and the rows that prove a contradiction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from ivsid import identification
from ivsid.files.records import sealed
from ivsid.identification import Identification, Narrower, narrower
from ivsid.log import Log, read_log
from ivsid.report import figures, page
from ivsid.report.figures import Drawing
from ivsid.report.page import Part, Report, Section
from ivsid.report.tables import quality_record
from ivsid.rows import WINDOW
from ivsid.vehicle import read_vehicle
from ivsid.workflow.first_screens import identified
from ivsid.workflow.log_files import log_series, quality_table
from ivsid.workflow.parameters import (
    MEANING,
    claim_lines,
    freedom_lines,
    method_table,
    narrower_lines,
    parameter_bars,
    parameter_lines,
    physical_lines,
)
from ivsid.workflow.progress import Progress, silent
from ivsid.workflow.set_up import with_setup

# Rows of a contradiction that the page shows; result.json holds all.
# Source: resource: lines of a page
MOST_ROWS: Final = 60
# Samples of a contradiction that the page lists, and those to which it leads in the log.
# Source: resource: lines of a page
MOST_SAMPLES: Final = 12
MOST_LINKS: Final = 6
# Seconds of the log on either side of such a sample.
# Source: definition: as on the page of a diagnosis
AROUND: Final = 10.0


def identify(
    vehicle: str | Path,
    log: str | Path,
    method: str = "feasible",
    *,
    partitions: int | None = None,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    bias: str = "auto",
    outliers: int = 0,
    physical: bool = False,
    progress: Progress = silent,
) -> Report:
    """Reads a vehicle file and a log, identifies and reports; the options are those of ``ivsid.identify``.

    Raises:
        IvsidError: an unusable file or option, in one sentence.
    """
    progress("reading")
    checked = read_vehicle(vehicle)
    data = read_log(log, checked.log)
    fit = identification.identify(
        checked,
        data,
        method,
        partitions=partitions,
        form=form,
        rows=rows,
        window=window,
        bias=bias,
        outliers=outliers,
        physical=physical,
        progress=progress,
    )
    progress("trying further rows")
    more = narrower(fit, data)
    progress("drawing")
    return identification_report(fit, data, more)


def identification_report(fit: Identification, log: Log, more: Narrower | None = None) -> Report:
    """The report of one identification.

    Args:
        fit: of the log.
        log: that was identified.
        more: what would narrow the intervals, if that was asked.
    """
    further = [] if more is None else narrower_lines(more)
    drawings = (figures.intervals([fit]), figures.channels(log))
    word = "guaranteed under the stated assumptions" if fit.guaranteed else f"not guaranteed{_why(fit)}"
    summary = f"{fit.vehicle.name}, method {fit.method}: {fit.status} ({MEANING[fit.status]}); {word}."
    if fit.physical:
        summary = f"{fit.vehicle.name}: no vessel has these parameters. {summary}"
    inflation = "no factor on the bounds makes the rows consistent" if fit.inflation is None else f"{fit.inflation:.4g}"
    facts = [f"rows: {', '.join(f'{n} {c}' for c, n in fit.rows.items())}"]
    if fit.method == "feasible":
        facts.append(f"inflation (smallest factor on all row radii with a consistent parameter): {inflation}")
    if fit.improper:
        facts.append(f"improper entries in the published inverse: {fit.improper}")
    if fit.reason:
        facts.append(fit.reason)
    facts += [f"the data leave open: {' '.join(f'{v:+.3g} {k}' for k, v in d.items())}" for d in fit.directions]
    facts += physical_lines(fit)
    facts += freedom_lines(fit)
    facts += claim_lines(fit)
    facts += further
    sections = [
        Section(
            "Parameters",
            (
                *_bars(fit),
                method_table([fit]),
                page.bullets(facts),
                *_picture(fit, drawings[0]),
            ),
        ),
        Section("Assumptions", (page.bullets(fit.assumes),)),
        Section("The log", (log_series(log), *_quality(log), *_notes(fit, log))),
    ]
    if fit.status == "empty":
        sections.insert(1, _contradiction(fit))
    lines = parameter_lines(fit) + [f"  {n}" for n in further] + [f"  note: {n}" for n in fit.notes]
    report = Report(
        f"Identification of {fit.vehicle.name}",
        summary,
        sealed({**fit.record(), "quality": quality_record(log.quality)}),
        tuple(sections),
        drawings,
        {},
        tuple(lines),
        identified(fit, further),
    )
    return with_setup(report, fit.setup)


def _why(fit: Identification) -> str:
    """Why an identification that follows from its rows is not guaranteed, where one key of the file says so."""
    if fit.method == "feasible" and fit.status != "not_applicable" and fit.vehicle.sensors.sigmas is not None:
        return ", since [sensors] states sigmas: write confidence in its place once its bounds are known"
    return ""


def _bars(fit: Identification) -> list[Part]:
    return [parameter_bars([fit])] if fit.parameters else []


def _picture(fit: Identification, drawing: Drawing) -> list[Part]:
    return [page.details("The intervals as a picture", (page.drawing(drawing),))] if fit.parameters else []


def _quality(log: Log) -> list[Part]:
    return [quality_table(log.quality)] if log.quality else []


def _notes(fit: Identification, log: Log) -> list[Part]:
    notes = [*fit.notes]
    if log.ignored:
        notes.append(f"columns not used: {', '.join(log.ignored)}")
    return [page.bullets(notes)] if notes else []


def _contradiction(fit: Identification) -> Section:
    """The samples of the rows that prove the model wrong, and the rows of each combination of signs."""
    found = [(c, r) for c in fit.falsifying for r in c["rows"]]
    places = Counter((r["channel"], r["time"], r["duration"], r["side"]) for _, r in found)
    samples = page.table(
        ["channel", "time [s]", "window [s]", "side", "in proofs"],
        [[c, f"{t:.6g}", d, side, n] for (c, t, d, side), n in places.most_common(MOST_SAMPLES)],
        f"{MOST_SAMPLES} of {len(places)}; result.json holds all." if len(places) > MOST_SAMPLES else "",
    )
    rows = [
        [
            ", ".join(f"{k} {'≥' if s > 0 else '≤'} 0" for k, s in c["orthant"].items() if s) or "any",
            r["channel"],
            f"{r['time']:.6g}",
            r["duration"],
            r["side"],
        ]
        for c, r in found[:MOST_ROWS]
    ]
    proofs = len(fit.falsifying)
    words = page.text(
        "These rows contradict each other. They are the samples to look at."
        if proofs == 1
        else f"Rows contradict each other, whatever the signs of the parameters: {proofs} combinations of signs, a proof for each. "
        "The rows that occur in most proofs stand first. They are the samples to look at."
    )
    table = page.table(["signs", "channel", "time [s]", "window [s]", "side"], rows)
    more = [page.details("The rows by the signs of the parameters", (table,))] if proofs > 1 else []
    links = [
        (f"{channel} at {time:.6g} s", "log", time - AROUND, time + long + AROUND)
        for channel, time, long in list(dict.fromkeys(p[:3] for p, _ in places.most_common()))[:MOST_LINKS]
    ]
    return Section("Why no parameter fits", (words, page.jump("Show them in the log:", links), samples, *more))
