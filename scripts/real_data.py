"""Every command on every real set: ``python scripts/real_data.py DATA OUT`` (DATA holds cse1, rov_30k, t200, sim_truth_pvs).

Leaves a folder with its report for each command in OUT, and prints one line a parameter: what docs/vessels.md is written from.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ivsid import IvsidError, report, workflow

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
# A tank that tows and pulls: what the captive tests of CyberShip say of the parameters of its free runs.
TOWED = {"drag.surge.linear": 0.137, "drag.surge.quadratic": 3.088}


def main(data: Path, out: Path) -> None:
    """Runs import, thrust, allan, simulate, identify and validate on all sets."""

    def run(name: str, work: Callable[[], Any]) -> dict[str, Any] | None:
        start = time.perf_counter()
        try:
            made = work()
        except IvsidError as refusal:
            print(f"{name}: refused: {refusal}", flush=True)
            return None
        report.write(made, out / name)
        print(f"{name}: {time.perf_counter() - start:.1f} s; {made.summary}", flush=True)
        record: dict[str, Any] = made.record
        return record

    for name, folder in (("cse1", "cse1"), ("rov30k", "rov_30k"), ("t200", "t200")):
        run(name, lambda n=name, f=folder: workflow.import_set(n, data / f))  # type: ignore[misc]
    tables = sorted([*(out / "t200").glob("t200_*V.csv"), *(out / "cse1").glob("vsp_*.csv"), *(out / "cse1").glob("bow*.csv")])
    for table in tables:
        found = run(f"thrust_{table.stem}", lambda t=table: workflow.thrust(t))  # type: ignore[misc]
        if found:
            best = next(f for f in found["fits"] if f["name"] == found["recommended"])
            print(f"    {found['recommended']}, band {best['band']:.3g} N; thrust {found['thrust_range']}")
    deck = run("allan_rov_deck", lambda: workflow.allan(data / "rov_30k" / "20150518--1335_deck_imu.csv.gz"))
    for channel, c in (deck or {"channels": {}})["channels"].items():
        print(f"    {channel}: N {c['random_walk']:.3g}, B {c['bias_instability']:.3g}, K {c['rate_random_walk']:.3g}, {c['bands']}")
    for name in ("otter", "vectored_rov"):
        run(f"simulate_{name}", lambda n=name: workflow.simulate(n, n))  # type: ignore[misc]
    otter = data / "sim_truth_pvs"
    cse1, rov = out / "cse1", out / "rov30k"
    fits = (
        ("otter_plain", EXAMPLES / "otter.toml", otter / "otter_calm.csv.gz", 1.0, ()),
        ("otter", EXAMPLES / "otter_extended.toml", otter / "otter_calm.csv.gz", 1.0, ("otter_current_0p4_30deg.csv.gz",)),
        ("cse1_run1", cse1 / "cse1.toml", cse1 / "random_run1.csv", 5.0, ("random_run3.csv",)),
        ("cse1_run1_20s", cse1 / "cse1.toml", cse1 / "random_run1.csv", 20.0, ("random_run3.csv",)),
        ("cse1_run3", cse1 / "cse1.toml", cse1 / "random_run3.csv", 5.0, ("random_run1.csv",)),
        ("cse1_no_thrust", cse1 / "cse1.toml", cse1 / "run1.csv", 5.0, ()),
        ("rov_manual", rov / "rov30k.toml", rov / "manual.csv", 1.0, ("automatic.csv",)),
        ("rov_manual_10s", rov / "rov30k.toml", rov / "manual.csv", 10.0, ("automatic.csv",)),
        ("rov_automatic", rov / "rov30k.toml", rov / "automatic.csv", 1.0, ("manual.csv",)),
        ("rov_automatic_10s", rov / "rov30k.toml", rov / "automatic.csv", 10.0, ("manual.csv",)),
    )
    for name, vehicle, log, window, others in fits:
        made = run(f"identify_{name}", lambda v=vehicle, f=log, w=window: workflow.identify(v, f, window=w))  # type: ignore[misc]
        if made is None:
            continue
        print(f"    {made['status']}, guaranteed {made['guaranteed']}, inflation {made['inflation']}, rows {made['rows']}")
        for id_, p in made["parameters"].items():
            towed = f"  (towing tank {TOWED[id_]:g})" if "cse1" in name and id_ in TOWED else ""
            print(f"    {id_} [{float(p['lower']):.4g}, {float(p['upper']):.4g}] {p['unit']}{towed}")
        for other in others:
            beside = log.parent / other
            checked = run(f"validate_{name}", lambda n=name, b=beside: workflow.validate(out / f"identify_{n}", b))  # type: ignore[misc]
            if checked:
                for channel, f in checked["force"].items():
                    print(
                        f"    {channel}: error {f['error_mean']:.3g} +- {f['error_sigma']:.3g} {f['unit']}, "
                        f"{f['falsified_samples']} of {f['rows']} rows contradict"
                    )
                print(f"    motion: {checked['motion']['median'] or checked['motion']['reason']}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
