"""A log that does not fit in memory, identified, validated and verified: seconds, peak memory and bytes on disk against its rows.

The log repeats ten minutes of the paper's SWAN at 1 kHz, 12 columns of Parquet, with a gap of ten seconds between two runs. Each command runs
in a process of its own, whose peak of memory of its own (what no file stands behind) is read from /proc.

Run: python benches/large_log.py [ROWS ...] [csv]
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from importlib.resources import files
from pathlib import Path

import polars as pl

from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

# Memory that each command may allocate [bytes]; a command that asks for more ends with an error.
LIMIT = 2 * 10**9


def written(folder: Path, rows: int, ending: str) -> Path:
    """The log, written a run at a time."""
    texts = [(files("ivsid") / "data" / f"{n}.toml").read_text() for n in ("swan", "swan_train")]
    vehicle, scenario = parse_vehicle(texts[0], "swan"), parse_scenario(texts[1], "swan_train")
    made = simulate(vehicle, scenario.model_copy(update={"duration": 600.0, "rate": 1000.0}), 1)
    run = pl.DataFrame({"t": made.t, **made.columns})
    part, path = folder / "run.parquet", folder / f"log_{rows}.{ending}"
    run.write_parquet(part)
    runs = [
        pl.scan_parquet(part).with_columns(pl.col("t") + 610.0 * k).head(max(0, rows - k * run.height))
        for k in range(-(-rows // run.height))
    ]
    whole = pl.concat(runs)
    if ending == "csv":
        whole.sink_csv(path)
    else:
        whole.sink_parquet(path)
    return path


def measured(words: str, command: list[str]) -> None:
    """Runs a command under the limit, and prints its time and its peak of memory."""
    start, spent = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    code = "import resource, sys; resource.setrlimit(resource.RLIMIT_DATA, (%d, %d)); from ivsid.cli.entry import main; sys.exit(main())"
    child = subprocess.Popen(
        [sys.executable, "-c", code % (LIMIT, LIMIT), *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    most = 0
    while child.poll() is None:
        try:
            status = Path(f"/proc/{child.pid}/status").read_text()
        except OSError:
            break
        most = max(most, *(int(line.split()[1]) for line in status.splitlines() if line.startswith("RssAnon")), 0)
        time.sleep(0.02)
    last = (child.communicate()[1].decode().strip().splitlines() or [""])[-1]
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    processors = now.ru_utime + now.ru_stime - spent.ru_utime - spent.ru_stime
    print(
        f"  {words:10} {time.perf_counter() - start:8.1f} s, {processors:8.1f} s of the processors, {most / 1e6:6.3f} GB of memory, "
        f"exit code {child.returncode} {last if child.returncode else ''}",
        flush=True,
    )


def main() -> None:
    """Prints the table."""
    ending = "csv" if "csv" in sys.argv else "parquet"
    for rows in [int(float(a)) for a in sys.argv[1:] if a != "csv"] or [10**6, 10**7]:
        with tempfile.TemporaryDirectory(dir="/var/tmp", prefix="ivsid-large-") as name:
            folder = Path(name)
            path = written(folder, rows, ending)
            print(f"{rows:,} rows, {path.stat().st_size / 1e9:.3f} GB of {ending}", flush=True)
            measured("identify", ["identify", "swan", str(path), "--out", str(folder / "fit")])
            measured("validate", ["validate", str(folder / "fit"), str(path), "--out", str(folder / "checked")])
            measured("verify", ["verify", str(folder / "fit"), str(path), "--out", str(folder / "proof")])


if __name__ == "__main__":
    main()
