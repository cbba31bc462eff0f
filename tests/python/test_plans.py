"""Planned trials: programmes inside the limits, predictions against whole logs, fences that are proved of every vehicle, plain words."""

from dataclasses import replace
from importlib.resources import files
from itertools import pairwise

import numpy as np
import pytest

import ivsid.plans.planning as planning
import ivsid.plans.search as search
from ivsid import identify, plan, simulation, workflow
from ivsid.errors import IvsidError
from ivsid.files.records import to_json
from ivsid.linear import regression
from ivsid.log import Log
from ivsid.plans.fence import at_rest, members, proved
from ivsid.plans.known import known_rows
from ivsid.plans.narrowing import Narrowing, relative_width, widest
from ivsid.plans.sailed import estimate_of, sail, scenario_of, truth_of, usual
from ivsid.plans.search import Setting
from ivsid.plans.shape import Shape
from ivsid.programme.scenario import parse_scenario
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.trial_plan import scenario_text

DATA = files("ivsid") / "data"
VEHICLE = parse_vehicle((DATA / "swan.toml").read_text(), "swan.toml")
TRUTH = {"mass.surge": 60.45, "drag.surge.quadratic": 255.0, "inertia.yaw": 8.0}


def trained():
    scenario = parse_scenario((DATA / "swan_train.toml").read_text(), "swan_train.toml")
    made = simulation.simulate(VEHICLE, scenario)
    return Log("train.csv", "a" * 64, made.t, made.columns)


@pytest.fixture(scope="module")
def train():
    return trained()


@pytest.fixture(scope="module")
def fit(train):
    return identify(VEHICLE, train)


@pytest.fixture(scope="module", autouse=True)
def few():
    """Searches of a few programmes; the night has whole ones."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "POPULATION", 6)
        yield


@pytest.fixture(scope="module")
def short(fit):
    """The plan of a moment: what the tests of the gate look at."""
    return plan(fit, seconds=10.0, fence=30.0, generations=2, seed=4)


def drawn(seed, seconds=20.0, vehicle=VEHICLE, *, feedback=False):
    shape = Shape(vehicle, seconds, feedback)
    return shape, np.random.default_rng(seed).uniform(size=shape.size)


@pytest.mark.parametrize("name", ["swan", "otter", "vectored_rov"])
def test_programmes_last_as_long_as_asked_and_demands_stay_inside_the_curves(name):
    vehicle = parse_vehicle((DATA / f"{name}.toml").read_text(), f"{name}.toml")
    for seed in range(20):
        shape, x = drawn(seed, vehicle=vehicle)
        segments = shape.segments(x)
        assert sum(s.duration for s in segments) == pytest.approx(20.0, abs=1e-9)
        assert all(s.duration > 0 and s.period > 0 for s in segments)
        for s in segments:
            sides = abs(s.sway) + max(np.abs(s.differential))
            for common in s.demand:
                for thruster in vehicle.thrusters:
                    low, high = thruster.demand_range or (thruster.table.demand[0] * 0, thruster.table.demand[-1])
                    assert low - 1e-2 <= common - sides and common + sides <= high + 1e-2


def test_the_rows_of_a_fit_hold_it_and_bound_it_as_its_log_does(fit):
    ids = tuple(fit.parameters)
    matrix, right = known_rows(fit, ids)
    truth = np.array([TRUTH[i] for i in ids])
    for k in range(matrix.shape[0]):
        low, high = ((matrix[k] * truth).sum().lower, (matrix[k] * truth).sum().upper)
        assert low <= right.upper[k] and right.lower[k] <= high
    again = regression.feasible_set(matrix, right).value
    for k, p in enumerate(fit.parameters.values()):
        assert again.lower[k] == pytest.approx(p.lower, rel=1e-9)
        assert again.upper[k] == pytest.approx(p.upper, rel=1e-9)


def test_a_prediction_is_the_set_of_both_whole_logs(fit, train):
    """Against all rows of both logs at once, of which the planner keeps some."""
    shape, x = drawn(3)
    sailed = sail(VEHICLE, scenario_of(shape.segments(x), 20.0, 20.0, TRUTH), 5)
    purpose = Narrowing(fit)
    found = purpose.intervals(sailed)
    rows = [build_rows(bound_log(log, VEHICLE), VEHICLE, purpose.terms) for log in (train, sailed.log)]
    matrix = type(rows[0].matrix)(*(np.concatenate([getattr(r.matrix, e) for r in rows]) for e in ("lower", "upper")))
    right = type(rows[0].right)(*(np.concatenate([getattr(r.right, e) for r in rows]) for e in ("lower", "upper")))
    whole = regression.feasible_set(matrix, right).value
    for k, (id_, (low, high)) in enumerate(found.items()):
        assert low <= whole.lower[k] * (1 + 1e-12) and whole.upper[k] <= high * (1 + 1e-12)
        assert high - low <= 1.1 * (whole.upper[k] - whole.lower[k])
        assert low <= TRUTH[id_] <= high


def test_open_and_small_intervals_have_a_width():
    assert relative_width((1.0, 3.0), 2.0) == 1.0
    assert relative_width((-1.0, 3.0), 1e-9) == pytest.approx(4 / 3)
    assert relative_width((1.0, np.inf), 2.0) == np.inf
    assert widest({"a": (1.0, 3.0), "b": (-np.inf, 1.0)}, {"a": 2.0, "b": 0.0}) == pytest.approx(1e6 + 1.0)


def test_a_plan_is_a_scenario_that_can_be_sailed(fit, short):
    again = parse_scenario(scenario_text(short.scenario, "a comment"), "plan.toml")
    assert again == short.scenario
    made = simulation.simulate(VEHICLE, again)
    assert made.t.size == 200
    for t in VEHICLE.thrusters:
        demand = made.columns[f"demand_{t.name}"]
        assert demand.min() >= 0 and demand.max() <= t.table.demand[-1]
    step = np.diff(made.t)
    most = {"u": 2.5, "v": 2.5, "r": 1.5}
    assert all(np.abs(np.diff(made.exact[n]) / step).max() <= limit for n, limit in most.items())
    assert "widest relative interval" in repr(short) and len(repr(short)) < 2000
    record = short.record()
    assert record["guaranteed"] is False and to_json(record)
    assert record["before"] == pytest.approx(Narrowing(fit).before())
    assert short.predicted.least <= short.predicted.median <= short.predicted.most <= record["before"] * (1 + 1e-9)


def test_the_same_seed_gives_the_same_plan(fit, short):
    again = plan(fit, seconds=10.0, fence=30.0, generations=2, seed=4)
    assert again.scenario == short.scenario and again.record() == short.record()


def test_a_fence_is_proved_of_every_vehicle_and_not_of_the_estimate_alone(fit, short):
    still = at_rest(fit, short.scenario, short.sailed)
    assert [still.log.columns[n][0] for n in ("u", "v", "r")] == [0.0, 0.0, 0.0]
    assert all(np.array_equal(x[1:], still.log.columns[n][1:]) for n, x in short.sailed.log.columns.items())
    until, whole, reason, assumes = proved(fit, still, 1e6)
    assert whole and reason is None and until == pytest.approx(9.95)
    assert "starts at rest" in assumes[0] and set(fit.assumes) <= set(assumes)
    # The estimate stays inside this one, and other consistent vehicles do not: to prove it would be wrong.
    reach = short.sailed.reach * 1.0001
    until, whole, reason, _ = proved(fit, short.sailed, reach)
    assert not whole and "reaches the fence" in reason and until < 9.95
    others = members(fit, short.scenario, fit.estimate)
    assert any(o.reach > reach for o in others)
    for o in others:
        at = o.log.t - o.log.t[0] <= until
        assert np.hypot(o.x, o.y)[at].max() <= reach
    assert not proved(replace(fit, guaranteed=False), short.sailed, 1e6)[1]


def test_feedback_is_no_ground_for_a_proof(fit):
    made = plan(fit, seconds=10.0, fence=1e6, feedback=True, generations=1)
    assert made.fence.proved_until == 0.0 and not made.fence.whole and "feedback" in made.fence.reason
    assert all(s.yaw_gain > 0 for s in made.scenario.segments)


def test_programmes_beyond_fence_or_limits_cost_more_than_all_others(fit):
    shape, x = drawn(1)
    settings = [Setting(shape, Narrowing(fit), estimate_of(fit), 20.0, fence, 1) for fence in (1e6, 5.0, 2.0)]
    costs = [s.cost(x) for s in settings]
    assert all(a <= b for a, b in pairwise(costs)) and costs[-1] > 1e9


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"seconds": 5.0}, "a length of 10 to 3600 s"),
        ({"fence": 0.0}, "a radius above 0"),
        ({"rate": 0.1}, "1 to 1000 Hz"),
        ({"generations": 0}, "at least 1"),
        ({"separate": ("drag.surge.lineer", "thruster.gain")}, "drag.surge.linear"),
        ({"separate": ("thruster.gain", "thruster.gain")}, "given twice"),
        ({"separate": ("thruster.gain", "drag.surge.linear"), "seconds": 30.0}, "a length of 61 to 3600 s"),
        ({"fence": 0.01, "seconds": 10.0, "generations": 1}, "give a wider fence"),
    ],
)
def test_what_cannot_be_planned_is_one_sentence(fit, how, said):
    with pytest.raises(IvsidError, match=said):
        plan(fit, **how)


def test_an_estimate_that_nothing_follows_is_named(fit):
    nothing = replace(fit, estimate={**fit.estimate, "inertia.yaw": 0.0})
    made = plan(nothing, seconds=10.0, generations=1)
    assert "inertia.yaw = 0" in made.notes[0] and "a vessel of usual size" in made.notes[0]
    for id_, value in usual(nothing).items():
        assert fit.parameters[id_].lower <= value <= fit.parameters[id_].upper
    with pytest.raises(IvsidError, match="no point estimate"):
        plan(replace(fit, estimate={}), seconds=10.0)


def test_the_command_leaves_its_files(fit, tmp_path, monkeypatch):
    monkeypatch.setattr(planning, "GENERATIONS", {"narrow": 1, "separate": 1})
    (tmp_path / "result.json").write_text(to_json(fit.record()))
    report = workflow.plan(tmp_path / "result.json", seconds=10.0, fence=20.0)
    assert parse_scenario(report.files["plan.toml"], "plan.toml").duration == 10.0
    assert "are predicted to bring the widest relative interval from" in report.summary
    assert any("fence of 20 m: " in line for line in report.lines)
    assert report.record["command"] == "plan" and report.record["fence"]["members"] > 4


# Nightly: a distance needs a diagnosis for each programme.
@pytest.mark.nightly
def test_causes_are_told_apart_better_than_by_the_library(fit, monkeypatch):
    monkeypatch.setattr(search, "POPULATION", 24)
    made = plan(fit, separate=("drag.surge.linear", "drag.surge.cubic"), generations=2)
    assert made.predicted.median > 0 and made.details and made.before is None
    assert made.best_rival is None or made.gain(made.best_rival[1]) > 0.5


# Nightly: two whole searches.
@pytest.mark.nightly
def test_a_minute_narrows_more_than_the_library_and_as_predicted(fit, monkeypatch):
    """Twins that the planner did not see: the vehicle of the log itself, whose numbers the fit does not know, with other seas and noise."""
    monkeypatch.setattr(search, "POPULATION", 24)
    made = plan(fit, fence=50.0)
    assert made.gain(made.best_rival[1]) >= 1.5
    purpose = Narrowing(fit)
    scenario = made.scenario.model_copy(update={"truth": truth_of(fit, TRUTH)})
    reached = [purpose.value(sail(fit.vehicle, scenario, 2000 + k)) for k in range(9)]
    assert float(np.median(reached)) == pytest.approx(made.predicted.median, rel=0.1)
    # Vehicles at the ends of the fit's intervals contradict its own log, so that they tell of the fence alone.
    assert all(t.reach <= 50.0 for t in members(fit, made.scenario, fit.estimate))
