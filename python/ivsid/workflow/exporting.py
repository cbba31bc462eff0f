"""``ivsid export``: an identified or extended model as a file of another simulator."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ivsid import exports
from ivsid.files.records import envelope
from ivsid.report import page
from ivsid.report.page import Report, Section
from ivsid.workflow.progress import Progress, silent


def export(result: str | Path, to: str, *, progress: Progress = silent) -> Report:
    """Reads a result and writes its model in the names and signs of a target.

    Args:
        result: folder of ``identify`` or ``diagnose``, or a vehicle file with numbers in its model.
        to: gz, vrx, mss, pvs, stonefish or yaml.
        progress: told of each step.

    Raises:
        IvsidError: an unusable result, or an unknown target, in one sentence.
    """
    progress(f"writing for {to}")
    path = Path(result)
    made = exports.export(path, to)
    read = path / "result.json" if path.is_dir() else path
    inputs = {read.name: hashlib.sha256(read.read_bytes()).hexdigest()} if read.is_file() else {}
    record = {**envelope("export", inputs), "target": made.target, "file": made.file, "unstated": list(made.unstated)}
    if made.unstated:
        summary = f"{made.file} for {made.target}; {len(made.unstated)} things are not in it."
    else:
        summary = f"{made.file} for {made.target}; every number of the model is in it."
    lacks = (
        page.bullets(made.unstated)
        if made.unstated
        else page.text("Nothing: every number of the model is in the file.")
    )
    return Report(
        f"Export to {made.target}",
        summary,
        record,
        (Section("Not in the file", (lacks,)), Section(made.file, (page.code(made.text),))),
        (),
        {made.file: made.text},
        tuple(f"  not in it: {sentence}" for sentence in made.unstated),
    )
