"""Readings against the tubes of a fit in ``validate``: causes that no row shows are proved by motion, and sound twins by nothing."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

import ivsid.tubes.reached as module
from ivsid import diagnose, identify, simulation, validate
from ivsid.diagnosis.statements.motion import motion_of, sentences
from ivsid.diagnosis.statements.proved import Proof, proof_of
from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.tubes.equations import equations_of
from ivsid.tubes.horizons import spaced
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.first_screens import validated
from ivsid.workflow.validation import tube_part, validation_lines, validation_summary

DATA = files("ivsid") / "data"
WIND = {"wind.steady.north": 1.0, "wind.steady.east": 0.6}


def log_of(name, effects=None, seconds=300.0, noise="gaussian"):
    """A trial of the shipped SWAN; uniform noise reaches the bounds of a log of this length."""
    text = (DATA / f"{name}.toml").read_text().replace('noise = "gaussian"', f'noise = "{noise}"')
    scenario = parse_scenario(text.replace("duration = 300.0", f"duration = {seconds}", 1), name)
    made = simulation.simulate(VEHICLE, scenario, None, effects, thrusters=3)
    return Log(f"{name}.csv", f"{len(effects or {}):064d}", made.t, made.columns)


VEHICLE = parse_vehicle((DATA / "swan.toml").read_text(), "swan.toml")


@pytest.fixture(scope="module")
def fit():
    return identify(VEHICLE, log_of("swan_train"))


def test_a_steady_wind_that_no_row_shows_is_proved_by_motion(fit):
    made = validate(fit, log_of("swan_test", WIND))
    assert not any(f.falsified for f in made.forces) and made.contradicted
    assert made.tubes.channels == "all" and made.tubes.guaranteed
    shown = made.tubes.clearest
    assert shown.tube[0] > shown.measured[1] or shown.measured[0] > shown.tube[1]
    assert f"to the reading of {shown.component} at {shown.end:.6g} s" in validation_summary(made)
    assert "and its motion does" in validation_summary(made)
    assert validated(made).tone == "bad" and "the motion does" in validated(made).verdict
    assert any(f"{max(made.tubes.outside.values())} " in line for line in validation_lines(made))
    assert tube_part(made)["kind"] == "table" and "reading outside" in repr(made)


@pytest.mark.parametrize("noise", ["gaussian", "uniform"])
def test_a_sound_twin_stays_inside(fit, noise):
    made = validate(fit, log_of("swan_test", noise=noise))
    assert not made.contradicted and set(made.tubes.outside.values()) == {0}
    assert validation_summary(made).endswith("nor does its motion.")


def test_a_fit_with_open_parameters_leaves_surge(fit):
    """An inertia without a bound: u is followed alone, with v and r as measured."""
    inertia = replace(fit.parameters["inertia.yaw"], lower=-np.inf, upper=np.inf)
    open_ = replace(fit, parameters={**fit.parameters, "inertia.yaw": inertia})
    made = module.reached(open_, log_of("swan_test", seconds=60.0))
    assert made.channels == "surge" and made.reason is None


def test_a_fit_that_lacks_a_parameter_has_no_tube_and_says_which(fit):
    """A method that does not apply may leave some intervals out."""
    rest = {i: p for i, p in fit.parameters.items() if i != "inertia.yaw"}
    lacking = replace(fit, method="qr", status="not_applicable", parameters=rest)
    made = module.reached(lacking, log_of("swan_test", seconds=30.0))
    assert made.channels in ("", "surge")
    with pytest.raises(IvsidError, match="has no interval of inertia.yaw"):
        equations_of(lacking)


def test_tubes_are_followed_unasked_in_logs_of_moderate_length(fit, monkeypatch):
    log = log_of("swan_test", seconds=30.0)
    monkeypatch.setattr(module, "UNASKED", 100)
    made = validate(fit, log)
    assert made.tubes.channels == "" and "600 rows take long" in made.tubes.reason
    assert "No tube was followed" in str(tube_part(made)) and not made.contradicted
    assert validate(fit, log, tubes=True).tubes.channels == "all"
    assert np.isfinite(validate(fit, log, tubes=False).forces[0].sigma)


def test_motion_is_asked_where_the_rows_of_the_log_itself_agree():
    train, test = (log_of(name, WIND) for name in ("swan_train", "swan_test"))
    proof = proof_of(VEHICLE, train)
    assert proof.status == "not_refuted"
    found = motion_of(proof, train, test)
    assert all(m.refuted and set(m.outside) == {1.0} for m in found)
    first, second = sentences(found, "a.csv", "b.csv")
    assert (
        "every row of a.csv moves from the state at" in first and "of a.csv: the model is wrong, or an error" in first
    )
    assert "of b.csv: the model is wrong, its numbers differ between the logs, or" in second
    # Nothing is proved by a fit that is no proof, and nothing said.
    assert not sentences(tuple(replace(m, guaranteed=False) for m in found), "a.csv", "b.csv")
    assert motion_of(Proof(None, "no rows"), train, test) == ()


# Nightly: a whole diagnosis.
@pytest.mark.nightly
def test_a_diagnosis_says_what_motion_proves():
    hidden = {"drag.sway.yaw_rate": 4.0}
    made = diagnose(VEHICLE, log_of("swan_train", hidden), log_of("swan_test", hidden), null_logs=0)
    assert [f.effect for f in made.findings] == ["drag.sway.yaw_rate"]
    assert made.proofs[0].refuted or made.moved
    assert made.record()["motion"] == [m.record() for m in made.motion]
    assert diagnose(VEHICLE, log_of("swan_train"), log_of("swan_test"), null_logs=0).motion == ()


def test_windows_of_a_long_log_are_evenly_spaced(fit):
    windows = [(20 * k, 20 * k + 20) for k in range(100)]
    assert spaced(windows, None) == spaced(windows, 2000) == windows
    few = spaced(windows, 600)
    assert few == windows[::4] and sum(b - a for a, b in few) <= 600
    log = log_of("swan_test", WIND)
    every, some = (module.reached(fit, log, windows=(1.0,), whole=False, steps=n) for n in (None, 1500))
    assert 0 < some.outside[1.0] <= every.outside[1.0]
