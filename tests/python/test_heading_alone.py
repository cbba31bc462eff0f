"""Logs without a gyro: the heading tells the yaw rate through the filter of yaw."""

import re

import numpy as np
import pytest

from diagnosis_logs import TRUTH, logs_of, screened, train_of, vehicle_of
from ivsid import IvsidError, diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.data.from_pose import differenced
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.left_out import axes_left_out
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

GYRO = re.compile(r"\[sensors.yaw_rate\]\n(?:[a-z_]+ = .*\n)+")


def without(log, *lost):
    return Log(log.name, log.sha256, log.t, {k: x for k, x in log.columns.items() if k not in lost})


def compass(accuracy=0.015):
    """The vessel without a gyro, with a compass of this accuracy."""
    text = GYRO.sub("", vehicle_of().text)
    return parse_vehicle(text.replace("accuracy = 0.015", f"accuracy = {accuracy}"), "compass.toml")


def blind(vehicle, effects=None, *, noise=0.0):
    """Both logs without a yaw rate and accelerations, with this noise on the headings beside that of the compass."""
    rng = np.random.default_rng(5)
    found = []
    for log in logs_of(vehicle_of(), effects):
        bare = without(log, "r", "rdot", "ax", "ay")
        psi = bare.columns["psi"] + rng.normal(0, noise, log.t.size)
        found.append(Log(log.name, log.sha256, log.t, {**bare.columns, "psi": psi}))
    return found


def test_a_heading_alone_gives_the_inertia_of_the_hull():
    """It was a quarter of the true one on a boat of 60 t: the rate was read as a sensor with white noise."""
    vehicle = compass()
    train, _ = blind(vehicle)
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    assert fit.noise.predictor.log.turned and not fit.noise.left_out
    for id_ in ("mass.surge", "mass.sway", "inertia.yaw"):
        assert fit.h.values[id_] == pytest.approx(TRUTH[id_], rel=0.1), id_
    # The rate that is made of the heading counts nowhere: its row of the whitened errors is nothing.
    row = fit.noise.predictor.labels.index((2, "r"))
    white = fit.noise.whitening(fit.noise.predictor.errors(fit.states))
    assert not white[row].any() and white[fit.noise.predictor.labels.index((2, "psi"))].any()


def test_a_sound_log_without_a_gyro_has_no_finding():
    vehicle = compass()
    result = diagnose(vehicle, *blind(vehicle), null_logs=0)
    assert (result.verdict, result.findings) == ("adequate", ())
    assert any("the heading alone tells the yaw rate" in n for n in result.notes)
    untested = {q["effect"] for q in result.not_tested}
    assert {"sensor.yaw_rate.bias", "sensor.yaw_rate.scale"} <= untested


def test_a_cause_is_named_without_a_gyro():
    vehicle = compass()
    logs = blind(vehicle, {"drag.yaw.linear": 12.0})
    assert "drag.yaw.linear" in screened(vehicle, logs[0]).passed


def test_a_coarse_compass_leaves_yaw_out():
    vehicle = compass(0.3)
    train, _ = blind(vehicle, noise=0.1)
    assert plain_fit(vehicle, channels(train, vehicle), everything).noise.left_out == {2}


def test_a_hull_that_damps_within_a_second_leaves_yaw_out_beside_a_compass():
    """The vessel turns enough, and a filter that forgets as quickly as it damps follows the noise of the heading."""
    terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic", "drag.yaw.linear"]
    vehicle = parse_vehicle(f"{compass(0.03).text}\n[model]\nterms = {terms}\n", "damped.toml")
    train, _ = blind(vehicle, {"drag.yaw.linear": 12.0}, noise=0.008)
    log = channels(train, vehicle)
    assert not axes_left_out(Predictor(vehicle, log, declared_ambient(vehicle)))
    assert plain_fit(vehicle, log, everything).noise.left_out == {2}


def test_a_compass_that_is_read_rarely_sets_the_clock():
    """Rates between its readings had made the heading too rare to be used, so that nothing told the yaw."""
    vehicle = compass()
    train, _ = blind(vehicle)
    psi = np.where(np.arange(train.t.size) % 5 == 0, train.columns["psi"], np.nan)
    log = channels(Log(train.name, train.sha256, train.t, {**train.columns, "psi": psi}), vehicle)
    assert log.turned and log.psi is not None and log.h == pytest.approx(0.5)


def test_a_log_with_a_gyro_keeps_it():
    log = train_of(vehicle_of())
    assert differenced(log) is log and not channels(log, vehicle_of()).turned


def test_a_pose_whose_velocities_are_noise_is_refused():
    vehicle = vehicle_of()
    train, test = (without(log, "u", "v", "r", "ax", "ay") for log in logs_of(vehicle))
    with pytest.raises(IvsidError, match="no velocities but those of its pose, whose noise is .* log u, v and r"):
        diagnose(vehicle, train, test)
