"""Vehicles and programmes of the examination, as the text of their files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SENSORS = """
[sensors]
confidence = 0.999
[sensors.velocity]
accuracy = 0.006
scale_factor_error = 0.004
[sensors.acceleration]
random_walk = 0.002
bias_instability = 3.0e-4
[sensors.yaw_rate]
random_walk = 1.745e-3
bias_instability = 2.0e-4
[sensors.heading]
accuracy = 0.015
[sensors.position]
accuracy = 0.5
[sensors.limits]
acceleration = 2.5
yaw_acceleration = 3.0
"""
KINDS = ("twin", "catamaran", "vectored", "tug", "rov", "steered", "azimuth")
BY_ANGLE = ("steered", "azimuth")


@dataclass(frozen=True)
class Conditions:
    """Conditions of a case that are given; all else follows from its seed.

    Attributes:
        style: of the programme.
        kind: of the vehicle, among ``KINDS``.
        ambient: force, as a multiple of the usual one.
        duration: of a log [s].
        rate: of its samples [Hz].
        noise: of the sensors.
        thrust: family of the thrust errors (tests/exam/thrust_errors.py), or ``none``.
        share: of the accuracy that these errors fill.
        sea: spectrum of the ambient force (tests/exam/seas.py); ``any`` draws one where nothing is hidden.
        sensors: errors of sensors beside their noise (tests/exam/sensor_errors.py); ``any`` draws them where nothing is hidden.
    """

    style: str | None = None
    kind: str | None = None
    ambient: float | None = None
    duration: float | None = None
    rate: float | None = None
    noise: str = "gaussian"
    thrust: str | None = None
    share: float | None = None
    sea: str = "markov"
    sensors: str = "white"


def vehicle_of(kind: str, rng: np.random.Generator) -> tuple[str, dict[str, float], float]:
    """Text of a vehicle file without its ambient force, its true numbers, and its scale of length."""
    spread = lambda: float(np.exp(rng.uniform(-0.4, 0.4)))  # noqa: E731
    arms = rng.uniform(0.2, 0.4)
    if kind == "twin":
        length, mass = 1.2, 50.0
    elif kind == "catamaran":
        length, mass = 2.0, 120.0
    elif kind == "vectored":
        length, mass = 0.8, 30.0
    elif kind == "rov":
        length, mass = 2.2, 1600.0
    elif kind in BY_ANGLE:
        length, mass = (1.4, 40.0) if kind == "steered" else (1.8, 90.0)
    else:
        length, mass = 3.0, 900.0
    scale = (mass / 50.0) ** (1 / 3)
    force = scale**3
    truth = {
        "mass.surge": mass * 1.16 * spread() ** 0.3,
        "mass.sway": mass * 1.5 * spread() ** 0.5,
        "inertia.yaw": 9.0 * scale**5 * spread() ** 0.7,
        "drag.surge.quadratic": 28.0 * scale**2 * spread(),
        "drag.sway.quadratic": 150.0 * scale**2 * spread(),
    }
    arm = arms * scale
    thrusters = []
    top, back = 40.0 * force, 30.0 * force
    accuracy = f"accuracy = {{ absolute = {0.1 * force:.4g}, relative = 0.02 }}"
    table = (
        f"table = {{ demand = [-100, -60, -30, 0, 30, 60, 100], "
        f"thrust = [{-back:.5g}, {-back * 0.47:.5g}, {-back * 0.17:.5g}, 0.0, {top * 0.15:.5g}, {top * 0.45:.5g}, {top:.5g}] }}"
    )
    more = {
        "steered": f"rudder = {{ area = {0.02 * scale**2:.5g}, aspect_ratio = 1.5, position = {-0.55 * scale:.4f}, propeller_diameter = {0.12 * scale:.4f} }}\n"
    }
    more["azimuth"] = 'steering = "azimuth"\n'
    if kind in ("vectored", "rov"):
        for name, x, y, a in (
            ("a", 0.25, -0.2, 0.6),
            ("b", 0.25, 0.2, -0.6),
            ("c", -0.25, -0.2, -0.6),
            ("d", -0.25, 0.2, 0.6),
        ):
            thrusters.append((name, x * scale, y * scale, a))
    elif kind == "tug":
        thrusters = [("port", -1.0, -arm, 0.0), ("starboard", -1.0, arm, 0.0), ("bow", 1.0, 0.0, 1.5707963267948966)]
    elif kind in BY_ANGLE:
        thrusters = [("screw", -0.5 * scale, 0.0, 0.0)]
    else:
        thrusters = [("port", -0.3 * scale, -arm, 0.0), ("starboard", -0.3 * scale, arm, 0.0)]
    text = f'name = "v"\n[hull]\nmass = {mass}\nlength = {length}\n'
    if rng.uniform() < 0.3:
        text += f"centre_of_gravity = [{rng.uniform(-0.05, 0.05) * length:.4f}, 0.0]\n"
    for name, x, y, a in thrusters:
        text += f'[[thrusters]]\nname = "{name}"\nposition = [{x:.4f}, {y:.4f}]\nazimuth = {a}\n{table}\n{accuracy}\n'
        text += more.get(kind, "")
    if kind == "azimuth":
        # Without damping, a thruster that is held aside spins the hull without end.
        truth |= {"drag.yaw.linear": 3.0 * scale**4.5 * spread(), "drag.yaw.quadratic": 4.0 * scale**5 * spread()}
        text += f"[model]\nterms = [{', '.join(repr(i) for i in truth)}]\n"
    return text + SENSORS, truth, scale


def programme(rng: np.random.Generator, duration: float, kind: str, scale: float, style: str) -> str:
    """Segments of a log, in TOML."""
    kinds = {
        "rich": ("steps", "zigzag", "circle", "prbs", "coast", "spiral", "chirp", "back"),
        "line": ("line",),
        "zigzag": ("zigzag",),
        "circle": ("circle",),
    }[style]
    time, rate = scale**0.5, scale**-0.5
    out, total = "", 0.0
    gain = float(25.0 / rate)
    while total < duration:
        k = str(rng.choice(kinds))
        if kind in BY_ANGLE:
            d = float(rng.uniform(25, 45)) * time
            total += d
            out += steered(rng, k, d, time)
            continue
        d, c = float(rng.uniform(20, 40)) * time, float(rng.uniform(25, 70))
        s: dict[str, object] = {}
        if k in ("steps", "line"):
            s = {"manoeuvre": "steps", "demand": rng.uniform(0 if k == "steps" else 20, 80, 4).round(1).tolist()}
            s |= {"period": float(rng.uniform(5, 10)) * time, "yaw_gain": gain}
        elif k == "zigzag":
            s = {"manoeuvre": "zigzag", "demand": c, "yaw_rate": float(rng.uniform(0.2, 0.6)) * rate, "yaw_gain": gain}
            s |= {"period": float(rng.uniform(4, 8)) * time, "differential_limit": 25.0}
        elif k == "circle":
            s = {"manoeuvre": "circle", "demand": c, "yaw_gain": gain, "differential_limit": 25.0}
            s |= {"yaw_rate": float(rng.choice([-1, 1]) * rng.uniform(0.15, 0.6)) * rate}
        elif k == "prbs":
            s = {"manoeuvre": "prbs", "demand": c, "amplitude": 15.0, "differential": 5.0, "yaw_gain": gain}
            s |= {"period": float(rng.uniform(1, 3)) * time, "differential_limit": 20.0}
        elif k == "coast":
            s, d = {"manoeuvre": "coast"}, 20.0 * time
        elif k == "spiral":
            s = {"manoeuvre": "spiral", "demand": c, "differential": [8.0, 4.0, 0.0, -4.0, -8.0], "yaw_gain": gain}
            s |= {"period": 6.0 * time}
        elif k == "back":
            s, d = {"manoeuvre": "steps", "demand": [-30.0, -50.0], "period": 6.0 * time, "yaw_gain": gain}, 12.0 * time
        else:
            s = {"manoeuvre": "chirp", "demand": c, "amplitude": 10.0, "period": 8.0 * time}
            s |= {"period_end": 1.5 * time, "yaw_gain": gain}
        if kind in ("vectored", "tug", "rov"):
            s["sway"] = float(rng.choice([0.0, 0.0, 30.0, -30.0]))
        s["duration"] = d
        total += d
        rows = "\n".join(f"{a} = {b!r}" if not isinstance(b, str) else f'{a} = "{b}"' for a, b in s.items())
        out += f"[[segments]]\n{rows}\n"
    return out


def steered(rng: np.random.Generator, k: str, duration: float, time: float) -> str:
    """A segment of a vehicle that turns by an angle: nothing is fed back but the heading of a zigzag."""
    c, angle = float(rng.uniform(30, 80)), float(rng.uniform(0.1, 0.35))
    sign = float(rng.choice([-1, 1]))
    s: dict[str, object] = {"demand": c, "rudder": angle * sign, "azimuth": angle * sign}
    if k in ("steps", "line", "back"):
        low, high = (-50.0, -20.0) if k == "back" else (15.0, 80.0)
        s |= {"manoeuvre": "steps", "demand": rng.uniform(low, high, 4).round(1).tolist()}
        s |= {"period": float(rng.uniform(5, 10)) * time, "rudder": 0.0, "azimuth": 0.0}
        duration = min(duration, 14.0 * time) if k == "back" else duration
    elif k == "zigzag":
        s |= {"manoeuvre": "heading_zigzag", "heading": float(rng.uniform(0.15, 0.5))}
    elif k == "circle":
        s |= {"manoeuvre": "steady"}
    elif k == "coast":
        s, duration = {"manoeuvre": "coast"}, 20.0 * time
    elif k == "spiral":
        s |= {"manoeuvre": "prbs", "amplitude": 5.0, "period": 8.0 * time}
    elif k == "prbs":
        s |= {"manoeuvre": "prbs", "amplitude": 15.0, "period": float(rng.uniform(2, 5)) * time}
    else:
        s |= {"manoeuvre": "chirp", "period": 12.0 * time, "period_end": 3.0 * time}
    s["duration"] = duration
    rows = "\n".join(f'{a} = "{b}"' if isinstance(b, str) else f"{a} = {b!r}" for a, b in s.items())
    return f"[[segments]]\n{rows}\n"
