"""Thrusts whose rate is limited, in the place of ones that lag."""

import numpy as np
import pytest
from tests.exam.cases import case

from dense_squares import least_squares
from diagnosis_logs import logs_of_case, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.slewed import PACES, lags, limited, slewed
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import visibility
from ivsid.vehicle import parse_vehicle


def test_a_limited_signal_follows_a_ramp_and_not_a_jump():
    assert limited(np.array([0.0, 3.0, 3.0, 3.0, -1.0]), 1.0).tolist() == [0.0, 1.0, 2.0, 3.0, 2.0]
    assert limited(np.array([0.5, 1.0, 0.7]), 1.0).tolist() == [0.5, 1.0, 0.7]


def test_the_fall_is_that_of_the_best_limit_by_least_squares():
    """The oracle limits the thrusts row by row, gives their forces by the places of the vehicle file, and solves the whole log."""
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle), everything)
    g, predictor = fit.gram, fit.noise.predictor
    n, h, values = predictor.log.n, predictor.log.h, fit.h.values
    s = next(q for q in score(fit)[1] if q.id == "thruster.lag")
    assert lags(s)
    fall = least_squares(g, fit.base)
    falls = []
    for pace in PACES:
        process = np.zeros((3, 2 * n))
        for k, t in enumerate(vehicle.thrusters):
            y, late = 0.0, []
            for x in fit.states.points.thrusts[k, :n]:
                most = max(abs(q) for q in t.table.thrust) * h / (pace * s.values[0])
                y = x if abs(x - y) <= most else y + np.sign(x - y) * most
                late.append(y - x)
            late = np.array(late)
            both = np.concatenate([late, 0.5 * (late + np.append(late[1:], late[-1]))])
            process[0] += both / values["mass.surge"]
            process[2] += -t.position[1] * both / values["inertia.yaw"]
        x, _ = g.white.blocks([predictor.answer(process)], g.good, g.length)
        falls.append(fall(x.reshape(1, -1), signed=False) if np.any(x) else 0.0)
    assert slewed(fit, s) == pytest.approx(max(falls), rel=1e-4, abs=1e-4)


@pytest.mark.parametrize(("what", "effect"), [("outside", "x.slew"), ("one", "thruster.lag")])
def test_a_limit_of_a_rate_is_no_lag_and_a_lag_is_one(what, effect):
    c = case(300002, what=what, effect=effect)
    vehicle, train = parse_vehicle(c.text, "v.toml"), logs_of_case(c)[0]
    fit, scored = score(plain_fit(vehicle, channels(train, vehicle), everything))
    shown = visibility(fit)
    tested = frozenset(i for i, v in shown.items() if v.tested)
    found = Threshold(calibrate(fit, tested, 0.005, 1), shown)(fit, scored)
    late = [s for s in scored if lags(s)]
    assert max(s.fall for s in late) > 1000.0
    assert any(s.id == "thruster.lag" for s in found.passed) == (what == "one")
    if what == "outside":
        assert not any(lags(s) for s in found.passed) and found.refused["thruster.lag"].rule == "slewed"
