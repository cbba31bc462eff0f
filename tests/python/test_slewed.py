"""Thrusts whose rate is limited, in the place of ones that lag."""

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of, logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import adopted, everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.slewed import PACES, lags, limited, slewed
from ivsid.vehicle import parse_vehicle


def test_a_limited_signal_follows_a_ramp_and_not_a_jump():
    assert limited(np.array([0.0, 3.0, 3.0, 3.0, -1.0]), 1.0).tolist() == [0.0, 1.0, 2.0, 3.0, 2.0]
    assert limited(np.array([0.5, 1.0, 0.7]), 1.0).tolist() == [0.5, 1.0, 0.7]


def test_the_gain_is_that_of_the_best_limit_in_the_place_of_the_lag():
    """The oracle limits the thrusts row by row, takes what they leave off the errors, and fits everything else once more."""
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, {"thruster.lag": 0.4}, duration=120.0), vehicle), everything)
    fit, scored = score(fit)
    s = next(q for q in scored if q.id == "thruster.lag")
    assert lags(s)
    problem = fit.problem
    states = improve(problem, fit.states.under(adopted(fit.h, s, fit)))
    predictor, h = problem.noise.predictor, states.h
    n, step = predictor.log.n, predictor.log.h
    (time,) = h.given[-1].values
    sent, late = fit.states.points.thrusts, states.points.thrusts

    def left(errors):
        g = problem.beside(problem.bare(h, errors), states)
        return Projection(g, range(len(g.names))).chi2

    errors, gains = predictor.errors(states), []
    for pace in PACES:
        process = np.zeros((3, 2 * n))
        for k, t in enumerate(vehicle.thrusters):
            most = max(abs(q) for q in t.table.thrust) * step / (pace * time)
            y, now = 0.0, []
            for x in sent[k, :n]:
                y = x if abs(x - y) <= most else y + np.sign(x - y) * most
                now.append(y)
            push = np.concatenate([now, 0.5 * (np.array(now) + np.append(now[1:], now[-1]))]) - late[k]
            process[0] += push / h.values["mass.surge"]
            process[2] += -t.position[1] * push / h.values["inertia.yaw"]
        gains.append(left(errors) - left(errors - predictor.answer(process)))
    assert slewed(problem, states, s, fit.h) == pytest.approx(max(0.0, *gains), rel=1e-3, abs=1e-2)


@pytest.mark.parametrize(
    ("effect", "hidden"),
    [
        # Nightly: whole diagnoses; the gate has a limit below, and delays are fitted in test_full_fits.py.
        pytest.param("thruster.delay", {"thruster.delay": 0.3}, marks=pytest.mark.nightly),
        pytest.param("thruster.lag", {"thruster.lag": 0.5}, marks=pytest.mark.nightly),
        pytest.param("thruster.shaft_lag", {"thruster.shaft_lag": 0.5}, marks=pytest.mark.nightly),
    ],
)
def test_what_follows_late_by_a_time_keeps_its_name(effect, hidden):
    """Of a delay of 0.3 s the score explains a sixth of what its full fit does, and a limit of a rate had a larger one."""
    vehicle = vehicle_of()
    found = diagnose(vehicle, *logs_of(vehicle, hidden), null_logs=0).findings
    assert [f.effect for f in found] == [effect]
    (bound,) = found[0].parameters.values()
    assert bound.lower <= hidden[effect] <= bound.upper


def test_a_limit_of_a_rate_is_no_lag():
    c = case(300002, what="outside", effect="x.slew")
    result = diagnose(parse_vehicle(c.text, "v.toml"), *logs_of_case(c), null_logs=0)
    assert [f.effect for f in result.findings] == ["unknown"]
    assert "slewed" in {r.rule for i, r in result.selection.refused.items() if i.startswith("thruster.")}
