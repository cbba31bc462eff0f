"""``ivsid example``: two logs of a simulated Otter with a cause that its vehicle file lacks, and a sealed file that names the cause."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Final

from ivsid import simulation
from ivsid.effects import sort_given
from ivsid.files.records import envelope, sealed, to_json
from ivsid.files.shipped import shipped
from ivsid.log import Log
from ivsid.programme.scenario import Scenario, read_scenario
from ivsid.report import figures, page
from ivsid.report.page import Report, Section
from ivsid.simulation.hidden import hidden_effects
from ivsid.vehicle import read_vehicle
from ivsid.workflow.log_files import csv
from ivsid.workflow.progress import Progress, silent

# Smallest and largest size of the hidden cause, as a multiple of its typical size: three minutes show it as a rule.
# Source: definition: the upper half of the sizes that ``ivsid simulate --hide`` draws
SIZES: Final = (1.0, 3.0)
# Seed of the example that the documents follow.
# Source: definition
SEED: Final = 2


def example(folder: str | Path, *, seed: int | None = None, progress: Progress = silent) -> Report:
    """Two logs, their vehicle file and their programme, as files of the report; ``truth.json`` names the hidden cause.

    Both runs have the same boat, with the same errors of its thrusters. The second one drives the segments of the programme in
    reverse order, with noise of its own.

    Args:
        folder: where the files will stand, for the commands in the report.
        seed: draws the cause and the noise; ``SEED`` by default.
        progress: told of each step.

    Raises:
        IvsidError: as ``simulation.simulate``.
    """
    seed = SEED if seed is None else seed
    vehicle_file, programme_file = shipped("otter"), shipped("example", "_programme")
    vehicle, first = read_vehicle(vehicle_file), read_scenario(programme_file)
    hidden = hidden_effects(vehicle, first, seed, 1, SIZES)
    second = first.model_copy(update={"segments": first.segments[::-1]})
    files: dict[str, str | bytes] = {
        "boat.toml": vehicle.text,
        "programme.toml": programme_file.read_text(),
    }
    drawings, truths, logs = [], {}, []
    for k, programme in enumerate((first, second), start=1):
        progress(f"simulating run {k}: {programme.duration:g} s at {programme.rate:g} Hz")
        made = simulation.simulate(vehicle, programme, noise_seed(seed, k), hidden, thrusters=noise_seed(seed, 0))
        name = f"run{k}.csv"
        text = csv(made.t, made.columns)
        digest = hashlib.sha256(text.encode()).hexdigest()
        files[name], truths[name] = text, made.truth
        logs.append({"name": name, "sha256": digest, "samples": made.t.size, "columns": ["t", *made.columns]})
        drawings.append(figures.channels(Log(name, digest, made.t, made.columns), f"run{k}"))
    (cause,) = (given.effect for given in sort_given(hidden))
    truth = {"seed": seed, "effect": cause.id, "cause": cause.cause, "numbers": hidden, "runs": truths}
    files["truth.json"] = to_json(sealed(truth)) + "\n"
    inputs = {
        "otter.toml": vehicle.sha256,
        programme_file.name: hashlib.sha256(programme_file.read_bytes()).hexdigest(),
    }
    command = f"ivsid diagnose {Path(folder) / 'boat.toml'} {Path(folder) / 'run1.csv'} {Path(folder) / 'run2.csv'}"
    record = {**envelope("example", inputs, seed), "logs": logs, "next": command}
    summary = f"Two runs of {vehicle.name}, {_length(first)}; one cause acts in both that boat.toml does not have."
    sections = (
        Section("Next", (page.text("This command names the cause:"), page.code(command))),
        Section("The logs", tuple(map(page.drawing, drawings))),
    )
    lines = ("  boat.toml, run1.csv, run2.csv, programme.toml", f"  next: {command}")
    return Report(f"Example: {vehicle.name}", summary, record, sections, tuple(drawings), files, lines)


def noise_seed(seed: int, run: int) -> int:
    """Seed of the noise of a run; that of run 0 draws the errors of the thrusters."""
    return 3 * seed + run


def _length(scenario: Scenario) -> str:
    return f"{scenario.duration:g} s at {scenario.rate:g} Hz each"
