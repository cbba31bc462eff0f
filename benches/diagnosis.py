"""Seconds of a diagnosis with its figures and files, 600 s at 20 Hz, beside a fit by hand in the same run.

Three logs: nothing is hidden, one effect, and a small one that is put to null logs. The peer fits five numbers of the model to the same log
with SciPy's ``least_squares``: windows of ten seconds, simulated in NumPy. It names no cause and has no interval.

Run: python benches/diagnosis.py [REPEATS]
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.optimize import least_squares

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.exam.draw import case

from ivsid.log import Log
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.report import page
from ivsid.vehicle import Vehicle
from ivsid.workflow import diagnosis as workflow

SEED, DURATION, RATE, WINDOW = 52001, 600.0, 20.0, 10.0
# What is hidden, its size in typical sizes, and null logs at most.
CASES = {
    "nothing hidden": (None, 0.0, 400),
    "one effect": ("drag.yaw.linear", 1.0, 400),
    # The smallest that stands beside every error of a thrust inside its accuracy: 0.1 did before plays were among them.
    "doubt": ("drag.yaw.linear", 0.115, 400),
}


def drawn(name: str) -> tuple[Vehicle, Log, Log]:
    """The vehicle and the two logs of a case."""
    effect, size, _ = CASES[name]
    what = {"what": "one", "effect": effect, "size": size} if effect else {"what": "none"}
    made = case(SEED, kind="twin", style="rich", duration=DURATION, rate=RATE, ambient=1.0, **what)
    return made.vehicle, *(Log(f"{k}.csv", "0" * 64, q.t, q.columns) for k, q in enumerate((made.train, made.test)))


def diagnosed(name: str, vehicle: Vehicle, train: Log, test: Log) -> str:
    """The diagnosis, its figures and its files, and what it said."""
    report = workflow.diagnosed(vehicle, train, test, null_logs=CASES[name][2])
    with tempfile.TemporaryDirectory() as folder:
        page.write(report, Path(folder))
    said = report.record["calibration"]["simulated"]
    nulls = "" if said is None else f", {said['logs']} null logs"
    findings = ", ".join(f["effect"] for f in report.record["findings"]) or "no finding"
    return f"{report.record['verdict']} ({findings}{nulls})"


def by_hand(vehicle: Vehicle, log: Log) -> np.ndarray:
    """The peer: masses, inertia and drags of a plain model by an output-error fit over windows."""
    c = log.columns
    force = np.zeros((3, log.t.size))
    for t in vehicle.thrusters:
        push = ThrustCurve(t.model_copy(update={"outside": "hold"})).value(c[f"demand_{t.name}"])
        along, across = np.cos(t.azimuth), np.sin(t.azimuth)
        force += np.stack([push * along, push * across, push * (t.position[0] * across - t.position[1] * along)])
    nu = np.stack([c["u"], c["v"], c["r"]])
    h, count = float(log.t[1] - log.t[0]), round(WINDOW * RATE)
    starts = np.arange(0, log.t.size - count, count)

    def rates(x: np.ndarray, push: np.ndarray, p: np.ndarray) -> np.ndarray:
        u, v, r = x
        return np.stack(
            [
                (push[0] + p[1] * v * r - p[3] * u * abs(u)) / p[0],
                (push[1] - p[0] * u * r - p[4] * v * abs(v)) / p[1],
                (push[2] + (p[0] - p[1]) * u * v) / p[2],
            ]
        )

    def errors(p: np.ndarray) -> np.ndarray:
        x, left = nu[:, starts], []
        for k in range(count):
            push = force[:, starts + k]
            one = rates(x, push, p)
            two = rates(x + 0.5 * h * one, push, p)
            three = rates(x + 0.5 * h * two, push, p)
            x = x + h / 6 * (one + 2 * two + 2 * three + rates(x + h * three, push, p))
            left.append(x - nu[:, starts + k + 1])
        return np.clip(np.nan_to_num(np.ravel(left), nan=10.0), -10.0, 10.0)

    first = np.array([60.0, 75.0, 9.0, 30.0, 150.0])
    return np.asarray(least_squares(errors, first, x_scale=first, bounds=(first / 10, first * 10), max_nfev=10).x)


def least(work: Callable[[], object], repeats: int) -> tuple[float, float, object]:
    """Least seconds of some runs, on the clock and of this process's processors, and the last result."""
    walls, spent, result = [], [], None
    for _ in range(repeats):
        wall, own = time.perf_counter(), time.process_time()
        result = work()
        walls.append(time.perf_counter() - wall)
        spent.append(time.process_time() - own)
    return min(walls), min(spent), result


def measured(names: list[str], repeats: int) -> dict[str, tuple[float, float, str]]:
    """Seconds on the clock of each case, the same over those of the peer, and what was said."""
    found = {}
    for name in names:
        vehicle, train, test = drawn(name)
        # The peer runs before and after, since other work comes and goes.
        peers = [least(lambda: by_hand(vehicle, train), 1)[0]]  # noqa: B023 - called at once
        wall, _, said = least(lambda: diagnosed(name, vehicle, train, test), repeats)  # noqa: B023 - called at once
        peers.append(least(lambda: by_hand(vehicle, train), 1)[0])  # noqa: B023 - called at once
        found[name] = (wall, wall / float(np.mean(peers)), str(said))
    return found


def main() -> None:
    """One row a case."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    say = sys.stdout.write
    diagnosed("nothing hidden", *drawn("nothing hidden"))
    for name, (wall, ratio, said) in measured(list(CASES), repeats).items():
        say(f"| {name} | {wall:.2f} s | {ratio:.2f} times the fit by hand | {said} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
