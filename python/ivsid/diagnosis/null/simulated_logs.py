"""Null logs of the parametric bootstrap: the log's own programme, simulated without any effect.

The fitted model runs forward in time under the logged demands and their feedback. The ambient force has the estimated strength and memory.
Errors of thrusts and sensors are drawn inside the declared bounds, and the readings carry the noise of the log's sensors. The simulation
shares the formulas of ``plant`` with the diagnosis, and neither its rows nor its filters.

Source: Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993, section 6.5 (parametric bootstrap).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.between import Between
from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.null.closed_loop import GRID_MARGIN, RATIO_ROUNDING, TABLE, Programme, ends, simulated
from ivsid.diagnosis.plant.declared_readings import declared, drawn_inside, slow_shapes
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.diagnosis.plant.thrust_errors import bound_of
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.linear.filters import decaying
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Lowest clock rate to which null logs are thinned [Hz]: ambient force, feedback and errors of the states all change within seconds.
# Source: resource: the time of a null log grows with its samples
SLOWEST: Final = 5.0
# The same where thrusts bend inside a step, under demands that are not held or lag behind: a prediction takes them in the middle of it [Hz].
# Source: resource: the time of a null log grows with its samples; at 5 Hz the errors of such steps are a quarter of a sensor's noise
SLOWEST_BENT: Final = 10.0
# Half waves of a thrust error over the range of demands: a calibration error is smooth.
# Source: geometry/physics: a measured thrust curve bends a few times over its range, and not more often.
ORDERS: Final = (0.6, 3.0)
# Corners of a broken line over the range of demands, at least and below.
# Source: geometry: the entries of a usual thrust table
PIECES: Final = (3, 10)
# Jumps of a curve over the range of demands, at least and below.
# Source: geometry: a drive switches once or a few times
JUMPS: Final = (1, 4)
# Teeth of a curve over the range of demands, at least and at most.
# Source: geometry: a coarse table that is read at its lower entry falls behind and catches up once an entry
TEETH: Final = (1.0, 8.0)
# Amplitude of a thrust error, as a share of its declared bound.
# Source: measured: make constants
SIZES: Final = (0.2, 1.0)
# A motion that exceeds the log's largest speed by this factor has left the programme.
# Source: measured: make constants
LOST: Final = 5.0
# Largest speed that is granted to an axis that hardly moves in the log [m/s, rad/s].
# Source: measured: make constants
LEAST_SPEED: Final = 0.1
# Ridge of the fit of waves to a thrust error, as a share of the sum of their squares; larger than that of a log's fit, since few demands leave
# waves undetermined, whose sizes have to stay near that of the error.
# Source: geometry: far above the rounding of doubles and far below the share of a wave that the demands tell apart
RIDGE: Final = 1e-6


def thinned(log: Channels, vehicle: Vehicle) -> tuple[Channels, int]:
    """A log on the clock of its null logs.

    Args:
        log: on its own clock.
        vehicle: whose log it is.

    Returns:
        The log at ``SLOWEST`` or less than twice as fast, unless it is slower itself, with the white noise of means over the samples that
        became one, and the number of these samples.
    """
    bent = not log.held or any(t.lag == "demand" and t.time_constant for t in vehicle.thrusters)
    q = max(1, int(1.0 / (log.h * (SLOWEST_BENT if bent else SLOWEST)) + RATIO_ROUNDING))
    # Null logs have the readings of a moment: a log of means gets the means of its demands as well.
    if q == 1 and (log.between is None or not log.between.apart):
        return log, 1
    n = log.n // q

    def means(x: Array) -> Array:
        return np.asarray(x[..., : n * q].reshape(*x.shape[:-1], n, q).mean(axis=-1))

    def firsts(x: Array) -> Array:
        return x[..., : n * q : q]

    def firsts_of(x: Array | None) -> Array | None:
        return None if x is None else firsts(x)

    sent: Callable[[Array], Array] = means if log.held else firsts
    between = log.between
    commands = (log.demands, log.angles, log.rudders)
    if between is not None:
        commands = tuple(x.mean(axis=2) for x in (between.demands, between.angles, between.rudders))
    demands, angles, rudders = (sent(x) for x in commands)
    # The thinned readings carry the white noise of their means.
    noise = {k: s / np.sqrt(q) for k, s in log.noise.items()}
    ax, ay, rdot = (firsts_of(a) for a in log.acceleration)
    made = replace(
        log,
        h=log.h * q,
        t=firsts(log.t),
        nu=firsts(log.nu),
        acceleration=(ax, ay, rdot),
        psi=firsts_of(log.psi),
        place=firsts_of(log.place),
        demands=demands,
        angles=angles,
        rudders=rudders,
        between=None,
        wind=firsts_of(log.wind),
        voltage=firsts_of(log.voltage),
        depth=firsts_of(log.depth),
        good=np.asarray(log.good[: n * q].reshape(n, q).all(axis=1)),
        noise=noise,
        # Null logs are made with the demands as they are held against them.
        lost=None,
    )
    return made, q


def null_logs(programme: Programme, seed: int, numbers: Sequence[int]) -> list[tuple[Channels, Hypothesis] | None]:
    """Null logs by number, each with the hypothesis that is true of it.

    A log depends on its seed and its number alone, and not on the logs that are simulated with it.

    Args:
        programme: of the log, with the fitted model.
        seed: of the draws.
        numbers: of the null logs.

    Returns:
        One entry for each number: the null log and its true hypothesis, or None where the motion leaves the programme.
    """
    log, n, count = programme.log, programme.log.n, len(numbers)
    rngs = [np.random.default_rng([seed, k]) for k in numbers]
    drawn, errors = _declared_errors(programme, rngs)
    pushed = np.stack([_ambient(programme.ambient, n, log.h, rng) for rng in rngs], axis=-1)
    noise = {name: np.stack([rng.standard_normal(n) * size for rng in rngs]) for name, size in log.noise.items()}
    states, rates, sent = simulated(programme, drawn, errors, pushed, noise)
    fastest = LOST * np.maximum(np.abs(log.nu).max(axis=1), LEAST_SPEED)
    made: list[tuple[Channels, Hypothesis] | None] = []
    for j in range(count):
        nu = states[:3, :, j]
        if not np.isfinite(nu).all() or (np.abs(nu).max(axis=1) > fastest).any():
            made.append(None)
            continue
        read = _readings(log, states[..., j], rates[..., j], {k: x[j] for k, x in noise.items()}, _at(drawn, j))
        demands, rudders, angles = np.split(sent[..., j], 3)
        between = None
        if log.between is not None:
            between = Between(
                log.between.demands + (demands - log.demands)[:, :, None],
                log.between.angles + (angles - log.angles)[:, :, None],
                log.between.rudders + (rudders - log.rudders)[:, :, None],
            )
        read = replace(read, demands=demands, rudders=rudders, angles=angles, between=between, running=False)
        made.append((read, replace(programme.h, declared_errors=_at(drawn, j))))
    return made


def _declared_errors(
    programme: Programme, rngs: Sequence[np.random.Generator]
) -> tuple[dict[str, Array], list[Array | None]]:
    """Declared errors of every null log.

    Errors of readings are anywhere inside their bound. A thrust error is a wave, a broken line, a few steps or teeth inside its bound, and the model of declared errors is fitted to it.

    Returns:
        Sizes by name, each of shape (count,), and thrust errors by thruster, each of shape (count, TABLE) or None.
    """
    inside = [drawn_inside(programme.vehicle, rng, earth=programme.log.earth) for rng in rngs]
    # An error without a bound of its own is normal.
    drawn = {
        name: np.array(
            [x[name] if name in x else prior * rng.standard_normal() for x, rng in zip(inside, rngs, strict=True)]
        )
        for name, prior in programme.declared_errors.items()
    }
    propulsion = Propulsion(programme.vehicle, programme.log)
    least, most = ends(programme)
    curves: list[Array | None] = []
    for k, thruster in enumerate(programme.vehicle.thrusters):
        count = len(propulsion.errors[k].knots)
        # A drawn curve is static: the functions of a hysteresis have no part in it.
        every = propulsion.errors[k].names(thruster.name)
        names = every[:count]
        if not names or names[0] not in drawn:
            curves.append(None)
            continue
        sent = propulsion.demands[k]
        grid = np.linspace(least[k] - thruster.neutral, most[k] - thruster.neutral + GRID_MARGIN, TABLE)
        low, high = (end - thruster.neutral for end in propulsion.curves[k].range)
        if not np.isfinite(high - low):
            low, high = float(grid[0]), float(grid[-1])
        waves = propulsion.errors[k].at(grid)[:count]
        bound = bound_of(thruster, propulsion.curves[k], grid)
        # The waves are fitted where demands were sent, weighted by how often.
        weight = np.sqrt(np.histogram(sent, np.r_[grid, grid[-1] + GRID_MARGIN])[0] / sent.size)
        inner = (waves * weight) @ (waves * weight).T
        inner += RIDGE * max(float(np.trace(inner)), 1e-300) * np.eye(len(names))
        errors = np.empty((len(rngs), TABLE))
        for i, rng in enumerate(rngs):
            errors[i] = rng.uniform(*SIZES) * bound * _shape((grid - low) / (high - low), rng)
        fitted = np.linalg.solve(inner, (waves * weight) @ (errors * weight).T)
        drawn |= dict(zip(names, fitted, strict=True)) | dict.fromkeys(every[count:], np.zeros(len(rngs)))
        curves.append(errors)
    return drawn, curves


def _shape(x: Array, rng: np.random.Generator) -> Array:
    """An error in units of its bound, over places from 0 to 1: one of four kinds that thrusters have.

    A calibration error is a wave; a table with wrong entries is a broken line; a worn or limited drive jumps; a coarse table, read at its
    lower entry, has teeth.
    """
    kind = int(rng.integers(4))
    if kind == 0:
        return np.asarray(np.sin(np.pi * rng.uniform(*ORDERS) * x + rng.uniform(0, 2 * np.pi)))
    if kind == 3:
        return np.asarray(rng.choice([-1.0, 1.0]) * (2.0 * np.mod(rng.uniform(*TEETH) * x + rng.uniform(), 1.0) - 1.0))
    places = np.sort(rng.uniform(0.0, 1.0, int(rng.integers(*(PIECES if kind == 1 else JUMPS)))))
    levels = rng.uniform(-1.0, 1.0, places.size + 1)
    levels /= np.abs(levels).max()
    if kind == 1:
        return np.asarray(np.interp(x, np.r_[0.0, places[1:], 1.0], levels))
    return np.asarray(levels[np.searchsorted(places, x)])


def _at(drawn: dict[str, Array], j: int) -> dict[str, float]:
    """Sizes of the declared errors in one null log."""
    return {k: float(x[j]) for k, x in drawn.items()}


def _ambient(ambient: Ambient, n: int, h: float, rng: np.random.Generator) -> Array:
    """Ambient accelerations over each step, a Gauss-Markov process in each axis, shape (3, n)."""
    out = np.empty((3, n))
    for k, (deviation, time) in enumerate(zip(ambient.deviation, ambient.time, strict=True)):
        decay = float(np.exp(-h / time))
        noise = rng.standard_normal(n) * deviation * np.sqrt(1 - decay**2)
        noise[0] = rng.standard_normal() * deviation
        out[k] = decaying(noise, decay)
    return out


def _readings(log: Channels, x: Array, nudot: Array, noise: dict[str, Array], drawn: dict[str, float]) -> Channels:
    """Readings of a simulated motion by the log's sensors, with their noise and their drawn errors."""
    n = log.n
    u, v, r = x[:3]

    # What a specific force has beyond the rate of its velocity; rates that are logged have none of it.
    cross = np.stack([-v * r, u * r, 0.0 * r])
    cross[np.flatnonzero(log.rates)] = 0.0
    specific = nudot[:3] + cross
    if log.averaged:
        # Means over the step before the row: the change of velocity, and Coriolis' part at its middle.
        mean = np.diff(x[:2], axis=1) / log.h + 0.5 * (cross[:2, 1:] + cross[:2, :-1])
        specific = np.concatenate([np.concatenate([specific[:2, :1], mean], axis=1), specific[2:]])
    exact = {"u": u, "v": v, "r": r, "ax": specific[0], "ay": specific[1], "rdot": nudot[2], "psi": x[3]}
    off = declared(drawn, exact, slow_shapes(n), earth=log.earth)
    a = tuple(
        None if log.acceleration[k] is None else specific[k] + off.get(name, 0.0) + noise[name]
        for k, name in enumerate(("ax", "ay", "rdot"))
    )
    return replace(
        log,
        nu=np.stack([x + off.get(q, 0.0) + noise[q] for q, x in zip(("u", "v", "r"), (u, v, r), strict=True)]),
        acceleration=(a[0], a[1], a[2]),
        psi=None if log.psi is None else x[3] + off.get("psi", 0.0) + noise["psi"],
        place=None
        if log.place is None
        else np.stack([x[4 + k] + off.get(q, 0.0) + noise[q] for k, q in enumerate("xy")]),
    )
