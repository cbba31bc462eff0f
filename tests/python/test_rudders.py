"""Rudders: the foil, its force over boxes, and in rows."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from conftest import as_log
from ivsid import IntervalArray, IvsidError, identify
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.declared_errors import nuisances
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import Hypothesis, acceleration
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import terms_of
from ivsid.log import Log
from ivsid.programme.scenario import Start
from ivsid.propulsion.actuation import nominal_force
from ivsid.propulsion.foil import drag_coefficient, lift_coefficient, lift_slope, rudder_force
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import follow, simulate
from ivsid.vehicle import Thruster, parse_vehicle
from test_actuators import PRBS, VALUES, scenario_of, vehicle_of
from test_rows import violated

RUDDER = '\n[[thrusters]]\nname = "screw"\nposition = [-0.5, 0.0]\ngain = 0.4\nrudder = { area = 0.02, aspect_ratio = 1.5, position = -0.55, propeller_diameter = 0.12, rate = 0.5 }\n'


@pytest.mark.parametrize("window", [0.1, 0.5])
def test_a_rudder_turns_the_vehicle_and_is_identified(window):
    """From the simulator's log as a file: rows hold at the truth, intervals hold it, and a rudder left out is falsified."""
    vehicle = vehicle_of(RUDDER)
    made = simulate(vehicle, scenario_of(), 3)
    assert "rudder_screw" in made.columns and np.abs(made.columns["rudder_screw"]).max() == pytest.approx(0.3)
    rows = build_rows(bound_log(as_log(made), vehicle), vehicle, terms_of(vehicle), kind="both", window=window)
    assert violated(rows, VALUES) == 0 and set(rows.channel) == {0, 1, 2}
    fit = identify(vehicle, as_log(made), window=window)
    assert fit.guaranteed and fit.status in ("enclosed", "unbounded")
    for id_, p in fit.parameters.items():
        assert p.lower <= VALUES[id_] <= p.upper, id_
    assert any("lift and drag of the stated foil" in a for a in fit.assumes)
    without = vehicle.model_copy(
        update={"thrusters": tuple(t.model_copy(update={"rudder": None}) for t in vehicle.thrusters)}
    )
    assert identify(without, as_log(made), window=window).status == "empty"
    force = nominal_force(vehicle, as_log(made))
    thrust = ThrustCurve(vehicle.thrusters[0]).value(made.columns["demand_screw"])
    blade = rudder_force(
        vehicle.thrusters[0].rudder, made.columns["rudder_screw"], thrust, *(made.columns[n] for n in "uvr")
    )
    np.testing.assert_allclose(force[:, 1], blade[1])
    columns = {k: v for k, v in made.columns.items() if k != "rudder_screw"}
    with pytest.raises(IvsidError, match="no column rudder_screw .the rudder angle of thruster screw"):
        identify(vehicle, Log("x.csv", "", made.t, columns))
    bare = parse_vehicle(vehicle.text.split("[sensors.limits]")[0], "bare.toml")
    with pytest.raises(IvsidError, match=r"has a rudder.*needs \[sensors.limits\]"):
        identify(bare, as_log(made))


@pytest.mark.parametrize("off", [0.0, -0.5])
def test_a_thrust_error_moves_the_force_of_a_blade_that_errs(off):
    """The signature against the physics with and without the error, at the same states."""
    text = RUDDER.replace("rate = 0.5", "rate = 0.5, accuracy = 0.2").replace(
        "gain = 0.4", "gain = 0.4\naccuracy = { absolute = 0.5 }"
    )
    vehicle = vehicle_of(text)
    # A diagnosis asks for more than a minute.
    longer = scenario_of(PRBS.replace("duration = 60.0", "duration = 90.0"))
    log = channels(as_log(simulate(vehicle, longer, 3)), vehicle)
    predictor = Predictor(vehicle, log, Ambient((0.01, 0.01, 0.01), (2.0, 2.0, 2.0)))
    h = Hypothesis(tuple(terms_of(vehicle)), VALUES, declared_errors={"~rudder.screw": off})
    states = predictor.settle(predictor.start(h), 2)
    columns = nuisances(Signatures(predictor, states))
    for name in ("~thrust.screw.0", "~thrust.screw.3"):
        there = replace(h, declared_errors={**h.declared_errors, name: 0.01})
        one, other = (acceleration(vehicle, x, states.points.under(*predictor.driving.force(x))) for x in (h, there))
        expected = predictor.answer((other - one) / 0.01)
        found = columns.arrays[columns.names.index(name)]
        # The blade answers to the square root of the stream, whose slopes are differences.
        assert np.linalg.norm(found - expected) < 0.01 * np.linalg.norm(expected)


@pytest.mark.parametrize("seed", range(8))
def test_a_rudder_s_force_is_enclosed_over_boxes(seed):
    """Random points of random boxes, small and large, across stall, reversal and standstill."""
    from ivsid.propulsion.rudder import drag_over, lift_over, rudder_over

    rng = np.random.default_rng(seed)
    blade = {"area": 0.02, "aspect_ratio": 1.5, "position": -0.5, "propeller_diameter": 0.12}
    rudder = Thruster.model_validate({"name": "r", "gain": 1.0, "rudder": blade}).rudder
    n = 400
    centre = rng.uniform(-1, 1, (5, n)) * np.array([[3.5], [15.0], [1.2], [0.6], [0.8]])
    radius = 10 ** rng.uniform(-6, 0, (5, n)) * np.array([[0.5], [4.0], [0.4], [0.3], [0.3]])
    box = [IntervalArray(c - q, c + q) for c, q in zip(centre, radius, strict=True)]
    found = rudder_over(rudder, box[0], box[1], (box[2], box[3], box[4]))
    slope = lift_slope(1.5)
    lift, drag = lift_over(box[0], slope, 0.6), drag_over(box[0], slope, rudder)
    for share in rng.uniform(-1, 1, (40, 5, n)):
        point = centre + share * radius
        for x, force in zip(found, rudder_force(rudder, *point), strict=True):
            assert x.contains(force).all()
        assert lift.contains(lift_coefficient(point[0], slope, 0.6)).all()
        assert drag.contains(drag_coefficient(point[0], slope, 0.6, 0.02, 1.5)).all()
    # Small boxes stay small: the ends are those of the curve, not of a crude bound.
    thin = IntervalArray(centre[0] - 1e-9, centre[0] + 1e-9)
    assert lift_over(thin, slope, 0.6).width.max() < 2e-8


def test_a_blade_turns_to_starboard():
    vehicle = vehicle_of(RUDDER)
    t = np.arange(200) * 0.05
    angles = {"screw": np.full(200, 0.3)}
    turning = follow(vehicle, VALUES, t, {"screw": np.full(200, 50.0)}, Start(u=0.8), angles)
    assert turning["rdot"][0] > 0 > turning["vdot"][0], "trailing edge to starboard: bow to starboard, stern to port"


@pytest.mark.parametrize("diameter", ["", ", propeller_diameter = 0.12"])
def test_a_force_of_floats_is_that_of_arrays(diameter):
    """Over flows from ahead, astern and across, past the stall, at rest, and numbers of a motion that grew without bound.

    NumPy's own sine of an array differs from that of a number in the last bit.
    """
    rudder = vehicle_of(RUDDER.replace(", propeller_diameter = 0.12", diameter)).thrusters[0].rudder
    rng = np.random.default_rng(4)
    points = rng.uniform(-1.0, 1.0, (4000, 5)) * [3.0, 60.0, 2.0, 1.0, 1.0]
    odd = np.array([*itertools.product((0.0, -0.0, 0.3), (0.0, -5.0), (0.0, -0.0, 1.0), (0.0, -0.5), (0.0, -0.0))])
    wild = np.array([[0.1, 1.0, x, 0.1, 0.1] for x in (np.nan, np.inf, -np.inf, 1e200)])
    points = np.concatenate([points, odd, wild])
    with np.errstate(all="ignore"):
        together = np.stack(rudder_force(rudder, *points.T), axis=1)
        apart = np.array([rudder_force(rudder, *point) for point in points.tolist()])
    np.testing.assert_allclose(apart, together, rtol=1e-13, atol=1e-13)


def test_a_foil_lifts_stalls_and_drags():
    slope = lift_slope(1.5)
    assert lift_slope(1e6) == pytest.approx(2 * np.pi, rel=1e-5)
    a = np.linspace(-np.pi, np.pi, 2001)
    lift, drag = lift_coefficient(a, slope, 0.6), drag_coefficient(a, slope, 0.6, 0.02, 1.5)
    assert np.abs(np.diff(lift)).max() < 0.02 and np.abs(np.diff(drag)).max() < 0.02, "no jump at the stall"
    assert np.abs(a[np.argmax(lift[(a > 0) & (a < 1.5)]) + np.argmax(a > 0)]) == pytest.approx(0.6, abs=0.05)
    assert lift_coefficient(np.pi / 2, slope, 0.6) == pytest.approx(0, abs=1e-12) and drag.min() == pytest.approx(0.02)
    np.testing.assert_allclose(lift, -lift[::-1], atol=1e-12)
    rudder = Thruster.model_validate(
        {
            "name": "r",
            "gain": 1.0,
            "rudder": {"area": 0.02, "aspect_ratio": 1.5, "position": -0.5, "propeller_diameter": 0.12},
        }
    ).rudder
    # A blade amidships only brakes; in drift it steadies; the slipstream of the propeller adds 2 T / (rho A) to the square.
    x, y, n = rudder_force(rudder, 0.0, 0.0, 1.0, 0.0, 0.0)
    assert x < 0 and y == n == 0
    _, y, n = rudder_force(rudder, 0.0, 0.0, 1.0, 0.2, 0.0)
    assert y < 0 < n
    disc = np.pi * 0.12**2 / 4
    ahead = rudder_force(rudder, 0.2, 10.0, 0.0, 0.0, 0.0)[1]
    assert ahead == pytest.approx(rudder_force(rudder, 0.2, 0.0, np.sqrt(20 / (1025 * disc)), 0.0, 0.0)[1])
    assert rudder_force(rudder, 0.2, -10.0, 0.0, 0.0, 0.0)[1] == 0
    # Energy: without thrust no angle and no motion lets the blade give energy to the hull.
    rng = np.random.default_rng(0)
    u, v, r, d = rng.uniform(-1, 1, (4, 1000))
    x, y, n = rudder_force(rudder, d, np.zeros(1000), u, v, r)
    assert (x * u + y * v + n * r <= 1e-12).all()
