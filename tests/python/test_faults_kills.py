"""Results under kills and beside other runs.

Oracle: every file is the old one or the new one, whole, and a run that ends by itself leaves all old or all new.
"""

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import time
import traceback
from pathlib import Path
from unittest import mock

import pytest

from ivsid import IvsidError
from ivsid.files import owned, whole
from ivsid.files.whole import clear_up, write_folder
from kept_folders import NAMES, content, leftovers, posix, seen, whole_ones


class Forked:
    """A copy of this process that does some work and announces steps of it."""

    def __init__(self, work):
        self._reader, writer = os.pipe()
        self.pid = os.fork()
        if not self.pid:
            # A shell starts what runs in its background with Ctrl-C ignored.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            signal.alarm(120)
            try:
                work(lambda k: os.write(writer, b"%d\n" % k))
            except KeyboardInterrupt:
                os._exit(130)
            except BaseException:
                traceback.print_exc()
                os._exit(1)
            os._exit(0)
        os.close(writer)

    def first(self):
        """Waits for the first announcement."""
        self._said = os.read(self._reader, 64)
        assert self._said

    def end(self, sign=None):
        """The announced steps, and the status of ``subprocess``, after a signal."""
        if sign is not None:
            os.kill(self.pid, sign)
        said = getattr(self, "_said", b"")
        while more := os.read(self._reader, 65536):
            said += more
        os.close(self._reader)
        return [int(k) for k in said.split()], os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


def writing(folder, first, step):
    """Writes generation after generation; each is announced when it is complete."""

    def work(announce):
        for k in range(first, 100_000, step):
            write_folder(folder, content(f"generation {k}"))
            announce(k)

    return work


@posix
@pytest.mark.parametrize("sign", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_kills_at_random_moments(tmp_path, sign):
    """Whole files after each kill, all of one generation after the next run, and nothing hidden stays."""
    rng = random.Random(int(sign))
    last = -1
    for attempt in range(6):
        writer = Forked(writing(tmp_path / "out", last + 1, 1))
        writer.first()
        time.sleep(rng.random() * 0.2)
        announced, _ = writer.end(sign)
        last = max([last + 1, *announced])
        found = whole_ones(tmp_path / "out")
        assert found.keys() == set(NAMES)
        told = {int(mark.split()[1]) for mark in found.values()}
        assert min(told) >= last and max(told) <= last + 1
        if sign != signal.SIGKILL:
            assert len(told) == 1, f"a run that ends by itself leaves one generation (attempt {attempt})"
            assert not leftovers(tmp_path / "out")
        last = max(told)
        if attempt % 2:
            clear_up(tmp_path / "out")
            assert len(set(whole_ones(tmp_path / "out").values())) == 1 and not leftovers(tmp_path / "out")


@posix
@pytest.mark.parametrize("call", range(len(NAMES) + 2))
def test_a_kill_before_every_rename(tmp_path, call):
    """Each moment of the change in turn; the next run finishes it."""
    write_folder(tmp_path, content("old"))
    count = iter(range(1000))

    def counted(plain):
        def wrapped(*words):
            if next(count) == call:
                os.kill(os.getpid(), signal.SIGKILL)
            return plain(*words)

        return wrapped

    def work(_):
        with mock.patch.multiple(Path, replace=counted(Path.replace), rename=counted(Path.rename)):
            write_folder(tmp_path, content("new"))

    status = Forked(work).end()[1]
    killed = status == -signal.SIGKILL
    assert killed == (call <= len(NAMES)) and (killed or status == 0)
    found = whole_ones(tmp_path)
    assert set(found.values()) <= {"old", "new"} and found.keys() == set(NAMES)
    if killed:
        assert leftovers(tmp_path)
    clear_up(tmp_path)
    # Before the first rename nothing has changed; from then on the change is carried out.
    assert set(whole_ones(tmp_path).values()) == {"old" if call == 0 else "new"}
    assert not leftovers(tmp_path)


def test_an_abandoned_way_back_is_finished(tmp_path):
    """Old files come back, and new ones that had no old one go."""
    undo = tmp_path / ".ivsid-undo-1234"
    for part, name in (
        ("old", "result.json"),
        ("old", "sub/a.csv"),
        ("none", "new.png"),
        ("none", "never.png"),
        ("new", "never.png"),
    ):
        (undo / part / name).parent.mkdir(parents=True, exist_ok=True)
        (undo / part / name).write_text("old")
    for name in ("result.json", "new.png", "mine.txt", "sub/a.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("new")
    write_folder(tmp_path, {"other.txt": "1"})
    assert seen(tmp_path) == {"result.json": b"old", "sub/a.csv": b"old", "mine.txt": b"new", "other.txt": b"1"}
    assert not leftovers(tmp_path)


def test_what_lies_behind_a_link_is_not_touched(tmp_path):
    """A prepared folder cannot make a run remove files elsewhere."""
    precious = tmp_path / "home" / "precious.txt"
    precious.parent.mkdir()
    precious.write_text("mine")
    out = tmp_path / "out"
    (out / ".ivsid-undo-x" / "none" / "sub").mkdir(parents=True)
    (out / ".ivsid-undo-x" / "none" / "sub" / "precious.txt").touch()
    (out / "sub").symlink_to(precious.parent, target_is_directory=True)
    (out / ".ivsid-commit-y").symlink_to(precious.parent, target_is_directory=True)
    write_folder(out, {"result.json": "1"})
    assert precious.read_text() == "mine" and (out / "result.json").read_text() == "1"


@posix
def test_the_staging_folder_of_a_living_run_is_left_alone(tmp_path):
    with owned.owned(tmp_path, whole.STAGE, whole.LOCK) as place:
        (place / "new").mkdir()
        write_folder(tmp_path, {"result.json": "1"})
        assert place.exists() and (place / "new").exists()
        # Neither the clock nor an age decides who lives.
        os.utime(place, (0, 0))
        clear_up(tmp_path)
        assert place.exists()
    clear_up(tmp_path)
    assert not place.exists() and (tmp_path / "result.json").exists()


def test_without_locks_nothing_living_is_touched(tmp_path, monkeypatch):
    """On POSIX a lock file without its lock would be a dead run's; a file system that knows none leaves abandoned folders."""
    (tmp_path / ".ivsid-stage-a" / "new").mkdir(parents=True)

    class NoLocks:
        LOCK_EX, LOCK_NB = 2, 4

        def flock(self, *_):
            raise OSError(95, "Operation not supported")

    monkeypatch.setattr(owned, "fcntl", NoLocks())
    write_folder(tmp_path, {"result.json": "1"})
    assert leftovers(tmp_path) == [".ivsid-stage-a", "owner"] or leftovers(tmp_path) == [".ivsid-stage-a"]
    monkeypatch.setattr(owned, "fcntl", None)
    write_folder(tmp_path, {"result.json": "2"})
    assert not leftovers(tmp_path) and (tmp_path / "result.json").read_text() == "2"


@posix
def test_two_runs_into_one_folder_leave_the_files_of_one(tmp_path):
    runs = [Forked(writing(tmp_path / "out", first, 2)) for first in (0, 1)]
    time.sleep(1.0)
    assert all(len(one.end(signal.SIGINT)[0]) > 1 for one in runs), "both runs wrote"
    assert len(set(whole_ones(tmp_path / "out").values())) == 1 and not leftovers(tmp_path / "out")


def test_a_run_that_fails_keeps_what_another_wrote_into_its_new_folder(tmp_path, monkeypatch):
    out = tmp_path / "a" / "out"
    plain = Path.replace

    def meanwhile(self, target):
        if "new" in self.parts:
            (out / "of_another_run.json").write_text("theirs")
            raise OSError(28, "No space left on device")
        return plain(self, target)

    monkeypatch.setattr(Path, "replace", meanwhile)
    with pytest.raises(IvsidError):
        write_folder(out, content("new"))
    assert seen(out) == {"of_another_run.json": b"theirs"}


@posix
@pytest.mark.nightly
@pytest.mark.parametrize("sign", [signal.SIGKILL, signal.SIGINT])
def test_whole_commands_that_are_killed(tmp_path, sign):
    """``ivsid simulate`` over old results, killed at moments from its start to beyond its end."""
    out, truth = tmp_path / "out", tmp_path / "truth.json"
    words = [sys.executable, "-m", "ivsid.cli", "simulate", "otter", "otter", "--out", str(out), "--truth", str(truth)]
    begin = time.monotonic()
    subprocess.run([*words, "--seed", "1"], check=True, capture_output=True)
    spent = time.monotonic() - begin
    rng = random.Random(int(sign))
    for k in range(12):
        one = subprocess.Popen(
            [*words, "--seed", str(k + 2)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            # Where this runs in the background of a shell, Ctrl-C is ignored, and its children inherit that.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - this process has one thread
        )
        # Half of the moments are drawn from the last fifth, in which files are written.
        time.sleep(spent * (rng.uniform(0.8, 1.05) if k % 2 else rng.random()))
        one.send_signal(sign)
        said = one.communicate()[1].decode()
        assert "Traceback" not in said
        clear_up(out)
        clear_up(tmp_path)
        record = json.loads((out / "result.json").read_text())
        log = (out / "log.csv").read_bytes()
        assert record["log"]["sha256"] == hashlib.sha256(log).hexdigest()
        assert json.loads(truth.read_text())["seed"] == record["seed"]
        assert not leftovers(tmp_path)
