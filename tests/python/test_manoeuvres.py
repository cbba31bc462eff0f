"""Scenarios: what each manoeuvre makes the vehicle do, and what the sensors make of it."""

import numpy as np
import pytest

from conftest import as_log
from ivsid import IvsidError, read_log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.log_files import csv as as_csv
from test_actuators import HULL, PAIR, POD, SENSORS, TRUTH
from test_rudders import RUDDER

POSE = "[sensors.heading]\naccuracy = 0.0\n[sensors.position]\naccuracy = 0.0\n[sensors.yaw_acceleration]\naccuracy = 0.0\n"
DAMPED = TRUTH + '"drag.yaw.linear" = 6.0\n"drag.sway.linear" = 20.0\n'


TWIN = PAIR.format("")


def run(segment, *, thrusters=TWIN, head="", duration=60.0, rate=10.0, sensors=SENSORS + POSE, seed=1, **effects):
    vehicle = parse_vehicle(HULL + thrusters + sensors, "boat.toml")
    text = f'duration = {duration}\nrate = {rate}\nnoise = "none"\n{head}\n{DAMPED}\n[[segments]]\nduration = {duration}\n{segment}'
    return simulate(
        vehicle, parse_scenario(text, "s.toml"), seed, {k.replace("__", "."): v for k, v in effects.items()}
    )


def test_a_heading_zigzag_overshoots_and_turns_back():
    made = run('manoeuvre = "heading_zigzag"\ndemand = 40\ndifferential = 20\nheading = 0.35')
    psi, side = made.exact["psi"], np.sign(made.columns["demand_port"] - made.columns["demand_starboard"])
    turns = np.flatnonzero(np.diff(side))
    assert turns.size >= 3
    # Each time the demand changes sides, the heading has just come 0.35 rad past the first one, on alternate sides.
    for j, k in enumerate(turns + 1):
        sign = 1 if j % 2 == 0 else -1
        assert sign * psi[k] >= 0.35 > sign * psi[k - 1]
    assert np.abs(psi).max() > 0.36, "overshoot"


def test_pull_out_spiral_sweep_and_free_decay():
    made = run('manoeuvre = "pull_out"\ndemand = 40\ndifferential = 20\nperiod = 20')
    r = made.exact["r"]
    assert r[199] > 0.05 and abs(r[-1]) < 0.1 * r[199]
    made = run('manoeuvre = "spiral"\ndemand = 40\ndifferential = [20, 10, 0, -10, -20]\nperiod = 12')
    rates = made.exact["r"][118::120]
    assert (np.diff(rates) < 0).all() and rates[0] > 0 > rates[-1]
    made = run('manoeuvre = "sweep"\ndemand = 40\namplitude = 20\nperiod = 20\nperiod_end = 2')
    demand = made.columns["demand_port"]
    assert demand.min() == pytest.approx(20, abs=0.5) and demand.max() == pytest.approx(60, abs=0.5)
    crossings = np.flatnonzero(np.diff(np.sign(demand - 40)))
    assert np.diff(crossings)[0] > 3 * np.diff(crossings)[-1]
    made = run('manoeuvre = "free_decay"', head="[start]\nu = 1.0\nv = 0.2\nr = 0.4\npsi = 1.0\nx = 5.0\n")
    assert (made.columns["demand_port"] == 0).all() and made.exact["x"][0] == 5 and made.exact["psi"][0] == 1
    assert made.exact["u"][0] == 1 and (np.diff(np.abs(made.exact["r"])) <= 0).all()


def test_station_keeping_comes_and_stays():
    corners = "".join(
        f'\n[[thrusters]]\nname = "t{k}"\nposition = [{x}, {y}]\nazimuth = {a}\nquadratic = {{ forward = 0.004 }}\ndemand_range = [-80, 80]\n'
        for k, (x, y, a) in enumerate(
            ((0.4, -0.3, 0.785), (0.4, 0.3, -0.785), (-0.4, -0.3, -0.785), (-0.4, 0.3, 0.785))
        )
    )
    gains = "position_gain = 15\nposition_damping = 40\nheading_gain = 20\nyaw_gain = 40\ndifferential_limit = 30"
    made = run(
        f'manoeuvre = "station"\nposition = [3, -2]\nheading = 0.5\n{gains}',
        thrusters=corners,
        duration=120.0,
        wind__steady__north=0.3,
        wind__steady__east=0.2,
    )
    e = made.exact
    assert np.hypot(e["x"][-1] - 3, e["y"][-1] + 2) < 0.6 and abs(e["psi"][-1] - 0.5) < 0.1
    assert np.abs(e["u"][-50:]).max() < 0.05
    # Each demand stays in the range of its curve.
    assert all(np.abs(made.columns[f"demand_t{k}"]).max() <= 80 for k in range(4))


@pytest.mark.parametrize("thrusters", [POD, RUDDER])
def test_a_vessel_that_steers_zigzags(thrusters):
    made = run(
        'manoeuvre = "heading_zigzag"\ndemand = 60\nrudder = 0.35\nazimuth = -0.35\nheading = 0.35', thrusters=thrusters
    )
    column = next(c for c in made.columns if c.startswith(("rudder_", "azimuth_")))
    assert np.abs(made.columns[column]).max() == pytest.approx(0.35)
    assert made.exact["psi"].max() > 0.35 and made.exact["psi"].min() < -0.2


PRBS = 'manoeuvre = "prbs"\ndemand = 35\namplitude = 25\ndifferential = 10\nperiod = 2\nyaw_gain = 10'


def test_readings_are_what_the_effects_say():
    plain = run(PRBS)
    e, c = plain.exact, plain.columns
    for name in ("u", "v", "r", "ax", "ay", "psi", "x", "y", "rdot"):
        np.testing.assert_allclose(c[name], e[name], atol=1e-12)
    arm = run(PRBS, sensor__velocity__lever_arm__x=0.3, sensor__velocity__lever_arm__y=-0.1).columns
    np.testing.assert_allclose(arm["u"], e["u"] + 0.1 * e["r"], atol=1e-12)
    np.testing.assert_allclose(arm["v"], e["v"] + 0.3 * e["r"], atol=1e-12)
    turned = run(PRBS, sensor__velocity__misalignment=0.1).columns
    np.testing.assert_allclose(turned["v"], e["v"] * np.cos(0.1) - e["u"] * np.sin(0.1), atol=1e-12)
    imu = run(PRBS, sensor__acceleration__lever_arm__x=0.2, sensor__acceleration__lever_arm__y=0.1).columns
    np.testing.assert_allclose(imu["ax"], e["ax"] - 0.2 * e["r"] ** 2 - 0.1 * e["rdot"], atol=1e-12)
    np.testing.assert_allclose(imu["ay"], e["ay"] + 0.2 * e["rdot"] - 0.1 * e["r"] ** 2, atol=1e-12)
    leak = run(PRBS, sensor__attitude_leak=1e-3).columns
    np.testing.assert_allclose(leak["ax"], e["ax"] + 1e-3 * e["thrust"], atol=1e-12)
    both = run(PRBS, sensor__yaw_rate__scale=0.02, sensor__yaw_rate__bias=0.01, sensor__velocity__scale=-0.03).columns
    np.testing.assert_allclose(both["r"], 1.02 * e["r"] + 0.01, atol=1e-12)
    np.testing.assert_allclose(both["u"], 0.97 * e["u"], atol=1e-12)


def test_a_late_reading_is_the_earlier_motion():
    """At 50 Hz the delay of 0.1 s is five samples: the reading is the truth of then, turned by the lever arm of then."""
    made = run(
        PRBS,
        rate=50.0,
        duration=30.0,
        sensor__velocity__delay=0.1,
        sensor__velocity__lever_arm__x=0.3,
        sensor__velocity__lever_arm__y=0.0,
    )
    e, c = made.exact, made.columns
    np.testing.assert_allclose(c["u"][5:], e["u"][:-5], atol=1e-9)
    np.testing.assert_allclose(c["v"][5:], (e["v"] + 0.3 * e["r"])[:-5], atol=1e-9)
    coarse = run(PRBS, rate=10.0, duration=30.0, sensor__velocity__delay=0.05).columns["u"]
    fine = run(PRBS, rate=20.0, duration=30.0)
    # Halfway between samples; the demands change every 2 s, on samples of both.
    assert (
        np.abs(coarse[1:] - fine.exact["u"][1:-1:2]).max() < 1e-4
        or np.abs(coarse[1:20] - fine.exact["u"][1:39:2]).max() < 1e-4
    )


def test_averaged_accelerations_are_means_over_the_sample_before():
    averaged = SENSORS.replace("random_walk = 0.002", 'random_walk = 0.002\nsampling = "averaged"')
    made = run(PRBS, sensors=averaged, rate=10.0)
    fine = run(PRBS.replace("yaw_gain = 10", ""), rate=200.0)
    open_loop = run(PRBS.replace("yaw_gain = 10", ""), sensors=averaged, rate=10.0)
    for name in ("ax", "ay"):
        dense = fine.exact[name][: 200 * 60].reshape(-1, 20).mean(axis=1)
        found = open_loop.columns[name][1:]
        assert np.sqrt(np.mean((found - dense[: found.size]) ** 2)) < 0.03 * np.std(dense), name
    assert made.columns["ax"].size == 600


def test_noise_is_what_the_vehicle_file_says():
    sensors = SENSORS.replace(
        "random_walk = 0.001", "random_walk = 0.001\nbias_instability = 0.02\nbias_time = 5.0\nrate_random_walk = 0.003"
    )
    vehicle = parse_vehicle(HULL + PAIR.format("") + sensors, "b.toml")
    text = f'duration = 4000\nrate = 10\n{DAMPED}[[segments]]\nmanoeuvre = "coast"'
    made = simulate(vehicle, parse_scenario(text, "s.toml"), 5)
    white = made.columns["ax"] - made.exact["ax"]
    assert white.std() == pytest.approx(0.002 / np.sqrt(0.1), rel=0.03)
    r = made.columns["r"] - made.exact["r"]
    # Increments: white noise twice, the bias by 1 - exp(-h/T), the walk by its rate.
    step = np.diff(r).var()
    expected = 2 * 0.001**2 / 0.1 + 2 * 0.02**2 * (1 - np.exp(-0.1 / 5)) + 0.003**2 * 0.1
    assert step == pytest.approx(expected, rel=0.05)
    far = r[1000:] - r[:-1000]
    assert far.var() > 0.003**2 * 100 * 0.3


FAULTS = "\n[sensing.velocity]\nperiod = 1.0\ndrop_outs = 0.2\ndrop_out_time = 3.0\n[sensing.position]\noutliers = 0.05\noutlier_size = 20.0\n"


def test_slow_sensors_hold_drop_out_and_stray(tmp_path):
    made = run(PRBS, head=FAULTS, duration=600.0)
    u, there = made.columns["u"], ~np.isnan(made.columns["u"])
    assert 0.1 < 1 - there.mean() < 0.3 and (np.isnan(u) == np.isnan(made.columns["v"])).all()
    fresh = np.arange(u.size) // 10 * 10
    np.testing.assert_array_equal(u[there], made.exact["u"][fresh][there])
    strays = np.abs(made.columns["x"] - made.exact["x"]) > 1e-9
    assert 0.03 < strays.mean() < 0.07 and np.std((made.columns["x"] - made.exact["x"])[strays]) == pytest.approx(
        20, rel=0.3
    )
    assert not np.isnan(made.columns["r"]).any()
    # The file reads back: empty cells are missing samples, held values are found.
    (tmp_path / "log.csv").write_text(as_csv(made.t, made.columns))
    log = read_log(tmp_path / "log.csv")
    assert np.isnan(log.columns["u"]).sum() >= np.isnan(u).sum() and log.notes
    assert as_log(made).t.size == 6000


@pytest.mark.parametrize(
    ("edit", "sentence"),
    [
        ('manoeuvre = "fly"', "manoeuvre = 'fly' is not usable"),
        ('manoeuvre = "heading_zigzag"', "give heading .rad. above 0"),
        ('manoeuvre = "station"', "holds nothing without a gain"),
        ('manoeuvre = "circle"\ndifferential = [1, 2]', "a list of differentials belongs to steps and spiral"),
        ('manoeuvre = "coast"\n[environment]\ncurrents = [1, 2]', "did you mean current"),
        ('manoeuvre = "coast"\n[sensing.velocity]\ndrop_outs = 1.5', "sensing.velocity.drop_outs = 1.5"),
        ('manoeuvre = "coast"\n[start]\nw = 1', "key start.w is unknown"),
    ],
)
def test_bad_scenarios_get_one_sentence(edit, sentence):
    with pytest.raises(IvsidError, match=sentence) as refusal:
        run(edit)
    assert str(refusal.value).count("\n") == 0


def test_a_current_stands_in_the_environment_or_in_the_truth():
    one = run(PRBS, head="[environment]\ncurrent = [0.1, -0.2]\n")
    other = run(PRBS, current__steady__north=0.1, current__steady__east=-0.2)
    np.testing.assert_array_equal(one.exact["u"], other.exact["u"])
    assert one.truth["parameters"]["current.steady.east"] == -0.2
    with pytest.raises(IvsidError, match="given twice"):
        run(PRBS, head="[environment]\ncurrent = [0.1, -0.2]\n", current__steady__north=0.1, current__steady__east=-0.2)


def test_depth_voltage_and_wind_become_columns():
    where = "[environment]\ndepth = 4.0\nvoltage = 16.0\nvoltage_fall = 0.02\nwind_speed = 5.0\nwind_direction = 1.0\nwind_gust = 1.0\n"
    made = run(PRBS, head=where, thruster__voltage_sag__power=2.0)
    assert (made.columns["depth"] == 4).all() and made.columns["voltage"][-1] == pytest.approx(16 - 0.02 * 59.9)
    assert made.columns["wind_speed"].std() > 0.2 and (made.columns["wind_direction"] == 1.0).all()
    with pytest.raises(IvsidError, match="follows the voltage"):
        run(PRBS, thruster__voltage_sag__power=2.0)
