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
from ivsid.files.processor import check_rounding
from ivsid.programme.manoeuvres import Programme
from ivsid.programme.scenario import Scenario, Start
from ivsid.simulation.equations import Plant, equations, plant, steps
from ivsid.simulation.integrate import Helm, Path, Pose, settle
from ivsid.simulation.propulsion import INSIDE, Propulsion
from ivsid.simulation.sensing import faulty, gauss_markov, noisy, sensed
from ivsid.simulation.steersman import Steersman
from ivsid.simulation.surroundings import readings, voltage_of, wind_of
from ivsid.simulation.true_thrust import TrueThrust
from ivsid.vehicle import Vehicle

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
    check_rounding()
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
    wind = wind_of(scenario, samples, np.random.default_rng([number, 1]))
    voltage = voltage_of(scenario, t)

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
    columns.update(readings(vehicle, scenario, t, wind, voltage, further))
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
    turned = angles or {}
    table, angle = (
        np.array([of.get(n, np.zeros(t.size)) for n in names], dtype=np.float64).reshape(len(names), t.size).T.tolist()
        for of in (demands, turned)
    )
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


def _commanded(vehicle: Vehicle, path: Path) -> dict[str, NDArray[np.float64]]:
    columns = {f"demand_{t.name}": path.demands[:, k] for k, t in enumerate(vehicle.thrusters)}
    for k, thruster in enumerate(vehicle.thrusters):
        if thruster.rudder is not None:
            columns[f"rudder_{thruster.name}"] = path.angles[:, k]
        elif thruster.steering == "azimuth":
            columns[f"azimuth_{thruster.name}"] = path.angles[:, k]
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
