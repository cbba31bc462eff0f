"""``ivsid fleet``: many logs of a vehicle, one by one and together, as a page, a record and Parquet tables."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from os import PathLike
from typing import Final

from ivsid import fleets
from ivsid.diagnosis import NULL_LOGS
from ivsid.files.records import sealed
from ivsid.fleets import Fleet, parquet, tables
from ivsid.fleets.drift import Change
from ivsid.fleets.result import Entry
from ivsid.fleets.run import LIKELY
from ivsid.intervals import shown
from ivsid.linear.spread import Client
from ivsid.report import drawn, page
from ivsid.report.drawn import Bar, Bars
from ivsid.report.page import Card, First, Part, Report, Section
from ivsid.rows import WINDOW
from ivsid.workflow.parameters import bounded, brief
from ivsid.workflow.progress import Progress, silent

# Logs that the page lists; the tables hold all.
# Source: resource: a page of a thousand logs stays below a megabyte
LISTED: Final = 300
# Single logs beside whose intervals those of all logs are drawn.
# Source: definition: what a screen holds
DRAWN: Final = 12
# Changes that the page and the terminal name.
# Source: definition: what a screen holds
CHANGES: Final = 20

MEANING: Final = {
    "enclosed": "every parameter that is consistent with all rows of all logs lies in these intervals",
    "unbounded": "all logs together leave some direction open; the ends that are given hold",
    "empty": "no parameter is consistent with all rows of all logs: a parameter changed, or a bound of the vehicle file is wrong",
    "not_applicable": "the rows of the logs leave too many signs open for a proof",
}


def fleet(
    logs: Sequence[str | PathLike[str]],
    vehicle: str | PathLike[str],
    out: str | PathLike[str],
    *,
    scheduler: str | Client | None = None,
    workers: int | None = None,
    diagnose: bool = True,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    seed: int | None = None,
    null_logs: int = NULL_LOGS,
    progress: Progress = silent,
) -> Report:
    """Identifies and diagnoses logs, holds them against each other, and reports; the options are those of ``ivsid.fleet``.

    Raises:
        IvsidError: unusable input, in one sentence.
    """
    found = fleets.fleet(
        logs,
        vehicle,
        out,
        scheduler=scheduler,
        workers=workers,
        diagnose=diagnose,
        form=form,
        rows=rows,
        window=window,
        seed=1 if seed is None else seed,
        null_logs=null_logs,
        progress=progress,
    )
    return fleet_report(found)


def fleet_report(found: Fleet) -> Report:
    """The report of a fleet."""
    sections = [
        Section("All logs together", tuple(_together(found))),
        Section("What changed", tuple(_drift(found))),
        Section("Causes by log", tuple(_findings(found))),
        Section("The logs", tuple(_logs(found))),
        Section("Assumptions", (page.bullets(found.assumes[:LISTED]),) if found.order else ()),
    ]
    files = {f"{name}.parquet": parquet(table) for name, table in tables(found).items()}
    return Report(
        f"The logs of {found.vehicle.name}",
        _summary(found),
        sealed(found.record()),
        tuple(s for s in sections if s.parts),
        (),
        files,
        tuple(_lines(found)),
        _first(found),
    )


def _summary(found: Fleet) -> str:
    count = f"{len(found.entries)} logs of {found.vehicle.name}"
    failed = f", {len(found.failed)} failed" if found.failed else ""
    if found.pooled is None:
        return f"{count}{failed}: no log can be used."
    status = found.pooled.solved.status
    sure = "guaranteed under the stated assumptions" if found.guaranteed else "not guaranteed"
    words = f"{count}{failed}. Together {status} ({MEANING[status]}); {sure}."
    if found.drift is not None and found.drift.changes:
        words += f" Under these assumptions parameters changed at least {len(found.drift.changes)} time{'s' * (len(found.drift.changes) > 1)}, in the order of {_by(found)}."
    return words


def _by(found: Fleet) -> str:
    return "dates" if found.dated else "names"


def _together(found: Fleet) -> list[Part]:
    if found.pooled is None:
        return [page.text("No log can be used.")]
    solved = found.pooled.solved
    facts = [f"{len(found.order)} logs, {found.traffic.rows} rows, of which {found.pooled.rows.count} prove the result"]
    if not found.pooled.complete:
        facts.append("the search ended early: the bounds hold, and may be wider than the logs allow")
    if found.contradicted:
        facts.append(
            f"left out, as no parameter is consistent with their own rows: {', '.join(found.contradicted[:DRAWN])}"
        )
    nothing = [e.place.name for e in found.entries if e.status == "not_applicable"]
    if nothing:
        facts.append(f"left out, as their identification proves nothing: {', '.join(nothing[:DRAWN])}")
    if solved.reason:
        facts.append(solved.reason)
    if found.joint is not None and found.joint < LIKELY:
        needed = 1 - 1e-3 / max(len(found.order), 1)
        facts.append(
            f"all sensor bounds of {len(found.order)} logs hold at once with a probability of at least {found.joint:.3g} at confidence = "
            f"{found.vehicle.sensors.confidence:g}, so nothing that rests on all of them is called guaranteed; with "
            f"[sensors] confidence = {needed:.9g} all bounds hold at once with probability 0.999"
        )
    if not found.parameters:
        return [page.bullets(facts)]
    numbers, rows = [], []
    for t in found.terms:
        lower, upper = found.parameters[t.id]
        each = [(found.names[k], *found.entries[k].bound(t.id)) for k in found.order]
        some = each if len(each) <= DRAWN else _tightest(each)
        bars = [Bar("all logs", lower, upper, brief(lower, upper), found.guaranteed)]
        bars += [Bar(n, a, b, brief(a, b), bool(found.guaranteed)) for n, a, b in some]
        numbers.append(Bars(f"{t.id} [{t.unit}]", tuple(bars)))
        low, high = max(each, key=lambda e: e[1]), min(each, key=lambda e: e[2])
        rows.append([t.id, t.unit, brief(lower, upper), low[1], low[0], high[2], high[0]])
    header = ["parameter", "unit", "all logs", "largest lower end", "of", "smallest upper end", "of"]
    caption = "The interval of all logs lies in that of each log. Green: guaranteed under the stated assumptions."
    return [drawn.bars(caption, numbers), page.table(header, rows), page.bullets(facts)]


def _tightest(each: list[tuple[str, float, float]]) -> list[tuple[str, float, float]]:
    """The logs with the narrowest intervals, in their order."""
    chosen = sorted(range(len(each)), key=lambda k: (each[k][2] - each[k][1], k))[:DRAWN]
    return [each[k] for k in sorted(chosen)]


def _drift(found: Fleet) -> list[Part]:
    drift = found.drift
    if drift is None:
        return []
    if not drift.changes:
        if found.pooled is not None and found.pooled.solved.empty:
            return [page.text("The logs contradict each other, and no least set of logs was found.")]
        return [
            page.text(
                "Nothing: some parameter is consistent with all rows of all logs, so no two logs contradict each other."
            )
        ]
    ids = [t.id for t in found.terms]
    rows = []
    for k, c in enumerate(drift.changes[:CHANGES]):
        last, first = drift.periods[k][-1], drift.periods[k + 1][0]
        rows.append(
            [
                f"{_when(found.entries[last])} / {_when(found.entries[first])}",
                ", ".join(found.names[n] for n in c.logs),
                c.irreducible,
                ", ".join(ids[j] for j in c.changed) or "–",
                ", ".join(ids[j] for j in c.alone) or "none",
            ]
        )
    header = ["boundary", "least set of logs", "irreducible", "must have changed", "could be the only change"]
    words = (
        f"Each period holds together; the first log after it contradicts it. So the parameters took at least {len(drift.periods)} values in the order "
        f"of {_by(found)}. A parameter must have changed where the intervals of two logs are disjoint."
    )
    periods = [[k, found.names[p[0]], found.names[p[-1]], len(p)] for k, p in enumerate(drift.periods)]
    parts = [
        page.text(words),
        page.table(header, rows),
        page.table(["period", "first log", "last log", "logs"], periods[:LISTED]),
    ]
    pairs = [
        [found.names[a], found.names[b], ", ".join(ids[j] for j in changed) or "all rows together"]
        for (a, b), changed in list(drift.pairs.items())[:LISTED]
    ]
    said = f"{len(drift.pairs)} pairs of logs contradict each other"
    if drift.untried:
        said += f"; {drift.untried} pairs whose intervals meet were not tried on all of their rows"
    parts.append(page.details(said, (page.table(["log", "other log", "disjoint, or proved by"], pairs),)))
    return parts


def _when(entry: Entry) -> str:
    began = entry.record.get("began")
    name = entry.place.name
    return name if began is None else f"{name} ({datetime.fromtimestamp(float(began), UTC):%Y-%m-%d %H:%M} UTC)"


def _findings(found: Fleet) -> list[Part]:
    if not any(e.diagnosis for e in found.entries):
        return []
    done = sum(found.verdicts().values())
    verdicts = ", ".join(f"{v} {n}" for v, n in found.verdicts().items()) or "none"
    rows = [[c, len(n), 100.0 * len(n) / max(done, 1), ", ".join(n[:4])] for c, n in found.findings().items()]
    parts = [
        page.text(f"Diagnoses: {done}; verdicts: {verdicts}."),
        page.table(["cause", "logs", "share [%]", "first logs"], rows)
        if rows
        else page.text("No cause stands in any log."),
    ]
    failed = [[e.place.name, e.diagnosis.error] for e in found.entries if e.diagnosis and e.diagnosis.error]
    if failed:
        table = page.table(["log", "why"], failed[:LISTED])
        parts.append(page.details(f"{len(failed)} logs were not diagnosed", (table,)))
    return parts


def _logs(found: Fleet) -> list[Part]:
    rows = [
        [
            e.place.name,
            e.status,
            e.record.get("samples"),
            e.record.get("inflation"),
            (e.diagnosis.record["verdict"] if e.diagnosis and e.diagnosis.record else None),
            len(e.record.get("setup", ())),
        ]
        for e in found.entries
        if e.error is None
    ]
    parts = []
    if found.failed:
        failed = [[name, why] for name, why in found.failed.items()]
        parts.append(page.table(["failed log", "why"], failed[:LISTED]))
    header = ["log", "status", "samples", "inflation", "verdict", "doubts about the set-up"]
    more = f" (the first {LISTED}; logs.parquet has all)" if len(rows) > LISTED else ""
    parts.append(page.details(f"{len(rows)} logs{more}", (page.table(header, rows[:LISTED]),)))
    return parts


def _change(found: Fleet, change: Change) -> str:
    ids = [t.id for t in found.terms]
    logs = ", ".join(found.names[k] for k in change.logs)
    words = f"{logs} contradict each other"
    if change.changed:
        words += f"; must have changed: {', '.join(ids[j] for j in change.changed)}"
    alone = [ids[j] for j in change.alone]
    only = f"it is {' or '.join(alone)}" if alone else "no single parameter explains it"
    return f"{words}; if one parameter changed alone, {only}" if alone else f"{words}; {only}"


def _lines(found: Fleet) -> list[str]:
    lines = [f"  {t.id:<24} {shown(*found.parameters[t.id]):>32} {t.unit}" for t in found.terms if found.parameters]
    if found.drift is not None:
        lines += [f"  {_change(found, c)}" for c in found.drift.changes[:CHANGES]]
        if found.drift.pairs:
            lines.append(f"  {len(found.drift.pairs)} pairs of logs contradict each other")
    lines += [f"  {cause} in {len(names)} logs" for cause, names in list(found.findings().items())[:CHANGES]]
    lines += [f"  failed: {name}: {why}" for name, why in list(found.failed.items())[:CHANGES]]
    reused = sum(e.outcome.reused for e in found.entries)
    if reused:
        lines.append(f"  {reused} of {len(found.entries)} logs were identified before, and not again")
    return lines


def _first(found: Fleet) -> First:
    if found.pooled is None:
        return First("No log can be used", "bad", "The sentences of the failed logs stand below.")
    solved = found.pooled.solved
    facts = tuple((i, bounded(*e, t.unit)) for t, (i, e) in zip(found.terms, found.parameters.items(), strict=False))
    cards = [Card("Intervals of all logs", f"{len(found.order)} logs.", facts, "all-logs-together")] if facts else []
    causes = tuple((c, f"{len(n)} logs") for c, n in list(found.findings().items())[:CHANGES])
    if causes:
        cards.append(Card("Causes", "Diagnoses of single logs.", causes, "causes-by-log"))
    if solved.empty:
        changes = () if found.drift is None else found.drift.changes
        verdict = f"The parameters changed at least {len(changes)} time{'s' * (len(changes) != 1)}"
        steps = tuple(_change(found, c) + "." for c in changes[:4])
        return First(verdict, "bad", "", tuple(cards), steps or ("Look at the logs that contradict each other.",))
    verdict = {
        "enclosed": f"{len(facts)} parameters hold in all {len(found.order)} logs",
        "unbounded": "All logs together leave some parameters open",
    }.get(solved.status, "These logs prove nothing together")
    following = ("Check the proof: ivsid verify result.json FOLDER_OF_LOGS.",)
    tone = "good" if solved.status == "enclosed" else "open"
    return First(verdict, tone, "", tuple(cards), following)
