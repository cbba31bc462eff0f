"""Turns that only a model with causes knows to be over within rows: a late thrust looks like inertia, and hides how quickly a hull damps them."""

from dataclasses import replace

import pytest

from diagnosis_logs import SENSORS, TRUTH, TWIN, logs_of
from ivsid.diagnosis import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.learning import learn, of_yaw, plain_fit, within_rows
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.statements.not_tested import left_out_note
from ivsid.effects import EFFECTS, Given, Term
from ivsid.vehicle import parse_vehicle

LAG = 0.5
# The hull forgets its turns six times a second, and rows come five times a second; its thrusters stand far out, so that it turns all the same.
DAMPING = 6.0 * TRUTH["inertia.yaw"]
TURNS = """
[[segments]]
manoeuvre = "prbs"
demand = 45.0
amplitude = 20.0
differential = 35.0
period = 3.0
duration = 60.0
[[segments]]
manoeuvre = "steps"
demand = [60.0, 30.0, 75.0, 15.0]
differential = [20.0, -30.0, 10.0]
period = 5.0
duration = 60.0
"""


def wide():
    terms = [*TRUTH, "drag.yaw.linear"]
    return parse_vehicle(TWIN.replace("0.28]", "0.9]") + SENSORS + f"[model]\nterms = {terms}\n", "wide.toml")


@pytest.fixture(scope="module")
def sailed():
    vehicle = wide()
    hidden = {"drag.yaw.linear": DAMPING, "thruster.lag": LAG}
    return vehicle, logs_of(vehicle, hidden, segments=TURNS, duration=120.0, rate=5.0)


def test_a_lag_shows_that_turns_are_over_within_rows(sailed):
    vehicle, (log, _) = sailed
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    # The plain model takes the lag for inertia, and lets the hull turn slowly.
    assert fit.h.values["inertia.yaw"] > 3 * TRUTH["inertia.yaw"] and not within_rows(fit)
    lagged = fit.states.under(fit.h.with_effect(Given(EFFECTS["thruster.lag"], (LAG,))))
    noise, states = learn(fit.noise.predictor, improve(fit.problem, lagged), everything, fit.fixed, frozenset())
    beside = survey(noise, improve(Problem.at(noise, fit.fixed, states), states), fit.fixed, frozenset())
    assert within_rows(beside)
    assert not within_rows(replace(beside, noise=replace(beside.noise, left_out=frozenset({2}))))
    # Numbers of the moment alone are kept where yaw is left out, and said to be.
    kept = of_yaw(beside.states)
    assert set(kept) == {"inertia.yaw", "drag.yaw.linear"}
    unseen = plain_fit(vehicle, channels(log, vehicle), everything, yaw=kept)
    assert unseen.noise.left_out == {2} and {i: unseen.h.values[i] for i in kept} == kept
    (note,) = left_out_note(unseen)
    assert "inertia.yaw, drag.yaw.linear are those of a first model, with yaw" in note and "usual hull" not in note


def test_terms_of_a_place_or_a_wind_are_asked_for_their_moment_as_well(sailed):
    vehicle, (log, _) = sailed
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    # Their columns need the place, the clock or the heading of the log.
    for id_ in ("wind.steady", "current.steady", "tether.tension", "drag.surge.hump", "payload.step"):
        given = EFFECTS[id_]
        h = fit.h.with_effect(Given(given, tuple(1.0 for _ in given.parameters)))
        assert set(of_yaw(fit.states.under(h))) == {"inertia.yaw", "drag.yaw.linear"}
    placed = Term("own.moment", "N_x", "N", lambda s: {"yaw": s.place.x})
    h = replace(fit.h, terms=(*fit.h.terms, placed), values={**fit.h.values, placed.id: 2.0})
    assert of_yaw(fit.states.under(h))[placed.id] == 2.0


def test_a_search_begins_again_without_yaw_where_its_causes_ask_for_it(sailed):
    vehicle, logs = sailed
    told = []
    result = diagnose(vehicle, *logs, null_logs=0, progress=told.append)
    assert any("looking again, without yaw" in said for said in told)
    assert [f.effect for f in result.findings] == ["thruster.lag"]
    bound = result.findings[0].parameters["thruster.lag"]
    assert bound.lower <= LAG <= bound.upper
    assert any("with yaw" in note for note in result.notes)


def test_a_drag_of_yaw_stands_that_no_search_without_yaw_can_show():
    """The first form of this search handed such a model out as adequate."""
    vehicle = wide()
    hidden = {"drag.yaw.linear": 2.0 * TRUTH["inertia.yaw"], "drag.yaw.quadratic": 30.0}
    told = []
    result = diagnose(
        vehicle, *logs_of(vehicle, hidden, segments=TURNS, duration=120.0, rate=5.0), null_logs=0, progress=told.append
    )
    assert any("looking again, without yaw" in said for said in told)
    assert [f.effect for f in result.findings] == ["drag.yaw.quadratic"]
    bound = result.findings[0].parameters["drag.yaw.quadratic"]
    assert bound.lower <= 30.0 <= bound.upper
