"""Looks at null logs: when their scores decide, the processes that examine them, the threshold that they give, and their cache."""

import json
import multiprocessing
import os
import subprocess
import sys
import time
from dataclasses import replace
from itertools import chain
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis_logs import train_of, vehicle_of
from ivsid.diagnosis import cache_folder
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.null.cache import keep, kept, key_of, rules_digest
from ivsid.diagnosis.null.calibration import LOOKS, scores
from ivsid.diagnosis.null.looks import Looks
from ivsid.diagnosis.null.tail import NullTest
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.progress import count as counted


def test_looks_decide_wrongly_as_seldom_as_they_state():
    """Strengths without an effect are exponential: a finding just at the level falls early, and one below it stands, in a few of a hundred."""
    rng = np.random.default_rng(4)
    level, looks = 0.01, [*LOOKS, 400]
    at_level = -np.log(level)

    def early(strength):
        """Whether a finding stands, falls, or neither before the last look."""
        x = rng.exponential(size=looks[-1])
        for count in looks[:-1]:
            used = NullTest(x[:count], np.zeros(count, dtype=bool), level)
            if used.decides(strength, len(looks)):
                return "stands" if strength >= used.threshold() else "falls"
        return "doubt"

    said = {q: [early(at_level + q) for _ in range(400)] for q in (-3.0, -1e-9, 1e-9, 3.0)}
    # Both sides of the level, by counts that a rate of 2.3 % exceeds once in a thousand.
    assert said[1e-9].count("falls") <= 19 and said[-1e-9].count("stands") <= 19
    assert said[-3.0].count("falls") > 350 and not said[-3.0].count("stands")
    assert said[3.0].count("stands") > 250 and not said[3.0].count("falls")


def test_progress_counts_the_null_logs_of_one_look():
    """Time left against the last look would be twenty times too long for most logs."""
    said = []

    def strengths(_seed, parts):
        yield from ((5.0, False) for _ in chain.from_iterable(parts))

    none = NullTest(np.zeros(0), np.zeros(0, dtype=bool), 0.005)
    Looks(1, 400, None, said.append).decided(lambda: SimpleNamespace(strengths=strengths), str, none, [200.0])
    more = ": 400 at most, where these leave doubt"
    assert said == [f"null logs {k} of {LOOKS[0]}{more}" for k in range(LOOKS[0] + 1)]
    assert [counted(words)[1:] for words in said[:2]] == [(0, LOOKS[0]), (1, LOOKS[0])]
    said.clear()
    Looks(1, LOOKS[0], None, said.append).decided(lambda: SimpleNamespace(strengths=strengths), str, none, [5.0])
    assert said[-1] == f"null logs {LOOKS[0]} of {LOOKS[0]}"


def test_scores_come_in_order_and_no_process_outlives_the_last_that_is_asked_for():
    """The first numbers decide, whichever process is quicker, and what a process does not come to is done here."""
    here = os.getpid()

    def strengths(seed, parts):
        for k in chain.from_iterable(parts):
            if k == 5 and os.getpid() != here:
                os._exit(1)
            time.sleep(0.02 if k % 2 else 0.0)
            yield float(k), False

    made = scores(SimpleNamespace(strengths=strengths), 1, range(8))
    assert [next(made) for _ in range(7)] == [(float(k), False) for k in range(7)]
    made.close()
    assert not multiprocessing.active_children()


def test_processes_end_when_the_one_that_started_them_is_killed(tmp_path):
    """Without a watch they worked on alone, for minutes."""
    script = (
        "import os, pathlib, sys, time\n"
        "from types import SimpleNamespace as N\n"
        "from ivsid.diagnosis.null import calibration\n"
        "def strengths(seed, parts):\n"
        "    pathlib.Path(sys.argv[1], str(os.getpid())).touch()\n"
        "    time.sleep(60)\n"
        "os.sched_getaffinity = lambda _: {0, 1}\n"
        "calibration.examined(N(strengths=strengths, examination=N(level=0.1)), 1, range(4))\n"
    )
    parent = subprocess.Popen([sys.executable, "-c", script, str(tmp_path)])

    def until(done):
        end = time.monotonic() + 30
        while not done() and time.monotonic() < end:
            time.sleep(0.05)
        assert done()

    until(lambda: len(list(tmp_path.iterdir())) == 2)
    workers = [Path("/proc", p.name) for p in tmp_path.iterdir()]
    assert all(w.exists() for w in workers)
    parent.kill()
    parent.wait()
    until(lambda: not any(w.exists() and "State:\tZ" not in (w / "status").read_text() for w in workers))


def test_null_logs_that_score_higher_make_the_test_stricter():
    strong = NullTest(np.linspace(5.0, 15.0, 400), np.zeros(400, dtype=bool), 0.005)
    weak = NullTest(np.linspace(1.0, 4.0, 400), np.zeros(400, dtype=bool), 0.005)
    assert strong.threshold() > 14 > weak.threshold()
    assert strong.threshold(2.0) > strong.threshold()
    # An exponential tail: its quantile is known.
    tail = NullTest(np.random.default_rng(1).exponential(1.3, 4000), np.zeros(4000, dtype=bool), 0.005)
    assert tail.threshold() == pytest.approx(-1.3 * np.log(0.005), rel=0.1)
    assert not NullTest(np.full(20, np.nan), np.zeros(20, dtype=bool), 0.005).usable


def test_the_cache_is_whole_or_nothing_and_follows_its_key(tmp_path, monkeypatch):
    test = NullTest(np.array([1.5, np.nan, 3.25]), np.array([True, False, False]), 0.005)
    keep(tmp_path, "a" * 64, test)
    back = kept(tmp_path, "a" * 64, 0.005)
    np.testing.assert_array_equal(back.strengths, test.strengths)
    np.testing.assert_array_equal(back.passed, test.passed)
    file = tmp_path / f"{'a' * 64}.json"
    text = file.read_text()
    for damaged in (text[:-20], text.replace("true", "false"), "[]", "", json.dumps({"key": "a"})):
        file.write_text(damaged)
        assert kept(tmp_path, "a" * 64, 0.005) is None
    file.write_text(text)
    file.rename(tmp_path / f"{'b' * 64}.json")
    assert kept(tmp_path, "b" * 64, 0.005) is None and kept(tmp_path, "c" * 64, 0.005) is None
    # A folder that cannot be made is no cache, and no error.
    keep(file.parent / f"{'b' * 64}.json" / "under", "d" * 64, test)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "ivsid" / "null_logs"


def test_a_rule_that_changes_between_two_releases_changes_the_key(tmp_path, monkeypatch):
    below = tmp_path / "rules_of_a_test" / "below"
    below.mkdir(parents=True)
    (below.parent / "__init__.py").write_text("")
    (below / "limits.py").write_text("LIMIT = 3.0\n")
    monkeypatch.syspath_prepend(tmp_path)
    before = rules_digest("rules_of_a_test")
    assert before == rules_digest("rules_of_a_test") != rules_digest()
    (below / "notes.txt").write_text("no rule")
    assert before == rules_digest("rules_of_a_test")
    (below / "limits.py").write_text("LIMIT = 4.0\n")
    assert before != rules_digest("rules_of_a_test")


def test_the_key_follows_content_and_not_names():
    vehicle = vehicle_of()
    log = channels(train_of(vehicle), vehicle)
    ids = frozenset({"drag.surge.linear"})
    key = key_of(vehicle, log, 1, 0.005, ids, 1e-4)
    assert key == key_of(vehicle, replace(log, name="b.csv"), 1, 0.005, ids, 1e-4)
    nu = log.nu.copy()
    nu[0, 7] = np.nextafter(nu[0, 7], np.inf)
    others = {
        key_of(vehicle, replace(log, nu=nu), 1, 0.005, ids, 1e-4),
        key_of(vehicle, log, 2, 0.005, ids, 1e-4),
        key_of(vehicle, log, 1, 0.005, ids | {"wind.steady"}, 1e-4),
        key_of(vehicle, log, 1, 0.005, ids, 2e-4),
        key_of(parse_vehicle(vehicle.text + "\n", vehicle.source), log, 1, 0.005, ids, 1e-4),
    }
    assert len(others) == 5 and key not in others
