"""Throughput of ``ivsid fleet`` against the number of logs and of workers, the bytes that move, and the same tables with workers killed.

    PYTHONPATH=python python benches/fleet_throughput.py FOLDER [LOGS [FIRST CASE]]

FOLDER gets the simulated logs, which a later run takes as they are. Prints the tables of docs/fleet.md.
"""

import multiprocessing
import os
import shutil
import signal
import sys
import time
from pathlib import Path

import ivsid
from ivsid.files.shipped import shipped
from ivsid.fleets import parquet, tables
from ivsid.fleets.crew import crew_of
from ivsid.programme.scenario import read_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import read_vehicle
from ivsid.workflow.log_files import parquet as log_file

# Seconds and samples per second of each log.
DURATION, RATE = 60.0, 20.0
# The drag grows by a sixth in the middle of the season.
CHANGE = {"drag.surge.quadratic": 40.0}
TABLES = ("changes", "contradictions", "findings", "logs", "parameters", "pooled")


def make(given):
    """One log, unless it is there."""
    folder, number, whole = given
    path = Path(folder) / f"day{number:05d}.parquet"
    if path.exists():
        return
    vehicle = read_vehicle("swan")
    programme = read_scenario(shipped("swan_train", "_programme")).model_copy(
        update={"duration": DURATION, "rate": RATE}
    )
    made = simulate(vehicle, programme, number + 1, CHANGE if number >= whole // 2 else {}, thrusters=7)
    path.write_bytes(log_file(made.t + 1.7e9 + 86400.0 * number, made.columns))


def run(logs, vehicle, out, workers, kills=0):
    """A run into a new folder: time, traffic, tables."""
    shutil.rmtree(out, ignore_errors=True)
    killed = []
    begin = time.monotonic()
    with crew_of(None, workers) as crew:
        started = time.monotonic() - begin

        def progress(step):
            due = step.startswith("identifying") and f" {len(logs) // 3 * (len(killed) + 1)} of" in step
            if due and len(killed) < kills:
                victim = next(iter(crew._client.run(os.getpid).values()))
                os.kill(victim, signal.SIGKILL)
                killed.append(victim)

        begin = time.monotonic()
        found = ivsid.fleet(logs, vehicle, out, scheduler=crew._client, diagnose=False, progress=progress)
        took = time.monotonic() - begin
    made = tables(found)
    return found, started, took, {n: parquet(made[n]) for n in TABLES}, len(killed)


def main():
    """Prints the tables."""
    folder, number = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    (folder / "logs").mkdir(parents=True, exist_ok=True)
    with multiprocessing.Pool(2) as pool:
        pool.map(make, [(folder / "logs", k, number) for k in range(number)], chunksize=8)
    boat = folder / "boat.toml"
    boat.write_text(read_vehicle("swan").text.replace("confidence = 0.999", "confidence = 0.9999999"))
    paths = sorted((folder / "logs").glob("*.parquet"))[:number]
    size = sum(p.stat().st_size for p in paths) / len(paths)
    print(f"{len(paths)} logs of {size / 1e3:.1f} kB")
    print(
        "| logs | workers | killed | start [s] | identify [s] | pool [s] | drift [s] | whole [s] | logs/s identified | passes | sent/log [B] | received/log [B] | finished/log [B] |"
    )
    print("|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|")
    known = {}
    # The whole season changes in its middle, its first half does not.
    half, eighth = number // 2, number // 8
    cases = [(number, 2, 0), (number, 2, 2), (half, 2, 0), (eighth, 2, 0), (eighth, 1, 0)]
    for count, workers, kills in cases[int(sys.argv[3]) if len(sys.argv) > 3 else 0 :]:
        some = paths[:count]
        found, started, took, content, killed = run(some, boat, folder / "out", workers, kills)
        same = known.setdefault(count, content) == content
        t, s = found.traffic, found.traffic.seconds
        finished = sum(p.stat().st_size for p in (folder / "out" / "done").rglob("*.json"))
        print(
            f"| {count} | {workers} | {killed} | {started:.1f} | {s['identify']:.1f} | {s['pool']:.2f} | {s['drift']:.2f} | {took:.1f} | "
            f"{count / s['identify']:.1f} | {t.passes} | {t.sent / count:.0f} | {t.received / count:.0f} | {finished / count:.0f} |",
            flush=True,
        )
        assert same, "the tables differ"
        print(
            f"<!-- {found.pooled.solved.status}, {len(found.drift.periods)} periods, {len(found.drift.pairs)} pairs, tried {found.drift.tried} -->",
            flush=True,
        )
    print("the tables of runs with the same logs are the same, byte for byte")


if __name__ == "__main__":
    main()
