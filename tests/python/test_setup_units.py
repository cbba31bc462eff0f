"""Demands in percent for fractions and the reverse, and angles in degrees for radians: named where the log tells, and nowhere else."""

from functools import cache

import numpy as np
import pytest
from tests.exam.cases import case

import setup_faults
from ivsid import IvsidError, setup_findings
from ivsid.log import Log
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import parse_vehicle
from setup_faults import hundredths, named, times

UNIT = "setup.demand.unit"


@cache
def drawn(seed):
    made = case(seed, what="none", style="rich", duration=200.0, rate=10.0)
    columns = dict(made.logs[0])
    return made.text, columns.pop("t"), columns


@pytest.mark.parametrize("seed", [7000, 7004, 7009])
def test_percentages_and_fractions_are_told_from_each_other(seed):
    text, t, columns = drawn(seed)
    for fraction, demands, wrong in ((True, 1.0, True), (True, 0.01, False), (False, 0.01, True), (False, 1.0, False)):
        given, changed = hundredths(text, columns, fraction=fraction, demands=demands)
        assert named(given, t, changed)[:1] == [UNIT] * wrong, (fraction, demands)


def test_percentages_beyond_a_curve_of_fractions_are_refused_with_the_factor():
    text = 'name = "b"\n[hull]\nmass = 1\n[[thrusters]]\nname = "p"\ngain = 40.0\ndemand_range = [-1.0, 1.0]\n'
    vehicle = parse_vehicle(text, "b.toml")
    demands = np.r_[np.zeros(5), 20.0, -60.0, 100.0]
    with pytest.raises(IvsidError, match=r"these are of the size of percentages.*scale = 0.01"):
        ThrustCurve(vehicle.thrusters[0]).value(demands)
    (found,) = setup_findings(vehicle, Log("log.csv", "", np.arange(8.0), {"demand_p": demands}))
    assert found.id == UNIT and found.certain
    # One wild reading, readings of a few units, and a shaft's speed are none.
    for other in (np.r_[0.2, -0.8, 0.9, 0.5, 60.0], np.array([2.0, 4.0, -3.0]), np.array([40.0, 120.0, 90.0])):
        assert setup_findings(vehicle, Log("log.csv", "", np.arange(float(other.size)), {"demand_p": other})) == ()
        with pytest.raises(IvsidError, match='or set outside = "hold"'):
            ThrustCurve(vehicle.thrusters[0]).value(other)


def boat(curve, mass=60.0):
    return (
        f'name = "b"\n[hull]\nmass = {mass}\n[sensors.velocity]\naccuracy = 1e-6\n[[thrusters]]\nname = "p"\n{curve}\n'
    )


def run(force, total=66.0, linear=4.0):
    """A boat of 66 kg with its water on a straight line, pushed by a force [N] of one value a step of 0.1 s."""
    u = np.zeros(force.size)
    for k in range(force.size - 1):
        u[k + 1] = u[k] + 0.1 * (force[k] - linear * u[k]) / total
    t, zero = 0.1 * np.arange(force.size), np.zeros(force.size)
    return t, {"u": u, "v": zero, "r": zero}


@pytest.fixture(scope="module")
def pushes():
    """Shares of the largest thrust, each held for 4 s."""
    return np.repeat(np.random.default_rng(2).uniform(-1, 1, 50), 40)


@pytest.mark.parametrize(
    ("curve", "demand", "wrong"),
    [
        ("gain = 40.0", 1.0, False),
        ("gain = 40.0", 100.0, True),
        ("gain = 0.4", 100.0, False),
        ("gain = 0.4", 1.0, True),
        ("gain = 0.4\ndemand_range = [-100, 100]", 1.0, True),
        ("gain = 0.4\ndemand_range = [-100, 100]", 100.0, False),
    ],
)
def test_a_gain_without_ends_is_told_by_the_mass_of_the_hull(pushes, curve, demand, wrong):
    t, motion = run(40.0 * pushes)
    found = setup_findings(parse_vehicle(boat(curve), "b.toml"), {"t": t, **motion, "demand_p": demand * pushes})
    assert [f.id for f in found] == [UNIT] * wrong
    if wrong:
        assert not found[0].certain and found[0].evidence["mass_without"] == pytest.approx(66.0, rel=0.05)
        line = found[0].remedy.removeprefix("state ").partition(" under [log.columns]")[0]
        mended = parse_vehicle(f"{boat(curve)}[log.columns]\n{line}\n", "b.toml")
        assert setup_findings(mended, {"t": t, **motion, "demand_p": demand * pushes}) == ()


@pytest.mark.parametrize(
    ("curve", "share", "mass"),
    [
        # A quiet log of a curve in percent, whose demands stay below one of them.
        ("gain = 0.4\ndemand_range = [-100, 100]", 0.009, 60.0),
        ("gain = 0.4", 0.009, 60.0),
        # A thrust in kilograms of force, and a hull in tonnes or grams: something is wrong, and it is not the demand.
        ("gain = 0.0408", 1.0, 60.0),
        ("gain = 0.4", 1.0, 0.06),
        ("gain = 0.4", 1.0, 60000.0),
    ],
)
def test_a_quiet_log_and_other_faults_are_no_unit_of_the_demand(pushes, curve, share, mass):
    t, motion = run(40.0 * share * pushes)
    table = {"t": t, **motion, "demand_p": 100.0 * share * pushes}
    assert setup_findings(parse_vehicle(boat(curve, mass), "b.toml"), table) == ()


@pytest.mark.parametrize("seed", [7005, 7006])
def test_angles_in_degrees_are_named_and_their_line_mends_the_log(seed):
    """A rudder by its range, beyond doubt; an azimuth thruster, which may stand anywhere, by the motion."""
    text, t, columns = drawn(seed)
    (name,) = [k for k in columns if k.startswith(("rudder_", "azimuth_"))]
    (found,) = setup_findings(parse_vehicle(text, "v.toml"), {"t": t, **times(**{name: setup_faults.DEGREES})(columns)})
    assert found.id == "setup.angle.unit" and found.certain == name.startswith("rudder_")
    line = f'{name} = {{ from = "{name}", unit = "deg" }}'
    assert found.remedy.startswith(f"state {line} under [log.columns]")
    mended = parse_vehicle(f"{text}\n[log.columns]\n{line}\n", "v.toml")
    assert setup_findings(mended, {"t": t, **times(**{name: setup_faults.DEGREES})(columns)}) == ()


def test_wild_readings_and_small_angles_of_a_rudder_are_no_degrees():
    text, t, columns = drawn(7006)
    rng = np.random.default_rng(1)
    wild = np.where(rng.uniform(size=t.size) < 0.02, 40.0, columns["rudder_screw"])
    for other in (wild, 3.0 * columns["rudder_screw"]):
        assert "setup.angle.unit" not in named(text, t, {**columns, "rudder_screw": other})
    # Thousandths of a radian are not called degrees.
    (found,) = setup_findings(parse_vehicle(text, "v.toml"), {"t": t, **times(rudder_screw=1000)(columns)})
    assert found.id == "setup.angle.unit" and "degrees" not in found.line
