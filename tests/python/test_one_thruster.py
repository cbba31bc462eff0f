"""Causes of one thruster alone, on logs of the examination's simulator."""

from types import SimpleNamespace

import pytest
from tests.exam.cases import setting

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.one_thruster import with_one_thruster
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.vehicle import parse_vehicle


def found(seed, key, number):
    here = setting(seed)
    logs = logs_of_case(SimpleNamespace(logs=here.logs({key: number})))
    (f,) = diagnose(parse_vehicle(here.text, "v.toml"), *logs, null_logs=0).findings
    return f


@pytest.mark.parametrize(
    ("seed", "key", "number"),
    [
        (270003, "thruster.saturation.d", 827.6),
        # Nightly: the gate has a cap, and asks for causes of a thruster whose curve leaves its bounds below.
        pytest.param(270005, "thruster.curve.starboard", -0.3, marks=pytest.mark.nightly),
        pytest.param(300402, "thruster.lag.port", 0.28, marks=pytest.mark.nightly),
        pytest.param(270001, "thruster.saturation.b", 15.52, marks=pytest.mark.nightly),
        pytest.param(270002, "thruster.deadband.port", 24.0, marks=pytest.mark.nightly),
        pytest.param(270005, "thruster.deadband.starboard", 24.0, marks=pytest.mark.nightly),
        pytest.param(270001, "thruster.reverse_loss.b", 0.6, marks=pytest.mark.nightly),
        pytest.param(270003, "thruster.advance_loss.d", 0.138, marks=pytest.mark.nightly),
        pytest.param(300417, "thruster.delay.starboard", 0.113, marks=pytest.mark.nightly),
        pytest.param(300412, "thruster.shaft_lag.starboard", 0.395, marks=pytest.mark.nightly),
    ],
)
def test_a_cause_of_one_thruster_is_named_with_it(seed, key, number):
    f = found(seed, key, number)
    assert f.effect == key.rsplit(".", 1)[0]
    ((name, bound),) = f.parameters.items()
    assert name == f.name == key
    assert bound.lower <= number <= bound.upper


@pytest.mark.parametrize(
    ("seed", "effect", "number"),
    [
        # Between two values of the grid the band of both thrusters showed less than that of one.
        (300262, "thruster.deadband", 19.957366),
        # Nightly: the gate has one of all thrusters.
        pytest.param(270003, "thruster.curve", -0.3, marks=pytest.mark.nightly),
        pytest.param(300402, "thruster.lag", 0.28, marks=pytest.mark.nightly),
    ],
)
def test_a_cause_of_all_thrusters_is_none_of_one(seed, effect, number):
    f = found(seed, effect, number)
    assert (f.effect, f.name, list(f.parameters)) == (effect, effect, [effect])


def test_an_error_that_leaves_its_bound_has_causes_of_its_thruster_asked_for():
    here = setting(270005)
    vehicle = parse_vehicle(here.text, "v.toml")
    log, _ = logs_of_case(SimpleNamespace(logs=here.logs({"thruster.curve.starboard": -0.3})))
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    # No cause of all thrusters says where to look.
    asked, alone = with_one_thruster(fit, [])
    new = set(asked.gram.names) - set(fit.gram.names)
    assert any(name.startswith("thruster.curve.starboard") for name in new)
    # A thrust that is late moves no curve.
    assert alone and not any(s.id == "thruster.lag" for s in alone)
