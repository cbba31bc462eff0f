"""The examiner's own simulator: thrusters, the classical Runge-Kutta method with fixed steps, and a record of the true motion.

It reads the text of a vehicle file and shares no code with the package but the helm (``ivsid.programme``), whose commands the log
holds: nothing that a diagnosis has to find rests on them. The ambient force is linear between samples, as it is held nowhere at sea.
"""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from tests.exam.physics import HULL, PLACE, Body, accelerations, changed, from_north, rudder, water
from tests.exam.tank import Tank
from tests.exam.thrust_curves import Curve, changed_thrust

from ivsid.programme.manoeuvres import Programme
from ivsid.programme.scenario import Scenario

# Longest step of the integration [s].
STEP = 0.05
# Share of a step by which its ends are looked at from inside.
INSIDE = 1e-9
# Effects that change a thrust at rest begin so.
THRUST = ("thruster.", "x.heat")
PLAIN = ("mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic")
KNOWN = ("name", "position", "azimuth", "table", "accuracy", "rudder", "steering")


@dataclass
class Motion:
    """A true motion.

    Attributes:
        t: times [s], shape (n,).
        states: u, v, r, psi, x, y at the samples, shape (n, 6).
        after: udot, vdot, rdot just after each sample, shape (n, 3).
        before: the same just before the next one, shape (n, 3).
        demands: of the thrusters, shape (n, k).
        angles: of rudders and azimuth thrusters [rad], shape (n, k).
        static: thrusts of the true curves without any effect [N], shape (n, k).
        thrust: sum of the thrusts that act [N], shape (n,).
        ambient: X, Y, N at the samples, shape (n, 3).
    """

    t: np.ndarray
    states: np.ndarray
    after: np.ndarray
    before: np.ndarray
    demands: np.ndarray
    angles: np.ndarray
    static: np.ndarray
    thrust: np.ndarray
    ambient: np.ndarray


@dataclass
class Vessel:
    """A vehicle file's text, read again, and the true numbers of its model; ``drift`` is the error of each thrust by the inflow, if there is one."""

    table: dict
    body: Body
    drift: tuple[Callable, ...] = ()

    @classmethod
    def read(cls, text: str, exact: Mapping[str, float]) -> Vessel:
        table = tomllib.loads(text)
        foreign = {k for t in table["thrusters"] for k in t} - set(KNOWN)
        assert not foreign, f"the examiner's simulator knows no {foreign}"
        hull = table["hull"]
        more = {k: v for k, v in exact.items() if k not in PLAIN}
        plain = [exact[k] for k in PLAIN]
        return cls(table, Body(hull["mass"], hull["length"], *hull.get("centre_of_gravity", (0.0, 0.0)), *plain, more))

    @property
    def thrusters(self) -> list[dict]:
        return self.table["thrusters"]

    def direction(self, k: int, angle, m=math):
        """Cosine and sine of a thruster's direction."""
        if self.thrusters[k].get("steering") == "azimuth":
            return m.cos(angle), m.sin(angle)
        a = self.thrusters[k].get("azimuth", 0.0)
        return math.cos(a), math.sin(a)

    def push(self, k: int, thrust, angle, u, v, r, loss: float = 0.0, m=math):
        """X, Y, N of a thruster and its rudder at a velocity through the water."""
        c, s = self.direction(k, angle, m)
        px, py = self.thrusters[k]["position"]
        if self.drift:
            thrust = thrust + self.drift[k](thrust, c * (u - py * r) + s * (v + px * r))
        thrust = thrust - loss * abs(thrust) * (c * (u - py * r) + s * (v + px * r))
        X, Y, N = c * thrust, s * thrust, (px * s - py * c) * thrust
        if blade := self.thrusters[k].get("rudder"):
            x, y, n = rudder(blade, angle, thrust, u, v, r, m)
            X, Y, N = X + x, Y + y, N + n
        return X, Y, N


def grouped(effects: Mapping[str, float], ids) -> dict[str, dict[str, float]]:
    """Numbers by effect and part; a part that is a thruster's name stays in the id."""
    out: dict[str, dict[str, float]] = {}
    for key, value in effects.items():
        id_, part = (key, "") if key in ids else key.rsplit(".", 1)
        if part and part not in ids[id_]:
            id_, part = key, ""
        out.setdefault(id_, {})[part] = value
    return out


def gauss_markov(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> np.ndarray:
    """Samples of a stationary first-order process, exact at the samples, shape (n,)."""
    memory = math.exp(-h / time)
    kicks = deviation * math.sqrt(1 - memory**2) * rng.standard_normal(n)
    kicks[0] = deviation * rng.standard_normal()
    return lfilter([1.0], [1.0, -memory], kicks)


def rates_of(vessel: Vessel, effects: Mapping[str, Mapping[str, float]], loss: list[float]) -> Callable:
    """The rates of u, v, r, psi, x, y at a time, under thrusts and angles and an ambient force with its slope since ``begin``."""
    count = len(vessel.thrusters)
    hull = [(HULL[i], p[""]) for i, p in effects.items() if i in HULL]
    hull += [(HULL[i], q) for i, q in vessel.body.more.items()]
    placed = [(PLACE[i], p) for i, p in effects.items() if i in PLACE]
    flows = any(i.startswith("current.") for i in effects)
    tunnel = effects.get("x.tunnel")
    turns = any(i in effects for i in ("payload.step", "fouling.drift"))
    body = changed(vessel.body, effects, 0.0)
    plain = [None if loss[k] or vessel.drift else _arms(vessel, k) for k in range(count)]

    def rates(t: float, s, pushes, angles, near, slope, begin) -> tuple[float, ...]:
        u, v, r, psi, x, y = s
        b = changed(vessel.body, effects, t) if turns else body
        uc = vc = au = av = 0.0
        if flows:
            north, east, north_rate, east_rate = water(effects, t)
            uc, vc = from_north(psi, north, east)
            au, av = from_north(psi, north_rate, east_rate)
        ur, vr = u - uc, v - vc
        past = t - begin
        X, Y, N = near[0] + slope[0] * past, near[1] + slope[1] * past, near[2] + slope[2] * past
        for function, q in hull:
            a, c, d = function(q, ur, vr, r, b)
            X, Y, N = X + a, Y + c, N + d
        for function, p in placed:
            a, c, d = function(p, t, ur, psi, x, y)
            X, Y, N = X + a, Y + c, N + d
        if tunnel:
            pushes, k = list(pushes), int(tunnel["thruster"])
            pushes[k] *= 1 + tunnel["loss"] * math.expm1(-((ur**2 + vr**2) / tunnel["pace"] ** 2))
        for k in range(count):
            if (arm := plain[k]) is not None:
                a, c, d = pushes[k] * arm[0], pushes[k] * arm[1], pushes[k] * arm[2]
            else:
                a, c, d = vessel.push(k, pushes[k], angles[k], ur, vr, r, loss[k])
            X, Y, N = X + a, Y + c, N + d
        if flows:
            # The rigid body is accelerated with the water.
            X, Y, N = (
                X - b.mass * au,
                Y - b.mass * av,
                N - vessel.body.mass * (vessel.body.x_g * av - vessel.body.y_g * au),
            )
        udot, vdot, rdot = accelerations(b, ur, vr, r, (X, Y, N))
        c, d = math.cos(psi), math.sin(psi)
        return udot + r * vc + au, vdot - r * uc + av, rdot, r, c * u - d * v, d * u + c * v

    return rates


def sail(
    vessel: Vessel,
    scenario: Scenario,
    effects: Mapping[str, Mapping[str, float]],
    curves: list[Curve],
    ambient: np.ndarray,
    rng: np.random.Generator,
) -> Motion:
    """The motion of a scenario.

    Args:
        vessel: its hull and thrusters.
        scenario: the commands, duration and rate.
        effects: numbers by effect and part.
        curves: the true curve of each thruster.
        ambient: X, Y, N at the samples, shape (n, 3).
        rng: of the programme's drawn signs.
    """
    n, h = len(ambient), 1 / scenario.rate
    pilot = Programme(scenario.segments, n, scenario.rate, rng).pilot()
    count = len(vessel.thrusters)
    lags, shafts, delays = (
        [_time(effects, f"thruster.{k}", t["name"]) for t in vessel.thrusters] for k in ("lag", "shaft_lag", "delay")
    )
    # What follows its goal late: the speed of a shaft, or else the thrust itself.
    late = [shaft or lag for shaft, lag in zip(shafts, lags, strict=True)]

    warm, warmth = effects.get("x.warm"), [0.0] * count
    cross, slew, lazy = (effects.get(i) for i in ("x.cross", "x.slew", "x.lazy"))
    followed, slow = [0.0] * count, 0.0

    def forces(now: list[float], moment: float) -> list[float]:
        if any(shafts):
            now = [
                _at_speed(vessel, acting, k, speed, curves, moment) if shafts[k] else speed
                for k, speed in enumerate(now)
            ]
        if warm:
            now = [x * (1 - warm["loss"] * q) for x, q in zip(now, warmth, strict=True)]
        if cross:
            # Each thruster but the first works in the wash of the one before it.
            washed = [0.0, *(cross["loss"] * abs(x) / curve.largest for x, curve in zip(now, curves, strict=True))]
            now = [x * (1 - q) for x, q in zip(now, washed[:count], strict=True)]
        return now

    loss = [_time(effects, "thruster.advance_loss", t["name"]) for t in vessel.thrusters]
    # What acts on a thrust at rest is asked for at every step.
    acting = {i: p for i, p in effects.items() if i.startswith(THRUST)}
    events = [effects[i]["time"] for i in ("payload.step", "thruster.failure") if i in effects]
    direct = not (acting or any(delays) or any(shafts))
    cut = any(events) or any(delays)
    mixed = [_signs(vessel, k) for k in range(count)]
    rates = rates_of(vessel, effects, loss)
    state = (0.0,) * 6

    def goals_at(moment: float) -> list[float]:
        if direct:
            return thrusts[-1]
        return [
            _asked(delays[k], asked, k, moment, h)
            if shafts[k]
            else _goal(vessel, acting, k, delays[k], asked, thrusts, curves, moment, h)
            for k in range(count)
        ]

    tank = Tank(**effects["x.slosh"]) if "x.slosh" in effects else None
    asked: list[list[float]] = []
    thrusts: list[list[float]] = []
    lagged = [0.0] * count
    out: dict[str, list] = {k: [] for k in ("states", "after", "before", "demands", "angles", "static", "thrust")}
    rows = ambient.tolist()
    for i in range(n):
        t = i * h
        command = pilot.command(i, state)
        demand = [
            min(max(a * command.surge + b * command.sway + c * command.turn, curve.low), curve.high)
            for (a, b, c), curve in zip(mixed, curves, strict=True)
        ]
        angle = [_angle(q, command) for q in vessel.thrusters]
        asked.append(demand)
        thrusts.append([curve(d) for curve, d in zip(curves, demand, strict=True)])
        near, far = rows[i], rows[min(i + 1, n - 1)]
        slope = [(b - a) / h for a, b in zip(near, far, strict=True)]
        if lazy:
            u = state[0]
            slow += (u - slow) * -math.expm1(-h / lazy["pace"])
            near = [near[0] - lazy["size"] * (slow * abs(slow) - u * abs(u)), *near[1:]]
        if tank:
            near = [near[0], near[1] + tank.pull(vessel.body.mass), near[2]]
        edges = [t, t + h]
        if cut:
            cuts = {t, t + h, *(e for e in events if t < e < t + h)}
            edges = sorted(cuts | {t + (d % h) for d in delays if d and 0 < d % h < h})
        for low, high in itertools.pairwise(edges):
            middle = (low + high) / 2
            goals = goals_at(middle)
            if slew:
                most = [curve.largest / slew["pace"] * h for curve in curves]
                if low == t:
                    steps = [min(max(g - q, -m), m) for g, q, m in zip(goals, followed, most, strict=True)]
                    followed = [q + x for q, x in zip(followed, steps, strict=True)]
                goals = followed
            if low == t:
                now = forces(_toward(goals, lagged, late, 0.0), middle)
                out["states"].append(state)
                out["after"].append(rates(t + INSIDE * h, state, now, angle, near, slope, t)[:3])
                out["thrust"].append(sum(now))
            steps = max(1, math.ceil((high - low) / STEP - 1e-9))
            step = (high - low) / steps
            for j in range(steps):
                way = [_toward(goals, lagged, late, share * step) for share in (0.0, 0.5, 1.0)]
                pushes = [forces(x, middle) for x in way]
                state = runge_kutta(rates, low + j * step, step, state, pushes, angle, near, slope, t)
                lagged = way[2]
        assert all(abs(q) < 1e9 for q in state), "the motion grows without bound"
        if tank:
            u, _, r = out["states"][-1][:3]
            tank.swing(out["after"][-1][1] + u * r, h)
        if warm:
            # A motor that gives half of its largest thrust all the time loses the whole share.
            heats = [(2 * x / curve.largest) ** 2 for x, curve in zip(lagged, curves, strict=True)]
            warmth = [q + (x - q) * h / warm["pace"] for q, x in zip(warmth, heats, strict=True)]
        out["before"].append(rates(t + h * (1 - INSIDE), state, forces(lagged, t + h), angle, near, slope, t)[:3])
        out["demands"].append(demand)
        out["angles"].append(angle)
        out["static"].append(thrusts[-1])
    return Motion(
        np.arange(n) * h,
        *(np.array(out[k]) for k in ("states", "after", "before", "demands", "angles", "static", "thrust")),
        ambient,
    )


def runge_kutta(rates, time: float, step: float, state, pushes, *held):
    """A step of the classical method; both ends are looked at from inside, because an event may stand there."""

    u, v, r, psi, x, y = state

    def moved(rate, share: float):
        a, b, c, d, e, f = rate
        q = share * step
        return u + q * a, v + q * b, r + q * c, psi + q * d, x + q * e, y + q * f

    k1 = rates(time + INSIDE * step, state, pushes[0], *held)
    k2 = rates(time + 0.5 * step, moved(k1, 0.5), pushes[1], *held)
    k3 = rates(time + 0.5 * step, moved(k2, 0.5), pushes[1], *held)
    k4 = rates(time + (1 - INSIDE) * step, moved(k3, 1.0), pushes[2], *held)
    return moved([(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)], 1.0)


def _toward(goals: list[float], now: list[float], lags: list[float], time: float) -> list[float]:
    """Thrusts a time [s] later: at their goals, or on their way with a first-order lag."""
    if not any(lags):
        return goals
    return [g if not lag else g + (a - g) * math.exp(-time / lag) for g, a, lag in zip(goals, now, lags, strict=True)]


def _time(effects, id_: str, name: str) -> float:
    return effects.get(f"{id_}.{name}", effects.get(id_, {"": 0.0}))[""]


def _arms(vessel: Vessel, k: int) -> tuple[float, float, float] | None:
    """Force and moment of a unit thrust; None for a thruster that turns or has a rudder."""
    t = vessel.thrusters[k]
    if "rudder" in t or t.get("steering") == "azimuth":
        return None
    c, s = vessel.direction(k, 0.0)
    x, y = t["position"]
    return c, s, x * s - y * c


def _signs(vessel: Vessel, k: int) -> tuple[float, float, float]:
    """Signs of a thruster's push ahead and to starboard, and of its moment."""
    c, s = vessel.direction(k, 0.0)
    x, y = vessel.thrusters[k]["position"]
    return tuple(0.0 if abs(q) < 1e-12 else math.copysign(1.0, q) for q in (c, s, x * s - y * c))


def _angle(thruster: dict, command) -> float:
    if "rudder" in thruster:
        return command.rudder
    return command.azimuth if thruster.get("steering") == "azimuth" else 0.0


def _asked(delay, asked, k, moment, h) -> float:
    """Demand that acts at a moment; none before the first one arrives."""
    i = math.floor((moment - delay) / h)
    return 0.0 if i < 0 else asked[min(i, len(asked) - 1)][k]


def _at_speed(vessel, effects, k, demand, curves, moment) -> float:
    """Thrust at rest of a shaft that turns as fast as a demand asks for."""
    t = vessel.thrusters[k]
    thrust = curves[k](demand)
    return changed_thrust(effects, t["name"], k, t["position"][1], demand, thrust, curves[k].largest, moment)


def _goal(vessel, effects, k, delay, asked, thrusts, curves, moment, h) -> float:
    """Thrust at rest of the demand that acts at a moment."""
    i = math.floor((moment - delay) / h)
    if i < 0:
        return 0.0
    i = min(i, len(asked) - 1)
    t = vessel.thrusters[k]
    return changed_thrust(
        effects, t["name"], k, t["position"][1], asked[i][k], thrusts[i][k], curves[k].largest, moment
    )
