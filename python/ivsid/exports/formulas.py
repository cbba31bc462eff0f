"""Equations of motion as lines in the syntax that MATLAB and Python share, for the simulators of Fossen.

M nudot_r + C(nu_r) nu_r = tau + damping, with M = M_RB + M_A, M_A = -diag(Xudot, Yvdot, Nrdot), in NED and body axes forward,
starboard, down. Source: Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2021, sections 3.3, 6.2 and 6.4; MSS, otter.m.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from ivsid.effects.drag import FRICTION_SPEED
from ivsid.exports.number import Number, exact
from ivsid.exports.planar import Planar
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation.equations import axis
from ivsid.vehicle import Thruster


@dataclass(frozen=True)
class Damping:
    """A term of the damping: the name of its coefficient, its force and its velocities."""

    name: str
    symbol: str
    channel: str
    product: str


DAMPING: Final[Mapping[str, Damping]] = {
    "drag.surge.linear": Damping("Xu", "X_u", "X", "u_r"),
    "drag.surge.quadratic": Damping("Xuu", "X_|u|u", "X", "abs(u_r)*u_r"),
    "drag.surge.cubic": Damping("Xuuu", "X_uuu", "X", "u_r*u_r*u_r"),
    "drag.surge.astern": Damping("Xastern", "-X_a", "X", "0.5*(abs(u_r)*u_r - u_r*u_r)"),
    "drag.surge.sideslip": Damping("Xvv", "X_vv", "X", "v_r*v_r"),
    "friction.coulomb": Damping("Xfriction", "-F_c", "X", f"tanh(u_r*{1 / FRICTION_SPEED!r})"),
    "drag.sway.linear": Damping("Yv", "Y_v", "Y", "v_r"),
    "drag.sway.quadratic": Damping("Yvv", "Y_|v|v", "Y", "abs(v_r)*v_r"),
    "drag.sway.cubic": Damping("Yvvv", "Y_vvv", "Y", "v_r*v_r*v_r"),
    "drag.sway.yaw_rate": Damping("Yr", "Y_r", "Y", "r"),
    "drag.lift.sway": Damping("Yuv", "Y_|u|v", "Y", "abs(u_r)*v_r"),
    "drag.yaw.linear": Damping("Nr", "N_r", "N", "r"),
    "drag.yaw.quadratic": Damping("Nrr", "N_|r|r", "N", "abs(r)*r"),
    "drag.yaw.cubic": Damping("Nrrr", "N_rrr", "N", "r*r*r"),
}
USUAL: Final = ("drag.surge.linear", "drag.sway.linear", "drag.yaw.linear")
# Effects that keys of a thruster state and its formula holds.
FORMED: Final = ("thruster.deadband", "thruster.saturation", "thruster.reverse_loss", "thruster.advance_loss")


@dataclass(frozen=True)
class Formulas:
    """A model as named constants and lines.

    Attributes:
        constants: by name, in order.
        lines: from u, v, r, psi, n1, n2, ..., V_c and beta_c to M and the vector of X, Y, N.
        tables: knots and coefficients of the curve of a thruster, by its place from 1.
        says: ids of the numbers in them.
    """

    constants: Mapping[str, Number]
    lines: tuple[str, ...]
    tables: Mapping[int, tuple[list[float], list[list[float]]]]
    says: frozenset[str]


def formulas(model: Planar) -> Formulas:
    """Constants and lines of a model."""
    surge, sway, yaw = model.added
    x, y = model.centre
    constants = {
        "m": exact(model.mass, "kg"),
        "xg": exact(x, "m"),
        "yg": exact(y, "m"),
        "Iz": exact(model.rigid_about_origin.value, "kg m^2"),
        "Xudot": (-surge).called("X_udot"),
        "Yvdot": (-sway).called("Y_vdot"),
        "Nrdot": (-yaw).called("N_rdot"),
    }
    says = {"added_mass.munk", "drag.lift.yaw"}
    forces = {"X": ["tauX"], "Y": ["tauY"], "N": ["tauN"]}
    for id_, term in DAMPING.items():
        number = model.damping(id_)
        if number is None and id_ not in USUAL:
            continue
        constants[term.name] = exact(0.0, "", term.symbol) if number is None else (-number).called(term.symbol)
        forces[term.channel].append(f"{term.name}*{term.product}")
        says.add(id_)
    constants["Nuv"] = model.moment
    forces["N"].append("Nuv*u_r*v_r")
    blown = [model.numbers.get(f"wind.steady.{p}") for p in ("north", "east")]
    if blown[0] is not None and blown[1] is not None:
        constants |= {"windN": blown[0], "windE": blown[1]}
        forces["X"].append("windN*cos(psi) + windE*sin(psi)")
        forces["Y"].append("windE*cos(psi) - windN*sin(psi)")
        says |= {"wind.steady.north", "wind.steady.east"}
    lines, tables, told = _thrusts(model)
    return Formulas(
        constants,
        (
            "u_c = V_c*cos(beta_c - psi)",
            "v_c = V_c*sin(beta_c - psi)",
            "u_r = u - u_c",
            "v_r = v - v_c",
            *lines,
            "CX = -(m - Yvdot)*v_r*r - m*xg*r*r",
            "CY = (m - Xudot)*u_r*r - m*yg*r*r",
            "CN = (Xudot - Yvdot)*u_r*v_r + m*xg*u_r*r + m*yg*v_r*r",
            *(f"{k} = {' + '.join(parts)} - C{k}" for k, parts in forces.items()),
        ),
        tables,
        frozenset(says | told | {"current.steady.north", "current.steady.east"}),
    )


def _thrusts(model: Planar) -> tuple[list[str], dict[int, tuple[list[float], list[list[float]]]], set[str]]:
    lines: list[str] = []
    tables: dict[int, tuple[list[float], list[list[float]]]] = {}
    says: set[str] = set()
    sums: dict[str, list[str]] = {"X": [], "Y": [], "N": []}
    for k, t in enumerate(model.vehicle.thrusters, start=1):
        curve = ThrustCurve(t)
        low, high = curve.range
        clipped = f"min(max(n{k}, {low!r}), {high!r})" if high < float("inf") else f"n{k}"
        lines.append(f"d{k} = {clipped} - {t.neutral!r}")
        if curve.pieces is not None:
            tables[k] = curve.pieces
            lines.append(f"T{k} = piecewise(d{k}, knots{k}, pieces{k})")
        else:
            lines.append(f"T{k} = {_curve(t, f'd{k}')}")
        px, py = t.position
        c, s = axis(t.azimuth)
        held = {id_: model.of_thruster(id_, t.name) for id_ in FORMED}
        says |= {n for id_ in FORMED for n in (id_, f"{id_}.{t.name}") if n in model.numbers}
        band, cap, loss, slip = (held[id_] for id_ in FORMED)
        if band is not None:
            lines.append(f"T{k} = T{k}*(abs(d{k}) >= {band.value!r})")
        if cap is not None:
            lines.append(f"T{k} = min(max(T{k}, {-cap.value!r}), {cap.value!r})")
        if loss is not None:
            lines.append(f"T{k} = T{k}*(1 - {loss.value!r}*(T{k} < 0))")
        if slip is not None:
            lines.append(f"T{k} = T{k} - abs(T{k})*((u_r - r*{py!r})*{c!r} + (v_r + r*{px!r})*{s!r})*{slip.value!r}")
        for channel, factor in (("X", c), ("Y", s), ("N", s * px - c * py)):
            sums[channel].append(f"T{k}*{factor!r}" if factor >= 0 else f"T{k}*({factor!r})")
    lines += [f"tau{channel} = {' + '.join(parts) or '0'}" for channel, parts in sums.items()]
    return lines, tables, says


def _curve(t: Thruster, d: str) -> str:
    """A curve without a table as an expression of the demand from its neutral."""
    if t.quadratic is not None:
        ahead, astern = t.quadratic.forward, t.quadratic.astern
        return f"({ahead!r}*({d} > 0) + {astern!r}*({d} < 0))*{d}*abs({d})"
    found = "0"
    for c in t.polynomial if t.polynomial is not None else (t.gain or 0.0, 0.0):
        found = f"({found})*{d} + ({c!r})"
    return found


def current(model: Planar) -> tuple[Number, Number]:
    """North and east of the steady current [m/s]; 0 where the model has none."""
    return model.get("current.steady.north", "m/s"), model.get("current.steady.east", "m/s")
