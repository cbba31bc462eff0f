"""Results under faults: full disks, folders in the way, renames that fail, clocks that jump.

Oracle: every file is the old one or the new one, whole, and a run that ends by itself leaves all old or all new.
"""

import os
import resource
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from command_line import run
from ivsid import IvsidError
from ivsid.files.whole import write_folder, write_together, write_whole
from kept_folders import NAMES, content, leftovers, posix, seen, whole_ones


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
