"""A turning hull in a heavy sea: the ambient force carries the states over half a step, too."""

import numpy as np
import pytest
from tests.exam.cases import setting
from tests.exam.readings import log as noisy

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.kalman import axis
from ivsid.effects import terms_of
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle


def test_the_ambient_acceleration_is_that_of_the_filter_state_by_state():
    """The oracle is the filter in its textbook form: predict, correct, one sample after the other."""
    noise = {"velocity": 0.02, "acceleration": 0.3}
    here = axis(0.1, noise, 0.5, 2.0)
    rng = np.random.default_rng(3)
    readings = {k: s * rng.standard_normal(200) for k, s in noise.items()}
    process = rng.standard_normal(200)
    expected, filtered = here.ambient(here.errors({**readings, "process": process}))
    gain, state = here.kalman_gain[1:], np.zeros(2)
    for i in range(200):
        assert expected[i] == pytest.approx(state[1], abs=1e-9)
        state = state + gain @ (np.array([readings[k][i] for k in here.outputs]) - state)
        assert filtered[i] == pytest.approx(state[1], abs=1e-9)
        state = np.array([state[0] + 0.1 * (state[1] + process[i]), here.decay * state[1]])


def test_the_middle_of_a_step_holds_the_push_of_the_sea():
    """At 10 Hz in ten times the usual sea a circle had structure in u r, because the states in the steps lagged behind the push by half a step."""
    q = setting(154035, kind="steered", style="circle", ambient=10.0, duration=300.0, rate=10.0)
    sailed, streams = q.sailed({}, 0)
    motion = sailed.motion
    columns = noisy(sailed.vessel, motion, sailed.clean, q.noise, streams[2])
    vehicle = parse_vehicle(q.text, "v.toml")
    log = channels(Log("1.csv", "0" * 64, motion.t, columns), vehicle)
    predictor = Predictor(vehicle, log, declared_ambient(vehicle))
    states = predictor.settle(predictor.start(Hypothesis(terms_of(vehicle), q.exact)), 4)
    # Cubics through the true velocities and accelerations at both ends of a step.
    x, h = motion.states[:, :3], log.h
    middle = 0.5 * (x[:-1] + x[1:]) + h / 8 * (motion.after[:-1] - motion.before[:-1])
    off = states.points.nu[:, log.n : -1].T - middle
    push = motion.ambient[:-1, 0]
    lag = -q.exact["mass.surge"] * np.polyfit(push[50:], off[50:, 0], 1)[0] / h
    # The share of a step by which the push is late: a half without it, and what the filter has not yet learnt with it.
    assert abs(lag) < 0.15


def test_the_ambient_moment_is_that_on_the_inertia_that_turns():
    """The water turns with the hull: with the hull's inertia alone the sea was taken for three times as rough in yaw, and what was learnt kept to it.

    Then the fit trusted the sensors' noise too much where the sea is slow, and a sound vessel on a circle got a cubic drag at ten standard deviations.
    """
    q = setting(160251, duration=300.0, rate=10.0)
    sailed, streams = q.sailed({}, 0)
    columns = noisy(sailed.vessel, sailed.motion, sailed.clean, q.noise, streams[2])
    vehicle = parse_vehicle(q.text, "v.toml")
    fit = plain_fit(vehicle, channels(Log("1.csv", "0" * 64, sailed.motion.t, columns), vehicle), everything)
    true = vehicle.ambient.moment / q.exact["inertia.yaw"]
    assert 0.7 * true < fit.noise.predictor.ambient.deviation[2] < 1.4 * true
