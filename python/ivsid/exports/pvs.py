"""PythonVehicleSimulator: a class as its vehicles are, with dynamics(eta, nu, u_actual, u_control, sampleTime).

Source: PythonVehicleSimulator, src/python_vehicle_simulator/vehicles/otter.py; docs/export.md.
"""

from __future__ import annotations

import math
from typing import Final

from ivsid.exports.formulas import current, formulas
from ivsid.exports.mss import name_of
from ivsid.exports.planar import Planar
from ivsid.exports.target import INERTIA, Body, Target, steering_sentences


def write(model: Planar) -> Body:
    """The body of a module with one class."""
    f = formulas(model)
    north, east = current(model)
    lags, told, sentences = _lags(model)
    count = len(model.vehicle.thrusters)
    hull = model.vehicle.hull
    lines = [
        "from math import cos, sin, tanh",
        "",
        "import numpy as np",
        "",
        "",
        f"class {name_of(model)}:",
        f"    {f'{model.title} in surge, sway and yaw; other motions are held.'!r}",
        "",
        f"    def __init__(self, controlSystem='stepInput', r=0, V_current={math.hypot(north.value, east.value)!r}, "
        f"beta_current={math.atan2(east.value, north.value)!r}):  # north {north.words}; east {east.words}",
        "        self.controlMode = 'stepInput'",
        "        self.controlDescription = 'Step inputs'",
        "        self.ref = r",
        "        self.V_c = V_current",
        "        self.beta_c = beta_current",
        f"        self.name = {model.title!r}",
        f"        self.L = {hull.length or 1.0!r}",
        f"        self.B = {hull.beam or 1.0!r}",
        f"        self.controls = {[t.name for t in model.vehicle.thrusters]!r}",
        f"        self.dimU = {count}",
        "        self.nu = np.zeros(6)",
        f"        self.u_actual = np.zeros({count})",
        f"        self.T_n = np.array({lags!r})  # time constants of the shafts (s), 0: none",
        *(f"        self.{k} = {v.value!r}  # {v.words}" for k, v in f.constants.items()),
        *(
            f"        self.{name}{k} = {value!r}"
            for k, table in f.tables.items()
            for name, value in zip(("knots", "pieces"), table, strict=True)
        ),
        "        MRB = np.array([[self.m, 0, -self.m*self.yg], [0, self.m, self.m*self.xg], [-self.m*self.yg, self.m*self.xg, self.Iz]])",
        "        MA = -np.diag([self.Xudot, self.Yvdot, self.Nrdot])",
        "        self.M = MRB + MA",
        "        self.Minv = np.linalg.inv(self.M)",
        "",
        "    def rates(self, psi, nu, n):",
        '        """nu_dot of u, v, w, p, q, r at shaft demands n."""',
        "        u, v, r = nu[0], nu[1], nu[5]",
        "        V_c, beta_c = self.V_c, self.beta_c",
        *(
            f"        {k} = self.{k}"
            for k in (*f.constants, *(f"{q}{k}" for k in f.tables for q in ("knots", "pieces")))
        ),
        *(f"        n{k} = n[{k - 1}]" for k in range(1, count + 1)),
        *(f"        {line}" for line in f.lines),
        "        a = self.Minv @ np.array([X, Y, N])",
        "        return np.array([a[0] + r*v_c, a[1] - r*u_c, 0, 0, 0, a[2]])",
        "",
        "    def dynamics(self, eta, nu, u_actual, u_control, sampleTime):",
        '        """[nu, u_actual] after a step of Euler\'s method."""',
        "        n = np.where(self.T_n > 0, u_actual, u_control)",
        "        n_dot = np.where(self.T_n > 0, (u_control - n) / np.where(self.T_n > 0, self.T_n, 1.0), 0.0)",
        "        return nu + sampleTime * self.rates(eta[5], nu, n), n + sampleTime * n_dot",
        "",
        "    def stepInput(self, t):",
        '        """No demand; replace it by a programme."""',
        f"        return np.zeros({count})",
        "",
        "",
        "def piecewise(d, knots, pieces):",
        '    """A polynomial between neighbouring knots, of the distance from the lower one."""',
        "    d = min(max(d, knots[0]), knots[-1])",
        "    k = min(int(np.searchsorted(knots, d, side='right')) - 1, len(pieces) - 1)",
        "    return np.polyval(pieces[k], d - knots[k])",
    ]
    return Body("\n".join(lines), f.says | INERTIA | told, (*sentences, *steering_sentences(model)))


def _lags(model: Planar) -> tuple[list[float], set[str], tuple[str, ...]]:
    """Time constants of the shafts, the numbers in them, and sentences on those that act on the thrust."""
    out, told = [], set()
    for t in model.vehicle.thrusters:
        name = f"thruster.lag.{t.name}"
        lag = model.of_thruster("thruster.lag", t.name)
        shaft = lag is not None and t.lag == "demand"
        out.append(lag.value if shaft and lag is not None else 0.0)
        if shaft:
            told |= {name, "thruster.lag"}
    late = [t.name for t in model.vehicle.thrusters if t.lag == "thrust" and model.of_thruster("thruster.lag", t.name)]
    return out, told, tuple(f"the lag of {n}, which acts on its thrust: the simulator has lags of shafts" for n in late)


TARGET: Final = Target("pvs", "PythonVehicleSimulator", lambda m: f"{name_of(m)}.py", write, ("#", ""))
