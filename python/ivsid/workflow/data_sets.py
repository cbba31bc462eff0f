"""``ivsid import``: a public data set as logs, thrust tables and a vehicle file."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ivsid.adapters import ADAPTERS, Imported, Part
from ivsid.errors import IvsidError, choice
from ivsid.files.records import envelope
from ivsid.log import Log, Quality
from ivsid.log.quality import examine, gaps, without_held
from ivsid.propulsion.bollard import examine as examine_thrust
from ivsid.report import figures, page
from ivsid.report.figures import Drawing
from ivsid.report.page import Report, Section
from ivsid.report.tables import quality_record
from ivsid.workflow.log_files import quality_table
from ivsid.workflow.progress import Progress, silent


def import_set(name: str, folder: str | Path, *, progress: Progress = silent) -> Report:
    """Reads a public data set from a folder; its logs, tables and vehicle file become files of the report.

    Raises:
        IvsidError: an unknown set, or a file of the folder that is missing or damaged.
    """
    if name not in ADAPTERS:
        raise IvsidError(f"data set '{name}' is unknown; {choice(name, ADAPTERS)}")
    progress("reading")
    made = ADAPTERS[name](Path(folder))
    content: dict[str, str | bytes] = {f"{n}.csv": part.text for n, part in made.logs.items()}
    content |= {f"{n}.csv": table.text for n, table in made.tables.items()}
    content |= {f"{n}.csv": _csv(columns) for n, columns in made.others.items()}
    if made.vehicle:
        content[made.vehicle] = (files("ivsid") / "data" / made.vehicle).read_text()
    progress("examining")
    quality = {n: _quality(n, part) for n, part in made.logs.items()}
    progress("drawing")
    drawings = _drawings(made)
    record = {
        **envelope("import", made.inputs),
        "set": name,
        "files": sorted(content),
        "facts": made.facts,
        "logs": {n: {"quality": quality_record(q), "notes": notes} for n, (q, notes) in quality.items()},
        "notes": made.notes,
    }
    sections = [Section("Notes on the data", (page.bullets(made.notes),))]
    for n, (table, notes) in quality.items():
        shown = [page.drawing(d) for d in drawings if d.name == f"log_{n}"]
        sections.append(Section(f"{n}.csv", (quality_table(table), page.bullets(notes), *shown)))
    drag = _drag_rows(made)
    if drag:
        header = ["axis", "coefficient", "lower", "upper", "runs", "status", "guaranteed"]
        sections.append(Section("Drag of the captive runs", (page.table(header, drag),)))
    rest = [page.drawing(d) for d in drawings if not d.name.startswith("log_")]
    if rest:
        sections.append(Section("Captive tests", tuple(rest)))
    summary = f"{made.title}: {len(made.logs)} logs, {len(made.tables)} thrust tables" + (
        f", vehicle file {made.vehicle}." if made.vehicle else "."
    )
    lines = [f"  {', '.join(sorted(content))}"]
    lines += [f"  {r[1]} in [{r[2]}, {r[3]}] ({r[4]} captive runs, {r[5]}, not guaranteed)" for r in drag]
    lines += [f"  note: {n}" for n in made.notes]
    lines += [f"  {n}: {note}" for n, part in made.logs.items() for note in part.notes]
    return Report(f"Import of {made.title}", summary, record, tuple(sections), drawings, content, tuple(lines))


def _drag_rows(made: Imported) -> list[list[object]]:
    """A row for each coefficient that captive runs give, or one that says why they give none."""
    rows: list[list[object]] = []
    for axis, found in made.facts.get("captive", {}).items():
        ends = found["coefficients"] or {f"drag.{axis}": ["none", "none"]}
        rows += [
            [
                axis,
                i,
                *(f"{x:.4g}" if isinstance(x, float) else x for x in e),
                found["runs"],
                found["status"],
                "no, it rests on assumptions",
            ]
            for i, e in ends.items()
        ]
    return rows


def _csv(columns: Mapping[str, NDArray[np.float64]]) -> str:
    names = list(columns)
    rows = zip(*(columns[n].tolist() for n in names), strict=True)
    return "\n".join([",".join(names), *(",".join(repr(x) for x in row) for row in rows)]) + "\n"


def _quality(name: str, part: Part) -> tuple[dict[str, Quality], list[str]]:
    """Quality and notes, as ``read_log`` gives them for the written file."""
    found, notes = {}, list(part.notes)
    for column, values in part.columns.items():
        kept, repeats, note = without_held(column, values)
        found[column], words = examine(column, part.t, kept, repeats, name)
        notes += [note] if note else []
        notes += words
    return found, [*notes, *gaps(part.t)]


def _drawings(made: Imported) -> tuple[Drawing, ...]:
    drawings = []
    for name, part in made.logs.items():
        drawings.append(figures.channels(Log(f"{name}.csv", "", part.t, part.columns), f"log_{name}"))
    for name, table in made.tables.items():
        bollard = examine_thrust(table.demand, table.thrust, None)
        unit = "us" if "(us)" in table.demand_name else "1"
        drawings.append(figures.thrust_curve(bollard, f"thrust_{name}", f"Thrust against demand, {name}", unit))
    for name, columns in made.others.items():
        drag = made.facts[name]
        coefficients = (drag["linear"], drag["quadratic"])
        drawings.append(figures.drag_curve(columns["u"], np.asarray(columns["force_X"]), coefficients, name))
    return tuple(drawings)
