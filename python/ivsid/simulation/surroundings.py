"""Wind and voltage of a scenario, and the columns of a log about the surroundings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.programme.scenario import Scenario
from ivsid.simulation.sensing import bounded, gauss_markov
from ivsid.vehicle import Vehicle


def wind_of(scenario: Scenario, n: int, rng: np.random.Generator) -> NDArray[np.float64]:
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


def voltage_of(scenario: Scenario, t: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The supply voltage [V], which falls steadily, of the shape of ``t``; None where the scenario has none."""
    where = scenario.environment
    return None if where.voltage is None else np.maximum(where.voltage - where.voltage_fall * t, 0.0)


def readings(
    vehicle: Vehicle,
    scenario: Scenario,
    t: NDArray[np.float64],
    wind: NDArray[np.float64],
    voltage: NDArray[np.float64] | None,
    rng: np.random.Generator,
) -> dict[str, NDArray[np.float64]]:
    """The columns of wind, depth and voltage that the scenario has, as their sensors read them."""
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
