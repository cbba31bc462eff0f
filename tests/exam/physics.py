"""The examiner's own equations of motion in the plane: hull, water, wind, waves and a tether, written from the definitions in docs/effects.md.

M nudot_r + C(nu_r) nu_r + D(nu_r) nu_r = tau - M_RB a_c in the notation of Fossen (2011), with nu_r = (u_r, v_r, r) relative to the
water and a_c the acceleration of the water. Nothing of the package is imported, so that an error of its physics shows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

# Distance [m] from its anchor within which a tether loses its pull, and the speed [m/s] at which dry friction is nearly whole.
FADE = 0.05
STICK = 0.02


@dataclass
class Body:
    """The plain model: inertia with added mass, quadratic drag, and where the centre of gravity is.

    Attributes:
        mass: of the rigid body [kg].
        length: [m].
        x_g: ahead of the origin [m].
        y_g: to starboard [m].
        m_u: m - X_udot [kg].
        m_v: m - Y_vdot [kg].
        i_r: I_z - N_rdot [kg m^2].
        d_u: -X_|u|u [kg/m].
        d_v: -Y_|v|v [kg/m].
        more: further hull forces by id, which the model has beside the plain ones.
    """

    mass: float
    length: float
    x_g: float
    y_g: float
    m_u: float
    m_v: float
    i_r: float
    d_u: float
    d_v: float
    more: dict[str, float]


def accelerations(b: Body, u, v, r, force):
    """udot, vdot, rdot relative to the water, for floats or arrays: M^-1 (tau - C nu - D nu), with C of M's own entries."""
    mx, my = b.mass * b.x_g, b.mass * b.y_g
    X, Y, N = force
    X = X + b.m_v * v * r + mx * r * r - b.d_u * abs(u) * u
    Y = Y - b.m_u * u * r + my * r * r - b.d_v * abs(v) * v
    N = N - (mx * u + my * v) * r
    # The Schur complement of surge and sway in M = [[m_u, 0, -m y_g], [0, m_v, m x_g], [-m y_g, m x_g, I]].
    rdot = (N + my / b.m_u * X - mx / b.m_v * Y) / (b.i_r - my * my / b.m_u - mx * mx / b.m_v)
    return (X + my * rdot) / b.m_u, (Y - mx * rdot) / b.m_v, rdot


def strips(v: float, r: float, half: float) -> tuple[float, float]:
    """Cross-flow force and moment per unit coefficient: w|w| and x w|w| along the hull, w = v + x r.

    Each side of the point where w changes its sign is a polynomial of degree 3 at most, which Simpson's rule integrates exactly.
    """
    turn = min(max(-v / r, -half), half) if r else half
    force = moment = 0.0
    for low, high in ((-half, turn), (turn, half)):
        for x, weight in ((low, 1.0), ((low + high) / 2, 4.0), (high, 1.0)):
            w = v + x * r
            part = weight * (high - low) / 6 * w * abs(w)
            force += part
            moment += x * part
    return force, moment


# Forces X, Y [N] and moment N [N m] of a hull that moves with u, v, r through the water, by the number q of the effect.
HULL: dict[str, Callable] = {
    "drag.surge.linear": lambda q, u, v, r, b: (-q * u, 0.0, 0.0),
    "drag.surge.sideslip": lambda q, u, v, r, b: (-q * v * v, 0.0, 0.0),
    "drag.surge.astern": lambda q, u, v, r, b: (q * u * u if u < 0 else 0.0, 0.0, 0.0),
    "friction.coulomb": lambda q, u, v, r, b: (-q * math.tanh(u / STICK), 0.0, 0.0),
    "drag.surge.cubic": lambda q, u, v, r, b: (-q * u**3, 0.0, 0.0),
    "drag.sway.cubic": lambda q, u, v, r, b: (0.0, -q * v**3, 0.0),
    "drag.yaw.cubic": lambda q, u, v, r, b: (0.0, 0.0, -q * r**3),
    "drag.sway.linear": lambda q, u, v, r, b: (0.0, -q * v, 0.0),
    "drag.sway.yaw_rate": lambda q, u, v, r, b: (0.0, -q * r, 0.0),
    "drag.lift.sway": lambda q, u, v, r, b: (0.0, -q * abs(u) * v, 0.0),
    "drag.yaw.linear": lambda q, u, v, r, b: (0.0, 0.0, -q * r),
    "drag.yaw.quadratic": lambda q, u, v, r, b: (0.0, 0.0, -q * abs(r) * r),
    "drag.lift.yaw": lambda q, u, v, r, b: (0.0, 0.0, -q * u * v),
    "added_mass.munk": lambda q, u, v, r, b: (0.0, 0.0, -q * u * v),
    "drag.cross_flow": lambda q, u, v, r, b: (0.0, *(-q * k for k in strips(v, r, b.length / 2))),
    # Outside the catalogue. The place is not that of the hull alone: see PLACE.
    "x.cubic": lambda q, u, v, r, b: (-q * u**3, 0.0, 0.0),
    "x.torque": lambda q, u, v, r, b: (0.0, 0.0, q * u**3),
    "x.side": lambda q, u, v, r, b: (0.0, q * u * u, 0.0),
    "x.turning": lambda q, u, v, r, b: (-q * u * r * r, 0.0, 0.0),
    "x.skeg": lambda q, u, v, r, b: (0.0, 0.0, q * abs(u * v)),
    "x.hump": lambda q, u, v, r, b: (-q * wave_hump(u, b.length), 0.0, 0.0),
}


def wave_hump(u: float, length: float) -> float:
    """A hump of the wave resistance about the speed at which half a wave is as long as the hull, a third of it wide."""
    top = 0.3 * math.sqrt(9.81 * length)
    return math.copysign(math.exp(-(((abs(u) - top) / (top / 3)) ** 2)), u) - math.copysign(math.exp(-9.0), u)


def from_north(psi: float, north: float, east: float) -> tuple[float, float]:
    """Surge and sway of a vector over ground."""
    c, s = math.cos(psi), math.sin(psi)
    return c * north + s * east, c * east - s * north


def wind(p: Mapping[str, float], t, u, psi, x, y):
    return (*from_north(psi, p["north"], p["east"]), 0.0)


def wave(p: Mapping[str, float], t, u, psi, x, y):
    size = p["amplitude"] * math.sin(2 * math.pi * t / p["period"] + p["phase"])
    return (*from_north(psi, size * math.cos(p["direction"]), size * math.sin(p["direction"])), 0.0)


def tether(p: Mapping[str, float], t, u, psi, x, y):
    north, east = p["anchor_north"] - x, p["anchor_east"] - y
    pull = p["force"] / math.sqrt(north * north + east * east + FADE * FADE)
    surge, sway = from_north(psi, pull * north, pull * east)
    return surge, sway, p["arm"] * sway


def hump(p: Mapping[str, float], t, u, psi, x, y):
    """A drag of the size ``height`` at ``speed``, ahead and astern, which falls off as the square of a hyperbolic secant."""
    ahead, astern = ((u - sign * p["speed"]) / p["width"] for sign in (1, -1))
    return p["height"] * (math.cosh(astern) ** -2 - math.cosh(ahead) ** -2), 0.0, 0.0


def shear(p: Mapping[str, float], t, u, psi, x, y):
    return p[""] * 0.02 * y * u, 0.0, 0.0


def windage(p: Mapping[str, float], t, u, psi, x, y):
    """The yaw moment of a wind from the north on a hull that is as long fore as aft: it vanishes ahead, abeam and astern."""
    return 0.0, 0.0, p[""] * math.sin(2 * psi)


def house(p: Mapping[str, float], t, u, psi, x, y):
    """The bend that a deck house leaves in the wind's force ahead, beyond what a cosine of the heading holds."""
    return p[""] * math.cos(3 * psi), 0.0, 0.0


# Forces that depend on time, heading and place, by the effect's numbers.
PLACE: dict[str, Callable] = {
    "wind.steady": wind,
    "wave.force": wave,
    "tether.tension": tether,
    "drag.surge.hump": hump,
    "x.shear": shear,
    "x.windage": windage,
    "x.house": house,
}


def water(effects: Mapping[str, Mapping[str, float]], t: float) -> tuple[float, float, float, float]:
    """The water's velocity north and east [m/s], and its acceleration."""
    north = east = north_rate = east_rate = 0.0
    if p := effects.get("current.steady"):
        north, east = p["north"], p["east"]
    if p := effects.get("current.oscillating"):
        w = 2 * math.pi / p["period"]
        size, rate = math.sin(w * t + p["phase"]), w * math.cos(w * t + p["phase"])
        north, east = north + size * p["north"], east + size * p["east"]
        north_rate, east_rate = rate * p["north"], rate * p["east"]
    return north, east, north_rate, east_rate


def changed(b: Body, effects: Mapping[str, Mapping[str, float]], t: float) -> Body:
    """The body at a time [s], with what alters its numbers."""
    given = {k: effects[k] for k in ("coupling.cg_x", "coupling.cg_y") if k in effects}
    values = dict(vars(b))
    if "coupling.cg_x" in given:
        values["x_g"] += given["coupling.cg_x"][""] / b.mass
    if "coupling.cg_y" in given:
        values["y_g"] += given["coupling.cg_y"][""] / b.mass
    if (p := effects.get("payload.step")) and t >= p["time"]:
        values["m_u"] += p["mass"]
        values["m_v"] += p["mass"]
    if p := effects.get("environment.shallow_water"):
        for k in ("m_u", "m_v", "d_u", "d_v"):
            values[k] *= p[""]
    if p := effects.get("fouling.drift"):
        values["d_u"] *= 1 + p[""] * t
    return Body(**values)


def rudder(blade: Mapping[str, float], angle, thrust, u, v, r, m=math):
    """X, Y [N] and N [N m] of a rudder behind a propeller; ``m`` is math for floats or numpy for arrays.

    Lift of a foil of small aspect ratio (Soeding) up to the stall, which then falls to 0 across the flow; friction, induced drag
    with a span efficiency of 0.9, and the drag of a plate beyond the stall; the slipstream of the momentum theory.
    """
    density, stall, least = 1025.0, 0.6, 0.02
    disc = math.pi / 4 * blade["propeller_diameter"] ** 2
    squared = u * abs(u) + (thrust + abs(thrust)) / (density * disc)
    along = m.copysign(m.sqrt(abs(squared)), squared)
    across = v + blade["position"] * r
    attack = angle + m.atan2(across, along)
    attack = attack - math.pi * (round(attack / math.pi) if m is math else m.round(attack / math.pi))
    a = blade["aspect_ratio"]
    slope = 2 * math.pi * a * (a + 0.7) / (a + 1.7) ** 2
    size = abs(attack)
    reached = min(size, stall) if m is math else m.minimum(size, stall)
    past = (size - reached) / (math.pi / 2 - stall)
    lift = m.copysign(slope * m.sin(reached) * m.cos(math.pi / 2 * past), attack)
    drag = least + (slope * m.sin(reached)) ** 2 / (0.9 * math.pi * a) + 1.2 * (m.sin(size) ** 2 - m.sin(reached) ** 2)
    pressure = 0.5 * density * blade["area"] * m.sqrt(along * along + across * across)
    Y = -pressure * (lift * along + drag * across)
    return pressure * (lift * across - drag * along), Y, blade["position"] * Y
