"""``ivsid follow --live --wait``: a log that is followed while another program writes it."""

import pytest

from command_line import run
from conftest import embedded
from ivsid import IvsidError, workflow
from ivsid.log.growing import growing
from ivsid.simulation import simulate
from ivsid.workflow.log_files import csv


@pytest.fixture(scope="module")
def written(tmp_path_factory, swan, programme):
    """A folder with a vehicle file, and the text of a log of half a minute."""
    folder = tmp_path_factory.mktemp("live")
    twin = simulate(swan, programme.model_copy(update={"noise": "uniform", "duration": 30.0}), 3)
    (folder / "swan.toml").write_text(embedded("swan.toml"))
    return folder, csv(twin.t, twin.columns)


def test_rows_are_taken_as_whole_lines_while_a_log_grows(written):
    folder, text = written
    log = folder / "log.csv"
    lines = text.splitlines(keepends=True)
    half = len(lines) // 2
    log.write_text(lines[0])
    # Whoever is told that a header is no log writes half of the rows and a part of one; who sees those writes the rest.
    rest = ["".join(lines[1:half]) + lines[half][:9], lines[half][9:] + "".join(lines[half + 1 :])]
    told, seen = [], []

    def write():
        if rest:
            with log.open("a") as target:
                target.write(rest.pop(0))

    def say(sentence):
        told.append(sentence)
        write()

    def watch(moment):
        seen.append(moment)
        write()

    report = workflow.follow(folder / "swan.toml", log, wait=0.15, say=say, watch=watch)
    assert len(told) == 1 and told[0].startswith("waiting for more rows: ")
    assert len(seen) == 2 and seen[0].rows < 0.6 * seen[1].rows
    whole = workflow.follow(folder / "swan.toml", log)
    assert report.record == whole.record and seen[1].rows == sum(whole.record["rows"].values())


def test_ctrl_c_ends_the_wait_and_reports_what_came(written):
    folder, text = written
    log = folder / "stopped.csv"
    log.write_text(text)
    seen = []

    def stop(moment):
        seen.append(moment)
        raise KeyboardInterrupt

    report = workflow.follow(folder / "swan.toml", log, wait=60.0, watch=stop)
    assert len(seen) == 1 and "one by one" in report.summary


def test_the_command_ends_when_no_row_comes(written):
    folder, text = written
    log = folder / "finished.csv"
    log.write_text(text)
    done = run("follow", folder / "swan.toml", log, "--live", "--wait", "0.1", "--out", folder / "out")
    assert done.returncode == 0 and done.stdout.count(" rows: ") == 1 and "one by one" in done.stdout, done.stderr


def test_misuse_gets_one_sentence(written):
    folder, text = written
    log, binary = folder / "log.csv", folder / "log.bin"
    log.write_text(text)
    binary.write_bytes(b"PAR1\x00\x00\n")
    for given, options, sentence in (
        (log, ("--wait", "1"), "with --live"),
        (log, ("--live", "--wait", "0"), "above 0"),
        (log, ("--live", "--wait", "1", "--speed", "2"), "without --speed"),
        (folder / "none.csv", ("--live", "--wait", "1"), "is no file"),
        (binary, ("--live", "--wait", "1"), "is no CSV in UTF-8"),
    ):
        done = run("follow", folder / "swan.toml", given, *options, "--out", folder / "none")
        assert done.returncode == 2 and sentence in done.stderr and "Traceback" not in done.stderr, done
        assert len(done.stderr.strip().splitlines()) == 1


def test_a_log_that_becomes_shorter_is_refused(tmp_path):
    log = tmp_path / "short.csv"
    log.write_text("t,u\n0,1\n1,2\n2")
    with growing(log) as lines:
        assert lines.grown() and lines.copy.read_text() == "t,u\n0,1\n1,2\n" and lines.copy.name == log.name
        assert not lines.grown()
        log.write_text("t,u\n0,1\n1,2\n2,3\n")
        assert lines.grown() and lines.copy.read_text() == log.read_text()
        log.write_text("t,u\n")
        with pytest.raises(IvsidError, match="became shorter"):
            lines.grown()
