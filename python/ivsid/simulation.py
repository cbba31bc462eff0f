"""Logs from a known truth: the equations of motion, the thrust curves with an error inside their accuracy, the sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ivsid.dynamics import Dynamics
from ivsid.effects import CATALOGUE, PAPER_TERMS, TYPICAL, Term, terms_of
from ivsid.errors import IvsidError
from ivsid.scenario import Scenario
from ivsid.sensors import count_errors, half_width, rule_for
from ivsid.thrust import ThrustCurve, directions
from ivsid.vehicle import InertialSensor, Thruster, Vehicle


@dataclass(frozen=True)
class Simulated:
    """A simulated log.

    Attributes:
        t: times [s], shape (n,).
        columns: the log as its sensors give it.
        truth: what is true: parameters, seed, noise, thrust and scale errors; for a file of its own.
        exact: the true channels, for tests.
    """

    t: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]
    truth: dict[str, Any]
    exact: dict[str, NDArray[np.float64]]


def simulate(
    vehicle: Vehicle, scenario: Scenario, seed: int | None = None, effects: Mapping[str, float] | None = None
) -> Simulated:
    """Runs a scenario.

    Args:
        vehicle: whose thrusters, sensors and model are simulated.
        scenario: manoeuvres and true values.
        seed: in place of the scenario's.
        effects: further terms of the catalogue with their values.

    Raises:
        IvsidError: unknown ids, missing values, or a vehicle without thrusters.
    """
    if not vehicle.thrusters:
        raise IvsidError("a vehicle without thrusters cannot be simulated; add [[thrusters]] to its file")
    number = scenario.seed if seed is None else seed
    rng = np.random.default_rng(number)
    values = {**scenario.truth, **(effects or {})}
    terms = _terms(vehicle, values)
    x_g, y_g = vehicle.hull.centre_of_gravity
    mass = vehicle.hull.mass
    model = Dynamics(terms, values, mass * x_g, mass * y_g)
    curves = [_TrueThrust(t, rng) for t in vehicle.thrusters]
    t, exact, demands = _run(vehicle, scenario, model, curves, rng)
    columns, sensor_truth = _sense(vehicle, scenario, t, exact, rng)
    columns.update({f"demand_{c.thruster.name}": d for c, d in zip(curves, demands, strict=True)})
    truth = {
        "parameters": {term.id: values[term.id] for term in terms},
        "effects": dict(effects or {}),
        "seed": number,
        "noise": scenario.noise,
        "sensors": sensor_truth,
        "thrust_error": {c.thruster.name: c.description for c in curves},
    }
    return Simulated(t, columns, truth, exact)


def hidden_effect(vehicle: Vehicle, seed: int) -> dict[str, float]:
    """An effect drawn from the seed: none in one of three, else a term that the model lacks at 0.1 to 3 times its typical size."""
    rng = np.random.default_rng([seed, 0x1D])
    absent = [i for i in TYPICAL if i not in {t.id for t in terms_of(vehicle)}]
    if rng.uniform() < 1 / 3 or not absent:
        return {}
    chosen = absent[int(rng.integers(len(absent)))]
    return {chosen: TYPICAL[chosen] * float(np.exp(rng.uniform(np.log(0.1), np.log(3.0))))}


def _terms(vehicle: Vehicle, values: Mapping[str, float]) -> tuple[Term, ...]:
    """The model's terms, and the catalogue's for every further value."""
    terms = {t.id: t for t in terms_of(vehicle)}
    shared = vehicle.model.terms == "paper"
    for id_ in values:
        if id_ in terms:
            continue
        if id_ not in CATALOGUE:
            raise IvsidError(f"'{id_}' is not simulated in this version; there are {', '.join(CATALOGUE)}")
        if shared and id_ in ("mass.sway", "drag.sway.quadratic"):
            # A value of its own ends the sharing of the paper's column.
            split = {"mass.sway": "mass.surge", "drag.sway.quadratic": "drag.surge.quadratic"}[id_]
            terms[split] = CATALOGUE[split]
        terms[id_] = CATALOGUE[id_]
    missing = [t.id for t in (PAPER_TERMS if shared else terms.values()) if t.id not in values]
    if missing:
        raise IvsidError(f"the scenario's [truth] has no value for {', '.join(missing)}; add it")
    return tuple(terms.values())


class _TrueThrust:
    """A thrust curve with a smooth error inside its accuracy, fixed for the log; no thrust has no error."""

    def __init__(self, thruster: Thruster, rng: np.random.Generator) -> None:
        self.thruster = thruster
        self.curve = ThrustCurve(thruster)
        self.phase, self.cycles, self.size = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 1.5), rng.uniform(0.2, 1.0)
        low, high = self.curve.range
        self.span = high - low if np.isfinite(high - low) else 1.0

    @property
    def description(self) -> dict[str, float]:
        return {"size": self.size, "cycles": self.cycles, "phase": self.phase}

    def __call__(self, demand: float) -> float:
        value = float(self.curve.value(demand))
        accuracy = self.thruster.accuracy
        bound = min(accuracy.absolute + accuracy.relative * abs(value), abs(value))
        return value + self.size * bound * float(np.sin(2 * np.pi * self.cycles * demand / self.span + self.phase))

    def clip(self, demand: float) -> float:
        """The demand inside the range of the curve, about its neutral."""
        low, high = self.curve.range
        return min(max(demand + self.thruster.neutral, low), high)


def _run(
    vehicle: Vehicle, scenario: Scenario, model: Dynamics, curves: list[_TrueThrust], rng: np.random.Generator
) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]], list[NDArray[np.float64]]]:
    """States and accelerations at every sample, and the demands; two Runge-Kutta steps a sample."""
    shares = [[float(s.midpoint) for s in directions(c.thruster)] for c in curves]
    turning = [np.sign(s[2]) if abs(s[2]) > 1e-12 else 0.0 for s in shares]
    h = 1.0 / scenario.rate
    ambient = _ambient(vehicle, round(scenario.duration * scenario.rate), h, rng)
    nu, psi, x, y = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0
    rows, demands = [], []
    for k, (common, differential, reference, gain, limit) in enumerate(scenario.commands(rng)):
        correction = min(max(gain * (reference - nu[2]), -limit), limit)
        demand = [c.clip(common + s * (differential + correction)) for c, s in zip(curves, turning, strict=True)]
        thrust = [c(d) for c, d in zip(curves, demand, strict=True)]
        force = tuple(ambient[k, j] + sum(t * s[j] for t, s in zip(thrust, shares, strict=True)) for j in range(3))
        rate = model.acceleration(nu, force)
        rows.append((*nu, *rate, psi, x, y))
        demands.append(demand)
        for _ in range(2):
            before = nu
            nu = model.step(nu, force, h / 2)
            psi_before, psi = psi, psi + h / 4 * (before[2] + nu[2])
            (xa, ya), (xb, yb) = _ground(before, psi_before), _ground(nu, psi)
            x, y = x + h / 4 * (xa + xb), y + h / 4 * (ya + yb)
    table = np.array(rows)
    if not np.isfinite(table).all():
        raise IvsidError("the simulated motion grows without bound; look at the true values and the demands")
    names = ("u", "v", "r", "udot", "vdot", "rdot", "psi", "x", "y")
    exact = {n: table[:, j] for j, n in enumerate(names)}
    exact["ax"] = exact["udot"] - exact["v"] * exact["r"]
    exact["ay"] = exact["vdot"] + exact["u"] * exact["r"]
    return np.arange(len(rows), dtype=np.float64) * h, exact, list(np.array(demands).T)


def _ground(nu: tuple[Any, Any, Any], psi: float) -> tuple[float, float]:
    c, s = np.cos(psi), np.sin(psi)
    return float(nu[0] * c - nu[1] * s), float(nu[0] * s + nu[1] * c)


def _ambient(vehicle: Vehicle, n: int, h: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Gauss-Markov force and moment of the stated rms and correlation time, shape (n, 3)."""
    if vehicle.ambient is None:
        return np.zeros((n, 3))
    a = vehicle.ambient
    return np.stack([gauss_markov(n, h, rms, a.time, rng) for rms in (a.force, a.force, a.moment)], axis=1)


def gauss_markov(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """A stationary first-order Gauss-Markov process, shape (n,)."""
    from scipy.signal import lfilter  # noqa: PLC0415 - slow to import, and only simulations need it

    decay = float(np.exp(-h / time))
    noise = rng.standard_normal(n) * deviation * np.sqrt(1 - decay**2)
    noise[0] = rng.standard_normal() * deviation
    return np.asarray(lfilter([1.0], [1.0, -decay], noise), dtype=np.float64)


def _sense(
    vehicle: Vehicle,
    scenario: Scenario,
    t: NDArray[np.float64],
    exact: dict[str, NDArray[np.float64]],
    rng: np.random.Generator,
) -> tuple[dict[str, NDArray[np.float64]], dict[str, Any]]:
    sensors, n, h = vehicle.sensors, t.size, 1.0 / scenario.rate
    quiet = scenario.noise == "none"
    columns: dict[str, NDArray[np.float64]] = {}
    truth: dict[str, Any] = {}
    if sensors.velocity is not None:
        e, sign = sensors.velocity.scale_factor_error, sensors.velocity.scale_factor_sign
        scale = 0.0 if quiet else rng.uniform(0.0 if sign > 0 else -e, 0.0 if sign < 0 else e)
        truth["velocity_scale"] = float(scale)
        for name in ("u", "v"):
            error = _bounded(sensors.velocity.accuracy, n, scenario.noise, rng)
            columns[name] = (1 + scale) * exact[name] + error
    inertial: list[tuple[str, InertialSensor | None, int]] = [("r", sensors.yaw_rate, 0)]
    inertial += [("ax", sensors.acceleration, 0), ("ay", sensors.acceleration, 1)]
    count = count_errors(n, [(s, a) for _, s, a in inertial if s is not None], vehicle)
    for name, sensor, axis in inertial:
        if sensor is None:
            continue
        if scenario.noise == "gaussian":
            walk = sensor.random_walk[axis] if isinstance(sensor.random_walk, tuple) else sensor.random_walk
            bias, time = sensor.axis(axis)
            error = rng.standard_normal(n) * walk / np.sqrt(h) + gauss_markov(n, h, bias, time, rng)
            error = error + np.cumsum(rng.standard_normal(n)) * sensor.rate_random_walk * np.sqrt(h)
            error = error + _bounded(sensor.accuracy, n, "gaussian", rng)
        else:
            reach = half_width(sensor, axis, h, rule_for(sensors, count), float(t[-1]))
            error = _bounded(float(reach), n, scenario.noise, rng)
        columns[name] = exact[name] + error
    for name, plain in (("psi", sensors.heading), ("x", sensors.position), ("y", sensors.position)):
        if plain is not None:
            columns[name] = exact[name] + _bounded(plain.accuracy, n, scenario.noise, rng)
    return columns, truth


def _bounded(reach: float, n: int, noise: str, rng: np.random.Generator) -> NDArray[np.float64]:
    """An error inside +-reach: uniform, or Gaussian with reach at three sigma and cut off there."""
    if noise == "none":
        return np.zeros(n)
    if noise == "uniform":
        return rng.uniform(-reach, reach, n)
    return np.clip(rng.standard_normal(n) * reach / 3, -reach, reach)
