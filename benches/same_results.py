"""Comparison of the results of two checkouts: ``python benches/same_results.py make DATA OUT`` in each, then ``... compare A B``.

A fixed set of logs (simulated from built-in vehicles, and public data where DATA holds them) goes through the command line of the
installed package. ``compare`` holds every result.json, vehicle file and certificate of one folder against those of the other, value by
value, and names each difference. Only the command line is used, so the two checkouts may differ in everything behind it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
BUILT_IN = ROOT / "python" / "ivsid" / "data"
NAMES = ("result.json", "falsified.json", "guaranteed.json", "model.toml", "vehicle.toml")
# A second log of each programme: the same segments under another seed.
OTHER_SEED = "12"


def commands(data: Path, out: Path) -> dict[str, list[str]]:
    """Arguments of ``ivsid`` by the name of their output folder, in the order in which they run."""
    todo: dict[str, list[str]] = {}
    swan, otter, rov = (str(BUILT_IN / f"{n}.toml") for n in ("swan", "otter", "vectored_rov"))
    for name, vehicle, programme, effects in (
        ("swan_train", swan, str(BUILT_IN / "swan_train.toml"), ()),
        ("swan_test", swan, str(BUILT_IN / "swan_test.toml"), ()),
        ("otter_null", "otter", "otter", ()),
        ("otter_delay", "otter", "otter", ("thruster.delay=0.4",)),
        ("rov_train", "vectored_rov", "vectored_rov", ()),
        ("rov_current", "vectored_rov", "vectored_rov", ("current.steady=0.08,0.05",)),
    ):
        given = [x for e in effects for x in ("--effect", e)]
        todo[name] = ["simulate", vehicle, programme, "--seed", "11", *given]
        todo[f"{name}_other"] = ["simulate", vehicle, programme, "--seed", OTHER_SEED, *given]

    def log(name: str) -> str:
        return str(out / name / "log.csv")

    for method in (
        "feasible",
        "qr",
        "exact",
        "partitioned",
        "hansen-bliek-rohn",
        "krawczyk",
        "cramer",
        "augmented",
        "kuttler",
        "neumaier",
        "published",
        "published-hull",
    ):
        todo[f"identify_swan_{method}"] = ["identify", swan, log("swan_train"), "--method", method]
    todo["identify_otter"] = ["identify", otter, log("otter_null")]
    todo["identify_rov_outliers"] = ["identify", rov, log("rov_train"), "--outliers", "1"]
    todo["validate_swan"] = ["validate", str(out / "identify_swan_feasible"), log("swan_test")]
    todo["validate_otter"] = ["validate", str(out / "identify_otter"), log("otter_null_other")]
    todo["diagnose_swan"] = ["diagnose", swan, log("swan_train"), log("swan_test")]
    for name in ("otter_null", "otter_delay"):
        todo[f"diagnose_{name}"] = ["diagnose", otter, log(name), log(f"{name}_other")]
    todo["diagnose_rov_current"] = ["diagnose", rov, log("rov_current"), log("rov_current_other")]
    todo["isolability_otter"] = ["isolability", otter, "otter"]
    todo["isolability_rov"] = ["isolability", rov, log("rov_train")]
    if (data / "cse1").is_dir():
        todo["cse1"] = ["import", "cse1", str(data / "cse1")]
        ship = str(out / "cse1" / "cse1.toml")
        runs = [str(out / "cse1" / f"random_run{k}.csv") for k in (1, 3)]
        todo["identify_cse1"] = ["identify", ship, runs[0], "--window", "5"]
        todo["identify_cse1_weak"] = ["identify", ship, runs[0], "--window", "3", "--rows", "weak"]
        todo["validate_cse1"] = ["validate", str(out / "identify_cse1"), runs[1]]
        todo["diagnose_cse1"] = ["diagnose", ship, *runs, "--null-logs", "8"]
    if (data / "sim_truth_pvs").is_dir():
        calm, current = (str(data / "sim_truth_pvs" / f"{n}.csv.gz") for n in ("otter_calm", "otter_current_0p4_30deg"))
        todo["identify_third"] = ["identify", str(EXAMPLES / "otter_extended.toml"), calm, "--window", "1"]
        todo["diagnose_third"] = ["diagnose", str(EXAMPLES / "otter.toml"), calm, current, "--null-logs", "8"]
    return todo


def make(data: Path, out: Path) -> None:
    """Runs every command that has not left its result yet, each with a cache of its own."""
    for name, arguments in commands(data, out).items():
        if (out / name / "result.json").exists():
            continue
        start = time.perf_counter()
        line = [sys.executable, "-c", "from ivsid.cli import main; main()", *arguments, "--out", str(out / name)]
        alone = {"XDG_CACHE_HOME": str(out / "cache"), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        done = subprocess.run(line, capture_output=True, text=True, env={**os.environ, **alone}, check=False)
        said = (out / f"{name}.txt").write_text(done.stdout.replace(str(out), "OUT") + done.stderr)
        print(f"{name}: exit {done.returncode}, {time.perf_counter() - start:.1f} s, {said} characters", flush=True)


def differences(a: Any, b: Any, at: str = "") -> list[str]:
    """Places where two values of JSON differ; numbers have to be equal as they are written."""
    if isinstance(a, dict) and isinstance(b, dict):
        apart = [f"{at}.{k}: only in one" for k in sorted(a.keys() ^ b.keys())]
        return apart + [d for k in a.keys() & b.keys() for d in differences(a[k], b[k], f"{at}.{k}")]
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return [d for k, (x, y) in enumerate(zip(a, b, strict=True)) for d in differences(x, y, f"{at}[{k}]")]
    return [] if a == b and type(a) is type(b) else [f"{at}: {str(a)[:60]} -> {str(b)[:60]}"]


def comparable(file: Path, folder: Path) -> Any:
    """A result without the places where it was made: folders of inputs, and the seal over the text that names them."""
    record = json.loads(file.read_text().replace(str(folder), "OUT"))
    if isinstance(record, dict):
        record.pop("seal", None)
        if "vehicle_source" in record:
            record["vehicle_source"] = Path(record["vehicle_source"]).name
    return record


def compare(first: Path, second: Path) -> int:
    """Prints each difference; the number of results that differ."""
    files = {p.relative_to(x) for x in (first, second) for n in NAMES for p in x.glob(f"*/{n}")}
    differ = 0
    for file in sorted(files):
        one, other = first / file, second / file
        if not (one.exists() and other.exists()):
            found = ["only one of the two has it"]
        elif file.suffix == ".json":
            found = differences(comparable(one, first), comparable(other, second))
        else:
            found = [] if one.read_text() == other.read_text() else ["its text differs"]
        differ += bool(found)
        if found:
            print(f"{file}: {len(found)} differences: " + "; ".join(found[:5]))
    print(f"{len(files)} files compared, {differ} differ")
    return differ


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "make":
        make(Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve())
    elif len(sys.argv) == 4 and sys.argv[1] == "compare":
        sys.exit(1 if compare(Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()) else 0)
    else:
        sys.exit("use: same_results.py make DATA OUT, or same_results.py compare A B")
