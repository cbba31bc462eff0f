"""A case in two sealed halves: a folder whose random name says nothing, and its truth, which the examined process is not given."""

from __future__ import annotations

import json
import secrets
import shutil
from pathlib import Path

import numpy as np
import polars as pl

PAPERS = ("vehicle.toml", "1.csv", "2.csv")


def seal(case, papers: Path, answers: Path) -> Path:
    """Writes the vehicle and both logs to a new folder of ``papers``, the truth with its seed to ``answers``, and returns the folder."""
    folder = _new(papers)
    (folder / "vehicle.toml").write_text(case.text)
    for name, columns in zip(("1", "2"), case.logs, strict=True):
        (folder / f"{name}.csv").write_text(pl.DataFrame(columns).write_csv())
    truth = {"seed": case.seed, "truth": case.truth, "exact": case.exact, "z": case.z, "stratum": case.stratum}
    _keep(folder, answers, truth)
    return folder


def adopt(source: Path, papers: Path, answers: Path) -> Path:
    """Seals the case of another simulator: ``vehicle.toml``, ``1.csv``, ``2.csv`` and ``truth.json``, and returns the new folder.

    ``truth.json`` holds the hidden numbers by id and part in ``truth``, and may state the numbers of the plain model in ``exact``, and
    what is hidden in ``what``. ``z`` says by effect how far it stands out; null stands for an author who knows that it is visible.
    """
    folder = _new(papers)
    for name in PAPERS:
        shutil.copyfile(source / name, folder / name)
    given = json.loads((source / "truth.json").read_text())
    z = {i: np.inf if q is None else q for i, q in given.get("z", {}).items()}
    what = given.get("what") or ("none", "one", "two")[len(z)]
    stratum = {
        "what": what,
        "sizes": dict.fromkeys(z),
        "kind": source.name,
        "style": "",
        "ambient": "",
        "rate": "",
        "duration": "",
    }
    truth = {"seed": source.name, "truth": given["truth"], "exact": given.get("exact"), "z": z, "stratum": stratum}
    _keep(folder, answers, truth)
    return folder


def answer(folder: Path, answers: Path) -> dict:
    """The truth of a folder."""
    return json.loads((answers / f"{folder.name}.json").read_text())


def _new(papers: Path) -> Path:
    folder = papers / secrets.token_hex(8)
    folder.mkdir(parents=True)
    return folder


def _keep(folder: Path, answers: Path, truth: dict) -> None:
    answers.mkdir(parents=True, exist_ok=True)
    (answers / f"{folder.name}.json").write_text(json.dumps(truth, default=float))
