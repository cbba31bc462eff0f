"""Sensors: geometry, delay, scale and bias of each, then noise, then lost and repeated samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Given, Reading, acting
from ivsid.effects.quantity import Quantity
from ivsid.programme.scenario import Faults, Scenario
from ivsid.sensors.noise import count_errors, half_width, rule_for
from ivsid.vehicle import InertialSensor, Vehicle

# Columns of the log by section of [sensors].
_COLUMNS: Final = {
    "velocity": ("u", "v"),
    "acceleration": ("ax", "ay"),
    "yaw_rate": ("r",),
    "yaw_acceleration": ("rdot",),
    "heading": ("psi",),
    "position": ("x", "y"),
}


def gauss_markov(n: int, h: float, deviation: float, time: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """A stationary first-order Gauss-Markov process, shape (n,).

    Args:
        n: samples.
        h: time between samples [s].
        deviation: standard deviation, in the unit of the result.
        time: correlation time [s].
        rng: source of the draws.
    """
    from scipy.signal import lfilter  # noqa: PLC0415 - slow to import, and only simulations need it

    decay = float(np.exp(-h / time))
    noise = rng.standard_normal(n) * deviation * np.sqrt(1 - decay**2)
    noise[0] = rng.standard_normal() * deviation
    return np.asarray(lfilter([1.0], [1.0, -decay], noise), dtype=np.float64)


def sensed(
    vehicle: Vehicle, t: NDArray[np.float64], exact: Mapping[str, NDArray[np.float64]], given: Sequence[Given]
) -> dict[str, NDArray[np.float64]]:
    """Readings without noise, by the names of ``exact``: averaged by sensors that average, then changed by the effects.

    Args:
        vehicle: its sensors and their mounting.
        t: times [s], shape (n,).
        exact: the true channels, each of shape (n,).
        given: the effects; those that change readings act in their order.
    """
    channels: dict[str, Quantity] = dict(exact)
    acceleration = vehicle.sensors.acceleration
    if acceleration is not None and acceleration.sampling == "averaged":
        channels.update(_averaged(t, exact))
    channels["r_v"] = channels["r_true"] = exact["r"]
    channels["at"] = _earlier(t, exact)
    for reading, numbers in sorted(acting(given, Reading), key=lambda q: q[0].order):
        channels.update(reading.function(channels, numbers))
    _mounted(vehicle, channels)
    return {name: channels[name] for name in exact}


def _mounted(vehicle: Vehicle, channels: dict[str, Quantity]) -> None:
    """Turns velocities and specific forces into those at the sensors' positions and in their axes, as the file mounts them."""
    r, rdot = channels["r_true"], channels["rdot"]
    for sensor, names in ((vehicle.sensors.velocity, ("u", "v")), (vehicle.sensors.acceleration, ("ax", "ay"))):
        if sensor is None or not (sensor.off_origin or sensor.turned):
            continue
        x, y = sensor.position
        first, second = (channels[n] for n in names)
        if names[0] == "u":
            first, second = first - y * r, second + x * r
        else:
            first, second = first - x * r * r - y * rdot, second + x * rdot - y * r * r
        c, s = np.cos(sensor.rotation), np.sin(sensor.rotation)
        channels[names[0]], channels[names[1]] = first * c + second * s, second * c - first * s


def _earlier(
    t: NDArray[np.float64], exact: Mapping[str, NDArray[np.float64]]
) -> Callable[[float], tuple[NDArray[np.float64], ...]]:
    """A function from a delay [s] to u, v, r at that earlier moment.

    Between two samples it is the parabola through both with the rate just after the first: rates jump at samples where demands do,
    so that a smooth interpolation across samples would be wrong. Before the log it is the first value.
    """

    def at(delay: float) -> tuple[NDArray[np.float64], ...]:
        then = t - delay
        k = np.clip(np.searchsorted(t, then, side="right") - 1, 0, t.size - 2)
        step, since = t[k + 1] - t[k], np.maximum(then - t[k], 0.0)
        found = []
        for name in ("u", "v", "r"):
            x, rate = exact[name], exact[f"{name}dot"]
            bend = (x[k + 1] - x[k] - rate[k] * step) / step**2
            found.append(x[k] + rate[k] * since + bend * since**2)
        return tuple(found)

    return at


def _averaged(t: NDArray[np.float64], exact: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Specific forces as means over the sample before each row; that of the first row is instantaneous."""
    u, v, r = exact["u"], exact["v"], exact["r"]
    h = np.diff(t)
    # The middle of each step on the parabola of ``_earlier``.
    middle = [
        x[:-1] + 0.25 * (d[:-1] * h + x[1:] - x[:-1])
        for x, d in ((u, exact["udot"]), (v, exact["vdot"]), (r, exact["rdot"]))
    ]
    means = {}
    for name, own, other, sign in (("ax", 0, 1, -1.0), ("ay", 1, 0, 1.0)):
        x = (u, v)[own]
        product = (u, v)[other] * r
        simpson = (product[:-1] + 4 * middle[other] * middle[2] + product[1:]) / 6
        means[name] = np.r_[exact[name][0], np.diff(x) / h + sign * simpson]
    return means


def noisy(
    vehicle: Vehicle,
    scenario: Scenario,
    t: NDArray[np.float64],
    exact: Mapping[str, NDArray[np.float64]],
    rng: np.random.Generator,
) -> tuple[dict[str, NDArray[np.float64]], dict[str, float]]:
    """The columns with the noise of the vehicle file, and the errors drawn once for the log, for the truth.

    Inertial sensors have white noise, a Gauss-Markov bias and a rate random walk; the others a scale error and an accuracy.

    Args:
        vehicle: its sensors.
        scenario: rate and kind of noise.
        t: times [s], shape (n,).
        exact: readings without noise, each of shape (n,).
        rng: source of the draws.
    """
    sensors, n, h = vehicle.sensors, t.size, 1.0 / scenario.rate
    quiet = scenario.noise == "none"
    columns: dict[str, NDArray[np.float64]] = {}
    truth: dict[str, float] = {}
    if sensors.velocity is not None:
        e, sign = sensors.velocity.scale_factor_error, sensors.velocity.scale_factor_sign
        scale = 0.0 if quiet else rng.uniform(0.0 if sign > 0 else -e, 0.0 if sign < 0 else e)
        truth["velocity_scale"] = float(scale)
        for name in ("u", "v"):
            error = bounded(sensors.velocity.accuracy, n, scenario.noise, rng)
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
            error = error + bounded(sensor.accuracy, n, "gaussian", rng)
        else:
            reach = half_width(sensor, axis, h, rule_for(sensors, count), float(t[-1]))
            error = bounded(float(reach), n, scenario.noise, rng)
        columns[name] = exact[name] + error
    plain = (
        ("psi", sensors.heading),
        ("x", sensors.position),
        ("y", sensors.position),
        ("rdot", sensors.yaw_acceleration),
    )
    if sensors.acceleration is not None and sensors.acceleration.gravity and sensors.attitude is not None:
        # The simulated vehicle is level, so that roll and pitch read their errors.
        for name in ("roll", "pitch"):
            columns[name] = bounded(sensors.attitude.accuracy, n, scenario.noise, rng)
    for name, section in plain:
        if section is not None:
            columns[name] = exact[name] + bounded(section.accuracy, n, scenario.noise, rng)
    return columns, truth


def bounded(reach: float, n: int, noise: str, rng: np.random.Generator) -> NDArray[np.float64]:
    """An error within +-reach, shape (n,): uniform, or Gaussian with ``reach`` at three sigma and clipped there, or none."""
    if noise == "none":
        return np.zeros(n)
    if noise == "uniform":
        return rng.uniform(-reach, reach, n)
    return np.clip(rng.standard_normal(n) * reach / 3, -reach, reach)


def faulty(columns: dict[str, NDArray[np.float64]], scenario: Scenario, rng: np.random.Generator) -> None:
    """Puts the scenario's faults on the columns, in place: repeated values of slower sensors, outliers, lost samples."""
    for sensor, names in _COLUMNS.items():
        faults: Faults | None = getattr(scenario.sensing, sensor)
        here = [n for n in names if n in columns]
        if faults is None or not here:
            continue
        n = columns[here[0]].size
        every = 1 if faults.period is None else max(1, round(min(faults.period * scenario.rate, float(n))))
        fresh = np.arange(n) // every * every
        wild = rng.uniform(size=n) < faults.outliers
        lost = _lost(n, faults, scenario.rate, rng)
        if not faults.hold:
            lost = lost | (fresh != np.arange(n))
        for name in here:
            reading = columns[name] + np.where(wild, rng.standard_normal(n) * faults.outlier_size, 0.0)
            reading = reading[fresh]
            columns[name] = np.where(lost, np.nan, reading)


def _lost(n: int, faults: Faults, rate: float, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Drop-outs whose lengths and distances are drawn from geometric distributions; the first sample is never lost."""
    lost = np.zeros(n, dtype=bool)
    if not faults.drop_outs:
        return lost
    out = max(1.0, faults.drop_out_time * rate)
    between = out * (1 - faults.drop_outs) / faults.drop_outs
    at = 1 + int(rng.geometric(min(1.0, 1 / between)))
    while at < n:
        length = int(rng.geometric(1 / out))
        lost[at : at + length] = True
        at += length + int(rng.geometric(min(1.0, 1 / between)))
    return lost
