"""Files of a command, known by their content: put in order, and named where they are wrong."""

import json
import os
from pathlib import Path

import pytest

from command_line import run, shell_files
from ivsid.cli import recognition


@pytest.fixture(scope="module")
def place(tmp_path_factory, twin):
    return shell_files(tmp_path_factory.mktemp("recognition"), twin)


def test_kinds_of_files_are_known_by_their_content(place, tmp_path):
    for name in ("boat.toml", "plan.toml", "run.csv"):
        (tmp_path / name.rpartition(".")[0]).write_bytes((place / name).read_bytes())
    assert recognition.kinds(tmp_path / "boat") == {recognition.VEHICLE}
    assert recognition.kinds(tmp_path / "plan") == {recognition.SCENARIO}
    assert recognition.kinds(tmp_path / "run") == {recognition.LOG}
    assert recognition.kinds(place / "fit") == recognition.kinds(place / "fit" / "result.json") == {recognition.FIT}
    assert recognition.kinds("otter") == {recognition.VEHICLE, recognition.SCENARIO}
    assert recognition.kinds("swan") == {recognition.VEHICLE}
    (tmp_path / "broken.toml").write_text("[hull\nmass = 1")
    assert recognition.kinds(tmp_path / "broken.toml") == recognition.kinds(tmp_path / "nothing") == frozenset()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "result.json").write_text(json.dumps({"command": "simulate"}))
    assert recognition.kinds(tmp_path / "other") == {recognition.RESULT, recognition.LOG}


def test_swapped_files_are_put_right_and_named(place):
    straight = (place / "fit" / "result.json").read_bytes()
    swapped = run("identify", place / "run.csv", place / "boat.toml", "--out", place / "swapped")
    assert swapped.returncode == 0
    assert swapped.stderr == (
        f"ivsid: taken as ivsid identify {place / 'boat.toml'} {place / 'run.csv'}, by the content of the files\n"
    )
    assert (place / "swapped" / "result.json").read_bytes() == straight
    again = run("verify", place / "run.csv", place / "fit", "--out", place / "proved", "--json")
    assert again.returncode == 0 and json.loads(again.stdout)["status"] == "proved"


def test_two_logs_keep_their_order():
    vehicle, log = frozenset({recognition.VEHICLE}), frozenset({recognition.LOG})
    needed = (vehicle, log, log)
    assert recognition.in_order((log, log, vehicle), needed) == (2, 0, 1)
    assert recognition.in_order((log, vehicle, log), needed) == (1, 0, 2)
    assert recognition.in_order((log, log, log), needed) is None
    assert recognition.in_order((vehicle, frozenset(), log), needed) is None


WRONG = {
    ("identify", "run.csv"): ("Missing argument VEHICLE", "needs a vehicle file and a log", "run.csv is a log"),
    ("identify", "boat.toml"): ("Missing argument LOG", "boat.toml is a vehicle file"),
    ("identify", "--json"): ("Missing argument VEHICLE", "nothing was given"),
    ("identify", "otter"): ("Missing argument LOG", "and otter is a vehicle file"),
    ("identify", "otter", "otter_programme"): ("otter is a vehicle file; otter_programme is a scenario",),
    ("simulate", "otter_programme"): ("Missing argument VEHICLE", "otter_programme is a scenario"),
    ("identify", "run.csv", "run.csv"): ("needs a vehicle file and a log", "run.csv is a log"),
    ("diagnose", "boat.toml", "run.csv"): ("Missing argument TEST", "another log"),
    ("diagnose", "run.csv", "run.csv"): ("Missing argument VEHICLE",),
    ("validate", "boat.toml", "run.csv"): (
        "needs the result of ivsid identify and a log",
        "boat.toml is a vehicle file",
    ),
    ("allan", "boat.toml"): ("needs a static recording", "boat.toml is a vehicle file"),
    ("thrust", "fit"): ("needs a bollard-pull table", "fit is the result of ivsid identify"),
    ("simulate", "boat.toml", "run.csv"): ("needs a vehicle file and a scenario", "run.csv is a log"),
    ("import", "cse1"): ("Missing argument DIR", "needs SET and DIR", "cse1 was given"),
}


@pytest.mark.parametrize("words", WRONG, ids=" ".join)
def test_wrong_files_get_one_sentence(place, monkeypatch, words):
    monkeypatch.chdir(place)
    made = run(*words, "--out", "none")
    assert made.returncode == 2 and made.stdout == "" and len(made.stderr.splitlines()) == 1
    for part in WRONG[words]:
        assert part in made.stderr, made.stderr
    assert not Path("none").exists()


def test_a_pipe_may_be_any_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert recognition.kinds(tmp_path / "pipe") == frozenset()
