"""A case in two sealed halves: what is examined, in a folder whose names say nothing, and its truth, which the examined process is not given."""

from __future__ import annotations

import json
from pathlib import Path

import polars as pl


def seal(case, papers: Path, answers: Path) -> Path:
    """Writes the vehicle and both logs to a folder of ``papers``, the truth to ``answers``, and returns the folder."""
    folder = papers / f"{case.seed:08d}"
    folder.mkdir(parents=True, exist_ok=True)
    answers.mkdir(parents=True, exist_ok=True)
    (folder / "vehicle.toml").write_text(case.vehicle.text)
    for name, log in (("1", case.train), ("2", case.test)):
        (folder / f"{name}.csv").write_text(pl.DataFrame({"t": log.t, **log.columns}).write_csv())
    truth = {"truth": case.truth, "exact": case.exact, "stratum": case.stratum}
    (answers / f"{case.seed:08d}.json").write_text(json.dumps(truth, default=float))
    return folder


def answer(folder: Path, answers: Path) -> dict:
    """The truth of a folder."""
    return json.loads((answers / f"{folder.name}.json").read_text())
