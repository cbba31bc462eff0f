"""Effects of typical size that contradict a fit of another log: by rows, by tubes, by both, and by neither.

Usage: python benches/refuted.py

Each vehicle is identified on a log without the effect, and validated on another one with it. Effects of all kinds are drawn at their typical
size. The last lines count sound logs of other seeds, on which neither may say anything.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from importlib.resources import files
from typing import Final

import numpy as np

from ivsid import identify, simulation, validate
from ivsid.effects import EFFECTS
from ivsid.log import Log
from ivsid.programme.scenario import Scenario, parse_scenario
from ivsid.simulation.hidden import can_hide, draw
from ivsid.vehicle import Vehicle, parse_vehicle

VEHICLES: Final = {"swan": ("swan_train", "swan_test"), "otter": ("otter_programme", "otter_programme")}
TRAINED, TESTED, THRUSTERS, SOUND = 1, 77, 5, 10


def log_of(vehicle: Vehicle, scenario: Scenario, seed: int, effects: Mapping[str, float] | None = None) -> Log:
    """A log of the same thrusters."""
    made = simulation.simulate(vehicle, scenario, seed, effects, thrusters=THRUSTERS)
    text = f"{seed} {sorted((effects or {}).items())}"
    return Log(f"{seed}.csv", hashlib.sha256(text.encode()).hexdigest(), made.t, made.columns)


def main() -> None:
    """Prints a line an effect, and the counts."""
    for name, programmes in VEHICLES.items():
        data = files("ivsid") / "data"
        vehicle = parse_vehicle((data / f"{name}.toml").read_text(), f"{name}.toml")
        train, test = (parse_scenario((data / f"{p}.toml").read_text(), p) for p in programmes)
        fit = identify(vehicle, log_of(vehicle, train, TRAINED))
        counts = dict.fromkeys(("rows alone", "tubes alone", "both", "neither"), 0)
        for number, (id_, effect) in enumerate(EFFECTS.items()):
            if not can_hide(effect, vehicle, test):
                continue
            hidden = draw(effect, 1.0, vehicle, test, np.random.default_rng(number))
            made = validate(fit, log_of(vehicle, test, TESTED, hidden))
            rows, tubes = sum(f.falsified for f in made.forces), dict(made.tubes.outside)
            kind = {(True, False): "rows alone", (False, True): "tubes alone", (True, True): "both"}.get(
                (rows > 0, any(tubes.values())), "neither"
            )
            counts[kind] += 1
            print(f"{name} {id_:<32} rows {rows:5d}, readings outside ({made.tubes.channels}) {list(tubes.values())}")
        said = [validate(fit, log_of(vehicle, test, TESTED + 1 + k)).contradicted for k in range(SOUND)]
        print(f"{name}: {counts}; {sum(said)} of {SOUND} sound logs contradicted")


if __name__ == "__main__":
    main()
