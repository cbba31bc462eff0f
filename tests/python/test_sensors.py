"""Readings to intervals."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from conftest import as_log
from ivsid.errors import IvsidError
from ivsid.log import Log
from ivsid.log.record import Clock
from ivsid.sensors.bounds import bound_log
from ivsid.sensors.doppler import doppler
from ivsid.sensors.noise import half_width, rule_for
from ivsid.vehicle import InertialSensor, Sensors, VelocitySensor, parse_vehicle


def test_sigmas_follow_from_confidence_by_the_union_bound():
    # docs/theory.md, "Sensor bounds": 6000 samples at p = 0.999 give 5.2, three channels 5.4.
    assert rule_for(Sensors(confidence=0.999), 6000).sigmas == pytest.approx(5.2, abs=0.05)
    assert rule_for(Sensors(confidence=0.999), 18000).sigmas == pytest.approx(5.4, abs=0.05)
    rule = rule_for(Sensors(confidence=0.99), 1000)
    assert 2 * 1000 * norm.sf(rule.sigmas) <= 0.01
    assert rule.guaranteed and "probability >= 0.99" in rule.sentence


def test_the_paper_s_rule_is_available_and_not_guaranteed():
    rule = rule_for(Sensors(sigmas=3), 6000)
    assert rule.sigmas == 3 and not rule.guaranteed
    sensor = InertialSensor(random_walk=0.0018, bias_instability=3.0e-4, bias_time=670.0)
    assert half_width(sensor, 0, 0.05, rule, 300.0) == pytest.approx(3 * 8.0524e-3, rel=1e-4)


def test_half_width_adds_noise_bias_and_hard_bound():
    rule = rule_for(Sensors(confidence=0.999), 100)
    sensor = InertialSensor(random_walk=0.01, bias_instability=(0.1, 0.2), accuracy=0.5)
    k = rule.sigmas
    assert half_width(sensor, 0, 0.25, rule, 10.0) == pytest.approx(k * 0.02 + k * 0.1 + 0.5, rel=1e-8)
    assert half_width(sensor, 1, 0.25, rule, 10.0) == pytest.approx(k * 0.02 + k * 0.2 + 0.5, rel=1e-8)


@given(
    st.floats(-10, 10),
    st.floats(0, 0.1),
    st.floats(0, 0.5),
    st.floats(-1, 1),
    st.floats(-1, 1),
    st.sampled_from([-1, 0, 1]),
)
def test_a_doppler_interval_holds_the_truth(truth, accuracy, scale, share, noise, sign):
    s = scale * (abs(share) * sign if sign else share)
    # The reading is rounded once; a bound of a few ulp on top of the accuracy covers that.
    reading = float((1 + Fraction(s)) * Fraction(truth) + Fraction(accuracy) * Fraction(noise))
    sensor = VelocitySensor(
        accuracy=accuracy + 4 * np.spacing(abs(reading)), scale_factor_error=scale, scale_factor_sign=sign
    )
    assert doppler(np.array([reading]), sensor).contains([truth]).all()


def test_channels_hold_the_truth_and_missing_samples_are_anything(swan, twin):
    log = as_log(twin)
    log.columns["u"][5] = np.nan
    try:
        bounded = bound_log(log, swan)
        for name in ("u", "v", "r", "ax", "ay"):
            assert bounded.channels[name].contains(twin.exact[name]).all(), name
        assert not bounded.present["u"][5] and np.isinf(bounded.channels["u"].upper[5])
    finally:
        log.columns["u"][5] = twin.exact["u"][5]


def test_gaussian_noise_stays_inside_with_the_stated_confidence(swan, programme):
    from ivsid.simulation import simulate

    misses = 0
    for seed in range(20):
        made = simulate(swan, programme, 1000 + seed)
        bounded = bound_log(as_log(made), swan)
        misses += any((~bounded.channels[n].contains(made.exact[n])).any() for n in ("u", "v", "r", "ax", "ay"))
    assert misses == 0


def test_three_sigma_is_no_bound_for_a_log(swan, programme):
    from ivsid.simulation import simulate

    vehicle = parse_vehicle(swan.text.replace("confidence = 0.999", "sigmas = 3"), "three.toml")
    made = simulate(vehicle, programme, 5)
    bounded = bound_log(as_log(made), vehicle)
    outside = sum(int((~bounded.channels[n].contains(made.exact[n])).sum()) for n in ("ax", "ay", "r"))
    assert outside > 0


@pytest.mark.parametrize(("sign", "error"), [(1, 0.004), (-1, 0.004), (0, 0.004)])
def test_a_scale_of_known_sign_is_one_sided_and_half_as_wide(sign, error):
    reading = np.array([2.0])
    wide = doppler(reading, VelocitySensor(accuracy=0.0, scale_factor_error=error))
    found = doppler(reading, VelocitySensor(accuracy=0.0, scale_factor_error=error, scale_factor_sign=sign))
    assert found.subset(wide).all()
    if sign > 0:
        # It reads too much: the truth is 2 / (1 + s), 0 <= s <= e.
        assert found.upper[0] >= 2.0 > found.upper[0] - 1e-12 and found.lower[0] == pytest.approx(2 / 1.004)
    elif sign < 0:
        assert found.lower[0] <= 2.0 < found.lower[0] + 1e-12 and found.upper[0] == pytest.approx(2 / 0.996)
    if sign:
        assert found.width[0] < 0.52 * wide.width[0]


def test_what_averages_on_another_clock_is_refused_or_left_out(swan):
    """A reading that averages the sensor's own step says nothing of the step between rows of another clock."""
    t = np.arange(40.0)
    still = {c: np.zeros(40) for c in ("u", "v", "r")}
    gyro = parse_vehicle(swan.text.replace("[sensors.yaw_rate]", '[sensors.yaw_rate]\nsampling = "averaged"'), "g.toml")
    with pytest.raises(IvsidError, match="r stands on another clock than the rows"):
        bound_log(Log("a.csv", "", t, still, clocks={"r": Clock(8, 5.0)}), gyro)
    text = swan.text.replace("[sensors.acceleration]", '[sensors.acceleration]\nsampling = "averaged"')
    with pytest.raises(IvsidError, match="is about ax and ay, and the log has udot"):
        bound_log(Log("a.csv", "", t, {**still, "udot": np.zeros(40)}), parse_vehicle(text, "a.toml"))


def test_each_length_of_window_is_one_more_mean_of_the_ambient_force(swan):
    vehicle = parse_vehicle(swan.text + "\n[ambient]\nforce = 0.1\nmoment = 0.1\ntime = 2.0\n", "w.toml")
    log = Log("a.csv", "", np.arange(40.0), {c: np.zeros(40) for c in ("u", "v", "r")})
    one, three = (bound_log(log, vehicle, windows).rule for windows in (1, 3))
    assert three.errors - one.errors == 2 * 40 * 3 and three.sigmas > one.sigmas
