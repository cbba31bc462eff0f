"""``ivsid simulate``: a log from a known truth, which stands apart from it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from ivsid import simulation
from ivsid.effects import EFFECTS, spread
from ivsid.errors import IvsidError, meant
from ivsid.files.records import envelope, to_json
from ivsid.files.shipped import shipped
from ivsid.log import Log
from ivsid.programme.scenario import read_scenario
from ivsid.report import figures, page
from ivsid.report.page import Report, Section
from ivsid.simulation.hidden import as_logged
from ivsid.vehicle import read_vehicle
from ivsid.workflow.log_files import csv, parquet
from ivsid.workflow.progress import Progress, silent

TABLES: dict[str, Callable[..., str | bytes]] = {"csv": csv, "parquet": parquet}


def simulate(
    vehicle: str | Path,
    scenario: str | Path,
    *,
    seed: int | None = None,
    effects: Mapping[str, float | Sequence[float]] | None = None,
    hide: int | None = None,
    hidden: int | None = None,
    table: str = "csv",
    progress: Progress = silent,
) -> Report:
    """Reads a vehicle file and a scenario, and simulates; the log and the truth become files of the report.

    Args:
        vehicle: path of a vehicle file, or the name of a shipped one (otter, vectored_rov).
        scenario: path of a scenario file, or the name of the vehicle that a shipped one is for.
        seed: in place of the scenario's.
        effects: further numbers by id of the catalogue; several in the order of its parameters, or one by id.part or id.NAME.
        hide: draws the effect (none in one case of three), and the noise if no seed is given, from this seed; neither seed is in
            the result.
        hidden: number of effects that ``hide`` draws.
        table: the log's format, csv or parquet.
        progress: told of each step.

    Raises:
        IvsidError: an unusable file or number, in one sentence.
    """
    vehicle, scenario = shipped(vehicle, ""), shipped(scenario, "_programme")
    checked, programme = read_vehicle(vehicle), read_scenario(scenario)
    given: dict[str, float] = {}
    for id_, values in (effects or {}).items():
        numbers = [values] if isinstance(values, (int, float)) else list(values)
        effect = EFFECTS.get(id_)
        measured = effect is not None and as_logged(effect, programme) is not effect
        given |= spread(id_, numbers, measured=measured)
    if table not in TABLES:
        raise IvsidError(f"a log is not written as '{table}'; {meant(table, TABLES)}use {' or '.join(TABLES)}")
    if hide is not None:
        if effects:
            raise IvsidError("--hide draws the effect itself; leave --effect out")
        if hidden is None:
            given = simulation.hidden_effect(checked, programme, hide)
        else:
            given = simulation.hidden_effects(checked, programme, hide, hidden)
        # The seed of the noise would let a reader remove the noise: it is drawn from the hidden seed, and not printed.
        seed = _noise_seed(hide) if seed is None else seed
    elif hidden is not None:
        raise IvsidError("--effects says how many effects --hide draws; give --hide SEED with it")
    progress(f"simulating {programme.duration:g} s at {programme.rate:g} Hz")
    made = simulation.simulate(checked, programme, seed, given)
    name = f"log.{table}"
    content = TABLES[table](made.t, made.columns)
    digest = hashlib.sha256(content if isinstance(content, bytes) else content.encode()).hexdigest()
    log = Log(name, digest, made.t, made.columns)
    used = made.truth["seed"] if hide is None else None
    inputs = {
        Path(vehicle).name: checked.sha256,
        Path(scenario).name: hashlib.sha256(Path(scenario).read_bytes()).hexdigest(),
    }
    record = {
        **envelope("simulate", inputs, used),
        "log": {"name": name, "sha256": digest, "samples": made.t.size, "columns": ["t", *made.columns]},
        "truth": "truth.json" if hide is None else None,
    }
    drawing = figures.channels(log)
    where = "The truth stands in truth.json." if hide is None else "The truth stands apart from this folder."
    sections = (Section("The log", (page.drawing(drawing), page.text(where))),)
    summary = f"{made.t.size} samples of {checked.name}" + (f", seed {used}." if hide is None else ".")
    return Report(
        f"Simulation of {checked.name}",
        summary,
        record,
        sections,
        (drawing,),
        {name: content, "truth.json": to_json(made.truth) + "\n"},
        (f"  {name}: the log; truth.json: what is true of it",),
    )


def _noise_seed(hide: int) -> int:
    return int(np.random.default_rng([hide, 0x5EED]).integers(2**53))
