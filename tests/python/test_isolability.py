"""Before the trial: the manoeuvre of the library that separates each set of causes, and what the advice is worth when it is followed."""

import numpy as np
import pytest

from diagnosis_logs import RUDDER, STEERED, TRUTH, TWIN, ZIGZAGS, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.planning.advice import advise
from ivsid.diagnosis.planning.isolability import APART, separability
from ivsid.log import Log
from ivsid.programme import trials
from ivsid.programme.scenario import parse_scenario
from ivsid.report.page import html
from ivsid.simulation import simulate
from ivsid.workflow import isolability
from pages import faults
from sampling import spaced

LINE = """
[[segments]]
manoeuvre = "steps"
demand = [60.0, 30.0, 75.0, 40.0]
period = 15.0
yaw_gain = 20.0
duration = 60.0
"""
CIRCLE = """
[[segments]]
manoeuvre = "circle"
demand = 55.0
yaw_rate = -0.5
yaw_gain = 25.0
differential_limit = 25.0
duration = 30.0
"""
ONE_LINE = """
[[segments]]
manoeuvre = "steady"
demand = 60.0
yaw_gain = 20.0
duration = 60.0
"""


def sailed(vehicle, values, columns, noise="none", only=None):
    logs = {}
    for trial in trials.library(vehicle):
        if only is None or trial.name in only:
            made = simulate(vehicle, trials.scenario(trial, vehicle, 10.0, values, noise))
            logs[trial.name] = Log(trial.name, "", made.t, {k: x for k, x in made.columns.items() if k in columns})
    return logs


def fitted(segments, vehicle=None):
    vehicle = vehicle or vehicle_of()
    train = train_of(vehicle, segments=segments)
    return vehicle, train, plain_fit(vehicle, channels(train, vehicle), everything)


@pytest.mark.sampled
def test_the_library_is_sailed_by_every_kind_of_vehicle():
    """Every manoeuvre moves the vehicle, none makes it spin, and those of the issue are there."""
    for text in (TWIN, RUDDER):
        vehicle = vehicle_of(text)
        names = {t.name for t in trials.library(vehicle)}
        assert {
            "zigzag 10/10", "zigzag 20/20", "circles at two speeds", "coast to rest", "PRBS", "speed steps", "spiral", "chirp in yaw",
            "acceleration straights", "round the anchor", "speed changes on four headings",
        } <= names  # fmt: skip
        assert ("turns on the spot" in names) == (text is TWIN)
        # A rudder's simulation takes ten times as long.
        for trial in spaced(trials.library(vehicle), 3 if text is TWIN else 1):
            made = simulate(vehicle, trials.scenario(trial, vehicle, 10.0, TRUTH))
            assert 120 <= made.t[-1] <= 200
            e = made.exact
            assert max(np.ptp(e["u"]), np.ptp(e["psi"])) > 0.5, trial.name
            if text is TWIN:
                assert trials.believable(vehicle, e["r"]), trial.name


def test_two_logs_as_one_are_what_one_log_of_both_is():
    """The information of the log with the manoeuvre is that of the blocks of both: twice the same log has sqrt(2) times z and d, up to the biases that each log has of its own."""
    vehicle, train, fit = fitted(ZIGZAGS)
    quiet = sailed(vehicle, fit.h.values, train.columns, only={"coast to rest"})
    sets = [("drag.surge.linear", "friction.coulomb")]
    twice, _ = advise(fit, sets, {"again": train, **quiet})
    again = next(c for c in twice[0].choices if c.trial == "again")
    assert again.d == pytest.approx(np.sqrt(2) * twice[0].d, rel=0.03)
    coast = next(c for c in twice[0].choices if c.trial == "coast to rest")
    assert coast.d > twice[0].d


# Nightly: a second pair of causes; the gate asks which pairs no manoeuvre separates.
@pytest.mark.slow
@pytest.mark.nightly
def test_coasting_separates_linear_drag_from_friction_best():
    for segments in spaced((LINE, LINE + CIRCLE), 1):
        vehicle, train, fit = fitted(segments)
        logs = sailed(vehicle, fit.h.values, train.columns)
        noisy = sailed(vehicle, fit.h.values, train.columns, "gaussian", {"zigzag 20/20"})["zigzag 20/20"]
        (one,), _ = advise(fit, [("drag.surge.linear", "friction.coulomb")], logs, noisy)
        assert one.d < APART and one.best.trial == "coast to rest" and one.best.d >= APART
        assert one.best.groups == (("drag.surge.linear",), ("friction.coulomb",))


# Nightly: the gate has the coast that separates drag from friction, and the command.
@pytest.mark.slow
@pytest.mark.nightly
def test_headings_separate_current_from_wind_better_than_straight_runs():
    """Speed changes on several headings, and best full turns, tell a current from a wind.

    A straight run that begins at rest tells them apart by its drift sideways, now that sway counts there: four logs of such a run, two of a
    current and two of a wind, were each named rightly. Without sway it had no two of them apart.
    """
    vehicle, train, fit = fitted(ONE_LINE)
    logs = sailed(vehicle, fit.h.values, train.columns)
    noisy = sailed(vehicle, fit.h.values, train.columns, "gaussian", {"zigzag 20/20"})["zigzag 20/20"]
    (one,), _ = advise(fit, [("current.steady", "wind.steady")], logs, noisy)
    d = {c.trial: c.d for c in one.choices}
    assert APART <= one.d < 0.5 * one.best.d
    headings = d["speed changes on four headings"]
    assert headings >= APART
    # A coast turns away as it comes to rest; these two do not. Full turns without speed are best: there only the wind pushes.
    assert headings > 1.25 * max(d["acceleration straights"], d["speed steps"])
    assert one.best.trial == "turns on the spot"


# Nightly: the gate has the command.
@pytest.mark.nightly
def test_algebra_is_broken_by_no_manoeuvre():
    vehicle, train, fit = fitted(ZIGZAGS)
    (one,), _ = advise(fit, [("added_mass.munk", "drag.lift.yaw")], sailed(vehicle, fit.h.values, train.columns))
    assert one.best is None and all(c.d < 0.1 for c in one.choices)
    assert one.record()["best"] is None


# Nightly: the gate has the coast that separates drag from friction, and the command.
@pytest.mark.slow
@pytest.mark.nightly
def test_the_advice_holds_when_it_is_followed():
    """The distance that a coast promises, against that of a real log of the programme with a coast behind it, sensors' noise and all."""
    vehicle, train, fit = fitted(LINE)
    pair = ("drag.surge.linear", "friction.coulomb")
    logs = sailed(vehicle, fit.h.values, train.columns, only={"coast to rest"})
    noisy = sailed(vehicle, fit.h.values, train.columns, "gaussian", {"zigzag 20/20"})["zigzag 20/20"]
    (one,), _ = advise(fit, [pair], logs, noisy)
    trial = next(t for t in trials.library(vehicle) if t.name == "coast to rest")
    head = "duration = 390.0\nrate = 10.0\nseed = 5\n[truth]\n" + "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
    scenario = parse_scenario(head + 4 * LINE, "s.toml")
    scenario = scenario.model_copy(update={"segments": (*scenario.segments, *(trial.segments * 4))})
    made = simulate(vehicle, scenario)
    longer = plain_fit(vehicle, channels(Log("both.csv", "", made.t, made.columns), vehicle), everything)
    real = separability(longer, wanted=pair)
    assert one.d < APART and 0.6 < one.best.d / min(real.distance[0, 1], real.distance[1, 0]) < 1.6


@pytest.mark.slow
@pytest.mark.sampled
def test_the_command_advises_for_a_scenario_and_for_a_log(tmp_path):
    from ivsid.workflow.log_files import csv

    vehicle = vehicle_of()
    (tmp_path / "boat.toml").write_text(vehicle.text)
    head = "duration = 240.0\nrate = 10.0\nseed = 3\n[truth]\n" + "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
    (tmp_path / "line.toml").write_text(head + LINE + CIRCLE)
    made = simulate(vehicle, parse_scenario(head + LINE + CIRCLE, "line.toml"))
    (tmp_path / "log.csv").write_text(csv(made.t, made.columns))
    for name in spaced(("log.csv", "line.toml"), 1):
        page = isolability(tmp_path / "boat.toml", tmp_path / name)
        record = page.record
        advice = {tuple(a["effects"]): a for a in record["advice"]}
        assert [d.name for d in page.drawings] == ["separation"]
        assert faults(html(page)) == [] and page.first is not None and page.first.following
        for c in record["classes"]:
            assert tuple(c["effects"]) in advice
        munk = advice[("added_mass.munk", "drag.lift.yaw")]
        assert munk["best"] is None and set(munk["manoeuvres"]) == set(record["manoeuvres"])
        astern = record["shown_by"]["drag.surge.astern"]
        assert astern["manoeuvre"] == "coast to rest" and astern["z"] >= 8
        assert record["z"]["drag.surge.astern"] < 8
        assert any("coast to rest would show it" in line for line in page.lines)


# Nightly: a second library of sails; the gate advises by that of two thrusters.
@pytest.mark.slow
@pytest.mark.nightly
def test_a_rudder_and_a_vehicle_without_thrusters_get_what_is_possible(tmp_path):
    vehicle = vehicle_of(RUDDER)
    train = train_of(vehicle, segments=STEERED, duration=120.0)
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    names = spaced([t.name for t in trials.library(vehicle)], 2)
    logs = sailed(vehicle, fit.h.values, train.columns, only=names)
    found, _ = advise(fit, [("drag.surge.linear", "friction.coulomb")], logs)
    assert found[0].choices and found[0].best is not None
    bare = vehicle.model_copy(update={"thrusters": ()})
    assert trials.library(bare) == () and trials.full_demand(bare) == 0.0
