"""Models for other simulators, against the equations of each target."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

import ivsid
from exported_boat import BEYOND, DAMPED, FURTHER, TABLE, TRUTH, WHOLE, boat
from ivsid.effects import sort_given, terms_of
from ivsid.simulation.equations import equations, plant
from other_simulators import Engine, close, fossen, gazebo, matlab, number, pvs, vrx


def accelerations(vehicle, states, thrusts):
    """u, v, r rates of ivsid's own equations at states (u, v, r, psi) under thrusts at no speed."""
    given = sort_given(vehicle.model.numbers, [t.name for t in vehicle.thrusters])
    rates = equations(plant(vehicle, terms_of(vehicle), given))
    angles = [0.0] * len(vehicle.thrusters)
    return np.array(
        [
            rates(0.0, *s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, *f, *angles)[:3]
            for s, f in zip(states, thrusts, strict=True)
        ]
    )


def random_states(seed=1, count=60):
    """u, v, r, psi and the demands of two thrusters."""
    rng = np.random.default_rng(seed)
    return rng.uniform((-1.5, -0.8, -0.7, -3.0), (1.5, 0.8, 0.7, 3.0), (count, 4)), rng.uniform(-90, 90, (count, 2))


def quadratic(demands, k=0.011):
    return k * demands * np.abs(demands)


def test_gazebo_moves_as_the_model_does():
    vehicle = boat({**TRUTH, **DAMPED, **FURTHER})
    made = ivsid.export(vehicle, "gz")
    states, demands = random_states()
    close(gazebo(made.text, states, demands), accelerations(vehicle, states, quadratic(demands)))
    assert made.unstated == ()
    # Against the motion come the usual signs.
    tree = ET.fromstring(made.text)
    for tag in ("xU", "xUabsU", "yV", "yVabsV", "nR", "nRabsR"):
        assert number(tree, f".//{tag}") < 0
    assert [number(tree, f".//fluid_added_mass/{q}") for q in ("xx", "yy")] == [8.0, 25.0]
    assert number(tree, ".//nUV") == pytest.approx(75.0 - 58.0 - 6.0 + 3.0)


def test_gazebo_takes_the_drag_of_a_current_and_says_what_differs():
    """Without added masses beyond equal ones the engine has no force that depends on the frame of the velocity."""
    vehicle = boat({**TRUTH, **BEYOND})
    made = ivsid.export(vehicle, "gz")
    assert any("friction.coulomb = 1.2 N" in s for s in made.unstated)
    assert any("Coriolis forces of the added mass in a current" in s for s in made.unstated)
    assert "<default_current>-0.2 0.3 0</default_current>" in made.text
    same = boat({**TRUTH, "mass.surge": 50.0, "mass.sway": 50.0, **{k: v for k, v in BEYOND.items() if "current" in k}})
    states, demands = random_states(2)
    close(gazebo(ivsid.export(same, "gz").text, states, demands), accelerations(same, states, quadratic(demands)))


def test_vrx_moves_as_a_model_with_one_mass_does():
    vehicle = boat(
        {"mass.surge": 60.0, "drag.surge.quadratic": 80.0, "inertia.yaw": 9.0, **DAMPED}, terms='terms = "paper"'
    )
    made = ivsid.export(vehicle, "vrx")
    states, demands = random_states(3)
    close(vrx(made.text, states, demands), accelerations(vehicle, states, quadratic(demands)))
    assert made.unstated == ()


def test_vrx_says_by_how_much_unequal_masses_differ():
    """The difference is that of the sentence, in both axes."""
    vehicle = boat({**TRUTH, **DAMPED}, hull="length = 1.2")
    made = ivsid.export(vehicle, "vrx")
    states, demands = random_states(4)
    apart = accelerations(vehicle, states, quadratic(demands)) - vrx(made.text, states, demands)
    engine = Engine(made.text)
    inertia = engine.rigid() * [[1, -1, -1], [-1, 1, 1], [-1, 1, 1]] + np.diag(
        [8.0, 25.0, number(engine.tree, ".//nDotR")]
    )
    u, v, r = states[:, :3].T
    missing = np.stack([17.0 * v * r, 17.0 * u * r, np.zeros(len(u))])
    close(apart, np.linalg.solve(inertia, missing).T)
    assert any("surge lacks 17 v r [N], sway has 17 u r [N]" in s for s in made.unstated)


PLACES, AZIMUTHS = ((-0.35, -0.30), (-0.40, 0.25)), (0.1, -0.2)


def test_mss_moves_as_the_model_does():
    vehicle = boat(WHOLE)
    made = ivsid.export(vehicle, "mss")
    constants, rates = matlab(made.text)
    states, demands = random_states(5)
    wanted = accelerations(vehicle, states, quadratic(demands))
    close([rates(s, n) for s, n in zip(states, demands, strict=True)], wanted)
    close(fossen(constants, states, quadratic(demands), PLACES, AZIMUTHS), wanted)
    assert made.unstated == () and made.file == "small_boat.m"
    for name in ("Xudot", "Yvdot", "Nrdot", "Xu", "Yv", "Nr"):
        assert constants[name] < 0
    assert (
        "function [xdot,U] = small_boat(x,n,V_c,beta_c)" in made.text
        and "MA = -diag([Xudot Yvdot Nrdot]);" in made.text
    )


def test_pythonvehiclesimulator_moves_as_the_model_does():
    vehicle = boat(WHOLE)
    made = ivsid.export(vehicle, "pvs")
    ship = pvs(made.text)
    states, demands = random_states(6)
    wanted = accelerations(vehicle, states, quadratic(demands))
    for (u, v, r, psi), n, rate in zip(states, demands, wanted, strict=True):
        nu = np.array([u, v, 0, 0, 0, r])
        moved, actual = ship.dynamics(np.array([0, 0, 0, 0, 0, psi]), nu, ship.u_actual, n, 1.0)
        close((moved - nu)[[0, 1, 5]], rate)
        close(actual, n)
    constants = {k: getattr(ship, k) for k in vars(ship) if isinstance(getattr(ship, k), float)}
    close(
        fossen({**constants, "V_c": ship.V_c, "beta_c": ship.beta_c}, states, quadratic(demands), PLACES, AZIMUTHS),
        wanted,
    )
    assert made.unstated == () and ship.Xudot < 0 and ship.Xu < 0 and ship.dimU == 2


@pytest.mark.parametrize(
    "curve",
    [
        TABLE,
        "polynomial = [1e-5, 2e-3, 0.1, 0.0]",
        "gain = 0.3\nneutral = 5.0",
        "quadratic = { forward = 0.011, reverse = 0.006 }\ndemand_range = [-60, 80]",
        'table = { demand = [10, 60, 100], thrust = [2.0, 18.0, 40.0] }\noutside = "hold"',
        f"{TABLE}\ndead_band = 12.0\nlimit = 20.0\nreverse_factor = 0.7\nadvance_loss = 0.06",
    ],
)
def test_thrust_curves_are_those_of_the_vehicle_file(curve):
    """Thrusts are interpolated here by SciPy and NumPy, from the file's own keys."""
    from scipy.interpolate import PchipInterpolator

    vehicle = boat({**TRUTH, **DAMPED}, curve)
    states, demands = random_states(7, 40)
    t = vehicle.thrusters[0]
    inside = demands.copy()
    if t.table is not None:
        d, f = np.array(t.table.demand), np.array(t.table.thrust)
        inside = np.clip(demands, min(d[0], 0.0), d[-1])
        thrust = PchipInterpolator(d, f)(inside)
        if d[0] > 0:
            thrust = np.where(inside < d[0], inside * f[0] / d[0], thrust)
    elif t.quadratic is not None:
        inside = np.clip(demands, -60, 80)
        thrust = np.where(inside < 0, 0.006, 0.011) * inside * np.abs(inside)
    else:
        inside = demands - t.neutral
        thrust = np.polyval(t.polynomial or (t.gain, 0.0), inside)
    if t.dead_band:
        thrust = np.clip(np.where(np.abs(inside) < 12.0, 0.0, thrust), -20.0, 20.0)
        thrust = np.where(thrust < 0, 0.7 * thrust, thrust)
    wanted = accelerations(vehicle, states, thrust)
    _, rates = matlab(ivsid.export(vehicle, "mss").text)
    close([rates(s, n) for s, n in zip(states, demands, strict=True)], wanted)
    ship = pvs(ivsid.export(vehicle, "pvs").text)
    close(
        [ship.rates(s[3], [s[0], s[1], 0, 0, 0, s[2]], n)[[0, 1, 5]] for s, n in zip(states, demands, strict=True)],
        wanted,
    )


def test_thrusters_of_gazebo_clamp_and_stand_still_as_the_model_says():
    vehicle = boat({**TRUTH, **DAMPED}, extra="dead_band = 12.0\nlimit = 30.0")
    made = ivsid.export(vehicle, "gz")
    assert made.unstated == ()
    states, demands = random_states(8)
    demands[::3] *= 0.15
    thrust = np.clip(np.where(np.abs(demands) < 12.0, 0.0, quadratic(demands)), -30.0, 30.0)
    assert (thrust == 0).any() and (np.abs(thrust) == 30.0).any()
    close(gazebo(made.text, states, demands), accelerations(vehicle, states, thrust))
    table = ivsid.export(boat(TRUTH, TABLE), "gz")
    assert any("the thrust curve of port: command its thrust" in s for s in table.unstated)
    assert (
        "<max_thrust_cmd>40.0</max_thrust_cmd>" in table.text and "<min_thrust_cmd>-30.0</min_thrust_cmd>" in table.text
    )


def test_the_lag_of_a_shaft_is_that_of_the_simulator():
    ship = pvs(ivsid.export(boat({**TRUTH, **DAMPED}, extra='time_constant = 0.4\nlag = "demand"'), "pvs").text)
    _, actual = ship.dynamics(np.zeros(6), np.zeros(6), np.array([10.0, 20.0]), np.array([50.0, 20.0]), 0.02)
    close(actual, [12.0, 20.0])
    late = ivsid.export(boat({**TRUTH, **DAMPED}, extra="time_constant = 0.4"), "pvs")
    assert any("thruster.lag.port = 0.4 s" in s for s in late.unstated) and any(
        "acts on its thrust" in s for s in late.unstated
    )


def test_stonefish_has_places_curves_and_what_it_cannot_say():
    """NED and forward, starboard, down are its own axes, so that no sign turns."""
    vehicle = boat(
        {**TRUTH, **DAMPED},
        "quadratic = { forward = 0.011, reverse = 0.006 }",
        extra='time_constant = 0.4\nlag = "demand"',
    )
    made = ivsid.export(vehicle, "stonefish")
    tree = ET.fromstring(made.text)
    assert tree.find(".//cg").get("xyz") == "0.05 -0.02 0.0" and tree.find(".//mass").get("value") == "50.0"
    port, starboard = tree.findall("actuator")
    assert port.find("origin").get("xyz") == "-0.35 -0.3 0.0" and starboard.find("origin").get("rpy") == "0.0 0.0 -0.2"
    coefficient = port.find("thrust_model/thrust_coeff")
    assert (coefficient.get("forward"), coefficient.get("reverse")) == ("0.011", "0.006")
    assert port.find("rotor_dynamics/time_constant").get("value") == "0.4"
    assert not any("thruster.lag" in s for s in made.unstated)
    for name in ("added masses", "drags", "mass.surge = 58 kg", "drag.surge.linear = 4 kg/s"):
        assert any(s.startswith(name) for s in made.unstated), name
    table = ET.fromstring(ivsid.export(boat(TRUTH, TABLE), "stonefish").text).find("actuator/thrust_model")
    demand, thrust = (np.array(table.find(k).get("value").split(), float) for k in ("input", "output"))
    assert (np.diff(demand) > 0).all() and np.interp(60.0, demand, thrust) == pytest.approx(18.0, rel=1e-3)
