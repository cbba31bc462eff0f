"""``ivsid isolability``: causes that a programme can show and tell apart, and the manoeuvre that would help."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ivsid import diagnosis, simulation
from ivsid.diagnosis import Advice, Isolability
from ivsid.errors import IvsidError
from ivsid.files.shipped import near_shipped, shipped
from ivsid.log import Log, read_log
from ivsid.programme import trials
from ivsid.programme.scenario import read_scenario
from ivsid.report import figures, page
from ivsid.report.page import Part, Report, Section
from ivsid.vehicle import Vehicle, read_vehicle
from ivsid.workflow.first_screens import separable
from ivsid.workflow.progress import Progress, silent

# Channels that a manoeuvre's log always has; others only where the log has them.
MOTION = ("u", "v", "r")
# The manoeuvre that is simulated with noise where the log says nothing of turning.
TURNS = ("zigzag 20/20", "PRBS")


def isolability(
    vehicle: str | Path, log: str | Path, *, seed: int | None = None, progress: Progress = silent
) -> Report:
    """Reads a vehicle file and a log, or a scenario to simulate, and reports its isolability with the best manoeuvres.

    Raises:
        IvsidError: an unusable file, in one sentence.
    """
    progress("reading")
    checked = read_vehicle(vehicle)
    data = _log(checked, Path(log), seed, progress)
    library = trials.library(checked, _full(checked, data))
    result = diagnosis.advised(
        checked,
        data,
        lambda values, rate, noisy: _sailed(checked, data, library, values, rate, noisy=noisy, progress=progress),
        progress=progress,
    )
    return isolability_report(checked, result, {t.name: t.words for t in library})


def _log(vehicle: Vehicle, path: Path, seed: int | None, progress: Progress) -> Log:
    path = shipped(path, "_programme")
    if not path.exists() and (near := near_shipped(path, "_programme")):
        raise IvsidError(
            f"log or scenario {path} is not there; {near}give the path of a file, or a shipped scenario's name"
        )
    if path.suffix != ".toml":
        return read_log(path, vehicle.log)
    scenario = read_scenario(path)
    progress("simulating the scenario")
    made = simulation.simulate(vehicle, scenario, seed)
    return Log(path.name, hashlib.sha256(path.read_bytes()).hexdigest(), made.t, made.columns)


def _full(vehicle: Vehicle, log: Log) -> float:
    """The largest demand from neutral: the end of the curves, or the largest demand of the log for curves without end."""
    if full := trials.full_demand(vehicle):
        return full
    asked = [
        float(np.nanmax(np.abs(log.columns[f"demand_{t.name}"] - t.neutral)))
        for t in vehicle.thrusters
        if f"demand_{t.name}" in log.columns
    ]
    return min(asked, default=0.0)


def _sailed(
    vehicle: Vehicle,
    log: Log,
    library: tuple[trials.Trial, ...],
    values: Mapping[str, float],
    rate: float,
    *,
    noisy: bool,
    progress: Progress,
) -> tuple[dict[str, Log], Log | None]:
    """The logs of all manoeuvres that the model can sail, and a noisy one in which the vehicle turns."""
    logs: dict[str, Log] = {}
    turning = None
    for k, trial in enumerate(library):
        progress(f"sailing {k} of {len(library)}: {trial.name}")
        made = _simulated(vehicle, log, trial, values, rate, "none")
        if made is None:
            continue
        logs[trial.name] = made
        if noisy and turning is None and trial.name in TURNS:
            turning = _simulated(vehicle, log, trial, values, rate, "gaussian")
    return logs, turning


def _simulated(
    vehicle: Vehicle, log: Log, trial: trials.Trial, values: Mapping[str, float], rate: float, noise: str
) -> Log | None:
    try:
        made = simulation.simulate(vehicle, trials.scenario(trial, vehicle, rate, values, noise))
    except IvsidError:
        return None
    if not trials.believable(vehicle, made.exact["r"]):
        return None
    columns = {k: x for k, x in made.columns.items() if k in log.columns or k in MOTION}
    # Wind, supply voltage and depth keep their means over the log.
    for name in ("wind_speed", "wind_direction", "voltage", "depth"):
        if name in log.columns:
            columns[name] = np.full(made.t.size, float(np.nanmean(log.columns[name])))
    return Log(trial.name, "", made.t, columns)


def isolability_report(vehicle: Vehicle, result: Isolability, words: Mapping[str, str]) -> Report:
    """The report of an isolability study."""
    record = result.record()
    record["manoeuvres"] = dict(words)
    rows = []
    for id_, v in sorted(result.visible.items(), key=lambda q: -q[1].z):
        near = record["nearest"].get(id_, {})
        rows.append([id_, v.z, v.tested, near.get("effect", "–"), near.get("rho"), near.get("d")])
    header = ["effect at its typical size", "z", "tested", "nearest", "rho", "d"]
    classes = [[", ".join(ids), *_advised(result, ids), said] for ids, said in result.classes]
    drawing = figures.separation(result)
    together = {ids for ids, _ in result.classes}
    close = [[", ".join(a.ids), *_advised(result, a.ids)] for a in result.advice if a.ids not in together]
    columns = ["causes", "d now", "best manoeuvre", "d with it", "left together"]
    sections = (
        Section(
            "Causes that this programme shows",
            (
                page.table(header, rows, "Tested from z = 8; told apart from d = 5."),
                *(() if drawing is None else (page.drawing(drawing),)),
            ),
        ),
        Section("Causes that it does not tell apart", (page.table([*columns, "remark of the catalogue"], classes),)),
        Section("Causes that it barely tells apart", (page.table(columns, close),) if close else ()),
        Section("Causes that it cannot test", (_untested(result, record),)),
        Section("The manoeuvres", (page.table(["name", "how it is sailed"], words.items()),) if words else ()),
    )
    tested = sum(v.tested for v in result.visible.values())
    summary = f"{vehicle.name}: {tested} effects of typical size are tested by this programme, {_sets(len(classes))} that it does not tell apart."
    return Report(
        f"Isolability for {vehicle.name}",
        summary,
        record,
        tuple(s for s in sections if s.parts),
        () if drawing is None else (drawing,),
        {},
        tuple(_lines(result, record)),
        separable(result),
    )


def _of(result: Isolability, ids: tuple[str, ...]) -> Advice | None:
    return next((a for a in result.advice if a.ids == ids), None)


def _advised(result: Isolability, ids: tuple[str, ...]) -> list[object]:
    """Cells of a table: the distance now, the best manoeuvre, the distance with it, and the causes that it leaves together."""
    advice = _of(result, ids)
    if advice is None:
        return [None, "none was tried", None, None]
    best = advice.best
    if best is None:
        return [advice.d, "none of the library", None, None]
    left = "; ".join(", ".join(g) for g in best.groups if len(g) > 1)
    return [advice.d, best.trial, best.d, left or "nothing"]


def _untested(result: Isolability, record: Mapping[str, Any]) -> Part:
    rows = []
    for q in record["not_tested"]:
        name, z = result.shown.get(q["effect"], ("–", None))
        rows.append([q["effect"], q["reason"], name, z])
    return page.table(["effect", "why", "shown best by", "z with it"], rows)


def _lines(result: Isolability, record: Mapping[str, Any]) -> list[str]:
    lines = []
    for ids, said in result.classes:
        lines.append(f"  not told apart: {', '.join(ids)}")
        advice = _of(result, ids)
        best = advice.best if advice is not None else None
        if advice is None:
            lines.append(f"    to separate them: {said}")
        elif best is None:
            lines.append(f"    no manoeuvre of the library separates them; {said}")
        else:
            left = [", ".join(g) for g in best.groups if len(g) > 1]
            rest = f"; still together: {'; '.join(left)}" if left else ""
            lines.append(f"    best: {best.trial}, d from {advice.d:.1f} to {best.d:.1f}{rest}")
    for q in record["not_tested"]:
        found = result.shown.get(q["effect"])
        best_of = "" if found is None else f"; {found[0]} would show it, z = {found[1]:.0f}"
        lines.append(f"  not tested: {q['effect']} ({q['reason']}{best_of})")
    return lines


def _sets(count: int) -> str:
    return f"in {count} sets" if count > 1 else "with one set" if count else "with no two"
