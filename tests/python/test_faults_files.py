"""Results under faults: kills, full disks, folders in the way, clocks that jump, two runs at once.

Oracle: every file is the old one or the new one, whole, and a run that ends by itself leaves all old or all new.
"""

import hashlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
import traceback
from contextlib import contextmanager
from pathlib import Path
from unittest import mock

import pytest

from command_line import run
from ivsid import IvsidError
from ivsid.files import owned, whole
from ivsid.files.whole import clear_up, write_folder, write_together, write_whole

NAMES = [*(f"figure_{k}.png" for k in range(9)), "result.json", "report.html"]
posix = pytest.mark.skipif(os.name != "posix", reason="signals, locks and limits of POSIX")


def content(mark, size=40_000):
    """Files whose bytes name their generation, each with a length of its own."""
    return {n: f"{mark} {n}\n".encode() * (1 + (size + 997 * k) // 20) for k, n in enumerate(NAMES)}


def seen(folder):
    """The files that a reader sees: all but what the writer hides."""
    return {
        str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file() and ".ivsid-" not in str(p)
    }


def leftovers(folder):
    return sorted(p.name for p in folder.rglob(".*"))


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


def whole_ones(folder):
    """Generations of the files in a folder; a file that is not whole fails."""
    found = {}
    for name, data in seen(folder).items():
        mark = data.split(b" " + name.encode())[0].decode()
        assert data == content(mark)[name], f"{name} is half written"
        found[name] = mark
    return found


@pytest.mark.parametrize("folder", ["new", "old"])
def test_a_folder_in_the_place_of_a_file_is_found_before_anything_changes(tmp_path, folder):
    out = tmp_path / folder
    if folder == "old":
        write_folder(out, content("old"))
        (out / "figure_5.png").unlink()
    (out / "figure_5.png").mkdir(parents=True)
    before = seen(out)
    with pytest.raises(IvsidError, match=r"figure_5.png cannot be written \(a folder stands in its place\)"):
        write_folder(out, content("new"))
    assert seen(out) == before and not leftovers(out)


def test_a_file_in_the_place_of_a_folder_is_found_before_anything_changes(tmp_path):
    write_folder(tmp_path, {"sub": "a file", "result.json": "old"})
    with pytest.raises(IvsidError, match="cannot be written"):
        write_folder(tmp_path, {"result.json": "new", "sub/inner.csv": "1"})
    assert seen(tmp_path) == {"sub": b"a file", "result.json": b"old"} and not leftovers(tmp_path)


@pytest.mark.parametrize("name", ["../out.txt", "/tmp/out.txt", "a/../../out.txt", "", "a\0b"])
def test_no_name_leads_out_of_the_folder(tmp_path, name):
    inside = tmp_path / "inside"
    with pytest.raises(IvsidError, match="plain name"):
        write_folder(inside, {"result.json": "1", name: "2"})
    assert not inside.exists() and not list(tmp_path.iterdir())


@pytest.mark.parametrize("at", range(len(NAMES)))
@pytest.mark.parametrize("there", [True, False])
def test_a_rename_that_fails_brings_the_old_files_back(tmp_path, monkeypatch, at, there):
    out = tmp_path / "out"
    if there:
        write_folder(out, {n: d for n, d in content("old").items() if n != "figure_3.png"})
    before = seen(out)
    plain, count = Path.replace, iter(range(100))

    def fails(self, target):
        if "new" in self.parts and next(count) == at:
            raise OSError(5, "Input/output error")
        return plain(self, target)

    monkeypatch.setattr(Path, "replace", fails)
    with pytest.raises(IvsidError, match="Input/output error"):
        write_folder(out, content("new"))
    assert seen(out) == before and out.exists() == there and not leftovers(tmp_path)


def test_results_in_two_folders_change_together(tmp_path, monkeypatch):
    log, truth = tmp_path / "log", tmp_path / "truth"
    write_together({truth: {"truth.json": "old"}, log: {"log.csv": "old"}})
    plain = Path.replace

    def fails(self, target):
        if self.name == "log.csv" and "new" in self.parts:
            raise OSError(28, "No space left on device")
        return plain(self, target)

    monkeypatch.setattr(Path, "replace", fails)
    with pytest.raises(IvsidError, match="No space left"):
        write_together({truth: {"truth.json": "new"}, log: {"log.csv": "new"}})
    assert seen(truth) == {"truth.json": b"old"} and seen(log) == {"log.csv": b"old"}
    monkeypatch.undo()
    # Two paths to one folder are one folder, and no run waits for itself.
    (tmp_path / "link").symlink_to(log, target_is_directory=True)
    write_together({tmp_path / "link": {"truth.json": "new"}, log: {"log.csv": "new"}})
    assert seen(log) == {"truth.json": b"new", "log.csv": b"new"} and not leftovers(tmp_path)


def test_a_folder_named_as_the_truth_is_refused_before_the_log_is_written(tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    for words in (["--truth", there], ["--hide", 3, "--truth", there]):
        made = run("simulate", "otter", "otter", "--out", tmp_path / "out", *words)
        assert (
            made.returncode == 2
            and "a folder stands in its place" in made.stderr
            and len(made.stderr.splitlines()) == 1
        )
        assert not (tmp_path / "out").exists() and not list(there.iterdir())


def test_the_truth_is_no_file_of_the_results(tmp_path):
    made = run("simulate", "otter", "otter", "--out", tmp_path / "out", "--truth", tmp_path / "out" / "result.json")
    assert made.returncode == 2 and "is a file of the results themselves" in made.stderr
    assert not (tmp_path / "out").exists()


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


@contextmanager
def small_disk(folder):
    """A file system of 1 MB, or None where none can be mounted."""
    folder.mkdir()
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(folder)], capture_output=True, check=False
    )
    try:
        yield folder if done.returncode == 0 else None
    finally:
        if done.returncode == 0:
            subprocess.run(["umount", str(folder)], check=True)


@posix
def test_a_full_disk_leaves_the_old_results(tmp_path):
    with small_disk(tmp_path / "disk") as disk:
        if disk is None:
            pytest.skip("no file system can be mounted here; the limit of a file's size stands for it in the next test")
        write_folder(disk / "out", content("old"))
        before = seen(disk)
        for size in (90_000, 200_000):
            with pytest.raises(IvsidError, match="No space left on device"):
                write_folder(disk / "out", content("new", size))
            assert seen(disk) == before and not leftovers(disk)
            with pytest.raises(IvsidError, match="No space left on device"):
                write_folder(disk / "fresh", content("new", size))
            assert not (disk / "fresh").exists()
        with pytest.raises(IvsidError, match="No space left on device"):
            write_whole(disk / "boat.toml", b"x" * 2_000_000)
        assert seen(disk) == before and not leftovers(disk)
        # The command says so in a sentence.
        made = run("example", disk / "ex")
        assert made.returncode == 2 and "No space left on device" in made.stderr and len(made.stderr.splitlines()) == 1
        assert seen(disk) == before and not leftovers(disk)


@posix
def test_a_limit_of_file_sizes_leaves_the_old_results(tmp_path):
    write_folder(tmp_path, content("old", 1000))
    before = seen(tmp_path)
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    # Beyond the limit Python gets an error in place of the signal, as it ignores that one.
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, old[1]))
    try:
        with pytest.raises(IvsidError, match="File too large"):
            write_folder(tmp_path, content("new", 40_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert seen(tmp_path) == before and not leftovers(tmp_path)


@posix
@pytest.mark.parametrize("command", [("example",), ("simulate", "otter", "otter", "--out"), ("demo", "--out")])
def test_a_folder_that_cannot_be_written_gets_a_sentence_at_once(command):
    """The proc file system refuses new folders to root, too."""
    if not Path("/proc/self").exists():
        pytest.skip("no proc file system")
    begin = time.monotonic()
    made = run(*command, "/proc/ivsid-out")
    assert made.returncode == 2 and "cannot be written" in made.stderr and len(made.stderr.splitlines()) == 1
    assert time.monotonic() - begin < 10.0


def test_a_read_only_folder_gets_a_sentence(tmp_path):
    folder = tmp_path / "out"
    write_folder(folder, content("old"))
    folder.chmod(0o555)
    try:
        if os.access(folder, os.W_OK):
            pytest.skip("modes do not hold for this user (root); the proc file system stands for it in the test above")
        with pytest.raises(IvsidError, match="Permission denied"):
            write_folder(folder, content("new"))
        assert set(whole_ones(folder).values()) == {"old"}
    finally:
        folder.chmod(0o755)


def test_a_clock_that_jumps_changes_nothing(tmp_path, monkeypatch):
    """No decision of the writer reads a clock: staging folders of the past and of the future are the same."""
    for k, moment in enumerate((0.0, 4e9, -1e9)):
        monkeypatch.setattr(time, "time", lambda moment=moment: moment)
        stale = tmp_path / f".ivsid-stage-{k}"
        stale.mkdir()
        os.utime(stale, (moment, moment))
        write_folder(tmp_path, content(f"generation {k}"))
        assert set(whole_ones(tmp_path).values()) == {f"generation {k}"} and not leftovers(tmp_path)


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
