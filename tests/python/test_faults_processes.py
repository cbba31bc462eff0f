"""Processes that were started for a part of the work end with the one that started them, however it ends."""

import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from ivsid.intervals import apart
from ivsid.intervals.apart import Apart, Prepared, end_with_parent

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="nothing is forked here")
# Seconds in which a process has to notice: several looks at its parent, on a busy machine.
PATIENCE = 20 * apart.LOOK


def endless(path):
    """Announces its number, and works on."""
    Path(path).with_suffix(f".{os.getpid()}").touch()
    while True:
        sum(range(1000))


def parent_of(work, tmp_path, count):
    """A process that starts others by ``work`` and waits; its number, and theirs once all of them are at work."""
    pid = os.fork()
    if not pid:
        # Whatever becomes of the test, nothing of it stays.
        signal.alarm(120)
        try:
            work()
            time.sleep(600)
        finally:
            os._exit(0)
    end = time.monotonic() + 60
    while len(found := list(tmp_path.glob("at.*"))) < count and time.monotonic() < end:
        time.sleep(0.02)
    return pid, [int(f.suffix[1:]) for f in found]


def alive(pid):
    """Whether a process works: one that is dead and waits for its parent's question does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state not in "ZX"


def forked(place):
    # Two, so that the second holds what the first one watches.
    return lambda: [Apart(lambda: endless(place)), Apart(lambda: endless(place))]


def pooled(place):
    def work():
        pool = ProcessPoolExecutor(2, multiprocessing.get_context("spawn"), end_with_parent)
        for _ in range(2):
            pool.submit(endless, place)

    return work


def copied(place):
    # The second is forked by the first.
    def work():
        for one in Prepared.some(2, endless, tuple):
            one.begin(place)

    return work


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks the proc file system who lives")
@pytest.mark.parametrize("kind", [forked, pooled, copied])
@pytest.mark.parametrize("sign", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_workers_end_with_a_killed_parent(kind, sign, tmp_path, monkeypatch):
    monkeypatch.setattr(apart, "processors", lambda: 2)
    parent, workers = parent_of(kind(tmp_path / "at"), tmp_path, 2)
    try:
        assert len(workers) == 2 and all(map(alive, workers))
        os.kill(parent, sign)
        os.waitpid(parent, 0)
        end = time.monotonic() + PATIENCE
        while any(map(alive, workers)) and time.monotonic() < end:
            time.sleep(0.05)
        assert not any(map(alive, workers))
    finally:
        for pid in workers:
            if alive(pid):
                os.kill(pid, signal.SIGKILL)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks the proc file system who lives")
def test_a_worker_ends_although_another_process_holds_its_pipe(tmp_path, monkeypatch):
    """A process that was forked later, and watches nothing, keeps open what the worker waits on."""
    monkeypatch.setattr(apart, "processors", lambda: 2)

    def work():
        one = Apart(lambda: endless(tmp_path / "at"))
        if not (bystander := os.fork()):
            signal.alarm(120)
            time.sleep(120)
            os._exit(0)
        (tmp_path / f"by.{bystander}").touch()
        return one

    parent, workers = parent_of(work, tmp_path, 1)
    while not (found := list(tmp_path.glob("by.*"))) and alive(parent):
        time.sleep(0.02)
    bystander = int(found[0].suffix[1:])
    try:
        os.kill(parent, signal.SIGKILL)
        os.waitpid(parent, 0)
        end = time.monotonic() + PATIENCE
        while any(map(alive, workers)) and time.monotonic() < end:
            time.sleep(0.05)
        assert alive(bystander) and not any(map(alive, workers))
    finally:
        for pid in (bystander, *workers):
            if alive(pid):
                os.kill(pid, signal.SIGKILL)


def test_a_worker_that_is_killed_costs_no_result(tmp_path, monkeypatch):
    """Its task is done again by the process that asks for it."""
    monkeypatch.setattr(apart, "processors", lambda: 2)
    here, told = os.getpid(), tmp_path / "at.1"

    def task():
        if os.getpid() != here:
            told.touch()
            time.sleep(600)
        return 42

    one = Apart(task)
    while not told.exists():
        time.sleep(0.01)
    os.kill(one._worker.pid, signal.SIGKILL)
    assert one.result() == 42


def test_every_process_that_is_started_watches_its_parent():
    """In the package and in the examination, by their texts: a call that starts a process, and the watch in the same file."""
    starts = re.compile(r"context\.Process\(|ProcessPoolExecutor\(|multiprocessing\.Process\(|os\.fork\(|\bPool\(")
    found = []
    for path in (*(ROOT / "python").rglob("*.py"), *(ROOT / "tests" / "exam").glob("*.py")):
        text = path.read_text(encoding="utf-8")
        if calls := starts.findall(text):
            found.append(path.name)
            assert len(re.findall(r"end_with_parent\b(?!:)", text)) >= len(calls), path
        # A process that was started here may fork copies of itself, which watch it.
        assert "os.fork(" not in text or path.name == "apart.py", path
    assert sorted(found) == ["apart.py", "calibration.py", "run.py"]


@pytest.mark.nightly
def test_a_diagnosis_that_is_killed_leaves_no_process(tmp_path):
    made = subprocess.run(
        [sys.executable, "-m", "ivsid.cli", "example", str(tmp_path / "ex")], check=True, capture_output=True
    )
    assert made.returncode == 0
    words = ["diagnose", "boat.toml", "run1.csv", "run2.csv", "--out", "found"]
    one = subprocess.Popen(
        [sys.executable, "-m", "ivsid.cli", *words],
        cwd=tmp_path / "ex",
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    family, end = set(), time.monotonic() + 120
    while not family and one.poll() is None and time.monotonic() < end:
        # A thread may end between the list of all and its own.
        with suppress(FileNotFoundError):
            threads = Path(f"/proc/{one.pid}/task").iterdir()
            family = {int(c) for t in threads for c in (t / "children").read_text().split()}
        time.sleep(0.01)
    assert family, "the diagnosis has processes of its own"
    one.kill()
    one.wait()
    time.sleep(PATIENCE)
    assert not any(map(alive, family))


def test_a_result_that_is_asked_for_again_is_not_worked_out_again(tmp_path):
    """Two stages ask for what is said of the plain model; a task of seconds is not done a second time by the one who asks."""

    def task():
        (tmp_path / f"{len(list(tmp_path.iterdir()))}").touch()
        return os.getpid()

    one = Apart(task)
    assert one.result() == one.result()
    assert len(list(tmp_path.iterdir())) == 1
    here = Apart(task, begun=False)
    assert here.result() == here.result() == os.getpid()
    assert len(list(tmp_path.iterdir())) == 2
