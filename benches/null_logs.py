"""Do Gaussian draws, simulated null logs and fresh logs of the simulator agree on the largest score without an effect? Rows for the docs.

python benches/null_logs.py [NULL_LOGS] [FRESH_LOGS] [PROGRAMME ...]
"""

from __future__ import annotations

import os
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.exam.vessels import programme, vehicle_of

from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.calibration import examined, trial_of
from ivsid.diagnosis.null.examination import Families
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import visibility
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

LEVEL, SEED, DURATION = 0.005, 7, 300.0
SHARES = (0.5, 0.9)
OPEN = """
[[segments]]
manoeuvre = "prbs"
demand = 40.0
amplitude = 20.0
differential = 5.0
period = 3.0
duration = 60.0
"""


def drawn(style: str, rate: float):
    """A vehicle and a way to simulate its programme with any seed; ``open`` has no feedback."""
    rng = np.random.default_rng([SEED, 3])
    text, truth, scale = vehicle_of("twin", rng)
    vehicle = parse_vehicle(text + "[ambient]\nforce = 0.15\nmoment = 0.03\ntime = 2.0\n", "v.toml")
    segments = OPEN if style == "open" else programme(rng, DURATION, "twin", scale, style)
    numbers = "\n".join(f'"{k}" = {v}' for k, v in truth.items())
    scenario = parse_scenario(
        f"duration = {DURATION}\nrate = {rate}\nseed = 1\n[truth]\n{numbers}\n{segments}", "s.toml"
    )

    def log(seed: int) -> Log:
        made = simulate(vehicle, scenario, seed)
        return Log("1.csv", "0" * 64, made.t, made.columns)

    return vehicle, log


def fitted(vehicle, log):
    """The fit of a log, its test, and the largest strength over the tested candidates."""
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    visible = visibility(fit)
    seen = frozenset(i for i, v in visible.items() if v.tested)
    test = Threshold(calibrate(fit, seen, LEVEL, 1), visible)
    tested = tuple(c for c in fit.candidates if c.variants and c.id in seen)
    other, scored = score(replace(fit, candidates=tested))
    best = min((s.chance for s in scored if s.physical), default=1.0)
    return fit, test, -np.log(max(best, 1e-300)), bool(test(other, scored).passed)


def main() -> None:
    """One row a programme."""
    nulls, fresh = (int(a) for a in (sys.argv[1:3] + ["100", "20"][len(sys.argv[1:3]) :]))
    say = sys.stdout.write
    for style in sys.argv[3:] or ["rich", "zigzag", "circle", "line", "open"]:
        vehicle, log = drawn(style, 10.0)
        fit, test, _, _ = fitted(vehicle, log(100))
        gauss = -np.log(np.maximum(test.calibration.smallest, 1e-300))
        start = time.perf_counter()
        found = examined(trial_of(fit, test.visible, Families(test)), 1, range(nulls))
        spent = time.perf_counter() - start
        real = [fitted(vehicle, log(200 + k))[2:] for k in range(fresh)]
        cells = [
            [f"{np.quantile(x, q):.1f}" for q in SHARES]
            for x in (gauss, found.kept, np.array([s for s, _ in real]))
            if x.size
        ]
        words = " | ".join(" ".join(c) for c in cells)
        passed = f"{int(found.passed.sum())}/{found.kept.size} | {sum(p for _, p in real)}/{fresh}"
        thresholds = f"{-np.log(test.calibration.chance):.1f} | {found.threshold():.1f}"
        say(f"| {style} | {len(test.visible)} | {words} | {thresholds} | {passed} | {spent / nulls:.2f} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
