"""Logs that are followed: the truth inside at every moment, widths of the whole log's set, changes only with a proof, and the command."""

import json

import numpy as np
import pytest

from command_line import run
from conftest import as_log, embedded
from ivsid import IvsidError, follow, identify
from ivsid.log import Log
from ivsid.simulation import simulate
from ivsid.workflow.log_files import csv
from pages import Page, faults

IDS = ("mass.surge", "drag.surge.quadratic", "inertia.yaw")


def made(swan, programme, seed, **update):
    return simulate(swan, programme.model_copy(update={"noise": "uniform", "duration": 60.0, **update}), seed)


@pytest.mark.parametrize("rows", ["pointwise", "integral"])
def test_the_truth_stays_inside_and_the_widths_are_those_of_the_whole_log(swan, programme, rows):
    for seed in range(3):
        twin = made(swan, programme, seed)
        truth = twin.truth["parameters"]
        seen = []
        found = follow(swan, as_log(twin), rows=rows, every=3.0, watch=seen.append, examine=False)
        assert tuple(seen) == found.moments and len(seen) == 20 and found.guaranteed
        for before, moment in zip((None, *seen), seen, strict=False):
            for id_, p in moment.parameters.items():
                assert p.lower <= truth[id_] <= p.upper, (seed, moment.time, id_)
                if before is not None:
                    assert before.parameters[id_].lower <= p.lower and p.upper <= before.parameters[id_].upper
        whole = identify(swan, as_log(twin), rows=rows, examine=False)
        assert found.status == whole.status and found.rows == whole.rows
        for id_, p in whole.parameters.items():
            if not np.isfinite(p.width):
                assert not np.isfinite(found.parameters[id_].width)
                continue
            ratio = found.parameters[id_].width / p.width
            # Both are proved outward from the same rows, and neither can be narrower than their exact hull.
            assert 1 - 1e-9 < ratio < 1.05, (seed, id_, ratio)


def joined(swan, programme, *truths):
    """One log in which the parameters jump: runs of a minute, one behind the other."""
    runs = [made(swan, programme, 7 + k, truth=t) for k, t in enumerate(truths)]
    step = runs[0].t[1] - runs[0].t[0]
    t, length = np.concatenate([r.t + k * (r.t[-1] + step) for k, r in enumerate(runs)]), runs[0].t[-1] + step
    columns = {name: np.concatenate([r.columns[name] for r in runs]) for name in runs[0].columns}
    return Log("joined.csv", "0" * 64, t, columns), length


def test_a_jump_is_proved_and_a_constant_parameter_never_changes(swan, programme):
    first = {"mass.surge": 60.0, "drag.surge.quadratic": 250.0, "inertia.yaw": 12.0}
    log, length = joined(swan, programme, first, {**first, "drag.surge.quadratic": 400.0})
    found = follow(swan, log, rows="pointwise", changes=30.0, examine=False)
    assert found.changes and all(c.time >= length for c in found.changes)
    assert found.changes[0].time < length + 60.0
    p = found.parameters["drag.surge.quadratic"]
    assert found.status != "empty" and p.lower <= 400.0 <= p.upper
    # Without windows the same contradiction is the end: no parameters explain the whole log.
    alone = follow(swan, log, rows="pointwise", examine=False)
    assert alone.status == "empty" and not alone.parameters and alone.changes[0].time >= length
    assert identify(swan, log, rows="pointwise", examine=False).status == "empty"
    steady, _ = joined(swan, programme, first, first)
    assert follow(swan, steady, rows="pointwise", changes=30.0, examine=False).changes == ()


def test_a_drift_within_its_rate_is_no_contradiction(swan, programme):
    first = {"mass.surge": 60.0, "drag.surge.quadratic": 250.0, "inertia.yaw": 12.0}
    log, length = joined(swan, programme, first, {**first, "drag.surge.quadratic": 400.0})
    # The jump of 150 takes place within one step of 0.05 s.
    found = follow(swan, log, drift={"drag.surge.quadratic": 150.0 / 0.05 * 1.01}, examine=False)
    assert found.status != "empty" and found.options["rows"] == "pointwise"
    assert any("drag.surge.quadratic changes by at most" in s for s in found.assumes)
    slow = follow(swan, log, drift={"drag.surge.quadratic": 0.1}, examine=False)
    assert slow.status == "empty" and slow.changes[0].time >= length


def test_misuse_gets_one_sentence(swan, programme):
    log = as_log(made(swan, programme, 0))
    for given, sentence in (
        ({"drift": {"drag.surge.qadratic": 1.0}}, "drift of 'drag.surge.qadratic' is no parameter"),
        ({"drift": {"mass.surge": -1.0}}, "a number from 0 up"),
        ({"drift": {"mass.surge": 1.0}, "changes": 5.0}, "were both given"),
        ({"drift": {"mass.surge": 1.0}, "rows": "integral"}, "use rows pointwise"),
        ({"changes": 0.0}, "windows of 0 s cannot be compared"),
        ({"start": np.inf}, "a start of inf is not usable"),
        ({"every": 0.0}, "moments every 0 s are not possible"),
    ):
        with pytest.raises(IvsidError, match=sentence) as refusal:
            follow(swan, log, examine=False, **given)
        assert "\n" not in str(refusal.value)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, swan, programme):
    place = tmp_path_factory.mktemp("follow")
    twin = made(swan, programme, 3)
    (place / "swan.toml").write_text(embedded("swan.toml"))
    (place / "log.csv").write_text(csv(twin.t, twin.columns))
    return place


def test_live_lines_off_a_terminal_and_files_of_the_result(folder):
    done = run("follow", folder / "swan.toml", folder / "log.csv", "--live", "--every", "20", "--out", folder / "out")
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.splitlines() if " rows: " in line]
    assert [line.split(" s, ")[0] for line in lines][:2] == ["20", "40"] and len(lines) == 3
    assert all(id_ in lines[-1] for id_ in IDS) and "one by one" in done.stdout
    record = json.loads((folder / "out" / "result.json").read_text())
    assert record["command"] == "follow" and record["status"] == "enclosed" and record["guaranteed"] is True
    assert set(record["narrowing"]) == set(IDS) and len(record["narrowing"]["mass.surge"]["lower"]) == 3
    last = record["parameters"]["mass.surge"]
    assert record["narrowing"]["mass.surge"]["lower"][-1] == last["lower"] and last["unit"] == "kg"
    page = (folder / "out" / "report.html").read_text()
    assert faults(page) == [] and "3 parameters are enclosed" in Page(page).text
    assert {"narrowing.png", "narrowing.svg"} <= {p.name for p in (folder / "out").iterdir()}


def test_options_of_the_command_reach_the_follower(folder):
    files = (folder / "swan.toml", folder / "log.csv", "--out", folder / "more")
    done = run("follow", *files, "--json", "--live", "--changes", "20", "--physical", "--rows", "pointwise")
    record = json.loads(done.stdout)
    assert record["options"]["changes"] == 20 and record["options"]["physical"] is True and record["changes"] == []
    for options, sentence in (
        (("--drift", "mass.surge"), "write ID=RATE"),
        (("--speed", "2"), "with --live"),
        (("--drift", "mass.surge=1", "--rows", "integral"), "use rows pointwise"),
    ):
        refused = run("follow", *files, *options)
        assert refused.returncode == 2 and sentence in refused.stderr, refused
