"""The diagnosis on logs that no examination draws: gaps, losses, outliers, epochs, poses, rudders, mounted sensors, linear demands."""

import numpy as np
import pytest

from diagnosis_logs import (
    RUDDER,
    STEERED,
    TABLE,
    TRUTH,
    TWIN,
    epochs,
    gaps,
    logs_of,
    losses,
    names,
    rows,
    train_of,
    vehicle_of,
    wild,
    with_columns,
)
from ivsid import IvsidError, diagnose
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.log import Log
from ivsid.sensors.lever_arms import at_origin
from ivsid.vehicle import parse_vehicle


# Nightly: whole diagnoses; the gate screens other kinds of damage in test_diagnosis_stages.py.
@pytest.mark.parametrize(
    "change",
    [
        pytest.param(gaps, marks=pytest.mark.nightly),
        pytest.param(losses, marks=pytest.mark.nightly),
        pytest.param(wild, marks=pytest.mark.nightly),
        pytest.param(epochs, marks=pytest.mark.nightly),
    ],
)
def test_a_damaged_log_of_a_true_model_is_adequate(change):
    vehicle = vehicle_of()
    train, test = logs_of(vehicle)
    rng = np.random.default_rng(5)
    result = diagnose(vehicle, change(train, rng), change(test, rng))
    assert result.verdict == "adequate", names(result)
    for id_, value in TRUTH.items():
        assert result.selection.last.h.values[id_] == pytest.approx(value, rel=0.06), id_
    if change is wild:
        assert any("stand far out" in n for n in result.notes)


# Nightly: the gate screens the same logs.
@pytest.mark.nightly
def test_an_effect_is_still_named_across_gaps_and_epochs():
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"drag.yaw.linear": 1.5})
    rng = np.random.default_rng(6)
    result = diagnose(vehicle, epochs(gaps(train, rng), rng), epochs(gaps(test, rng), rng))
    assert ["drag.yaw.linear" in s for s in names(result)] == [True]


# Nightly: the gate screens it.
@pytest.mark.nightly
def test_a_short_log_names_nothing_and_says_what_it_does_not_test():
    vehicle = vehicle_of()
    train, test = logs_of(vehicle)
    result = diagnose(vehicle, rows(train, train.t < 70), test)
    assert result.verdict == "adequate" and len(result.not_tested) > 5


def test_a_log_full_of_gaps_is_refused_in_a_sentence():
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, duration=100.0)
    with pytest.raises(IvsidError, match="fewer missing samples"):
        diagnose(vehicle, rows(train, (train.t % 6) < 3), test)


# Nightly: the gate screens these logs.
@pytest.mark.nightly
@pytest.mark.parametrize("lost", [("psi", "x", "y"), ("ax", "ay"), ("psi", "x", "y", "ax", "ay")])
def test_missing_channels_make_no_findings(lost):
    vehicle = vehicle_of()
    train, test = (
        Log(log.name, log.sha256, log.t, {k: x for k, x in log.columns.items() if k not in lost})
        for log in logs_of(vehicle)
    )
    result = diagnose(vehicle, train, test)
    assert result.verdict == "adequate"
    assert any(q["effect"].startswith("sensor.") for q in result.not_tested)


# Nightly: the longer log, twenty seconds of the gate for the same verdict.
@pytest.mark.parametrize("duration", [90.0, pytest.param(120.0, marks=pytest.mark.nightly)])
def test_a_pose_alone_never_makes_a_name(duration):
    """Velocities from a pose are smoothed with what comes after: refused, or adequate, or unknown, but no cause by name."""
    extra = "[sensors.limits]\nacceleration = 2.0\nyaw_acceleration = 2.0\n"
    vehicle = vehicle_of(extra=extra)
    pose = [
        Log(log.name, log.sha256, log.t, {k: x for k, x in log.columns.items() if k not in ("u", "v", "r", "ax", "ay")})
        for log in logs_of(vehicle, duration=duration)
    ]
    try:
        result = diagnose(vehicle, *pose)
    except IvsidError as refused:
        assert "no numbers of the model follow" in str(refused) or "no velocities but those of its pose" in str(refused)
    else:
        assert {f.effect for f in result.findings} <= {"unknown"}


# Nightly: the gate screens both logs.
@pytest.mark.nightly
def test_a_rudder_is_followed_and_a_hidden_effect_behind_it_is_named():
    vehicle = vehicle_of(RUDDER)
    train, test = logs_of(vehicle, segments=STEERED)
    result = diagnose(vehicle, train, test)
    assert result.verdict == "adequate", names(result)
    assert result.selection.last.h.values["inertia.yaw"] == pytest.approx(TRUTH["inertia.yaw"], rel=0.1)
    train, test = logs_of(vehicle, {"drag.surge.linear": 6.0}, segments=STEERED)
    result = diagnose(vehicle, train, test)
    assert "drag.surge.linear" in names(result)[0]
    # Without its rudder the model is wrong, and nothing in the catalogue is a rudder.
    without = vehicle.model_copy(
        update={"thrusters": tuple(t.model_copy(update={"rudder": None}) for t in vehicle.thrusters)}
    )
    train, test = logs_of(vehicle, segments=STEERED)
    assert diagnose(without, train, test).verdict != "adequate"


def test_mounted_sensors_come_back_to_the_origin():
    """The simulator moves the readings away by its own formulas; noise and the derivative of the yaw rate are all that differs."""
    where = "position = [0.4, -0.2]\nrotation = 0.3\n"
    bare = vehicle_of()
    text = bare.text
    for section in ("[sensors.velocity]\n", "[sensors.acceleration]\n"):
        text = text.replace(section, section + where)
    mounted = parse_vehicle(text, "mounted.toml")
    train = train_of(bare)
    moved, _ = logs_of(mounted)
    back = at_origin(moved, mounted.sensors)
    assert np.std(moved.columns["v"] - train.columns["v"]) > 0.05
    for name, most in (("u", 0.01), ("v", 0.01), ("ax", 0.04), ("ay", 0.04)):
        assert np.std(back.columns[name] - train.columns[name]) < most, name


def test_a_linear_demand_gives_the_mean_of_the_curve_between_two_samples():
    """For a cubic curve Simpson's rule is exact: the mean of T over a demand that runs straight is an integral of a polynomial."""
    text = TWIN.replace(TABLE, "polynomial = [2e-5, 1e-3, 0.1, 0.0]")
    held, linear = vehicle_of(text), vehicle_of(text, extra='[log]\ndemand = "linear"\n')
    train = train_of(held, duration=80.0)
    sent = train.columns["demand_port"]
    antiderivative = np.polyint([2e-5, 1e-3, 0.1, 0.0])
    a, b = sent[:-1], sent[1:]
    same = np.isclose(a, b, atol=1e-3)
    gap = np.where(same, 1.0, b - a)
    exact = (np.polyval(antiderivative, b) - np.polyval(antiderivative, a)) / gap
    found = Propulsion(linear, channels(train, linear)).thrusts()
    np.testing.assert_allclose(found.mean[0][:-1][~same], exact[~same], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.now[0], np.polyval([2e-5, 1e-3, 0.1, 0.0], sent))
    held_found = Propulsion(held, channels(train, held)).thrusts()
    np.testing.assert_allclose(held_found.mean[0], held_found.now[0])


def test_axes_that_are_coupled_across_another_are_whitened():
    """Surge with yaw, sway by itself: the rows of the pair do not stand together. Against sums written out."""
    rng = np.random.default_rng(0)
    pair, alone, x = rng.standard_normal((3, 2, 2)), rng.standard_normal((3, 1, 1)), rng.standard_normal((4, 3, 70))
    white = Whitening(((0, 2), (1,)), (pair, alone))(x)
    for group, taps in (((0, 2), pair), ((1,), alone)):
        wanted = np.zeros((4, len(group), 70))
        for lag, tap in enumerate(taps):
            wanted[:, :, lag:] += np.einsum("ij,kjn->kin", tap, x[:, list(group), : 70 - lag])
        np.testing.assert_allclose(white[:, list(group)], wanted, atol=1e-12)


def test_a_spin_that_the_clock_cannot_follow_is_refused():
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, duration=90.0)
    spinning = with_columns(train, lambda k, x: 40.0 * x if k == "r" else x)
    # The set-up looks like degrees taken for radians, which is said first unless the file insists.
    with pytest.raises(IvsidError, match="in deg/s and taken for rad/s"):
        diagnose(vehicle, spinning, test)
    insists = parse_vehicle(vehicle.text + '\n[setup]\naccept = ["setup.yaw_rate.unit"]\n', "vehicle.toml")
    with pytest.raises(
        IvsidError, match=r"from one sample to the next, and a diagnosis follows 0.3; log \d+(\.\d)? rows a second"
    ):
        diagnose(insists, spinning, test)
