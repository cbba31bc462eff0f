"""Models for other simulators, against the equations of each target as its source has them, written here a second time."""

import json
import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import ivsid
from command_line import run
from ivsid import IvsidError
from ivsid.effects import sort_given, terms_of
from ivsid.exports import TARGETS
from ivsid.identification import read_identification
from ivsid.simulation.equations import equations, plant
from ivsid.vehicle import parse_vehicle

TRUTH = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}
DAMPED = {
    "drag.surge.linear": 4.0,
    "drag.sway.linear": 8.0,
    "drag.yaw.linear": 1.5,
    "drag.yaw.quadratic": 2.5,
}
FURTHER = {
    "drag.surge.astern": 10.0,
    "drag.surge.sideslip": 30.0,
    "drag.sway.yaw_rate": -4.0,
    "drag.lift.sway": 12.0,
    "drag.lift.yaw": -3.0,
    "added_mass.munk": 6.0,
    "coupling.cg_x": 1.5,
    "coupling.cg_y": -0.7,
}
CUBIC = {"drag.surge.cubic": 5.0, "drag.sway.cubic": 70.0, "drag.yaw.cubic": 4.0}
BEYOND = {"friction.coulomb": 1.2, "current.steady.north": 0.3, "current.steady.east": -0.2}
TABLE = "table = { demand = [-100, -60, -30, 0, 30, 60, 100], thrust = [-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0] }"
QUADRATIC = "quadratic = { forward = 0.011 }\ndemand_range = [-110, 110]"


def boat(numbers, curve=QUADRATIC, *, extra="", terms="", hull="length = 1.2", head=""):
    """A boat with asymmetric thrusters and a centre of gravity off the origin."""
    text = f'name = "Small boat"\n[hull]\nmass = 50\n{hull}\ncentre_of_gravity = [0.05, -0.02]\n'
    for name, place, azimuth in (("port", "[-0.35, -0.30]", 0.1), ("starboard", "[-0.40, 0.25]", -0.2)):
        text += f'[[thrusters]]\nname = "{name}"\nposition = {place}\nazimuth = {azimuth}\n{curve}\n{extra}\n'
    text += f"{head}\n[model]\n{terms}\n[model.fitted]\n"
    text += "".join(f'"{k}" = {{ value = {v}, lower = {v - 0.25}, upper = {v + 0.5} }}\n' for k, v in numbers.items())
    return parse_vehicle(text, "boat.toml")


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


def number(tree, path):
    found = tree.findall(path)
    assert len(found) == 1, path
    return float(found[0].text)


class Engine:
    """A rigid body of SDF with its thruster frames in axes forward, port, up, as the physics engine moves it in the plane."""

    def __init__(self, text):
        self.tree = ET.fromstring(text)
        inertial = ".//link[@name='base_link']/inertial"
        self.x, self.y = (float(q) for q in self.tree.find(f"{inertial}/pose").text.split()[:2])
        self.mass = number(self.tree, f"{inertial}/mass")
        self.izz = number(self.tree, f"{inertial}/inertia/izz")
        assert all(number(self.tree, f"{inertial}/inertia/{q}") * 2 >= self.izz for q in ("ixx", "iyy"))

    def plugin(self, name):
        return next(p for p in self.tree.iter("plugin") if p.get("name") == name)

    def pushed(self, forces):
        """X, Y, N of thrusts along the x axes of their frames."""
        total = np.zeros(3)
        for name, force in forces.items():
            frame = next(f for f in self.tree.iter("frame") if f.get("name") == f"thruster_{name}")
            x, y, _, _, _, yaw = (float(q) for q in frame.find("pose").text.split())
            c, s = math.cos(yaw), math.sin(yaw)
            total += force * np.array([c, s, x * s - y * c])
        return total

    def thrust(self, name, command):
        """Thruster.cc in the mode of angular velocities: clamp, rho K D^4 w|w|, dead band in newtons."""
        p = next(q for q in self.tree.iter("plugin") if q.findtext("joint_name") == f"{name}_joint")
        assert p.findtext("use_angvel_cmd") == "true"
        w = min(max(command, float(p.findtext("min_thrust_cmd"))), float(p.findtext("max_thrust_cmd")))
        k = [float(p.findtext(t)) for t in ("fluid_density", "thrust_coefficient", "propeller_diameter")]
        force = k[0] * k[1] * k[2] ** 4 * w * abs(w)
        return 0.0 if abs(force) < float(p.findtext("deadband") or 0.0) else force

    def rigid(self):
        """The 6-DOF rigid-body inertia about the link's origin, rows and columns u, v, r."""
        m, x, y = self.mass, self.x, self.y
        return np.array([[m, 0, -m * y], [0, m, m * x], [-m * y, m * x, self.izz + m * (x * x + y * y)]])


def coriolis(inertia, nu):
    """C(nu) nu of an inertia matrix in the plane: the force that turning momentum needs (Kirchhoff)."""
    u, v, r = nu
    momentum = inertia @ nu
    return np.array([-r * momentum[1], r * momentum[0], u * momentum[1] - v * momentum[0]])


def gazebo(text, states, demands):
    """Hydrodynamics.cc and an engine whose inertia holds the added mass, in axes forward, port, up; accelerations in ours."""
    engine = Engine(text)
    plugin = engine.plugin("gz::sim::systems::Hydrodynamics")
    # Unset derivatives are 0 there; every pair and triple of SNAME names is read.
    coefficients = {c.tag: float(c.text) for c in plugin if re.fullmatch(r"[xyn][UVR](abs)?[UVR]?", c.tag)}
    assert not [c.tag for c in plugin if "Dot" in c.tag]
    added = np.diag([number(engine.tree, f".//fluid_added_mass/{q}") for q in ("xx", "yy", "rr")])
    inertia = engine.rigid() + added
    current = [float(q) for q in (plugin.findtext("default_current") or "0 0 0").split()]
    out = []
    for (u, v, r, psi), n in zip(states, demands, strict=True):
        nu = np.array([u, -v, -r])
        # Heading from east to north; the current stands east, north.
        yaw = math.pi / 2 - psi
        c, s = math.cos(yaw), math.sin(yaw)
        water = np.array([c * current[0] + s * current[1], c * current[1] - s * current[0], 0.0])
        flow = dict(zip("UVR", nu - water, strict=True))
        force = np.zeros(3)
        for tag, k in coefficients.items():
            channel, first, rest = "xyn".index(tag[0]), tag[1], tag[2:]
            second = 1.0 if not rest else abs(flow[rest[3]]) if rest.startswith("abs") else flow[rest]
            force[channel] += k * flow[first] * second
        force += engine.pushed({name: engine.thrust(name, q) for name, q in zip(("port", "starboard"), n, strict=True)})
        out.append(np.linalg.solve(inertia, force - coriolis(inertia, nu)) * (1, -1, -1))
    return np.array(out)


def vrx(text, states, demands):
    """SimpleHydrodynamics.cc: added masses times the acceleration in space, drags, and no Coriolis force in the sum."""
    engine = Engine(text)
    plugin = engine.plugin("vrx::SimpleHydrodynamics")
    k = {c.tag: float(c.text) for c in plugin if c.tag != "link_name"}
    wanted = {f"{a}{b}{c}" for a, c in zip("xyzkmn", "UVWPQR", strict=True) for b in ("Dot", "", c)}
    assert set(k) == wanted | {"max_effort"} and all(q >= 0 for q in k.values())
    rigid = engine.rigid()
    added = np.diag([k["xDotU"], k["yDotV"], k["nDotR"]])
    out = []
    for (u, v, r, _), n in zip(states, demands, strict=True):
        nu = np.array([u, -v, -r])
        drag = [-(k[f"{a}{b}"] + k[f"{a}{b}{b}"] * abs(x)) * x for a, b, x in zip("xyn", "UVR", nu, strict=True)]
        push = engine.pushed({name: engine.thrust(name, q) for name, q in zip(("port", "starboard"), n, strict=True)})
        # An accelerometer in axes forward, port, up: rate - r v and rate + r u.
        turning = np.array([-nu[2] * nu[1], nu[2] * nu[0], 0.0])
        right = drag + push - coriolis(rigid, nu) - added @ turning
        out.append(np.linalg.solve(rigid + added, right) * (1, -1, -1))
    return np.array(out)


def close(found, wanted):
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)


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


def fossen(constants, states, thrusts, places, azimuths):
    """Fossen's equations in six degrees of freedom by m2c, as the otter of MSS and of PythonVehicleSimulator composes them."""
    k = constants
    mrb = np.zeros((6, 6))
    m, x, y = k["m"], k["xg"], k["yg"]
    mrb[:3, :3] = m * np.eye(3)
    mrb[0, 5] = mrb[5, 0] = -m * y
    mrb[1, 5] = mrb[5, 1] = m * x
    mrb[2:5, 2:5] = np.eye(3) * m
    mrb[5, 5] = k["Iz"]
    ma = -np.diag([k["Xudot"], k["Yvdot"], 0, 0, 0, k["Nrdot"]])

    def skew(a):
        return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])

    def m2c(matrix, nu):
        one = matrix[:3, :3] @ nu[:3] + matrix[:3, 3:] @ nu[3:]
        two = matrix[3:, :3] @ nu[:3] + matrix[3:, 3:] @ nu[3:]
        return np.block([[np.zeros((3, 3)), -skew(one)], [-skew(one), -skew(two)]])

    out = []
    for (u, v, r, psi), force in zip(states, thrusts, strict=True):
        u_c = k["V_c"] * math.cos(k["beta_c"] - psi)
        v_c = k["V_c"] * math.sin(k["beta_c"] - psi)
        nu = np.array([u - u_c, v - v_c, 0, 0, 0, r])
        a, b = nu[:2]
        damping = np.zeros(6)
        damping[0] = k["Xu"] * a + k.get("Xuu", 0) * abs(a) * a + k.get("Xvv", 0) * b * b
        damping[0] += k.get("Xastern", 0) * (a * abs(a) if a < 0 else 0) + k.get("Xfriction", 0) * math.tanh(a / 0.02)
        damping[1] = k["Yv"] * b + k.get("Yvv", 0) * abs(b) * b + k.get("Yr", 0) * r + k.get("Yuv", 0) * abs(a) * b
        damping[5] = k["Nr"] * r + k.get("Nrr", 0) * abs(r) * r + k["Nuv"] * a * b
        for row, name, x in ((0, "Xuuu", a), (1, "Yvvv", b), (5, "Nrrr", r)):
            damping[row] += k.get(name, 0) * x**3
        if "windN" in k:
            damping[0] += k["windN"] * math.cos(psi) + k["windE"] * math.sin(psi)
            damping[1] += k["windE"] * math.cos(psi) - k["windN"] * math.sin(psi)
        for t, (px, py), angle in zip(force, places, azimuths, strict=True):
            c, s = math.cos(angle), math.sin(angle)
            damping += t * np.array([c, s, 0, 0, 0, px * s - py * c])
        right = damping - (m2c(mrb, nu) + m2c(ma, nu)) @ nu
        moved = [0, 1, 5]
        rates = np.linalg.solve((mrb + ma)[np.ix_(moved, moved)], right[moved])
        out.append(np.add(rates, [r * v_c, -r * u_c, 0.0]))
    return np.array(out)


def matlab(text):
    """Constants and equations of a function of MATLAB as a function in Python: the file uses what both languages share."""
    code = re.sub(r"%.*", "", text)
    constants = {k: float(v) for k, v in re.findall(r"^(\w+) = (-?[\d.e+-]+);", code, re.M)}
    constants |= {k: float(v) for k, v in re.findall(r"(V_c|beta_c) = (-?[\d.e+-]+);", code)}
    tables = dict(re.findall(r"^((?:knots|pieces)\d+) = \[(.*)\];", code, re.M))
    space = {"abs": abs, "min": min, "max": max, "cos": math.cos, "sin": math.sin, "tanh": math.tanh, **constants}
    for name, value in tables.items():
        space[name] = np.array([[float(q) for q in row.split()] for row in value.split(";")])

    def piecewise(d, knots, pieces):
        knots = knots[0]
        d = min(max(d, knots[0]), knots[-1])
        k = min(int(np.flatnonzero(knots <= d)[-1]), len(pieces) - 1)
        return np.polyval(pieces[k], d - knots[k])

    lines = text[text.index("% equations\n") : text.index("% end of equations")].splitlines()[1:]
    assert all(line.endswith(";") for line in lines)
    source = "\n".join(line.rstrip(";") for line in lines)
    tail = text[text.index("% end of equations") : text.index("function T = piecewise")]
    assert "nu_r_dot = (MRB + MA) \\ [X; Y; N];" in tail and "xdot = zeros(12,1);" in tail
    rigid, added = (re.search(rf"{q} = (?:-diag\()?\[(.*?)\]", tail)[1] for q in ("MRB", "MA"))
    moved = [re.search(rf"xdot\(\[{q}\]\) = .*?\[(.*)\];", tail)[1].split(";") for q in ("1 2 6", "7 8 12")]
    assert "xdot([1 2 6]) = nu_r_dot + [" in tail

    def rates(state, n):
        local = {**space, "piecewise": piecewise, **dict(zip(("u", "v", "r", "psi"), state, strict=True))}
        local |= {f"n{k}": q for k, q in enumerate(n, start=1)}
        exec(source, local)

        def value(x):
            return float(eval(x, local))

        matrix = np.array([[value(q) for q in row.split()] for row in rigid.split(";")])
        matrix = matrix - np.diag([value(q) for q in added.split()])
        a = np.linalg.solve(matrix, [local["X"], local["Y"], local["N"]])
        u, v, r, psi = state
        c, s = math.cos(psi), math.sin(psi)
        close([value(q) for q in moved[1]], [u * c - v * s, u * s + v * c, r])
        return np.add(a, [value(q) for q in moved[0]])

    return constants, rates


PLACES, AZIMUTHS = ((-0.35, -0.30), (-0.40, 0.25)), (0.1, -0.2)
WHOLE = {**TRUTH, **DAMPED, **FURTHER, **CUBIC, **BEYOND, "wind.steady.north": 1.5, "wind.steady.east": -0.8}


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


def pvs(text, name="small_boat"):
    space = {}
    exec(compile(text, "vehicle.py", "exec"), space)
    return space[name]()


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


def test_yaml_holds_everything():
    yaml = pytest.importorskip("yaml")
    vehicle = boat({**WHOLE, "thruster.delay": 0.3}, TABLE, extra="dead_band = 12.0")
    made = ivsid.export(vehicle, "yaml")
    read = yaml.safe_load(made.text)
    assert made.unstated == () and set(read["numbers"]) >= {*WHOLE, "thruster.delay", "thruster.deadband.port"}
    assert read["numbers"]["mass.surge"] == {
        "value": 58.0,
        "lower": 57.75,
        "upper": 58.5,
        "unit": "kg",
        "symbol": "m - X_udot",
    }
    port = read["thrusters"][0]
    assert port["position"] == [-0.35, -0.3] and port["table"]["thrust"][-1] == 40.0 and port["dead_band"] == 12.0
    assert read["hull"]["mass"] == 50.0 and read["hull"]["centre_of_gravity"] == [0.05, -0.02]


NEVER = ("thruster.delay = 0.3 s", "sensor.yaw_rate.bias = 0.01 rad/s", "drag.cross_flow = 25 kg/m^2")


@pytest.mark.parametrize("target", [t.name for t in TARGETS if t.name != "yaml"])
def test_what_a_target_cannot_say_is_said_in_the_file_and_in_the_result(target):
    vehicle = boat({**TRUTH, "thruster.delay": 0.3, "sensor.yaw_rate.bias": 0.01, "drag.cross_flow": 25.0})
    made = ivsid.export(vehicle, target)
    for words in NEVER:
        assert any(s.startswith(words) for s in made.unstated)
        assert words in made.text
    assert all(s.replace("--", "- -") in made.text for s in made.unstated)


@pytest.mark.parametrize("target", [t.name for t in TARGETS])
def test_cubic_drags_stand_in_files_of_equations_and_are_unstated_elsewhere(target):
    """Plugins of Gazebo and VRX have matrices of linear and quadratic damping alone, Stonefish has the drag of a mesh."""
    made = ivsid.export(boat({**TRUTH, **CUBIC}), target)
    missing = {i for i in CUBIC if any(s.startswith(f"{i} = {CUBIC[i]:g} ") for s in made.unstated)}
    assert missing == (set() if target in ("mss", "pvs", "yaml") else set(CUBIC))


@pytest.mark.parametrize(
    ("target", "words"),
    [("gz", "7.75 to 8.5 kg"), ("vrx", "7.75 to 8.5 kg"), ("mss", "-8.5 to -7.75 kg"), ("pvs", "-8.5 to -7.75 kg")],
)
def test_intervals_go_with_their_numbers(target, words):
    """The added mass in surge is the whole less 50 kg; its ends turn with its sign."""
    line = next(
        q for q in ivsid.export(boat({**TRUTH, **DAMPED}), target).text.splitlines() if "X_udot" in q and "to" in q
    )
    assert words in line
    moment = next(q for q in ivsid.export(boat({**TRUTH, **DAMPED}), "gz").text.splitlines() if "<nUV>" in q)
    assert "16.25 to 17.75 kg" in moment


def test_every_target_has_one_file_and_one_name():
    assert [t.name for t in TARGETS] == ["gz", "vrx", "mss", "pvs", "stonefish", "yaml"]


def test_an_identification_is_exported_from_its_folder(tmp_path, twin):
    """Mid-values of its intervals, in the total form and in that of added masses."""
    from conftest import as_log, embedded

    vehicle = parse_vehicle(embedded("swan.toml"), "swan.toml")
    fit = ivsid.identify(vehicle, as_log(twin))
    fit.save(tmp_path / "fit")
    read = read_identification(tmp_path / "fit")
    made = ivsid.export(tmp_path / "fit", "yaml")
    line = next(q for q in made.text.splitlines() if '"mass.surge"' in q)
    assert f"value: {read.parameters['mass.surge'].midpoint!r}" in line
    assert f"lower: {read.parameters['mass.surge'].lower!r}" in line
    assert made == ivsid.export(read, "yaml")
    done = run("export", tmp_path / "fit", "--to", "mss", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "out" / "result.json").read_text())
    assert record["command"] == "export" and record["target"] == "mss" and (tmp_path / "out" / record["file"]).exists()
    assert all(s in done.stdout for s in record["unstated"])
    added = ivsid.export(ivsid.identify(vehicle, as_log(twin), form="added"), "mss").text
    one, other = (matlab(t)[0] for t in (ivsid.export(fit, "mss").text, added))
    assert other["Xudot"] == pytest.approx(one["Xudot"], abs=0.5)


def test_a_diagnosis_is_exported_by_its_model(tmp_path):
    vehicle = boat({**TRUTH, **DAMPED})
    (tmp_path / "result.json").write_text('{"command": "diagnose"}')
    with pytest.raises(IvsidError, match="no model.toml"):
        ivsid.export(tmp_path, "gz")
    (tmp_path / "model.toml").write_text(vehicle.text)
    assert ivsid.export(tmp_path, "gz").text.splitlines()[2:] == ivsid.export(vehicle, "gz").text.splitlines()[2:]


@pytest.mark.parametrize(
    ("given", "to", "words"),
    [
        (lambda _: boat(TRUTH), "gazebo", "'gazebo' is no target; use gz, vrx, mss, pvs, stonefish, yaml"),
        (lambda _: boat({"mass.surge": 58.0}), "gz", "no number for mass.sway, inertia.yaw"),
        (lambda p: p, "gz", "cannot be read"),
        (lambda p: p / "none", "gz", "cannot be read"),
        (lambda p: _written(p, "[1"), "gz", "is no result"),
        (lambda p: _written(p, '{"command": "allan"}'), "gz", "is a result of allan"),
    ],
)
def test_unusable_results_are_refused_in_a_sentence(tmp_path, given, to, words):
    with pytest.raises(IvsidError, match=re.escape(words)):
        ivsid.export(given(tmp_path), to)


def _written(place, text):
    (place / "result.json").write_text(text)
    return place


def test_a_name_is_text_in_every_file():
    """Neither a line break nor a quote of a vehicle's name becomes code or markup."""
    name = """A "boat" & <co> -- one\\nraise SystemExit 'x' """
    text = boat({**TRUTH, **DAMPED}).text.replace('name = "Small boat"', f"name = {json.dumps(name)}", 1)
    vehicle = parse_vehicle(text, "boat.toml")
    assert vehicle.name == name
    for target in ("gz", "vrx", "stonefish"):
        tree = ET.fromstring(ivsid.export(vehicle, target).text)
        assert " ".join(name.split()) in [e.get("name") for e in tree.iter()]
    ship = pvs(ivsid.export(vehicle, "pvs").text, "a_boat_co_one_nraise_systemexit_x")
    assert ship.name == " ".join(name.split())
    broken = vehicle.model_copy(update={"name": "one\ntwo"})
    for target in TARGETS:
        assert "\ntwo" not in ivsid.export(broken, target.name).text
