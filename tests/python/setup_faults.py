"""Wrong set-ups as users make them, put into sound logs: each is one function of the columns of a log and the text of its vehicle file.

Prints the counts of docs/diagnosis.md: ``python tests/python/setup_faults.py --cases 100``.
"""

import argparse
import sys
from collections.abc import Callable, Iterator

import numpy as np
from tests.exam.cases import case

from ivsid.log import Log
from ivsid.setup import setup_findings
from ivsid.vehicle import parse_vehicle

Columns = dict[str, np.ndarray]
DEGREES = 57.29577951308232
KNOTS = 3600.0 / 1852.0
BARE = ("u", "v", "r", "demand_", "azimuth_", "rudder_")


def times(**factors: float) -> Callable[[Columns], Columns]:
    return lambda c: {k: x * factors.get(k, 1.0) for k, x in c.items()}


def exchanged(a: str, b: str) -> Callable[[Columns], Columns]:
    return lambda c: {**c, a: c[b], b: c[a]}


def bare(c: Columns) -> Columns:
    """Velocities and demands alone."""
    return {k: x for k, x in c.items() if k.startswith(BARE)}


def compass(c: Columns) -> Columns:
    """The heading in degrees as a compass shows it, from 0 to 360."""
    return {**c, "psi": np.mod(c["psi"] * DEGREES, 360.0)}


# Faults of channels: the fault, and the ids of which one names it.
MOTION: dict[str, tuple[Callable[[Columns], Columns], tuple[str, ...]]] = {
    "yaw rate of the wrong sign": (times(r=-1), ("setup.yaw_rate.sign",)),
    "the same, with heading alone": (
        lambda c: {**times(r=-1)(bare(c)), "psi": c["psi"]},
        ("setup.yaw_rate.sign",),
    ),
    "heading of the wrong sign": (times(psi=-1), ("setup.heading.sign",)),
    "heading of the wrong sign, by the moment": (
        lambda c: {**bare(c), "psi": -c["psi"]},
        ("setup.heading.sign",),
    ),
    "surge velocity of the wrong sign": (times(u=-1), ("setup.surge_velocity.sign",)),
    "sway velocity of the wrong sign": (times(v=-1), ("setup.sway_velocity.sign",)),
    "acceleration ax of the wrong sign": (times(ax=-1), ("setup.surge_acceleration.sign",)),
    "acceleration ay of the wrong sign": (times(ay=-1), ("setup.sway_acceleration.sign",)),
    "u and v swapped": (exchanged("u", "v"), ("setup.velocity.axes",)),
    "ax and ay swapped": (exchanged("ax", "ay"), ("setup.acceleration.axes",)),
    "yaw rate in degrees": (times(r=DEGREES), ("setup.yaw_rate.unit",)),
    "yaw rate in degrees, without heading": (
        lambda c: {**times(r=DEGREES)(bare(c)), "ax": c["ax"], "ay": c["ay"]},
        ("setup.yaw_rate.unit",),
    ),
    "yaw rate in degrees, by the limits alone": (lambda c: times(r=DEGREES)(bare(c)), ("setup.r.limit",)),
    "heading in degrees": (compass, ("setup.heading.unit",)),
    "both in degrees": (lambda c: compass(times(r=DEGREES)(c)), ("setup.angles.unit",)),
    "accelerations in g": (times(ax=1 / 9.80665, ay=1 / 9.80665), ("setup.acceleration.unit",)),
    "accelerations in milli-g": (times(ax=1e3 / 9.80665, ay=1e3 / 9.80665), ("setup.acceleration.unit",)),
    "velocities in knots": (times(u=KNOTS, v=KNOTS), ("setup.velocity.unit",)),
    "velocities in km/h": (times(u=3.6, v=3.6), ("setup.velocity.unit",)),
}


def thruster_faults(c: Columns) -> Iterator[tuple[str, Columns, tuple[str, ...]]]:
    """Faults of demands and angles: the fault, the columns with it, and the ids of which one names it."""
    names = [k.removeprefix("demand_") for k in c if k.startswith("demand_")]
    for name in names[:1]:
        yield "a reversed thruster", times(**{f"demand_{name}": -1.0})(c), ("setup.thruster.reversed",)
        for angle in (f"rudder_{name}", f"azimuth_{name}"):
            if angle in c:
                yield "a rudder or azimuth of the wrong sign", times(**{angle: -1.0})(c), ("setup.angle.sign",)
    if len(names) > 1:
        swap = exchanged(f"demand_{names[0]}", f"demand_{names[1]}")
        yield "port and starboard swapped", swap(c), ("setup.thruster.swapped",)
    yield "yaw rate of the wrong sign, by the moment alone", times(r=-1)(bare(c)), ("setup.yaw_rate.sign",)


def log_of(t: np.ndarray, columns: Columns) -> Log:
    return Log("log.csv", "0" * 64, t, columns)


def named(text: str, t: np.ndarray, columns: Columns) -> list[str]:
    """The ids that the examination names."""
    return [f.id for f in setup_findings(parse_vehicle(text, "v.toml"), log_of(t, columns))]


def pulses(text: str, c: Columns, *, hold: bool) -> tuple[str, Columns]:
    """Demands as pulse widths where the tables take 100 for full thrust."""
    if hold:
        text = text.replace("accuracy = { absolute", 'outside = "hold"\naccuracy = { absolute')
    return text, {k: 1500.0 + 4.0 * x if k.startswith("demand_") else x for k, x in c.items()}


def main() -> None:
    """Counts over drawn cases."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--hidden", type=int, default=50)
    parser.add_argument("--seed", type=int, default=7000)
    options = parser.parse_args()
    counts: dict[str, list[int]] = {}
    alarms = []

    def counted(fault: str, found: list[str], ids: tuple[str, ...]) -> None:
        row = counts.setdefault(fault, [0, 0, 0])
        row[0] += 1
        row[1] += any(i in ids for i in found)
        row[2] += bool(found) and not any(i in ids for i in found)

    for seed in range(options.seed, options.seed + options.cases):
        drawn = case(seed, what="none", style="rich", duration=200.0, rate=10.0)
        columns = dict(drawn.logs[0])
        t = columns.pop("t")
        if found := named(drawn.text, t, columns):
            alarms.append((seed, found))
        for fault, (change, ids) in MOTION.items():
            counted(fault, named(drawn.text, t, change(columns)), ids)
        for fault, changed, ids in thruster_faults(columns):
            counted(fault, named(drawn.text, t, changed), ids)
        text, changed = pulses(drawn.text, columns, hold=True)
        counted("pulse widths for a table of ±100", named(text, t, changed), ("setup.demand.unit",))
    for seed in range(options.hidden):
        for what in ("none", "one", "two", "outside"):
            drawn = case(20_000 + seed, what=what, duration=300.0)
            for log in drawn.logs:
                columns = dict(log)
                t = columns.pop("t")
                row = counts.setdefault(f"sound, hidden: {what}", [0, 0, 0])
                row[0] += 1
                row[2] += bool(named(drawn.text, t, columns))
    say = sys.stdout.write
    say("| set-up | logs | named | named something else |\n|---|---|---|---|\n")
    for fault, (logs, right, wrong) in counts.items():
        say(f"| {fault} | {logs} | {right} | {wrong} |\n")
    say(f"alarms on sound logs: {alarms}\n")


if __name__ == "__main__":
    main()
