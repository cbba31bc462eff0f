"""``ivsid isolability``."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ivsid import diagnosis, report, simulation
from ivsid.diagnosis import Isolability
from ivsid.log import Log, read_log
from ivsid.report import Report, Section
from ivsid.scenario import read_scenario
from ivsid.vehicle import Vehicle, read_vehicle
from ivsid.workflow.common import Progress, silent


def isolability(
    vehicle: str | Path, log: str | Path, *, seed: int | None = None, progress: Progress = silent
) -> Report:
    """Reads a vehicle and a log, or a scenario that is simulated first, and says what it can show."""
    progress("reading")
    checked = read_vehicle(vehicle)
    result = diagnosis.isolability(checked, _log(checked, Path(log), seed, progress), progress=progress)
    return isolability_report(checked, result)


def _log(vehicle: Vehicle, path: Path, seed: int | None, progress: Progress) -> Log:
    if path.suffix != ".toml":
        return read_log(path, vehicle.log)
    scenario = read_scenario(path)
    progress("simulating the scenario")
    made = simulation.simulate(vehicle, scenario, seed)
    return Log(path.name, hashlib.sha256(path.read_bytes()).hexdigest(), made.t, made.columns)


def isolability_report(vehicle: Vehicle, result: Isolability) -> Report:
    """The report."""
    record = result.record()
    rows = []
    for id_, v in sorted(result.visible.items(), key=lambda q: -q[1].z):
        near = record["nearest"].get(id_, {})
        rows.append([id_, v.z, v.tested, near.get("effect", "–"), near.get("rho"), near.get("d")])
    header = ["effect at its typical size", "z", "tested", "nearest", "rho", "d"]
    classes = [[", ".join(ids), words] for ids, words in result.classes]
    sections = (
        Section(
            "What this programme shows", (report.table(header, rows, "Tested from z = 8; told apart from d = 5."),)
        ),
        Section("What it does not tell apart", (report.table(["causes", "what would separate them"], classes),)),
        Section(
            "What it cannot test",
            (report.table(["effect", "why"], [[q["effect"], q["reason"]] for q in record["not_tested"]]),),
        ),
    )
    tested = sum(v.tested for v in result.visible.values())
    summary = f"{vehicle.name}: {tested} effects of typical size are tested by this programme, in {len(classes)} sets that it does not tell apart."
    lines = [summary]
    lines += [f"  not told apart: {', '.join(ids)}\n    to separate them: {words}" for ids, words in result.classes]
    lines += [f"  not tested: {q['effect']} ({q['reason']})" for q in record["not_tested"]]
    return Report(f"Isolability for {vehicle.name}", summary, record, sections, (), {}, tuple(lines))
