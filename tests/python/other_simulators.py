"""Equations of the simulators that ivsid exports to, as the source of each has them, written here a second time."""

import math
import re
import xml.etree.ElementTree as ET

import numpy as np


def close(found, wanted):
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)


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


def pvs(text, name="small_boat"):
    space = {}
    exec(compile(text, "vehicle.py", "exec"), space)
    return space[name]()
