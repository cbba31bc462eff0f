"""Twins with a known truth: is it inside what ``identify`` proves? 500 of them with ``make twins``, a few in the tests.

Each twin has a vehicle, noise and parameters of its own, from its seed alone. Prints a Markdown table.
"""

import argparse
import math
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from ivsid import identify, verify
from ivsid.log import Log
from ivsid.programme.scenario import Scenario, parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import Vehicle, parse_vehicle

# Vehicle file, programme, the length of its part that is used [s], and terms that both the twin and its model go without.
VEHICLES = {
    "SWAN": ("swan.toml", "swan_train.toml", 100.0, ()),
    "Otter": (
        "otter.toml",
        "otter_programme.toml",
        120.0,
        ("drag.cross_flow", "added_mass.munk", "drag.yaw.quadratic"),
    ),
    "vectored ROV": ("vectored_rov.toml", "vectored_rov_programme.toml", 60.0, ()),
}
ROWS = ("pointwise", "integral")


@cache
def prepared(name: str) -> tuple[Vehicle, Scenario]:
    """A vehicle with a model whose every term the programme's truth has."""
    vehicle_file, programme, duration, without = VEHICLES[name]
    text, words = ((files("ivsid") / "data" / n).read_text() for n in (vehicle_file, programme))
    for term in without:
        text = text.replace(f'"{term}", ', "").replace(f', "{term}"', "").replace(f'"{term}",', "")
    scenario = parse_scenario(words, programme)
    truth = {k: v for k, v in scenario.truth.items() if k not in without}
    return parse_vehicle(text, vehicle_file), scenario.model_copy(update={"duration": duration, "truth": truth})


def twin(seed: int, noise: str, rule: str = "confidence = 0.999", *, checked: bool = False) -> dict[str, object]:
    """One twin identified with pointwise or integral rows, and whether its truth is inside.

    Args:
        seed: decides everything.
        noise: ``uniform`` up to the stated bounds, or ``gaussian``.
        rule: of the file's [sensors].
        checked: whether ``verify`` proves the result, too.
    """
    rng = np.random.default_rng(50_000 + seed)
    name = list(VEHICLES)[seed % len(VEHICLES)]
    rows = ROWS[(seed // len(VEHICLES)) % 2]
    vehicle, scenario = prepared(name)
    truth = {k: v * float(rng.uniform(0.8, 1.25)) for k, v in scenario.truth.items()}
    made = simulate(vehicle, scenario.model_copy(update={"truth": truth, "noise": noise}), seed)
    log = Log("twin.csv", "0" * 64, made.t, made.columns)
    judged = parse_vehicle(vehicle.text.replace("confidence = 0.999", rule), "twin.toml")
    fit = identify(judged, log, rows=rows)
    inside = fit.status != "empty" and all(p.lower <= truth[k] <= p.upper for k, p in fit.parameters.items())
    proved = None
    if checked:
        with tempfile.TemporaryDirectory() as folder:
            fit.save(Path(folder) / "result.json")
            proved = verify(Path(folder) / "result.json", log).proved
    return {
        "vehicle": name,
        "rows": rows,
        "status": fit.status,
        "guaranteed": fit.guaranteed,
        "inside": inside,
        "ends": sum(math.isfinite(e) for p in fit.parameters.values() for e in (p.lower, p.upper)),
        "proved": proved,
    }


def _one(job: tuple[int, str, str, bool]) -> dict[str, object]:
    seed, noise, rule, checked = job
    return twin(seed, noise, rule, checked=checked)


def main() -> None:
    """Counts over many twins."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--twins", type=int, default=500)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--verify", action="store_true")
    options = parser.parse_args()
    say, extra = sys.stdout.write, options.verify
    say("| noise, rule | vehicle | rows | twins | truth inside | called guaranteed | statuses |")
    say(" proved |\n" if extra else "\n")
    say("|---|---|---|---|---|---|---|" + ("---|\n" if extra else "\n"))
    for noise, rule, share in (
        ("uniform", "confidence = 0.999", 1),
        ("gaussian", "confidence = 0.999", 1),
        ("gaussian", "sigmas = 3", 10),
    ):
        jobs = [(seed, noise, rule, extra) for seed in range(options.twins // share)]
        with ProcessPoolExecutor(options.jobs) as pool:
            found = list(pool.map(_one, jobs, chunksize=2))
        for name in VEHICLES:
            for rows in ROWS:
                mine = [f for f in found if f["vehicle"] == name and f["rows"] == rows]
                counts = Counter(str(f["status"]) for f in mine)
                inside, called, proved = (sum(bool(f[k]) for f in mine) for k in ("inside", "guaranteed", "proved"))
                words = ", ".join(f"{k} {v}" for k, v in counts.items())
                say(f"| {noise}, {rule} | {name} | {rows} | {len(mine)} | {inside} | {called} | {words} |")
                say(f" {proved} |\n" if extra else "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
