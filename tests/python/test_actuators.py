"""Thrusters that turn, lag, stall or come in pairs: in the vehicle file, in motion, and in rows that hold at the truth."""

from dataclasses import replace

import numpy as np
import pytest

from conftest import as_log, embedded
from ivsid import IntervalArray, IvsidError, identify, validate
from ivsid.effects import terms_of
from ivsid.log import Log, Sweep
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion.actuation import nominal_force, pushed
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import follow, simulate
from ivsid.simulation.equations import Plant
from ivsid.simulation.propulsion import Propulsion
from ivsid.simulation.true_thrust import TrueThrust
from ivsid.vehicle import Thruster, parse_vehicle
from test_rows import violated

SENSORS = """
[sensors]
[sensors.velocity]
accuracy = 0.002
[sensors.acceleration]
random_walk = 0.002
[sensors.yaw_rate]
random_walk = 0.001
[sensors.limits]
acceleration = 2.5
yaw_acceleration = 2.5
"""
HULL = 'name = "boat"\n[hull]\nmass = 50\nlength = 1.2\n'
PAIR = """
[[thrusters]]
name = "port"
position = [-0.4, -0.28]
quadratic = {{ forward = 0.006, reverse = 0.004 }}
demand_range = [-80, 80]
accuracy = {{ absolute = 0.2, relative = 0.02 }}
{0}
[[thrusters]]
name = "starboard"
position = [-0.4, 0.28]
quadratic = {{ forward = 0.006, reverse = 0.004 }}
demand_range = [-80, 80]
accuracy = {{ absolute = 0.2, relative = 0.02 }}
{0}
"""
TRUTH = """
[truth]
"mass.surge" = 58.0
"mass.sway" = 75.0
"inertia.yaw" = 9.0
"drag.surge.quadratic" = 28.0
"drag.sway.quadratic" = 150.0
"""
PRBS = """
duration = 60.0
rate = 10.0
noise = "uniform"
[[segments]]
manoeuvre = "prbs"
demand = 30
amplitude = 25
differential = 8
period = 2.0
yaw_gain = 25.0
azimuth = 0.5
rudder = 0.3
"""
VALUES = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}
POD = '\n[[thrusters]]\nname = "pod"\nposition = [-0.5, 0.0]\ngain = 0.4\ndemand_range = [0, 80]\nsteering = "azimuth"\nsteering_rate = 0.6\n'


def vehicle_of(thrusters, sensors=SENSORS):
    return parse_vehicle(HULL + thrusters + sensors, "boat.toml")


def scenario_of(text=PRBS):
    return parse_scenario(text.replace("[[segments]]", TRUTH + "[[segments]]", 1), "scenario.toml")


@pytest.mark.parametrize(
    "claims",
    [
        "",
        "time_constant = 0.35",
        "time_constant = 0.04",
        'time_constant = 0.35\nlag = "demand"',
        "dead_band = 20.0\nlimit = 12.0\nreverse_factor = 0.7",
        "advance_loss = 0.3",
        "advance_loss = 0.3\ntime_constant = 0.35",
        'advance_loss = 0.3\ntime_constant = 0.35\nlag = "demand"',
        'dead_band = 20.0\nlimit = 12.0\ntime_constant = 0.5\nlag = "demand"',
    ],
)
@pytest.mark.parametrize("kind", ["auto", "both"])
def test_rows_hold_at_the_truth_with_what_the_file_claims(claims, kind):
    vehicle = vehicle_of(PAIR.format(claims))
    made = simulate(vehicle, scenario_of(), 11)
    rows = build_rows(bound_log(as_log(made), vehicle), vehicle, terms_of(vehicle), kind=kind, window=0.5)
    assert rows.time.size > 1000 and violated(rows, VALUES) == 0
    assert any("time constant" in a for a in rows.assumes) == ("time_constant" in claims)
    fit = identify(vehicle, as_log(made))
    # Weak thrusts leave the sway drag open; nothing excludes the truth.
    assert fit.status in ("enclosed", "unbounded") and all(
        fit.parameters[i].lower <= VALUES[i] <= fit.parameters[i].upper for i in VALUES
    )


def test_a_lag_left_out_is_falsified_and_a_lag_claimed_is_not():
    vehicle = vehicle_of(PAIR.format("time_constant = 0.6").replace("0.2, relative = 0.02", "0.02, relative = 0.002"))
    made = simulate(vehicle, scenario_of(), 4)
    memoryless = vehicle_of(PAIR.format("").replace("0.2, relative = 0.02", "0.02, relative = 0.002"))
    assert identify(memoryless, as_log(made)).status == "empty"
    fit = identify(vehicle, as_log(made))
    assert fit.status == "enclosed" and any("time constant of 0.6 s" in a for a in fit.assumes)
    quiet = scenario_of().model_copy(update={"noise": "none"})
    other = as_log(simulate(vehicle, quiet, 5))
    followed = validate(replace(fit, estimate=VALUES), other).motion
    static = validate(replace(fit, estimate=VALUES, vehicle=memoryless), other).motion
    assert followed.reason is None and followed.rms["u"] < 0.3 * static.rms["u"]


def test_a_lag_starts_again_after_a_gap_and_a_missing_demand():
    vehicle = vehicle_of(PAIR.format("time_constant = 0.35"))
    made = simulate(vehicle, scenario_of(), 11)
    columns = {k: v.copy() for k, v in made.columns.items()}
    columns["demand_port"][200:203] = np.nan
    t = made.t.copy()
    t[400:] += 5.0
    push = pushed(vehicle.thrusters[0], Log("gap.csv", "", t, columns), held=True)
    X = push.at_rows[0]
    full = ThrustCurve(vehicle.thrusters[0]).interval(np.array([-80.0]), np.array([80.0]))
    for k in (0, 203, 400):
        assert X[k].lower <= full.lower[0] and X[k].upper >= full.upper[0]
    assert X[150].width < 0.1 * full.width[0] and not push.present[201]


@pytest.mark.parametrize("lag", ["thrust", "demand"])
@pytest.mark.parametrize(
    ("demand", "curve"),
    [
        (50.0, {"gain": 1.0, "demand_range": (20, 100)}),
        (50.0, {"table": {"demand": [20, 100], "thrust": [0.0, 80.0]}}),
        (-50.0, {"table": {"demand": [-100, -20], "thrust": [-100.0, -20.0]}}),
        (150.0, {"gain": 1.0, "demand_range": (20, 100), "outside": "hold"}),
        (1650.0, {"gain": 0.1, "demand_range": (20, 400), "neutral": 1500.0}),
    ],
)
def test_a_lagging_thruster_may_be_at_rest_before_the_log(lag, demand, curve):
    thruster = Thruster.model_validate({"name": "a", "time_constant": 0.5, "lag": lag, **curve})
    t = np.arange(0, 3, 0.1)
    X = pushed(thruster, Log("x", "", t, {"demand_a": np.full(t.size, demand)}), held=True)
    low, high = ThrustCurve(thruster).range
    goal = min(max(demand, low), high)
    if lag == "thrust":
        truth = float(ThrustCurve(thruster).value(goal)) * (1 - np.exp(-t / 0.5))
        known = np.ones(t.size, dtype=bool)
    else:
        shaft = thruster.neutral + (goal - thruster.neutral) * (1 - np.exp(-t / 0.5))
        known = (shaft >= low) & (shaft <= high)
        truth = np.where(known, ThrustCurve(thruster).value(np.clip(shaft, low, high)), 0.0)
    assert X.at_rows[0].contains(truth).all() and known.any()
    assert X.at_rows[0].width[-1] < 1 and any("before the log it was at rest" in a for a in X.assumes)


def test_a_shaft_is_not_followed_to_a_demand_outside_its_curve():
    thruster = Thruster(name="a", gain=1.0, demand_range=(-100, 100), time_constant=0.5, lag="demand")
    log = Log("x", "", np.arange(0, 3, 0.1), {"demand_a": np.full(30, 150.0)})
    with pytest.raises(IvsidError, match="demand 150 of thruster a lies outside its demand_range"):
        pushed(thruster, log, held=True)


def azimuth_log(t, angle, over=None, demand=10.0):
    sweeps = {} if over is None else {"azimuth_a": Sweep(*over, "azimuth_a never changes faster than 0.5 a second")}
    return Log("x", "", t, {"demand_a": np.full(t.size, demand), "azimuth_a": angle}, over=sweeps)


def test_an_azimuth_pushes_wherever_it_points_between_the_rows():
    """An angle that turns on: the exact mean of its force over each step, which no held angle gives."""
    t, rate = np.arange(0, 5, 0.2), 0.5
    thruster = Thruster(name="a", gain=1.0, steering="azimuth")
    over = (rate * t[:-1], rate * t[1:])
    X, Y, _ = pushed(thruster, azimuth_log(t, rate * t, over), held=True).over_steps
    turned = rate * t
    assert X.contains(10 * np.diff(np.sin(turned)) / (rate * 0.2)).all()
    assert Y.contains(-10 * np.diff(np.cos(turned)) / (rate * 0.2)).all() and X.width.max() < 1.1
    push = pushed(thruster, azimuth_log(t, rate * t, (np.r_[np.nan, over[0][1:]], over[1])), held=True)
    assert push.whole is not None and not push.whole[0] and push.whole[1:].all() and push.present.all()
    assert push.assumes == ("azimuth_a never changes faster than 0.5 a second",)
    held = pushed(thruster, azimuth_log(t, rate * t), held=True)
    assert held.assumes == ("azimuth_a holds from each row to the next",)


def test_an_azimuth_turns_the_shorter_way_through_half_a_turn():
    t = np.arange(0, 2, 0.5)
    angle = 2.8 + 1.3664 * t
    thruster = Thruster(name="a", gain=1.0, steering="azimuth")
    wrapped = np.arctan2(np.sin(angle), np.cos(angle))
    X, Y, _ = pushed(thruster, azimuth_log(t, wrapped), held=False).over_steps
    for k in range(3):
        fine = np.linspace(angle[k], angle[k + 1], 1001)
        assert X[k].contains(10 * np.cos(fine).mean()) and Y[k].contains(10 * np.sin(fine).mean())
    assert X.width.max() < 7
    # Half a turn from row to row may go either way round.
    X, Y, _ = pushed(thruster, azimuth_log(t, np.array([0.0, np.pi, 0.0, 0.1])), held=False).over_steps
    assert (Y.lower[:2] <= -10).all() and (Y.upper[:2] >= 10).all() and Y[2].width < 1.1


@pytest.mark.parametrize(
    "claims", [{}, {"reverse_factor": 1.4}, {"reverse_factor": 0.7, "limit": 20.0, "dead_band": 10.0}]
)
def test_the_true_thrust_stays_inside_what_the_file_claims_of_its_error(claims):
    text = {"name": "a", "gain": 0.5, "demand_range": (-100, 100), "accuracy": {"absolute": 2.0, "relative": 0.05}}
    thruster = Thruster.model_validate({**text, **claims})
    vehicle = parse_vehicle(HULL, "boat.toml").model_copy(update={"thrusters": (thruster,)})
    demand = np.linspace(-100, 100, 101)
    bounds = ThrustCurve(thruster).interval(demand)
    most = 0.0
    for seed in range(40):
        moving = Propulsion(Plant(vehicle, (), {}, ()), [TrueThrust(thruster, np.random.default_rng(seed))])
        thrust = np.array([moving._thrust(0, float(d), 0.0) for d in demand])
        assert bounds.contains(thrust).all()
        most = max(most, float(np.abs(thrust - ThrustCurve(thruster).value(demand)).max()))
    assert most > 2.0


def test_an_advance_loss_left_out_is_falsified_and_needs_its_limits():
    tight = PAIR.replace("0.2, relative = 0.02", "0.02, relative = 0.002")
    vehicle, without = vehicle_of(tight.format("advance_loss = 0.2")), vehicle_of(tight.format(""))
    made = simulate(vehicle, scenario_of(), 4)
    assert identify(vehicle, as_log(made)).status != "empty" and identify(without, as_log(made)).status == "empty"
    u, r = (made.columns[n] for n in "ur")
    port = ThrustCurve(without.thrusters[0]).value(made.columns["demand_port"])
    starboard = ThrustCurve(without.thrusters[1]).value(made.columns["demand_starboard"])
    surge = port - 0.2 * abs(port) * (u + 0.28 * r) + starboard - 0.2 * abs(starboard) * (u - 0.28 * r)
    np.testing.assert_allclose(nominal_force(vehicle, as_log(made))[:, 0], surge)
    bare = parse_vehicle(vehicle.text.split("[sensors.limits]")[0], "bare.toml")
    with pytest.raises(IvsidError, match=r"advance_loss.*needs \[sensors.limits\]"):
        identify(bare, as_log(made))


@pytest.mark.parametrize("demand", ["hold", "linear"])
def test_an_azimuth_thruster_pushes_where_its_column_points(demand):
    vehicle = vehicle_of(POD)
    made = simulate(vehicle, scenario_of(), 3)
    assert {"demand_pod", "azimuth_pod"} <= set(made.columns)
    angle = made.columns["azimuth_pod"]
    assert np.abs(angle).max() == pytest.approx(0.5) and np.abs(np.diff(angle)).max() <= 0.06 + 1e-12
    force = nominal_force(vehicle, as_log(made))
    thrust = 0.4 * made.columns["demand_pod"]
    np.testing.assert_allclose(
        force, np.stack([thrust * np.cos(angle), thrust * np.sin(angle), -0.5 * thrust * np.sin(angle)], 1)
    )
    if demand == "hold":
        rows = build_rows(bound_log(as_log(made), vehicle), vehicle, terms_of(vehicle), kind="both", window=0.5)
        assert violated(rows, VALUES) == 0
        fit = identify(vehicle, as_log(made))
        assert (
            fit.status == "enclosed" and fit.parameters["inertia.yaw"].lower <= 9 <= fit.parameters["inertia.yaw"].upper
        )
    else:
        push = pushed(vehicle.thrusters[0], as_log(made), held=False)
        for share in (0.0, 0.3, 1.0):
            between = angle[:-1] + share * np.diff(angle)
            at = thrust[:-1] + share * np.diff(thrust)
            assert push.over_steps[0].contains(at * np.cos(between)).all()
    del made.columns["azimuth_pod"]
    with pytest.raises(IvsidError, match="no column azimuth_pod.*direction of thruster pod"):
        identify(vehicle, as_log(made))


def test_a_voith_schneider_unit_is_two_thrusters():
    unit = '\n[[thrusters]]\nname = "vsp"\nkind = "voith-schneider"\nposition = [-0.4, 0.1]\ngain = 1.5\n'
    surge, sway = parse_vehicle(HULL + unit, "v.toml").thrusters
    assert (surge.name, sway.name) == ("vsp_surge", "vsp_sway") and sway.azimuth == pytest.approx(np.pi / 2)
    assert surge.gain == sway.gain == 1.5 and surge.position == sway.position
    own = parse_vehicle(HULL + unit + "sway = { quadratic = { forward = 0.2 } }\n", "v.toml").thrusters[1]
    assert own.gain is None and own.quadratic.forward == 0.2
    vehicle = parse_vehicle(HULL + unit + SENSORS, "v.toml")
    t = np.arange(3) * 0.1
    made = follow(vehicle, VALUES, t, {"vsp_surge": np.full(3, 2.0), "vsp_sway": np.full(3, -1.0)})
    assert made["udot"][0] == pytest.approx(3.0 / 58) and made["vdot"][0] == pytest.approx(-1.5 / 75)
    assert made["rdot"][0] == pytest.approx((0.4 * 1.5 - 0.1 * 3.0) / 9)
    for wrong, sentence in (
        (unit.replace("voith-schneider", "jet"), "kind 'jet' is not known"),
        (unit + "sway = 3\n", "is no curve"),
        (unit + "\nquadratic = { forward = -1 }", "quadratic.forward = -1"),
        (unit.replace("gain = 1.5", "gain = 1.5\ndemand_range = [2, 1]"), "lowest, highest"),
    ):
        with pytest.raises(IvsidError, match=sentence):
            parse_vehicle(HULL + wrong, "v.toml")


def test_the_quadratic_curve_and_its_claims_are_enclosed():
    rng = np.random.default_rng(2)
    for change in (
        {"quadratic": {"forward": 0.1, "reverse": 0.06}},
        {"quadratic": {"forward": 0.1}, "dead_band": 2.0, "limit": 5.0, "reverse_factor": 0.8, "neutral": 1.0},
        {"polynomial": (0.02, 0.0, 1.0, 0.0), "dead_band": 1.0, "reverse_factor": 1.2},
        {"table": {"demand": [-9, 0, 9], "thrust": [-6, 0, 8]}, "dead_band": 3.0, "limit": 4.0},
    ):
        curve = ThrustCurve(Thruster.model_validate({"name": "p", **change}))
        a, b = np.sort(rng.uniform(-8, 8, (2, 200)), axis=0)
        over, at = curve.interval(a, b), curve.interval(a)
        for share in np.linspace(0, 1, 21):
            assert over.contains(curve.value(a + share * (b - a))).all()
        assert at.contains(curve.value(a)).all() and (at.width < 1e-9).all()
    band = ThrustCurve(Thruster(name="p", gain=1.0, dead_band=2.0))
    assert band.value([-2.0, -1.9, 0.0, 1.9, 2.0]).tolist() == [-2.0, 0.0, 0.0, 0.0, 2.0]
    edge = band.interval(np.array([2.0]))
    assert edge.contains(0.0).all() and edge.contains(2.0).all(), "a rounded demand at the edge may be on either side"
    assert isinstance(edge, IntervalArray)
    bounded = ThrustCurve(Thruster(name="p", gain=1.0, demand_range=(-5.0, 5.0)))
    with pytest.raises(IvsidError, match=r"demand 6 of thruster p lies outside its demand_range \(-5 to 5\)"):
        bounded.value(6.0)


@pytest.mark.parametrize("name", ["otter", "vectored_rov"])
def test_shipped_vehicles_hold_their_own_truth(name):
    vehicle = parse_vehicle(embedded(f"{name}.toml"), name)
    assert "Sources:" in vehicle.text and "Choices:" in vehicle.text, "every number has its source"
    scenario = parse_scenario(embedded(f"{name}_programme.toml"), name)
    made = simulate(vehicle, scenario.model_copy(update={"duration": 120.0, "noise": "uniform"}), 2)
    limits = vehicle.sensors.limits
    assert (
        np.abs(made.exact["udot"]).max() < limits.acceleration
        and np.abs(made.exact["vdot"]).max() < limits.acceleration
    )
    assert np.abs(made.exact["rdot"]).max() < limits.yaw_acceleration
    rows = build_rows(bound_log(as_log(made), vehicle), vehicle, terms_of(vehicle))
    assert set(rows.channel) == {0, 1, 2} and violated(rows, scenario.truth) == 0


def test_a_lagging_thrust_that_turns_within_a_step_is_bounded_by_all_its_values():
    """The mean of T cos a is not the mean of T times a cosine where T changes its sign on the way."""
    unit = 'name = "p"\ngain = 1.0\ndemand_range = [-10, 10]\ntime_constant = 0.4\nsteering = "azimuth"\n'
    vehicle = parse_vehicle(f'name = "a"\n[hull]\nmass = 3\n[[thrusters]]\n{unit}', "a.toml")
    demand, t = np.array([10.0, -10.0, 10.0, -10.0, 10.0]), np.arange(5.0)
    turning = Sweep(np.zeros(4), np.full(4, np.pi), "it turns")
    columns = {"demand_p": demand, "azimuth_p": np.zeros(5)}
    log = Log("a.csv", "", t, columns, over={"azimuth_p": turning})
    found = pushed(vehicle.thrusters[0], log, held=True).over_steps[0]
    s = (np.arange(20000) + 0.5) / 20000
    thrust = 0.0
    for k in range(4):
        inside = demand[k] + (thrust - demand[k]) * np.exp(-s / 0.4)
        mean = float(np.mean(inside * np.cos(np.pi * s)))
        assert found.lower[k] <= mean <= found.upper[k]
        thrust = demand[k] + (thrust - demand[k]) * np.exp(-1 / 0.4)
