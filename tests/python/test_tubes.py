"""Tubes: no consistent trajectory leaves them, they are narrow, and a vehicle outside the fit does."""

import json
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import ivsid
from command_line import run
from conftest import as_log, embedded
from ivsid import IvsidError, identify
from ivsid.effects import terms_of
from ivsid.identification import Parameter
from ivsid.intervals import IntervalArray
from ivsid.linear.trajectories import Model
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.tubes import tube
from ivsid.tubes.equations import equations_of
from ivsid.tubes.given import straight
from ivsid.tubes.horizons import of_piece, start_of, window
from ivsid.tubes.inputs import course_of
from ivsid.tubes.parameters import blocks_of, pieces_of
from ivsid.vehicle import parse_vehicle
from ivsid.verification.claims import part_of, start_box
from ivsid.verification.covered import covers
from ivsid.verification.rational import Range
from ivsid.verification.tubes import TubeChecker
from ivsid.workflow.trajectories import _followed
from tube_oracle import integrate, shapes

SWAN = parse_vehicle(embedded("swan.toml"), "swan.toml")
REACH = 0.5


@pytest.fixture(scope="module")
def fit(once):
    def make(_):
        text = embedded("swan_train.toml").replace("duration = 300.0", "duration = 90.0", 1)
        made = simulate(SWAN, parse_scenario(text, "train"))
        return identify(SWAN, as_log(made), examine=False)

    return once("tube-fit", make)


@pytest.fixture(scope="module")
def twin(once):
    def make(_):
        text = embedded("swan_test.toml").replace("duration = 300.0", "duration = 60.0", 1)
        return simulate(SWAN, parse_scenario(text, "test"))

    return once("tube-twin", make)


@pytest.fixture(scope="module")
def test_log(twin):
    return as_log(twin)


@pytest.fixture(scope="module")
def course(test_log):
    return course_of(SWAN, test_log)


def thrusts(log, rows):
    """Thrusts without errors, from the file's table by SciPy's own interpolation, over each step."""
    from scipy.interpolate import PchipInterpolator

    table = SWAN.thrusters[0].table
    curve = PchipInterpolator(table.demand, table.thrust)
    found = []
    for t in SWAN.thrusters:
        d = log.columns[f"demand_{t.name}"][rows][:-1]
        found.append(np.where(d < table.demand[0], d * table.thrust[0] / table.demand[0], curve(np.maximum(d, 15.0))))
    return np.stack(found, axis=1)


def members(rng, fit, k):
    """Parameters inside the polytope: its vertices first, then convex combinations."""
    blocks = {i: b for b in blocks_of(fit, fit.parameters) for i in b.ids}
    pair, single = blocks["mass.surge"], blocks["inertia.yaw"]
    v = np.array([[float(x) for x in p] for p in pair.vertices])
    weights = rng.dirichlet(np.full(len(v), 0.3), k)
    weights[: len(v)] = np.eye(len(v))[:k]
    m, d = (weights @ v).T
    ends = [float(p[0]) for p in single.vertices]
    share = rng.choice([0.0, 1.0, 0.5], k)
    return m, d, ends[0] + share * (ends[-1] - ends[0])


def starts(rng, box, k):
    """Starts inside a box: corners for half of the members."""
    share = np.where(rng.random((6, k)) < 0.5, rng.integers(0, 2, (6, k)), rng.random((6, k)))
    inside = box.lower[:, None] + share * (box.upper - box.lower)[:, None]
    return np.clip(inside, box.lower[:, None], box.upper[:, None])


def escapes(bounds, states):
    """Number of samples outside, of bounds of shape (n, 6) and states of shape (n, 6, k)."""
    return int(((states < bounds.lower[:, :, None]) | (states > bounds.upper[:, :, None])).sum())


def examined(rng, fit, course, first, count, k, channels="all"):
    """Bounds and states of one window."""
    alone = channels == "straight"
    equations = equations_of(fit, (True, not alone, not alone))
    given = straight(course) if alone else None
    rows = slice(first, first + count + 1)
    bounds = followed(equations.model, course, first, count, given)
    box = start_of(course, first, given)
    t = course.log.t[rows]
    states = integrate(
        starts(rng, box, k),
        *members(rng, fit, k),
        t,
        thrusts(course.log, rows),
        shapes(rng, k, t, REACH * (1 - 1e-12), 3.0),
        straight=alone,
    )
    return bounds, states


def followed(model: Model, course, first, count, given=None, force=None):
    steps = slice(first, first + count)
    return model.follow(
        start_of(course, first, given),
        course.h[steps],
        (course.force if force is None else force)[steps],
        None if given is None else given[steps],
    ).bounds


@pytest.mark.parametrize("first", [0, 310, 640])
def test_no_trajectory_leaves_the_tube(fit, course, first):
    bounds, states = examined(np.random.default_rng(first), fit, course, first, 80, 40)
    assert bounds.shape[0] == 81
    assert escapes(bounds, states) == 0


def test_no_straight_run_leaves_the_tube_of_surge(fit, course):
    bounds, states = examined(np.random.default_rng(5), fit, course, 0, 200, 30, "straight")
    assert escapes(bounds, states) == 0


@pytest.mark.nightly
@pytest.mark.parametrize("first", range(0, 1000, 100))
def test_no_trajectory_of_many_leaves_the_tube(fit, course, first):
    bounds, states = examined(np.random.default_rng([7, first]), fit, course, first, 200, 500)
    assert bounds.shape[0] == 201
    assert escapes(bounds, states) == 0


def middles(x):
    return IntervalArray(x.midpoint)


@pytest.mark.parametrize("mutant", ["thrust", "half", "start", "parameters", "step"])
def test_a_tube_of_too_little_is_left(fit, course, mutant):
    """Each bound is needed: without one of them the same trajectories escape."""
    rng = np.random.default_rng(11)
    first, count, k = 310, 60, 40
    _, states = examined(rng, fit, course, first, count, k)
    model, force, h = equations_of(fit).model, course.force, course.h
    start = start_of(course, first, None)
    if mutant == "thrust":
        force = middles(force)
    if mutant == "half":
        force = middles(force) + IntervalArray(-0.5 * force.radius, 0.5 * force.radius)
    if mutant == "start":
        start = middles(start)
    if mutant == "step":
        h = h * IntervalArray(np.array(0.9))
    if mutant == "parameters":
        centre = {i: replace(p, lower=p.midpoint, upper=p.midpoint) for i, p in fit.parameters.items()}
        model = equations_of(replace(fit, parameters=centre, certificates=())).model
    steps = slice(first, first + count)
    bounds = model.follow(start, h[steps], force[steps], None).bounds
    assert escapes(bounds, states) > 0


def test_the_tube_of_surge_is_attained(fit, test_log):
    """Outer over inner: a straight run's bounds are those of extreme members but for the switches of its demands."""
    made = tube(fit, test_log, channels="straight", windows=[10.0])
    for r in made.runs:
        ratio = r.ratio(0)
        assert np.median(ratio) <= 1.01 and ratio.max() <= 2.0, r.name
    widest = made.runs[0].horizon.bounds
    assert np.all(widest.lower[:, 0] <= widest.upper[:, 0]) and np.isfinite(widest.lower[:, 0]).all()


# Nightly: eighteen seconds; the gate has all channels of a twin of nine parameters, and the yaw rate.
@pytest.mark.nightly
def test_all_channels_over_short_windows(fit, test_log):
    made = tube(fit, test_log, windows=[2.0])
    windows = made.runs[1]
    assert [np.median(windows.ratio(k)) <= most for k, most in ((0, 1.6), (1, 1.2), (2, 1.1))] == [True] * 3
    assert made.guaranteed and not made.refuted
    assert "any function of time" in " ".join(made.assumes)


def test_twice_the_box_is_not_far_wider(fit, course):
    """Parameters, thrust errors and start twice as far from their middles."""

    def widths(factor):
        wide = {
            i: replace(p, lower=p.midpoint - factor * p.width / 2, upper=p.midpoint + factor * p.width / 2)
            for i, p in fit.parameters.items()
        }
        model = equations_of(replace(fit, parameters=wide, certificates=()), (True, False, False)).model
        r = factor * course.force.radius
        bounds = followed(model, course, 0, 1000, straight(course), middles(course.force) + IntervalArray(-r, r))
        return bounds.upper[:, 0] - bounds.lower[:, 0]

    once, twice = widths(1.0), widths(2.0)
    assert np.all(twice[1:] <= 2.5 * once[1:])


def test_time_is_linear_in_samples(fit, course):
    import time

    model, given = equations_of(fit, (True, False, False)).model, straight(course)

    def seconds(count):
        least = np.inf
        for _ in range(3):
            begun = time.process_time()
            followed(model, course, 0, count, given)
            least = min(least, time.process_time() - begun)
        return least

    # Twice the samples and a part for what does not grow: the share of a quadratic cost would be four.
    assert seconds(1000) <= 3.2 * seconds(500)


def test_a_vehicle_outside_the_fit_is_refuted(fit):
    """Another drag: its readings leave the tube, and the window that shows it is the shortest."""
    text = embedded("swan_test.toml").replace("duration = 300.0", "duration = 30.0", 1)
    text = text.replace('"drag.surge.quadratic" = 255.0', '"drag.surge.quadratic" = 340.0')
    other = as_log(simulate(SWAN, parse_scenario(text, "other")))
    made = tube(fit, other, windows=[10.0], inner=False)
    assert made.refuted
    found = next(f for r in made.runs for f in r.refuted)
    assert found.measured[0] > found.tube[1] or found.tube[0] > found.measured[1]
    course, model = course_of(SWAN, other), equations_of(fit).model
    begin, last = found.rows
    assert found.start == other.t[begin] and found.end == other.t[last]
    column = "uvr".index(found.component)
    again = followed(model, course, begin, last - begin)
    assert (again.lower[-1, column], again.upper[-1, column]) == found.tube
    shorter = followed(model, course, begin + 1, last - begin - 1)
    reading = course.measured[last]
    assert np.all((shorter.lower[-1, :3] <= reading.upper) & (reading.lower <= shorter.upper[-1, :3]))


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


@pytest.mark.parametrize("channels", ["all", "straight"])
def test_the_checker_proves_every_step(fit, test_log, channels):
    """In exact arithmetic, from the second definitions of the terms."""
    log = Log("part.csv", test_log.sha256, test_log.t[:60], {n: x[300:360] for n, x in test_log.columns.items()})
    made = tube(fit, log, channels=channels, windows=[], inner=False, check=True)
    assert made.checked.parts == made.checked.proved == 59 and not made.checked.faults


FORGED = {
    "upper": (8, 1, -1e-4),
    "lower": (6, 0, 1e-4),
    "sway": (7, 1, -1e-4),
    "rates": (3, 1, -1e-3),
    "turn": (5, 0, 1e-3),
    "start": (2, 1, 1e-3),
}


@pytest.mark.parametrize("case", FORGED)
def test_the_checker_refuses_a_claim_that_is_too_narrow(fit, course, case):
    column, end, shift = FORGED[case]
    equations = equations_of(fit)
    steps = slice(310, 311)
    followed = equations.model.follow(start_of(course, 310, None), course.h[steps], course.force[steps], certify=True)
    row = [list(e) for e in zip(followed.parts.lower[0].tolist(), followed.parts.upper[0].tolist(), strict=True)]
    force = list(zip(course.force.lower[310].tolist(), course.force.upper[310].tolist(), strict=True))
    h = (float(course.h.lower[310]), float(course.h.upper[310]))
    points = equations.pieces[0].points
    assert TubeChecker(fit.vehicle, "total", points).fault(part_of(row, force, h, 1)) is None
    row[column][end] += shift
    assert TubeChecker(fit.vehicle, "total", points).fault(part_of(row, force, h, 1)) is not None


def certified(fit, course, first, count, start):
    """A checker, and the parts of a tube."""
    equations = equations_of(fit)
    steps = slice(first, first + count)
    found = equations.model.follow(start, course.h[steps], course.force[steps], certify=True)
    rows = [
        [list(e) for e in zip(a, b, strict=True)]
        for a, b in zip(found.parts.lower.tolist(), found.parts.upper.tolist(), strict=True)
    ]
    parts = []
    for row, (step, _, share) in zip(rows, found.steps, strict=True):
        k = first + step
        force = list(zip(course.force.lower[k].tolist(), course.force.upper[k].tolist(), strict=True))
        parts.append((row, force, (float(course.h.lower[k]), float(course.h.upper[k])), share))
    return TubeChecker(fit.vehicle, "total", equations.pieces[0].points), parts


def test_the_checker_integrates_the_turn(fit, course):
    """After a second the yaw rate is narrower than its accelerations alone allow, and no narrower than its row since the start."""
    checker, parts = certified(fit, course, 310, 40, start_of(course, 310, None))
    assert all(checker.fault(part_of(*p)) is None for p in parts[:-1])
    row, *rest = parts[-1]
    forgotten = TubeChecker(fit.vehicle, "total", equations_of(fit).pieces[0].points)
    assert "of r" in forgotten.fault(part_of(row, *rest))
    row[8][1] -= 1e-3
    assert "upper end of r" in checker.fault(part_of(row, *rest))


def wide(course, first):
    """A start that turns at any rate up to 4 rad/s, either way."""
    box = start_of(course, first, None)
    lower, upper = box.lower.copy(), box.upper.copy()
    lower[2], upper[2] = -4.0, 4.0
    return IntervalArray(lower, upper)


def test_the_checker_bounds_the_momentum(fit, course):
    """A turn of any rate leaves the momentum alone: without that bound, ends and accelerations are not proved."""
    checker, parts = certified(fit, course, 310, 50, wide(course, 310))
    assert all(checker.fault(part_of(*p)) is None for p in parts)
    row, *rest = parts[-1]
    forgotten = TubeChecker(fit.vehicle, "total", equations_of(fit).pieces[0].points)
    assert forgotten.fault(part_of(row, *rest)) is not None
    row[6][1] -= 1e-3
    assert checker.fault(part_of(row, *rest)) is not None


def test_a_turn_of_any_rate_keeps_a_tube_finite(fit, course):
    """Nobody escapes, and the speed stays below what the thrust can drive against the drag."""
    first, count, k = 310, 80, 40
    start, steps, rows = wide(course, first), slice(first, first + count), slice(first, first + count + 1)
    bounds = equations_of(fit).model.follow(start, course.h[steps], course.force[steps], None).bounds
    assert bounds.shape[0] == count + 1
    assert np.abs(np.r_[bounds.lower[:, :2], bounds.upper[:, :2]]).max() < 1.0
    rng, t = np.random.default_rng(3), course.log.t[rows]
    states = integrate(
        starts(rng, start, k),
        *members(rng, fit, k),
        t,
        thrusts(course.log, rows),
        shapes(rng, k, t, REACH * (1 - 1e-12), 3.0),
    )
    assert escapes(bounds, states) == 0


def test_a_tube_without_readings_lasts(fit, test_log):
    """Yaw has no damping: its rate grows with time, and nothing else without end."""
    made = tube(fit, test_log, windows=[], inner=False)
    whole = made.runs[0].horizon
    assert [w.proved for w in whole.windows] == [w.last for w in whole.windows]
    assert np.abs(np.r_[whole.bounds.lower[:, :2], whole.bounds.upper[:, :2]]).max() < 1.5
    assert not made.refuted


def test_a_tube_beside_rows_ends_where_it_bounds_little(fit, course, monkeypatch):
    """Validation and diagnosis follow no turn of many radians, and keep what was proved before it."""
    equations, last = equations_of(fit), 400
    whole = window(equations, course, 0, last, None)
    monkeypatch.setattr("ivsid.tubes.horizons.TRIED", 100)
    assert window(equations, course, 0, last, None, early=True).shape[0] == last + 1
    monkeypatch.setattr("ivsid.tubes.horizons.TURN", 1e-3)
    ended = window(equations, course, 0, last, None, early=True)
    assert ended.shape[0] == 101 and np.array_equal(ended.upper, whole.upper[:101])


# Nightly: a twin of nine parameters stands in the gate.
@pytest.mark.nightly
def test_the_yaw_rate_is_attained(fit, test_log):
    """Over ten seconds: one inertia for the whole window, and errors of the moment as their integral."""
    windows = tube(fit, test_log, windows=[10.0], whole=False).runs[0]
    assert np.median(windows.ratio(2)) <= 1.05 and windows.ratio(2).max() <= 1.15
    assert np.median(windows.ratio(0)) <= 1.5 and np.median(windows.ratio(1)) <= 1.2


OTTER = parse_vehicle(embedded("otter.toml"), "otter.toml")


@pytest.fixture(scope="module")
def otter(fit):
    """Nine parameters within 2 % of the truth of the shipped programme, with a cross flow, lagging shafts and Munk's moment; and its twin."""
    scenario = parse_scenario(
        embedded("otter_programme.toml").replace("duration = 600.0", "duration = 40.0", 1), "otter"
    )
    ids = [t.id for t in terms_of(OTTER)]
    around = {i: Parameter(0.98 * scenario.truth[i], 1.02 * scenario.truth[i], "", "") for i in ids}
    known = replace(fit, vehicle=OTTER, parameters=around, estimate=dict(scenario.truth), certificates=())
    return known, simulate(OTTER, scenario)


# Nightly: the gate follows five parameters, and the equations of nine.
@pytest.mark.nightly
def test_a_twin_of_nine_parameters_stays_inside(otter):
    known, twin = otter
    made = tube(known, as_log(twin), windows=[5.0], inner=False)
    truth = np.stack([twin.exact[n] for n in ("u", "v", "r")], axis=1)
    for r in made.runs:
        low, high = r.horizon.bounds.lower[:, :3], r.horizon.bounds.upper[:, :3]
        assert np.all((low <= truth) & (truth <= high)), r.name
    assert not made.refuted
    widths = made.runs[1].horizon.bounds
    assert np.median(widths.upper[:, 0] - widths.lower[:, 0]) < 0.25


def test_the_checker_knows_the_cross_flow(otter):
    known, twin = otter
    log = as_log(twin)
    part = Log("part.csv", log.sha256, log.t[:12], {n: x[400:412] for n, x in log.columns.items()})
    made = tube(known, part, windows=[], inner=False, check=True)
    assert made.checked.parts >= 11 and not made.checked.faults


def test_cells_of_the_yaw_rate_hold_every_trajectory(fit, course):
    """In a turn and out of it: nobody escapes, and surge and sway are narrower than in one box."""
    cut = replace(equations_of(fit), yaw_cells=8)
    for first in (310, 640):
        whole, states = examined(np.random.default_rng(first), fit, course, first, 80, 40)
        bounds = window(cut, course, first, first + 80, None)
        assert bounds.shape[0] == 81 and escapes(bounds, states) == 0
        one, many = (np.median(b.upper[1:, :3] - b.lower[1:, :3], axis=0) for b in (whole, bounds))
        assert np.all(many < one) and many[1] < 0.98 * one[1]


def test_the_checker_proves_cells_of_the_yaw_rate(fit, test_log, course):
    """Each part, and that the cells that are cut anew hold all states of the step before."""
    log = Log("part.csv", test_log.sha256, test_log.t[:14], {n: x[310:324] for n, x in test_log.columns.items()})
    made = tube(fit, log, windows=[], inner=False, yaw_cells=3, check=True)
    assert made.yaw_cells == 3 and made.checked.parts == made.checked.proved >= 26
    equations = replace(equations_of(fit), yaw_cells=3)
    piece, start = equations.pieces[0], start_of(course, 310, None)
    found = of_piece(equations, piece, course, 310, 321, None, parts=1, certify=True)
    claims = {}
    for (step, cell, share), low, high in zip(found.steps, found.parts.lower, found.parts.upper, strict=True):
        k = 310 + step
        force = list(zip(course.force.lower[k].tolist(), course.force.upper[k].tolist(), strict=True))
        h = (float(course.h.lower[k]), float(course.h.upper[k]))
        part = part_of(list(zip(low.tolist(), high.tolist(), strict=True)), force, h, share)
        claims.setdefault(step, []).append((cell, part))

    def fault(last, change):
        """What the checker says first of a step whose claims are changed, after those before it."""
        checker = TubeChecker(fit.vehicle, "total", piece.points)
        checker.begin(start_box(start.lower[:3].tolist(), start.upper[:3].tolist()))
        assert not any(f for step in range(last) for f in checker.faults(claims[step]))
        return checker.faults(change(claims[last]))[0]

    assert len(claims[0]) > 1 and len(claims[10]) > 2
    assert all("leave states" in fault(0, change) for change in (lambda c: c[1:], lambda c: c[:-1]))
    assert "leave states" in fault(10, lambda c: [c[0], *c[2:]])


def box(*ends):
    return tuple(Range(Fraction(a), Fraction(b)) for a, b in ends)


def test_a_cover_has_no_gap():
    whole = box((0, 1), (-1, 1), (0, 3))
    cells = [box((0, 1), (-1, 1), (a, a + 1)) for a in range(3)]
    assert covers(cells, whole) and covers(cells[::-1], whole) and covers(cells, box((0, 1), (0, 0), (1, 1)))
    assert not covers([], whole) and not covers([], box((0, 1), (0, 1), (2, 2)))
    for k in range(3):
        assert not covers(cells[:k] + cells[k + 1 :], whole)
        # A cell that lacks some of sway where the yaw rates meet, though another holds the same yaw rate.
        assert not covers([*cells, box((0, 1), (-1, Fraction(1, 2)), (k, k + 1))], whole)
    beyond = box((5, 6), (5, 6), (4, 5))
    assert covers([*cells, beyond], whole) and not covers(cells, box((0, 1), (0, 1), (2, Fraction(7, 2))))


def test_pieces_cover_the_parameters(fit, test_log):
    """The hull of the pieces' tubes holds all trajectories, is no wider than the tube of all parameters, and is proved again."""
    rng = np.random.default_rng(3)
    course = course_of(SWAN, test_log)
    whole, states = examined(rng, fit, course, 310, 60, 40)
    cut = equations_of(fit, cells=2)
    assert len(cut.pieces) == 8
    bounds = window(cut, course, 310, 370, None)
    assert escapes(bounds, states) == 0
    assert np.all(whole.lower <= bounds.lower) and np.all(bounds.upper <= whole.upper)
    assert np.all(bounds.upper[60, :3] - bounds.lower[60, :3] < whole.upper[60, :3] - whole.lower[60, :3])
    # A piece alone is left.
    alone = window(replace(cut, pieces=cut.pieces[:1]), course, 310, 370, None)
    assert escapes(alone, states) > 0
    log = Log("part.csv", test_log.sha256, test_log.t[:8], {n: x[300:308] for n, x in test_log.columns.items()})
    again = tube(fit, log, channels="straight", windows=[], inner=False, cells=2, check=True)
    assert again.pieces == 4 and again.checked.proved == again.checked.parts == 28


@pytest.mark.parametrize(("key", "value"), [("lower", ["x"]), ("right", None), ("upper", [3, 4])])
def test_a_damaged_certificate_is_a_sentence(fit, key, value):
    """An edited result is read by whoever validates: a corner of its sets that is no number ends in a sentence."""
    edited = deepcopy(fit.certificates)
    for c in edited:
        for row in c.get("rows", ()):
            row[key] = value * len(row["lower"]) if value == ["x"] else value
    with pytest.raises(IvsidError, match="a certificate of the fit cannot be read"):
        pieces_of(replace(fit, certificates=edited), list(fit.parameters), 1)
