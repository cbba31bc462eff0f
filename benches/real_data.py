"""Every command on every real set: ``python benches/real_data.py DATA OUT`` (DATA holds cse1, rov_30k, t200, sim_truth_pvs).

Leaves a folder with its report for each command in OUT, and prints one line a parameter, the source of docs/vessels.md.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ivsid import IntervalArray, IvsidError, read_log, read_vehicle, regression, workflow
from ivsid.effects import terms_of
from ivsid.report import page
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
# Parameters of CyberShip's free runs from its captive tests: towing and bollard pulls.
TOWED = {"drag.surge.linear": 0.137, "drag.surge.quadratic": 3.088}


def claim(vehicle: Path, log: Path, values: dict[str, float], kind: str, window: float) -> str:
    """Consistency of independently known parameters with a log: the rest is identified with these fixed."""
    checked = read_vehicle(vehicle)
    rows = build_rows(
        bound_log(read_log(log, checked.log), checked), checked, terms_of(checked), kind=kind, window=window
    )
    ids = [t.id for t in rows.terms]
    held = [ids.index(i) for i in values]
    free = [j for j in range(len(ids)) if j not in held]
    known = rows.matrix[:, held] * IntervalArray(np.array([values[ids[j]] for j in held]))
    right = rows.right - known.sum(axis=1)
    matrix = rows.matrix[:, free]
    surge = rows.channel == 0
    found = regression.feasible_set(matrix[surge][:, [0, 1]], right[surge])
    named = "" if found.value is None else f" {ids[free[0]]} [{found.value.lower[0]:.4g}, {found.value.upper[0]:.4g}],"
    return f"{found.status}, inflation {found.inflation:.3g},{named} on {int(surge.sum())} rows of surge"


def run(out: Path, name: str, work: Callable[[], Any]) -> dict[str, Any] | None:
    """One command with its report, or its refusal."""
    start = time.perf_counter()
    try:
        made = work()
    except IvsidError as refusal:
        print(f"{name}: refused: {refusal}", flush=True)
        return None
    page.write(made, out / name)
    print(f"{name}: {time.perf_counter() - start:.1f} s; {made.summary}", flush=True)
    record: dict[str, Any] = made.record
    return record


def main(data: Path, out: Path) -> None:
    """Runs import, thrust, allan, simulate, identify and validate on all sets."""
    for name, folder in (("cse1", "cse1"), ("rov30k", "rov_30k"), ("t200", "t200")):
        run(out, name, lambda n=name, f=folder: workflow.import_set(n, data / f))  # type: ignore[misc]
    tables = sorted(
        [*(out / "t200").glob("t200_*V.csv"), *(out / "cse1").glob("vsp_*.csv"), *(out / "cse1").glob("bow*.csv")]
    )
    for table in tables:
        found = run(out, f"thrust_{table.stem}", lambda t=table: workflow.thrust(t))  # type: ignore[misc]
        if found:
            best = next(f for f in found["fits"] if f["name"] == found["recommended"])
            print(f"    {found['recommended']}, band {best['band']:.3g} N; thrust {found['thrust_range']}")
    deck = run(out, "allan_rov_deck", lambda: workflow.allan(data / "rov_30k" / "20150518--1335_deck_imu.csv.gz"))
    for channel, c in (deck or {"channels": {}})["channels"].items():
        print(
            f"    {channel}: N {c['random_walk']:.3g}, B {c['bias_instability']:.3g}, K {c['rate_random_walk']:.3g}, {c['bands']}"
        )
    for name in ("otter", "vectored_rov"):
        run(out, f"simulate_{name}", lambda n=name: workflow.simulate(n, n))  # type: ignore[misc]
    otter = data / "sim_truth_pvs"
    cse1, rov = out / "cse1", out / "rov30k"
    for kind, window in (("integral", 5.0), ("integral", 20.0), ("weak", 3.0), ("weak", 6.0)):
        for factor in (0.0, 0.5, 1.0, 2.0, 4.0):
            values = {i: factor * x for i, x in TOWED.items()}
            said = claim(cse1 / "cse1.toml", cse1 / "random_run1.csv", values, kind, window)
            print(f"    drag of the towing tank times {factor:g}, rows {kind} of {window:g} s: {said}", flush=True)
    fits_of(out, cse1, rov, otter)


def fits_of(out: Path, cse1: Path, rov: Path, otter: Path) -> None:
    """Identifies every log, and validates each fit on another one."""
    fits = (
        ("otter_plain", EXAMPLES / "otter.toml", otter / "otter_calm.csv.gz", 1.0, ()),
        (
            "otter",
            EXAMPLES / "otter_extended.toml",
            otter / "otter_calm.csv.gz",
            1.0,
            ("otter_current_0p4_30deg.csv.gz",),
        ),
        ("cse1_run1", cse1 / "cse1.toml", cse1 / "random_run1.csv", 5.0, ("random_run3.csv",)),
        ("cse1_run1_weak", cse1 / "cse1.toml", cse1 / "random_run1.csv", 3.0, ()),
        ("cse1_run1_20s", cse1 / "cse1.toml", cse1 / "random_run1.csv", 20.0, ("random_run3.csv",)),
        ("cse1_run3", cse1 / "cse1.toml", cse1 / "random_run3.csv", 5.0, ("random_run1.csv",)),
        ("cse1_no_thrust", cse1 / "cse1.toml", cse1 / "run1.csv", 5.0, ()),
        ("rov_manual", rov / "rov30k.toml", rov / "manual.csv", 1.0, ("automatic.csv",)),
        ("rov_manual_10s", rov / "rov30k.toml", rov / "manual.csv", 10.0, ("automatic.csv",)),
        ("rov_automatic", rov / "rov30k.toml", rov / "automatic.csv", 1.0, ("manual.csv",)),
        ("rov_automatic_10s", rov / "rov30k.toml", rov / "automatic.csv", 10.0, ("manual.csv",)),
    )
    for name, vehicle, log, window, others in fits:
        kind = "weak" if name.endswith("weak") else "auto"
        made = run(
            out,
            f"identify_{name}",
            lambda v=vehicle, f=log, w=window, k=kind: workflow.identify(v, f, window=w, rows=k),  # type: ignore[misc]
        )
        if made is None:
            continue
        print(
            f"    {made['status']}, guaranteed {made['guaranteed']}, inflation {made['inflation']}, rows {made['rows']}"
        )
        for id_, p in made["parameters"].items():
            towed = f"  (towing tank {TOWED[id_]:g})" if "cse1" in name and id_ in TOWED else ""
            print(f"    {id_} [{float(p['lower']):.4g}, {float(p['upper']):.4g}] {p['unit']}{towed}")
        for other in others:
            beside = log.parent / other
            checked = run(out, f"validate_{name}", lambda n=name, b=beside: workflow.validate(out / f"identify_{n}", b))  # type: ignore[misc]
            if checked:
                for channel, f in checked["force"].items():
                    print(
                        f"    {channel}: error {f['error_mean']:.3g} +- {f['error_sigma']:.3g} {f['unit']}, "
                        f"{f['falsified_samples']} of {f['rows']} rows contradict"
                    )
                print(f"    motion: {checked['motion']['median'] or checked['motion']['reason']}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
