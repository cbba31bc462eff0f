"""Simulation: equations of motion, thrust curves with an error within their accuracy, and sensors give a log."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Given, Reading, of_kind, sort_given, terms_of
from ivsid.effects.environment import STEADY_CURRENT
from ivsid.errors import IvsidError
from ivsid.programme.manoeuvres import Command, Programme
from ivsid.programme.scenario import Scenario, Start
from ivsid.simulation.equations import Plant, axis, equations, plant, steps
from ivsid.simulation.integrate import Helm, Path, Pose, settle
from ivsid.simulation.propulsion import INSIDE, Propulsion
from ivsid.simulation.sensing import bounded, faulty, gauss_markov, noisy, sensed
from ivsid.simulation.true_thrust import TrueThrust
from ivsid.vehicle import Thruster, Vehicle

# Time constants after which a lag has forgotten its past.
# Source: theorem: exp(-40) = 4e-18 lies below the rounding of float64
FORGOTTEN: Final = 40.0


@dataclass(frozen=True)
class Simulated:
    """A simulated log.

    Attributes:
        t: times [s], shape (n,).
        columns: the log by column, each of shape (n,).
        truth: parameters, effects, seed, noise, thrust and scale errors, as in truth.json.
        exact: the true channels, each of shape (n,).
    """

    t: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]
    truth: dict[str, Any]
    exact: dict[str, NDArray[np.float64]]


def simulate(
    vehicle: Vehicle,
    scenario: Scenario,
    seed: int | None = None,
    effects: Mapping[str, float] | None = None,
    *,
    thrusters: int | None = None,
) -> Simulated:
    """Runs a scenario.

    Args:
        vehicle: thrusters, sensors and model; numbers of its ``[model.fitted]`` are true where the scenario states none.
        scenario: manoeuvres and true values.
        seed: replaces the scenario's.
        effects: further numbers of the catalogue, by id, id.part, or id.NAME for one thruster.
        thrusters: seed of another log of the same thrusters, whose errors are static; by default this log has thrusters of its own.

    Raises:
        IvsidError: unknown ids, missing values, a vehicle without thrusters, or a motion that does not settle.
    """
    if not vehicle.thrusters:
        raise IvsidError("a vehicle without thrusters cannot be simulated; add [[thrusters]] to its file")
    number = scenario.seed if seed is None else seed
    rng = np.random.default_rng(number)
    given = sort_given(_numbers(vehicle, scenario, effects or {}), [t.name for t in vehicle.thrusters])
    model = plant(vehicle, terms_of(vehicle), given)
    _known_causes(scenario, given)
    # The errors of the thrusters are a generator's first numbers.
    curves = [TrueThrust(t, rng) for t in vehicle.thrusters]
    if thrusters is not None:
        same = np.random.default_rng(thrusters)
        curves = [TrueThrust(t, same) for t in vehicle.thrusters]
    samples, h = round(scenario.duration * scenario.rate), 1.0 / scenario.rate
    t = np.arange(samples, dtype=np.float64) * h
    ambient = _ambient(vehicle, samples, h, rng)
    programme = Programme(scenario.segments, samples, scenario.rate, rng)
    # Wind and faults draw from generators of their own, so that they do not change the noise that a seed gives.
    wind = _wind(scenario, samples, np.random.default_rng([number, 1]))
    voltage = _voltage(scenario, t)

    def make() -> tuple[Propulsion, Helm]:
        propulsion = Propulsion(model, curves)
        if voltage is not None:
            first, fall = voltage[0], scenario.environment.voltage_fall
            propulsion.supply(lambda time: max(1.0 - fall * time / first, 0.0))
        return propulsion, Steersman(vehicle, curves, programme, h)

    outside = np.hstack([ambient, wind])
    path = settle(equations(model), steps(model, INSIDE), make, t.tolist(), _pose(scenario.start), outside)
    exact = channels(path)
    columns, sensor_truth = noisy(vehicle, scenario, t, sensed(vehicle, t, exact, given), rng)
    further = np.random.default_rng([number, 2])
    faulty(columns, scenario, further)
    columns.update(_commanded(vehicle, path))
    columns.update(_surroundings(vehicle, scenario, t, wind, voltage, further))
    return Simulated(
        t, columns, _truth(model, given, scenario, number, effects or {}, curves, sensor_truth, path), exact
    )


def follow(
    vehicle: Vehicle,
    values: Mapping[str, float],
    t: NDArray[np.float64],
    demands: Mapping[str, NDArray[np.float64]],
    start: Start | None = None,
    angles: Mapping[str, NDArray[np.float64]] | None = None,
    force: NDArray[np.float64] | None = None,
    *,
    first: int = 0,
) -> dict[str, NDArray[np.float64]]:
    """The motion under known demands, such as those of a log on its own clock, without noise or thrust error.

    Args:
        vehicle: thrusters and model, with the numbers of its ``[model.fitted]``.
        values: true values by id or id.part, in place of those.
        t: times [s], increasing, shape (n,); effects of time count from the first.
        demands: by thruster, each held from its row to the next, shape (n,).
        start: the state at row ``first``; at rest at the origin by default.
        angles: of rudders and azimuth thrusters by name [rad], each of shape (n,); 0 by default.
        force: known X, Y [N], N [N m] beside the thrusters, each held from its row to the next, shape (n, 3).
        first: the row at which the motion begins; demands of earlier rows move the thrusters alone.

    Returns:
        u, v, r, udot, vdot, rdot, psi, x, y, ax, ay and thrust (the sum of the thrusts [N]), each of shape (n - first,).

    Raises:
        IvsidError: as ``simulate``, or a thruster without demands.
    """
    names = [q.name for q in vehicle.thrusters]
    missing = [n for n in names if n not in demands]
    if missing:
        raise IvsidError(f"no demands are given for thruster {', '.join(missing)}; each needs one for every row")
    given = sort_given({**vehicle.model.numbers, **values}, names)
    model = plant(vehicle, terms_of(vehicle), given)
    quiet = [
        TrueThrust(q.model_copy(update={"accuracy": type(q.accuracy)()}), np.random.default_rng(0))
        for q in vehicle.thrusters
    ]
    table = np.stack([np.asarray(demands[n], dtype=np.float64) for n in names], axis=1).tolist()
    turned = angles or {}
    angle = np.stack([np.asarray(turned.get(n, np.zeros(t.size)), dtype=np.float64) for n in names], axis=1).tolist()
    since = (t - t[0]).tolist()

    def make() -> tuple[Propulsion, Helm]:
        propulsion = Propulsion(model, quiet)
        for k in range(_remembered(propulsion, since, first), first):
            propulsion.demand(since[k], table[k])
            propulsion.advance(since[k], since[k + 1])
        return propulsion, lambda k, _state: (table[first + k], angle[first + k])

    outside = np.hstack([np.zeros((t.size, 3)) if force is None else force, np.zeros((t.size, 2))])
    path = settle(equations(model), steps(model, INSIDE), make, since[first:], _pose(start or Start()), outside[first:])
    return channels(path)


def _remembered(propulsion: Propulsion, since: list[float], first: int) -> int:
    """The earliest row whose demand the thrusters still feel at row ``first``."""
    reach = FORGOTTEN * max(propulsion.lags, default=0.0) + max(propulsion.delays, default=0.0)
    return max(bisect_right(since, since[first] - reach) - 1, 0)


def channels(path: Path) -> dict[str, NDArray[np.float64]]:
    """The channels of a motion by the log's names, and ``thrust`` [N], each of shape (n,)."""
    exact = {n: path.states[:, j] for j, n in enumerate(("u", "v", "r"))}
    exact |= {n: path.rates[:, j] for j, n in enumerate(("udot", "vdot", "rdot"))}
    exact |= {n: path.states[:, j] for j, n in enumerate(("psi", "x", "y"), start=3)}
    exact["ax"] = exact["udot"] - exact["v"] * exact["r"]
    exact["ay"] = exact["vdot"] + exact["u"] * exact["r"]
    exact["thrust"] = path.thrust
    return exact


class Steersman:
    """A helm that follows a programme within the ranges and rates of the thrusters."""

    def __init__(self, vehicle: Vehicle, curves: list[TrueThrust], programme: Programme, step: float) -> None:
        self._curves, self._pilot = curves, programme.pilot()
        self._shares = [_shares(t) for t in vehicle.thrusters]
        self._kinds = [("rudder" if t.rudder is not None else t.steering) for t in vehicle.thrusters]
        self._steers = any(k != "fixed" for k in self._kinds)
        rates = [t.rudder.rate if t.rudder is not None else t.steering_rate for t in vehicle.thrusters]
        self._most = [float("inf") if q is None else q * step for q in rates]
        self._angles = [0.0 for _ in vehicle.thrusters]

    def __call__(self, k: int, state: Pose) -> tuple[list[float], list[float]]:
        """Demands of the thrusters and angles [rad] of rudders and azimuth thrusters from sample k on."""
        asked = self._pilot.command(k, state)
        surge, sway, turn = asked[:3]
        demands = [
            c.clip(a * surge + b * sway + t * turn) for c, (a, b, t) in zip(self._curves, self._shares, strict=True)
        ]
        if self._steers:
            # The motion keeps the list, so that it must be a new one.
            self._angles = [self._turned(j, asked) if kind != "fixed" else 0.0 for j, kind in enumerate(self._kinds)]
        return demands, self._angles

    def _turned(self, j: int, asked: Command) -> float:
        wanted = asked.rudder if self._kinds[j] == "rudder" else asked.azimuth
        now = self._angles[j]
        return now + min(max(wanted - now, -self._most[j]), self._most[j])


def _shares(thruster: Thruster) -> tuple[float, float, float]:
    """Signs of a thruster's force ahead and to starboard, and of its moment to starboard."""
    c, s = axis(0.0 if thruster.steering == "azimuth" else thruster.azimuth)
    x, y = thruster.position
    moment = x * s - y * c
    return tuple(0.0 if abs(q) <= 1e-12 else float(np.sign(q)) for q in (c, s, moment))  # type: ignore[return-value]


def _pose(start: Start) -> Pose:
    return start.u, start.v, start.r, start.psi, start.x, start.y


def _numbers(vehicle: Vehicle, scenario: Scenario, effects: Mapping[str, float]) -> dict[str, float]:
    values = {**vehicle.model.numbers, **scenario.truth, **effects}
    current = scenario.environment.current
    if current is not None:
        if any(k.startswith(f"{STEADY_CURRENT.id}.") for k in values):
            raise IvsidError(f"the current is given twice, in [environment] and as {STEADY_CURRENT.id}; leave one out")
        values |= dict(zip(STEADY_CURRENT.parts, current, strict=True))
    return values


def _known_causes(scenario: Scenario, given: tuple[Given, ...]) -> None:
    """Refuses an effect of a measured cause that the scenario lacks."""
    for g in given:
        if "wind_speed" in g.effect.needs and scenario.environment.wind_speed is None:
            raise IvsidError(
                f"{g.effect.parts[0]} multiplies the wind; give the scenario [environment] wind_speed [m/s]"
            )
        if "voltage" in g.effect.needs and scenario.environment.voltage is None:
            raise IvsidError(f"{g.effect.parts[0]} follows the voltage; give the scenario [environment] voltage [V]")


def _ambient(vehicle: Vehicle, n: int, h: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Gauss-Markov force and moment of the stated rms and correlation time, shape (n, 3)."""
    if vehicle.ambient is None:
        return np.zeros((n, 3))
    a = vehicle.ambient
    return np.stack([gauss_markov(n, h, rms, a.time, rng) for rms in (a.force, a.force, a.moment)], axis=1)


def _wind(scenario: Scenario, n: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """The air's velocity north and east [m/s], shape (n, 2)."""
    where = scenario.environment
    if where.wind_speed is None:
        return np.zeros((n, 2))
    speed = np.full(n, where.wind_speed)
    if where.wind_gust:
        speed = np.maximum(speed + gauss_markov(n, 1 / scenario.rate, where.wind_gust, where.wind_gust_time, rng), 0.0)
    # The stated direction is the one that the wind comes from.
    wind: NDArray[np.float64] = -np.outer(speed, [np.cos(where.wind_direction), np.sin(where.wind_direction)])
    return wind


def _voltage(scenario: Scenario, t: NDArray[np.float64]) -> NDArray[np.float64] | None:
    where = scenario.environment
    return None if where.voltage is None else np.maximum(where.voltage - where.voltage_fall * t, 0.0)


def _commanded(vehicle: Vehicle, path: Path) -> dict[str, NDArray[np.float64]]:
    columns = {f"demand_{t.name}": path.demands[:, k] for k, t in enumerate(vehicle.thrusters)}
    for k, thruster in enumerate(vehicle.thrusters):
        if thruster.rudder is not None:
            columns[f"rudder_{thruster.name}"] = path.angles[:, k]
        elif thruster.steering == "azimuth":
            columns[f"azimuth_{thruster.name}"] = path.angles[:, k]
    return columns


def _surroundings(
    vehicle: Vehicle,
    scenario: Scenario,
    t: NDArray[np.float64],
    wind: NDArray[np.float64],
    voltage: NDArray[np.float64] | None,
    rng: np.random.Generator,
) -> dict[str, NDArray[np.float64]]:
    columns: dict[str, NDArray[np.float64]] = {}
    where = scenario.environment
    if where.wind_speed is not None:
        accuracy = 0.0 if vehicle.sensors.wind is None else vehicle.sensors.wind.accuracy
        columns["wind_speed"] = np.maximum(np.hypot(*wind.T) + bounded(accuracy, t.size, scenario.noise, rng), 0.0)
        columns["wind_direction"] = np.full(t.size, where.wind_direction)
    if where.depth is not None:
        columns["depth"] = np.full(t.size, where.depth)
    if voltage is not None:
        columns["voltage"] = voltage
    return columns


def _truth(
    model: Plant,
    given: tuple[Given, ...],
    scenario: Scenario,
    seed: int,
    effects: Mapping[str, float],
    curves: list[TrueThrust],
    sensors: dict[str, float],
    path: Path,
) -> dict[str, Any]:
    parameters = {term.id: model.values[term.id] for term in model.terms}
    for g in given:
        if not g.effect.terms:
            parameters |= g.named
    error = dict(zip(("u", "v", "r"), path.error, strict=True))
    return {
        "parameters": parameters,
        "effects": dict(effects),
        "seed": seed,
        "noise": scenario.noise,
        "environment": scenario.environment.model_dump(exclude_none=True),
        "start": scenario.start.model_dump(),
        "sensors": sensors,
        "sensor_effects": [g.effect.id for g in of_kind(given, Reading)],
        "thrust_error": {c.thruster.name: c.description for c in curves},
        "integration": {"method": "Runge-Kutta of order 4", "steps_per_sample": path.steps, "error": error},
    }
