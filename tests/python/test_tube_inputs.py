"""Tubes of fits and logs that are short of something: open parameters, gaps, refusals in a sentence, and the command."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ivsid
from command_line import run
from conftest import as_log, embedded
from ivsid import IvsidError
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.tubes import tube
from ivsid.tubes.parameters import blocks_of
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.trajectories import _followed
from tube_runs import SWAN, course_of_log, fit_of, log_of, twin_of  # noqa: F401 - fixtures


def test_long_windows_are_searched_by_halves(fit, monkeypatch):
    """Where lengths are not tried one by one, the window that is found shows the reading, and is at most twice the shortest."""
    text = embedded("swan_test.toml").replace("duration = 300.0", "duration = 30.0", 1)
    text = text.replace('"drag.surge.quadratic" = 255.0', '"drag.surge.quadratic" = 340.0')
    other = as_log(simulate(SWAN, parse_scenario(text, "other")))

    def found():
        made = tube(fit, other, windows=[], inner=False)
        return made.runs[0].refuted[0]

    shortest = found()
    monkeypatch.setattr("ivsid.tubes.refuted.TRIED", 0)
    halved = found()
    assert halved.rows[1] == shortest.rows[1]
    assert halved.measured[0] > halved.tube[1] or halved.tube[0] > halved.measured[1]
    length, least = (r.rows[1] - r.rows[0] for r in (halved, shortest))
    assert least <= length <= 2 * least


def test_parameters_that_do_not_act_may_stay_open(fit, test_log):
    """Surge alone asks for no interval of the yaw; all channels do, by name."""
    yaw = replace(fit.parameters["inertia.yaw"], lower=-np.inf, upper=np.inf)
    opened = replace(fit, parameters={**fit.parameters, "inertia.yaw": yaw})
    for channels in ("straight", "surge"):
        closed, made = (tube(f, test_log, channels=channels, windows=[], inner=False) for f in (fit, opened))
        assert (made.runs[0].horizon.bounds.lower == closed.runs[0].horizon.bounds.lower)[:, 0].all()
        assert (made.runs[0].horizon.bounds.upper == closed.runs[0].horizon.bounds.upper)[:, 0].all()
    with pytest.raises(IvsidError, match="inertia.yaw has no bound, .* or follow surge alone"):
        tube(opened, test_log, windows=[], inner=False)
    # The command chooses for a user who names no channels.
    assert _followed(fit) == ("all", "")
    channels, less = _followed(opened)
    assert channels == "surge" and less.endswith("v and r as measured: inertia.yaw has no bound.")


def test_an_open_parameter_leaves_the_others_of_its_rows_as_boxes(fit, test_log):
    """A set of rows with an open interval has no corners: the tube is that of the intervals, and no narrower."""
    drag = replace(fit.parameters["drag.surge.quadratic"], lower=-np.inf, upper=np.inf)
    opened = replace(fit, parameters={**fit.parameters, "drag.surge.quadratic": drag})
    blocks = blocks_of(opened, ["mass.surge"])
    assert [b.ids for b in blocks] == [("mass.surge",)]
    p = fit.parameters["mass.surge"]
    assert blocks[0].box == ((p.lower, p.upper),)


def test_gaps_end_a_tube(fit, test_log):
    """A lost row may have held a demand: the tube restarts behind it from the measured state."""
    keep = np.r_[0:200, 230:400]
    columns = {n: x[keep] for n, x in test_log.columns.items()}
    log = Log(test_log.name, test_log.sha256, test_log.t[keep], columns)
    made = tube(fit, log, windows=[5.0], inner=False)
    assert [(w.first, w.last) for w in made.runs[0].horizon.windows] == [(0, 199), (200, 369)]
    assert all(w.last <= 199 or w.first >= 200 for r in made.runs for w in r.horizon.windows)


def test_surge_alone_takes_drift_and_turn_from_the_log(fit, test_log, twin):
    made = tube(fit, test_log, channels="surge", windows=[], inner=False)
    bounds, u = made.runs[0].horizon.bounds, twin.exact["u"]
    assert np.all((bounds.lower[:, 0] <= u) & (u <= bounds.upper[:, 0]))
    assert not made.refuted and np.median(made._columns()["median width"]) < 0.1
    assert any("v and r are as measured" in s for s in made.assumes)


REFUSED = {
    "channels": (lambda f, log: tube(f, log, channels="sway"), "channels 'sway' are unknown"),
    "windows": (lambda f, log: tube(f, log, windows=[0.0]), "positive lengths are needed"),
    "cells": (lambda f, log: tube(f, log, cells=0), "at least 1, is needed"),
    "no yaw cells": (lambda f, log: tube(f, log, yaw_cells=0), "at least 1 and at most 1024"),
    "too many yaw cells": (lambda f, log: tube(f, log, yaw_cells=10**30), "at least 1 and at most 1024"),
    "yaw cells of surge": (lambda f, log: tube(f, log, channels="surge", yaw_cells=2), "leave yaw_cells out"),
    "pieces": (lambda f, log: tube(f, log, cells=9), "into 729 pieces"),
    "parts": (lambda f, log: tube(f, log, parts=0), "at least 1, is needed"),
    "open": (
        lambda f, log: tube(
            replace(f, parameters=f.parameters | {"inertia.yaw": replace(f.parameters["inertia.yaw"], upper=np.inf)}),
            log,
        ),
        "inertia.yaw has the interval [",
    ),
    "empty": (lambda f, log: tube(replace(f, status="empty", parameters={}), log), "has no parameters to simulate"),
}


def test_a_channel_without_mass_is_refused_and_surge_alone_followed(fit, test_log):
    text = embedded("swan.toml").replace('terms = "paper"', 'terms = ["mass.surge", "drag.surge.quadratic"]')
    vehicle = parse_vehicle(text, "swan.toml")
    kept = {i: p for i, p in fit.parameters.items() if i != "inertia.yaw"}
    known = replace(fit, vehicle=vehicle, parameters=kept)
    with pytest.raises(IvsidError, match=r"no mass or inertia in sway.*--channels surge or straight"):
        tube(known, test_log, examine=False)
    made = tube(known, test_log, channels="straight", windows=[], inner=False, examine=False)
    assert all(w.proved == w.last for w in made.runs[0].horizon.windows)


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_gets_one_sentence(fit, test_log, case):
    call, words = REFUSED[case]
    with pytest.raises(IvsidError) as caught:
        call(fit, test_log)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_forces_that_depend_on_the_motion_are_refused(fit, test_log):
    text = embedded("swan.toml").replace("azimuth = 0.0\n", "azimuth = 0.0\nadvance_loss = 0.1\n", 1)
    with pytest.raises(IvsidError, match="claims advance_loss or has a rudder"):
        tube(replace(fit, vehicle=parse_vehicle(text, "swan.toml")), test_log)


def test_the_command_leaves_its_files(fit, test_log, tmp_path):
    fit.save(tmp_path / "fit")
    from ivsid.workflow.log_files import csv

    short = {n: x[:200] for n, x in test_log.columns.items()}
    (tmp_path / "log.csv").write_text(csv(test_log.t[:200], short))
    done = run("tube", tmp_path / "fit", tmp_path / "log.csv", "--windows", "5", "--out", tmp_path / "made")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "made" / "result.json").read_text())
    assert (
        record["command"] == "tube"
        and record["guaranteed"] is True
        and [r["window"] for r in record["runs"]] == [None, 5.0]
    )
    assert record["runs"][0]["components"]["u"]["median_ratio"] >= 1.0
    names = {p.name for p in (tmp_path / "made").iterdir()}
    assert {"tube.csv", "tube_whole.png", "tube_5s.svg", "report.html"} <= names
    (tmp_path / "programme.toml").write_text(
        embedded("swan_test.toml").replace("duration = 300.0", "duration = 12.0", 1)
    )
    done = run(
        "tube",
        tmp_path / "fit",
        tmp_path / "programme.toml",
        "--no-inner",
        "--out",
        tmp_path / "planned",
        "--channels",
        "straight",
    )
    assert done.returncode == 0, done.stderr
    assert "written to" in done.stdout


def test_the_name_in_python(fit, test_log):
    """The function, its text in a terminal, its table and its drawing."""
    assert ivsid.tube is tube
    log = Log("part.csv", test_log.sha256, test_log.t[:100], {n: x[:100] for n, x in test_log.columns.items()})
    made = ivsid.tube(fit, log, windows=[2.0], inner=False, examine=False)
    assert "no reading contradicts the fit" in repr(made) and len(repr(made)) <= 1000
    assert made.to_polars()["component"].to_list() == [*made.to_polars()["component"].to_list()[:6]] * 2
    from matplotlib.figure import Figure

    assert len(made.plot(Figure())) == 6
