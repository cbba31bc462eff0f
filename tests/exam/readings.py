"""The examiner's own sensors: the effects on their readings, then noise as the vehicle file states it."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from tests.exam.simulator import Motion, Vessel, gauss_markov


def exact(motion: Motion, effects: Mapping[str, Mapping[str, float]]) -> dict[str, np.ndarray]:
    """Readings without noise: the delay acts first, then arms, misalignment, leak, scales and biases."""
    u, v, r, psi, x, y = motion.states.T
    udot, vdot, rdot = motion.after.T
    seen_u, seen_v, turning = u, v, r
    if p := effects.get("sensor.velocity.delay"):
        seen_u, seen_v, turning = earlier(motion, p[""])
    if p := effects.get("sensor.velocity.lever_arm"):
        seen_u, seen_v = seen_u - p["y"] * turning, seen_v + p["x"] * turning
    if p := effects.get("sensor.velocity.misalignment"):
        c, s = math.cos(p[""]), math.sin(p[""])
        seen_u, seen_v = c * seen_u + s * seen_v, c * seen_v - s * seen_u
    if p := effects.get("sensor.velocity.scale"):
        seen_u, seen_v = (1 + p[""]) * seen_u, (1 + p[""]) * seen_v
    ax, ay = udot - v * r, vdot + u * r
    if p := effects.get("sensor.acceleration.lever_arm"):
        ax, ay = ax - p["x"] * r**2 - p["y"] * rdot, ay - p["y"] * r**2 + p["x"] * rdot
    if p := effects.get("sensor.attitude_leak"):
        ax = ax + p[""] * motion.thrust
    if p := effects.get("sensor.acceleration.bias"):
        ax, ay = ax + p["x"], ay + p["y"]
    gyro = r * (1 + effects.get("sensor.yaw_rate.scale", {"": 0.0})[""])
    gyro = gyro + effects.get("sensor.yaw_rate.bias", {"": 0.0})[""]
    gyro = gyro + effects.get("x.gyro", {"": 0.0})[""] * ay
    if p := effects.get("x.late"):
        gyro = gyro + earlier(motion, p[""])[2] - r
    return {"u": seen_u, "v": seen_v, "r": gyro, "ax": ax, "ay": ay, "psi": psi, "x": x, "y": y}


def earlier(motion: Motion, delay: float) -> list[np.ndarray]:
    """u, v, r a time [s] earlier: Hermite's cubic between samples with the rates at both ends; at rest before the log."""
    h = motion.t[1] - motion.t[0]
    then = np.maximum(motion.t - delay, 0.0)
    k = np.minimum((then / h + 1e-9).astype(int), motion.t.size - 2)
    s = (then / h - k)[:, None]
    y0, y1 = motion.states[k, :3], motion.states[k + 1, :3]
    d0, d1 = h * motion.after[k], h * motion.before[k]
    cubic = y0 + s * d0 + s**2 * (3 * (y1 - y0) - 2 * d0 - d1) + s**3 * (2 * (y0 - y1) + d0 + d1)
    return list(cubic.T)


def within(reach: float, n: int, noise: str, rng: np.random.Generator) -> np.ndarray:
    """Errors inside a bound, shape (n,): a bell with its third deviation at the bound, redrawn beyond, or even."""
    if noise == "none":
        return np.zeros(n)
    if noise == "uniform":
        return reach * rng.uniform(-1, 1, n)
    draws = rng.standard_normal(n)
    while (beyond := np.abs(draws) > 3).any():
        draws[beyond] = rng.standard_normal(beyond.sum())
    return reach / 3 * draws


def inertial(sensor: Mapping[str, float], n: int, h: float, noise: str, rng: np.random.Generator) -> np.ndarray:
    """White noise of the stated random walk and a wandering bias, shape (n,)."""
    if noise == "none":
        return np.zeros(n)
    white = rng.standard_normal(n) if noise == "gaussian" else math.sqrt(3) * rng.uniform(-1, 1, n)
    wander = gauss_markov(n, h, sensor["bias_instability"], sensor.get("bias_time", 300.0), rng)
    return sensor["random_walk"] / math.sqrt(h) * white + wander


def log(
    vessel: Vessel,
    motion: Motion,
    clean: Mapping[str, np.ndarray],
    noise: str,
    rng: np.random.Generator,
    slow: tuple[float, Mapping[str, np.ndarray]] = (0.0, {}),
) -> dict[str, np.ndarray]:
    """The columns of a log; slow errors leave the noise the rest of each accuracy (tests/exam/sensor_errors.py)."""
    sensors, n, h = vessel.table["sensors"], motion.t.size, motion.t[1] - motion.t[0]
    reach = sensors["velocity"].get("scale_factor_error", 0.0)
    scale = 0.0 if noise == "none" else rng.uniform(-reach, reach)
    share, off = slow
    left = {s: (1 - share) * sensors[s]["accuracy"] for s in ("velocity", "heading", "position")}
    columns = {k: (1 + scale) * clean[k] + within(left["velocity"], n, noise, rng) for k in ("u", "v")}
    columns["r"] = clean["r"] + inertial(sensors["yaw_rate"], n, h, noise, rng)
    columns |= {k: clean[k] + inertial(sensors["acceleration"], n, h, noise, rng) for k in ("ax", "ay")}
    columns["psi"] = clean["psi"] + within(left["heading"], n, noise, rng)
    columns |= {k: clean[k] + within(left["position"], n, noise, rng) for k in ("x", "y")}
    columns |= {k: columns[k] + x for k, x in off.items()}
    for k, t in enumerate(vessel.thrusters):
        columns[f"demand_{t['name']}"] = motion.demands[:, k]
        if "rudder" in t or t.get("steering") == "azimuth":
            columns[f"{'rudder' if 'rudder' in t else 'azimuth'}_{t['name']}"] = motion.angles[:, k]
    return columns
