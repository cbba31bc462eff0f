"""A minute that is planned on the demo's fit, beside the library, and on twins that the planner did not see: the table of docs/measurements.md.

Usage: python benches/plans.py [TWINS]
"""

from __future__ import annotations

import math
import sys
import time
from importlib.resources import files

import numpy as np

from ivsid import identify, plan, simulation
from ivsid.log import Log
from ivsid.plans.narrowing import Narrowing
from ivsid.plans.sailed import estimate_of, sail, scenario_of
from ivsid.programme.scenario import parse_scenario
from ivsid.programme.trials import library
from ivsid.vehicle import parse_vehicle

FENCE, SECONDS, RATE = 50.0, 60.0, 20.0


def main() -> None:
    """Prints predictions and what twins reach."""
    twins = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    data = files("ivsid") / "data"
    vehicle = parse_vehicle((data / "swan.toml").read_text(), "swan.toml")
    made = simulation.simulate(vehicle, parse_scenario((data / "swan_train.toml").read_text(), "swan_train"))
    fit = identify(vehicle, Log("train.csv", "0" * 64, made.t, made.columns))
    begun = time.perf_counter()
    found = plan(fit, fence=FENCE, seconds=SECONDS)
    print(f"planned in {time.perf_counter() - begun:.0f} s: from {found.before:.4f} to {found.predicted.median:.4f}")
    print(f"best of the library inside fence and limits: {found.best_rival}; fence: {found.fence.record()}")
    purpose = Narrowing(fit)
    for trial in library(vehicle):
        sailed = sail(vehicle, scenario_of(trial.segments, SECONDS, RATE, estimate_of(fit)), 1)
        if sailed is not None:
            words = f"value {purpose.value(sailed):.4f}, {sailed.reach:.1f} m, {sailed.hardest:.2f} of the limits, {sailed.spin:.2f} of the fastest turn"
            print(f"{trial.name:<32} {words}")
    rng = np.random.default_rng(7)
    reached, inside, farthest = [], 0, 0.0
    ids, n = list(fit.parameters), twins
    matrix, right = purpose.known
    for k in range(n):
        # A member of the set: points of the box are drawn until one meets every row.
        while True:
            truth = {i: float(rng.uniform(fit.parameters[i].lower, fit.parameters[i].upper)) for i in ids}
            held = (matrix * np.array([truth[i] for i in ids])).sum(axis=1)
            if bool(((held.lower <= right.upper) & (right.lower <= held.upper)).all()):
                break
        sailed = sail(vehicle, scenario_of(found.scenario.segments, SECONDS, RATE, truth), 10_000 + k)
        if sailed is None:
            continue
        inside += sailed.reach <= FENCE
        farthest = max(farthest, sailed.reach)
        if k < n // 5:
            reached.append(purpose.value(sailed))
    low, middle, high = np.quantile(reached, [0.05, 0.5, 0.95])
    print(
        f"{len(reached)} twins reach {middle:.4f} median ({low:.4f} to {high:.4f}), predicted {found.predicted.median:.4f}"
    )
    share = np.mean(np.abs(np.array(reached) / found.predicted.median - 1) <= 0.2)
    print(f"within 20 % of the prediction: {share:.3f}; fence kept by {inside} of {n}, farthest {farthest:.1f} m")
    assert math.isfinite(middle)


if __name__ == "__main__":
    main()
