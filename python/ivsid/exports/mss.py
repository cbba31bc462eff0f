"""MSS: a function of MATLAB as its vessels are, with the state x = [u v w p q r x y z phi theta psi]' and shaft demands n.

Source: MSS, VESSELS/otter.m; docs/export.md.
"""

from __future__ import annotations

import keyword
import math
import re
from typing import Final

from ivsid.exports.formulas import current, formulas
from ivsid.exports.planar import Planar
from ivsid.exports.target import INERTIA, Body, Target, steering_sentences

# Words of MATLAB and Python, and names that the files use themselves.
# Source: definition: MATLAB, iskeyword; Python, keyword
WORDS: Final = frozenset(
    [
        "break",
        "case",
        "catch",
        "classdef",
        "continue",
        "else",
        "elseif",
        "end",
        "for",
        "function",
        "global",
        "if",
        "otherwise",
        "parfor",
        "persistent",
        "return",
        "spmd",
        "switch",
        "try",
        "while",
        "piecewise",
        "np",
        "sin",
        "cos",
        "tanh",
    ]
) | frozenset(keyword.kwlist)


def name_of(model: Planar) -> str:
    """The vehicle's name as an identifier of MATLAB and of Python."""
    plain = re.sub(r"\W+", "_", model.vehicle.name.lower(), flags=re.ASCII).strip("_")
    return plain if plain[:1].isalpha() and plain not in WORDS else f"vessel_{plain}"


def write(model: Planar) -> Body:
    """The body of a function file."""
    f = formulas(model)
    north, east = current(model)
    lines = [
        f"function [xdot,U] = {name_of(model)}(x,n,V_c,beta_c)",
        f"% [xdot,U] = {name_of(model)}(x,n,V_c,beta_c) in surge, sway and yaw; other rates are 0.",
        "% x = [u v w p q r x y z phi theta psi]', n: demands of the thrusters in the file's order, V_c, beta_c: current (m/s, rad).",
        *(f"%   n({k}): {t.name}" for k, t in enumerate(model.vehicle.thrusters, start=1)),
        f"if nargin < 4, V_c = {math.hypot(north.value, east.value)!r}; beta_c = {math.atan2(east.value, north.value)!r}; end "
        f"% north {north.words}; east {east.words}",
        "",
        *(f"{k} = {v.value!r}; % {v.words}" for k, v in f.constants.items()),
    ]
    for k, (knots, pieces) in f.tables.items():
        # Pieces of different degree get leading zeros.
        longest = max(map(len, pieces))
        rows = "; ".join(" ".join(repr(c) for c in ([0.0] * (longest - len(p)) + list(p))) for p in pieces)
        lines += [f"knots{k} = [{' '.join(map(repr, knots))}];", f"pieces{k} = [{rows}];"]
    lines += [
        "",
        "u = x(1); v = x(2); r = x(6); psi = x(12);",
        *(f"n{k} = n({k});" for k in range(1, len(model.vehicle.thrusters) + 1)),
        "U = sqrt(u*u + v*v);",
        "% equations",
        *(f"{line};" for line in f.lines),
        "% end of equations",
        "MRB = [m 0 -m*yg; 0 m m*xg; -m*yg m*xg Iz];",
        "MA = -diag([Xudot Yvdot Nrdot]);",
        "nu_r_dot = (MRB + MA) \\ [X; Y; N];",
        "xdot = zeros(12,1);",
        "xdot([1 2 6]) = nu_r_dot + [r*v_c; -r*u_c; 0];",
        "xdot([7 8 12]) = [u*cos(psi) - v*sin(psi); u*sin(psi) + v*cos(psi); r];",
        "end",
        "",
        "function T = piecewise(d, knots, pieces)",
        "% A polynomial between neighbouring knots, of the distance from the lower one.",
        "d = min(max(d, knots(1)), knots(end));",
        "k = min(find(knots <= d, 1, 'last'), size(pieces, 1));",
        "T = polyval(pieces(k,:), d - knots(k));",
        "end",
    ]
    return Body("\n".join(lines), f.says | INERTIA, steering_sentences(model))


TARGET: Final = Target("mss", "MSS (MATLAB)", lambda m: f"{name_of(m)}.m", write, ("%", ""))
