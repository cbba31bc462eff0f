"""Tubes: no consistent trajectory leaves them, they are narrow, and a vehicle outside the fit does."""

from dataclasses import replace

import numpy as np
import pytest

from conftest import as_log, embedded
from ivsid.effects import terms_of
from ivsid.identification import Parameter
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.tubes import tube
from ivsid.tubes.equations import equations_of
from ivsid.tubes.given import straight
from ivsid.tubes.horizons import start_of, window
from ivsid.tubes.inputs import course_of
from ivsid.vehicle import parse_vehicle
from tube_oracle import integrate, shapes
from tube_runs import (  # noqa: F401 - fixtures
    REACH,
    SWAN,
    course_of_log,
    escapes,
    examined,
    fit_of,
    followed,
    log_of,
    members,
    starts,
    thrusts,
    twin_of,
    wide,
)


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
