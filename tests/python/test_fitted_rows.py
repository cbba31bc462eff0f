"""Causes of ``[model.fitted]`` in interval rows: the truth lies inside under them, is refuted without them, and the checker agrees."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import HULL, TRUTH
from ivsid import identify, validate, verify
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion.actuation import Push
from ivsid.propulsion.carried import Fitted
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

TABLE = "table = { demand = [-100, -60, -30, 0, 30, 60, 100], thrust = [-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0] }"
SHARP = (
    HULL
    + "".join(
        f'[[thrusters]]\nname = "{name}"\nposition = [-0.35, {y}]\n{TABLE}\naccuracy = {{ absolute = 0.01, relative = 0.001 }}\n'
        for name, y in (("port", -0.28), ("starboard", 0.28))
    )
    + """
[sensors]
confidence = 0.999
[sensors.velocity]
accuracy = 0.0004
[sensors.acceleration]
accuracy = 0.002
[sensors.yaw_rate]
accuracy = 2.0e-4
[sensors.heading]
accuracy = 0.001
[sensors.limits]
acceleration = 1.5
yaw_acceleration = 2.5
"""
)
SCENARIO = """
duration = 14.0
rate = 10.0
seed = 5
noise = "uniform"
[[segments]]
manoeuvre = "prbs"
demand = 55.0
amplitude = 35.0
differential = 18.0
period = 1.7
yaw_gain = 0.0
duration = 14.0
"""
# Numbers of causes that rows take into account, and whether the log shows that they are there: without them the truth is refuted.
CARRIED = {
    "thruster.delay": {"thruster.delay": 0.13},
    "one delay": {"thruster.delay.port": 0.26},
    "thruster.gain": {"thruster.gain": 0.08},
    "one gain": {"thruster.gain.starboard": -0.09},
    "thruster.asymmetry": {"thruster.asymmetry": 0.07},
    "thruster.lag": {"thruster.lag": 0.35},
    "thruster.shaft_lag": {"thruster.shaft_lag": 0.3},
    "thruster.deadband": {"thruster.deadband": 30.0},
    "thruster.saturation": {"thruster.saturation": 14.0},
    "thruster.advance_loss": {"thruster.advance_loss": 0.1},
    "current.steady": {"current.steady.north": 0.12, "current.steady.east": -0.09},
    "sensor.acceleration.bias": {"sensor.acceleration.bias.x": 0.05, "sensor.acceleration.bias.y": -0.03},
    "sensor.acceleration.lever_arm": {"sensor.acceleration.lever_arm.x": 0.2, "sensor.acceleration.lever_arm.y": 0.1},
    "sensor.yaw_rate.bias": {"sensor.yaw_rate.bias": 0.02},
    "sensor.yaw_rate.scale": {"sensor.yaw_rate.scale": 0.06},
    "sensor.velocity.scale": {"sensor.velocity.scale": -0.05},
    "sensor.velocity.misalignment": {"sensor.velocity.misalignment": 0.06},
    "sensor.velocity.lever_arm": {"sensor.velocity.lever_arm.x": 0.3, "sensor.velocity.lever_arm.y": -0.1},
    "several": {
        "thruster.delay": 0.13,
        "thruster.gain.port": 0.05,
        "current.steady.north": 0.12,
        "current.steady.east": -0.09,
        "sensor.yaw_rate.bias": 0.02,
        "sensor.velocity.scale": 0.03,
        "sensor.velocity.lever_arm.x": 0.3,
        "sensor.velocity.lever_arm.y": -0.1,
    },
}


def log_with(numbers, seed=5):
    """A log of the true vehicle with causes in it; errors of sensors and thrusters are uniform inside their bounds."""
    scenario = parse_scenario(SCENARIO.replace("seed = 5", f"seed = {seed}"), "s.toml")
    done = simulate(parse_vehicle(SHARP, "boat.toml"), scenario, effects={**TRUTH, **numbers})
    return Log("run.csv", "0" * 64, done.t, done.columns)


def stating(numbers, share=0.0):
    """The vehicle with numbers in ``[model.fitted]``, each with an interval of some share of itself that holds it off its middle."""
    lines = [
        f'"{k}" = {v!r}'
        if not share
        else f'"{k}" = {{ value = {v * (1 + share / 2)!r}, lower = {min(v * (1 - share), v * (1 + 2 * share))!r}, '
        f"upper = {max(v * (1 - share), v * (1 + 2 * share))!r} }}"
        for k, v in numbers.items()
    ]
    return parse_vehicle(SHARP + "\n[model.fitted]\n" + "\n".join(lines) + "\n", "model.toml")


def holds(fit):
    """Whether the true parameters lie in the intervals; an empty set holds nothing."""
    return fit.status != "empty" and all(p.lower <= TRUTH[n] <= p.upper for n, p in fit.parameters.items())


@pytest.mark.parametrize("which", CARRIED)
def test_the_truth_lies_inside_under_the_stated_causes_and_is_refuted_without_them(which, tmp_path):
    numbers = CARRIED[which]
    log = log_with(numbers)
    fit = identify(stating(numbers), log, rows="both", examine=False)
    assert fit.guaranteed and holds(fit), (fit.status, fit.parameters)
    assert not any("leave out" in n for n in fit.notes)
    assert any("causes of [model.fitted] act as stated" in a and all(n in a for n in numbers) for a in fit.assumes)
    assert not holds(identify(parse_vehicle(SHARP, "boat.toml"), log, rows="both", examine=False))
    fit.save(tmp_path)
    report = verify(tmp_path, log)
    assert report.proved, report.failures[:3]


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("which", CARRIED)
def test_intervals_of_causes_hold_the_truth_in_each_kind_of_row(which, seed, tmp_path):
    """A statement about any number of an interval is weaker than that about one of them."""
    log, keys = log_with(CARRIED[which], seed), ("thruster.lag", "thruster.shaft_lag", "thruster.deadband")
    # A key of a thruster takes one number.
    share = 0.0 if which in (*keys, "thruster.saturation", "thruster.advance_loss") else 0.05
    for kind in ("auto", "integral", "both"):
        fit = identify(stating(CARRIED[which], share), log, rows=kind, examine=False)
        assert fit.guaranteed and holds(fit), (kind, fit.status, fit.parameters)
        fit.save(tmp_path)
        assert verify(tmp_path, log).proved


def test_the_key_of_a_thruster_takes_the_value_and_the_assumption_says_so():
    numbers = {"thruster.lag": 0.35, "thruster.gain": 0.08}
    fit = identify(stating(numbers, 0.05), log_with(numbers), examine=False)
    (sentence,) = [a for a in fit.assumes if "act as stated" in a]
    assert f"thruster.lag is {0.35 * 1.025!r}" in sentence and "thruster.gain lies in [0.076" in sentence


# Causes that no row takes into account, alone or beside a key that stands in their way, and what a row would need.
LEFT_OUT = {
    "gain under a limit": ({"thruster.gain": 0.05, "thruster.saturation": 20.0}, "thruster.gain"),
    "delay before a lag": ({"thruster.delay": 0.1, "thruster.lag": 0.2}, "thruster.delay"),
    "wave": (
        {"wave.force.amplitude": 1.0, "wave.force.period": 4.0, "wave.force.phase": 0.0, "wave.force.direction": 0.0},
        "wave.force.amplitude",
    ),
    "late velocity": ({"sensor.velocity.delay": 0.1}, "sensor.velocity.delay"),
    "negative loss": ({"thruster.advance_loss": -0.05}, "thruster.advance_loss"),
}


@pytest.mark.parametrize("which", LEFT_OUT)
def test_a_cause_that_no_row_holds_leaves_no_guarantee_and_the_checker_tells_a_forged_one(which, tmp_path):
    numbers, name = LEFT_OUT[which]
    log = log_with(numbers)
    fit = identify(stating(numbers), log, examine=False)
    assert not fit.guaranteed and f"{name}" in "".join(a for a in fit.assumes if a.endswith("acts in no row"))
    assert any(f"leave out {name}" in n or f", {name}" in n for n in fit.notes)
    fit.save(tmp_path)
    assert not [f for f in verify(tmp_path, log).failures if "guaranteed" in f]
    replace(fit, guaranteed=True).save(tmp_path)
    assert any("leave out" in f for f in verify(tmp_path, log).failures)


def test_rows_of_a_number_that_was_changed_afterwards_are_refuted(tmp_path):
    """The checker takes the numbers from the vehicle file, and not from the result."""
    numbers = CARRIED["several"]
    log = log_with(numbers)
    fit = identify(stating({**numbers, "sensor.yaw_rate.bias": 0.021}), log, examine=False)
    replace(fit, vehicle=stating(numbers)).save(tmp_path)
    assert not verify(tmp_path, log).proved


def test_a_late_demand_across_lost_rows_and_jittering_stamps_keeps_its_thrust():
    """Thrusts of late demands hold the exact means over steps, and are missing where a lost row may have held another demand."""
    rng = np.random.default_rng(8)
    t = 0.13 * np.arange(90) + rng.uniform(-0.04, 0.04, 90)
    t = np.r_[t[t < 6.0], t[t > 6.6]]
    demand = np.round(rng.uniform(-90.0, 90.0, t.size))
    log = Log("run.csv", "0" * 64, t, {"demand_port": demand})
    thruster = parse_vehicle(SHARP, "boat.toml").thrusters[0]
    curve = ThrustCurve(thruster)
    for delay in (0.0, 0.04, 0.2, 0.9):
        ends = (max(delay - 0.01, 0.0), delay + 0.01)
        made = Push(thruster, log, held=True, fitted=Fitted(delay=ends)).forces(0, t.size)
        thrust, fine = curve.value(demand), 400
        known = 0
        for k in range(t.size - 1):
            moments = t[k] + (np.arange(fine) + 0.5) / fine * (t[k + 1] - t[k]) - delay
            acting = np.searchsorted(t, moments, "right") - 1
            if made.whole[k]:
                known += 1
                assert (
                    acting.min() >= 0 and (np.diff(t)[np.unique(acting[acting < t.size - 1])] < 1.51 * log.period).all()
                )
                mean, slack = thrust[acting].mean(), 2 * np.ptp(thrust[acting]) / fine
                x = made.over_steps[0]
                assert x.lower[k] - slack <= mean <= x.upper[k] + slack
            if made.present[k]:
                at = thrust[np.searchsorted(t, t[k] - delay, "right") - 1]
                assert made.at_rows[0].lower[k] <= at <= made.at_rows[0].upper[k]
        assert 60 < known < t.size - 2


def test_validation_predicts_forces_with_the_causes():
    """The predicted force of a late thrust agrees with the log, and without the delay it does not."""
    numbers = {"thruster.delay": 0.13}
    log, other = log_with(numbers), log_with(numbers, 6)
    fit = identify(stating(numbers), log, rows="integral", examine=False)
    with_it = validate(fit, other)
    without = validate(replace(fit, vehicle=parse_vehicle(SHARP, "boat.toml")), other)
    assert not any(f.falsified for f in with_it.forces) and any(f.falsified for f in without.forces)
    assert not any("no row of forces" in n for n in with_it.notes)
