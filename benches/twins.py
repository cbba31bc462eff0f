"""Share of 100 seeded twins whose truth lies in each method's interval, with noise at the stated bounds.

Run: .venv/bin/python benches/twins.py [--twins 100] [--noise uniform|gaussian] [--sigmas 3]
Prints a Markdown table: share of twins in which a method gave intervals for every parameter, in which all of them held the
truth, and the median width of each parameter's interval.
"""

import argparse
from importlib.resources import files

import numpy as np

from ivsid import identify
from ivsid.identification import METHODS
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle


def main() -> None:
    """Simulates, identifies by every method, counts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--twins", type=int, default=100)
    parser.add_argument("--noise", choices=("uniform", "gaussian"), default="uniform")
    parser.add_argument("--sigmas", type=float, default=None)
    options = parser.parse_args()
    data = files("ivsid") / "data"
    text = (data / "swan.toml").read_text()
    vehicle = parse_vehicle(text, "swan.toml")
    judged = vehicle
    if options.sigmas is not None:
        judged = parse_vehicle(text.replace("confidence = 0.999", f"sigmas = {options.sigmas}"), "swan.toml")
    scenario = parse_scenario((data / "swan_train.toml").read_text(), "swan_train.toml")
    names = list(scenario.truth)
    given, held = dict.fromkeys(METHODS, 0), dict.fromkeys(METHODS, 0)
    called = dict.fromkeys(METHODS, 0)
    widths: dict[str, list[list[float]]] = {m: [] for m in METHODS}
    for seed in range(options.twins):
        rng = np.random.default_rng(10_000 + seed)
        truth = {
            "mass.surge": float(rng.uniform(55, 90)),
            "drag.surge.quadratic": float(rng.uniform(150, 400)),
            "inertia.yaw": float(rng.uniform(7, 20)),
        }
        made = simulate(vehicle, scenario.model_copy(update={"truth": truth, "noise": options.noise}), seed)
        log = Log("twin.csv", "", made.t, made.columns)
        for method in METHODS:
            fit = identify(judged, log, method)
            called[method] += fit.guaranteed
            if set(fit.parameters) != set(names):
                continue
            given[method] += 1
            held[method] += all(fit.parameters[n].lower <= truth[n] <= fit.parameters[n].upper for n in names)
            widths[method].append([fit.parameters[n].width for n in names])
    print(
        f"{options.twins} twins, {options.noise} noise, {'confidence 0.999' if options.sigmas is None else f'{options.sigmas} sigmas'}\n"
    )
    print(
        "| method | called guaranteed | gave intervals | all held the truth | median width: " + ", ".join(names) + " |"
    )
    print("|---|---|---|---|---|")
    for m in METHODS:
        shown = ", ".join(f"{w:.3g}" for w in np.median(widths[m], axis=0)) if widths[m] else "–"
        print(f"| {m} | {called[m]} | {given[m]} | {held[m]} | {shown} |")


if __name__ == "__main__":
    main()
