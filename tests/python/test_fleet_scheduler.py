"""A scheduler that is killed in the middle of a run: one sentence, and the next run with another one goes on from there."""

import json
import subprocess
import sys
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

from command_line import COMMAND, run_process
from fleet_logs import season

pytestmark = [
    # Clusters of several processes, and 24 identifications twice.
    pytest.mark.nightly,
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra fleet is not installed"),
]


@contextmanager
def cluster(folder):
    """A scheduler and a worker in processes of their own, and its address."""
    folder.mkdir()
    place, dask = folder / "scheduler.json", str(Path(sys.executable).parent / "dask")
    begun = []

    def begin(*words):
        with (folder / "said.txt").open("ab") as said:
            begun.append(subprocess.Popen([dask, *words, "--no-dashboard"], stdout=said, stderr=said, cwd=folder))

    try:
        begin("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(place))
        end = time.monotonic() + 120
        while not place.exists() or not place.read_text().endswith("}"):
            assert time.monotonic() < end, (folder / "said.txt").read_text()
            time.sleep(0.1)
        address = json.loads(place.read_text())["address"]
        begin("worker", address, "--no-nanny", "--nthreads", "1", "--death-timeout", "60")
        import distributed

        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(1, timeout=120)
        yield begun[0], address
    finally:
        for process in begun:
            process.kill()
            process.wait()


def content(out):
    return {p.name: p.read_bytes() for p in out.glob("*.parquet") if p.name != "times.parquet"}


def test_a_killed_scheduler_gets_a_sentence_and_the_next_one_resumes(tmp_path):
    logs, out, undisturbed = tmp_path / "logs", tmp_path / "out", tmp_path / "one"
    season(logs, 24, 12, effects={"drag.surge.quadratic": 40.0})
    words = ["fleet", logs, "--vehicle", "swan", "--no-diagnose"]

    def finished():
        return {p.name: p.stat().st_mtime_ns for p in (out / "done").rglob("*.json")}

    with cluster(tmp_path / "first") as (scheduler, address):
        command = [*COMMAND, *map(str, words), "--scheduler", address, "--out", str(out)]
        running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while len(finished()) < 4 and running.poll() is None:
            time.sleep(0.02)
        scheduler.kill()
        _, said = running.communicate(timeout=120)
    assert running.returncode == 2, said
    assert "Traceback" not in said and "internal fault" not in said
    assert f"the scheduler at {address} was lost in the middle of the work" in " ".join(said.split())
    before = finished()
    assert 4 <= len(before) < 24 and not list(out.glob("*.parquet"))

    with cluster(tmp_path / "second") as (_, address):
        made = run_process(*words, "--scheduler", address, "--out", out)
        assert made.returncode == 0, made.stderr
    after = finished()
    assert len(after) == 24 and all(after[name] == when for name, when in before.items())
    made = run_process(*words, "--workers", "0", "--out", undisturbed)
    assert made.returncode == 0, made.stderr
    assert content(out) == content(undisturbed) and len(content(out)) >= 6
