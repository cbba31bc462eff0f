"""Wrong set-ups as users make them, put into sound logs: each is one function of the columns of a log and the text of its vehicle file.

``python tests/python/setup_faults.py --cases 100`` prints counts as docs/diagnosis.md has them; ``--out`` holds them after each case.
"""

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np
from tests.exam.cases import case

from ivsid.log import Log
from ivsid.setup import setup_findings
from ivsid.vehicle import parse_vehicle

Columns = dict[str, np.ndarray]
DEGREES = 57.29577951308232
KNOTS = 3600.0 / 1852.0
BARE = ("u", "v", "r", "demand_", "azimuth_", "rudder_")


@cache
def drawn(seed, what="none", style="rich"):
    made = case(seed, what=what, style=style, duration=200.0, rate=10.0)
    columns = dict(made.logs[0])
    return made.text, columns.pop("t"), columns


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
                yield f"{angle.partition('_')[0]} in degrees", times(**{angle: DEGREES})(c), ("setup.angle.unit",)
                yield (
                    f"{angle.partition('_')[0]} in degrees, 0 to 360",
                    {**c, angle: np.mod(c[angle] * DEGREES, 360.0)},
                    ("setup.angle.unit",),
                )
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


def hundredths(text: str, c: Columns, *, fraction: bool, demands: float) -> tuple[str, Columns]:
    """Demands times a factor, beside tables that go to 100 as they are drawn, or to 1 and hold their ends."""

    def divided(match: re.Match[str]) -> str:
        return "demand = [" + ", ".join(repr(float(x) / 100) for x in match[1].split(",")) + "]"

    if fraction:
        text = re.sub(r"demand = \[([^\]]*)\]", divided, text)
        text = text.replace("accuracy = { absolute", 'outside = "hold"\naccuracy = { absolute')
    return text, {k: x * demands if k.startswith("demand_") else x for k, x in c.items()}


def counts(seeds: range, hidden: range) -> Iterator[dict[str, list[int]]]:
    """Logs, those whose fault is named, and those of which something else is said, by fault, after each seed."""
    found: dict[str, list[int]] = {}

    def counted(fault: str, ids: list[str], right: tuple[str, ...]) -> None:
        row = found.setdefault(fault, [0, 0, 0])
        row[0] += 1
        row[1] += any(i in right for i in ids)
        row[2] += bool(ids) and not any(i in right for i in ids)

    for seed in seeds:
        drawn = case(seed, what="none", style="rich", duration=200.0, rate=10.0)
        columns = dict(drawn.logs[0])
        t = columns.pop("t")
        counted("none", named(drawn.text, t, columns), ())
        for fault, (change, right) in MOTION.items():
            counted(fault, named(drawn.text, t, change(columns)), right)
        for fault, changed, right in thruster_faults(columns):
            counted(fault, named(drawn.text, t, changed), right)
        text, changed = pulses(drawn.text, columns, hold=True)
        counted("pulse widths for a table of ±100", named(text, t, changed), ("setup.demand.unit",))
        for fault, fraction, demands in (
            ("percentages for a table of ±1", True, 1.0),
            ("fractions for a table of ±100", False, 0.01),
        ):
            text, changed = hundredths(drawn.text, columns, fraction=fraction, demands=demands)
            counted(fault, named(text, t, changed), ("setup.demand.unit",))
        text, changed = hundredths(drawn.text, columns, fraction=True, demands=0.01)
        counted("none, tables of ±1", named(text, t, changed), ())
        yield found
    for seed in hidden:
        for what in ("none", "one", "two", "outside"):
            drawn = case(seed, what=what, duration=300.0)
            for log in drawn.logs:
                columns = dict(log)
                counted(f"none, hidden effects: {what}", named(drawn.text, columns.pop("t"), columns), ())
        yield found


def main() -> None:
    """Counts over drawn cases, printed when they are done or stopped."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--hidden", type=int, default=50)
    parser.add_argument("--seed", type=int, default=7000)
    parser.add_argument("--out", type=Path, default=Path("/tmp/setup_counts.json"))
    options = parser.parse_args()
    first = options.seed
    for found in counts(range(first, first + options.cases), range(first + 13_000, first + 13_000 + options.hidden)):
        options.out.write_text(json.dumps(found, ensure_ascii=False))
    say = sys.stdout.write
    say("| fault | logs | named | something else named |\n|---|---|---|---|\n")
    for fault, (logs, right, wrong) in found.items():
        say(f"| {fault} | {logs} | {right} | {wrong} |\n")


if __name__ == "__main__":
    main()
