"""Null logs: this log's programme run forward in time without any effect, many at once.

The fitted model moves under the log's demands and what feedback it has, an ambient force as strong and as slow as estimated, and errors of thrusts
and sensors drawn as they are declared; its sensors have the log's noise. It is stepped by Runge and Kutta's method in true states: of the
diagnosis it shares the physics' formulas, and neither rows nor filters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.null.feedback import Feedback
from ivsid.diagnosis.plant.physics import Hypothesis, Mass, acceleration
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# The clock of null logs is no faster [Hz], and no step of the motion longer [s].
FASTEST: Final = 10.0
LONGEST: Final = 0.1
# A thrust error is a wave of so many half turns over the range of demands, and of this share of its bound.
ORDERS: Final = (0.6, 3.0)
SIZES: Final = (0.2, 1.0)
# Entries of a thrust curve over the demands that were sent.
TABLE: Final = 4001
# Past so many times the largest speed of the log the model has lost the motion.
LOST: Final = 5.0


@dataclass(frozen=True)
class Programme:
    """What null logs are made from.

    Attributes:
        vehicle: of the file.
        log: on the clock of the null logs.
        h: the fitted model.
        ambient: as estimated.
        declared_errors: standard deviation of each declared error by its name.
        start: u, v, r at the first sample.
        feedback: of what is sent.
        reference: states that the logged demands answered to, shape (4, n).
    """

    vehicle: Vehicle
    log: Channels
    h: Hypothesis
    ambient: Ambient
    declared_errors: dict[str, float]
    start: Array
    feedback: Feedback
    reference: Array


def thinned(log: Channels) -> tuple[Channels, int]:
    """The log on a clock of 10 Hz at most, its white noise as that of means, and how many samples became one.

    Nothing of what null logs are asked is quicker: errors in the regressors, feedback, ambient force.
    """
    q = max(1, int(np.ceil(1.0 / (log.h * FASTEST) - 1e-6)))
    if q == 1:
        return log, 1
    n = log.n // q

    def means(x: Array) -> Array:
        return np.asarray(x[..., : n * q].reshape(*x.shape[:-1], n, q).mean(axis=-1))

    def firsts(x: Any) -> Any:
        return None if x is None else x[..., : n * q : q]

    sent = means if log.held else firsts
    # White noise of sensors that are read more rarely is as small as that of their means.
    noise = {k: s / np.sqrt(q) for k, s in log.noise.items()}
    ax, ay, rdot = (firsts(a) for a in log.acceleration)
    made = replace(
        log,
        h=log.h * q,
        t=firsts(log.t),
        nu=firsts(log.nu),
        acceleration=(ax, ay, rdot),
        psi=firsts(log.psi),
        place=firsts(log.place),
        demands=sent(log.demands),
        angles=sent(log.angles),
        rudders=sent(log.rudders),
        between=None,
        force=sent(log.force),
        wind=firsts(log.wind),
        voltage=firsts(log.voltage),
        depth=firsts(log.depth),
        good=np.asarray(log.good[: n * q].reshape(n, q).all(axis=1)),
        noise=noise,
    )
    return made, q


def null_logs(programme: Programme, seed: int, numbers: Sequence[int]) -> list[tuple[Channels, Hypothesis] | None]:
    """Logs of the model as it is, by number, with what is true of each: the same for the same seed, however many are made together.

    None where the motion does not stay near that of the log.
    """
    log, n, count = programme.log, programme.log.n, len(numbers)
    rngs = [np.random.default_rng([seed, k]) for k in numbers]
    drawn, errors = _declared(programme, rngs)
    pushed = np.stack([_ambient(programme.ambient, n, log.h, rng) for rng in rngs], axis=-1)
    noise = {name: np.stack([rng.standard_normal(n) * size for rng in rngs]) for name, size in log.noise.items()}
    states, rates, sent = _moved(programme, drawn, errors, pushed, noise)
    fastest = LOST * np.maximum(np.abs(log.nu).max(axis=1), 0.1)
    made: list[tuple[Channels, Hypothesis] | None] = []
    for j in range(count):
        nu = states[:3, :, j]
        if not np.isfinite(nu).all() or (np.abs(nu).max(axis=1) > fastest).any():
            made.append(None)
            continue
        read = _readings(log, states[..., j], rates[..., j], {k: x[j] for k, x in noise.items()}, _at(drawn, j))
        thrusters = len(log.demands)
        parts = sent[..., j]
        read = replace(
            read,
            demands=parts[:thrusters],
            rudders=parts[thrusters : 2 * thrusters],
            angles=parts[2 * thrusters :],
            between=None
            if log.between is None
            else replace(log.between, demands=log.between.demands + (parts[:thrusters] - log.demands)[:, :, None]),
        )
        made.append((read, replace(programme.h, declared_errors=_at(drawn, j))))
    return made


def _declared(programme: Programme, rngs: Sequence[np.random.Generator]) -> tuple[dict[str, Array], list[Array | None]]:
    """The size of each declared error in each log, and the thrust errors themselves, shape (count, TABLE) for each thruster.

    Sizes are normal, but a thrust error is any wave inside its bound: the declared waves stand for it as well as they can, and no better.
    """
    drawn = {
        name: np.array([rng.standard_normal() for rng in rngs]) * s for name, s in programme.declared_errors.items()
    }
    propulsion = Propulsion(programme.vehicle, programme.log)
    curves: list[Array | None] = []
    for k, thruster in enumerate(programme.vehicle.thrusters):
        names = [f"~thrust.{thruster.name}.{j}" for j in range(len(propulsion.errors[k]))]
        if not names or names[0] not in drawn:
            curves.append(None)
            continue
        sent = propulsion.demands[k]
        grid = np.linspace(sent.min(), sent.max() + 1e-9, TABLE)
        low, high = (end - thruster.neutral for end in propulsion.curves[k].range)
        if not np.isfinite(high - low):
            low, high = float(grid[0]), float(grid[-1])
        waves = np.stack([error(grid) for error in propulsion.errors[k]])
        # How often each demand was sent says where the waves have to fit.
        weight = np.sqrt(np.histogram(sent, np.r_[grid, grid[-1] + 1e-9])[0] / sent.size)
        inner = (waves * weight) @ (waves * weight).T
        inner += 1e-6 * max(float(np.trace(inner)), 1e-300) * np.eye(len(names))
        errors = np.empty((len(rngs), TABLE))
        for i, rng in enumerate(rngs):
            order, phase, size = rng.uniform(*ORDERS), rng.uniform(0, 2 * np.pi), rng.uniform(*SIZES)
            errors[i] = size * waves[0] * np.sin(np.pi * order * (grid - low) / (high - low) + phase)
        fitted = np.linalg.solve(inner, (waves * weight) @ (errors * weight).T)
        drawn |= dict(zip(names, fitted, strict=True))
        curves.append(errors)
    return drawn, curves


def _at(drawn: dict[str, Array], j: int) -> dict[str, float]:
    return {k: float(x[j]) for k, x in drawn.items()}


def _ambient(ambient: Ambient, n: int, h: float, rng: np.random.Generator) -> Array:
    """Accelerations over each step, shape (3, n)."""
    out = np.empty((3, n))
    for k, (deviation, time) in enumerate(zip(ambient.deviation, ambient.time, strict=True)):
        decay = float(np.exp(-h / time))
        noise = rng.standard_normal(n) * deviation * np.sqrt(1 - decay**2)
        noise[0] = rng.standard_normal() * deviation
        out[k] = lfilter([1.0], [1.0, -decay], noise)
    return out


class _Drives:
    """Thrusts of all logs from what is sent, step by step, with the lags that the file states."""

    def __init__(self, vehicle: Vehicle, log: Channels, errors: list[Array | None], count: int) -> None:
        self.vehicle, self.log, self.count = vehicle, log, count
        self.behind: list[Array | None] = [None for _ in vehicle.thrusters]
        propulsion = Propulsion(vehicle, log)
        self.low = log.demands.min(axis=1)
        self.pace = np.maximum(log.demands.max(axis=1) - self.low, 1e-9) / (TABLE - 1)
        self.row = np.arange(count)
        self.tables = []
        for k in range(len(vehicle.thrusters)):
            grid = self.low[k] + self.pace[k] * np.arange(TABLE)
            off = errors[k]
            rows = [None] * count if off is None else list(off)
            self.tables.append(np.stack([propulsion.static(k, grid, row) for row in rows]))

    def static(self, k: int, demand: Array) -> Array:
        """Thrust at a demand without any lag, shape (count,)."""
        place = np.clip((demand - self.low[k]) / self.pace[k], 0.0, TABLE - 1.000001)
        cell = place.astype(np.int64)
        table, share = self.tables[k], place - cell
        return np.asarray((1 - share) * table[self.row, cell] + share * table[self.row, cell + 1])

    def step(self, now: Array, later: Array, share: float) -> tuple[Array, Array, Array]:
        """Thrusts at the start, in the middle and at the end of a step of ``share`` samples, each of shape (thrusters, count)."""
        out = np.empty((3, len(self.behind), self.count))
        for k, thruster in enumerate(self.vehicle.thrusters):
            middle = 0.5 * (now[k] + later[k]) if later is not now else now[k]
            lag = thruster.time_constant or 0.0
            if lag <= 1e-6:
                out[:, k] = self.static(k, now[k])
                if later is not now:
                    out[1, k], out[2, k] = self.static(k, middle), self.static(k, later[k])
                continue
            decay = [float(np.exp(-part * share * self.log.h / lag)) for part in (0.5, 1.0)]
            of_demand = thruster.lag == "demand"
            goal = middle if of_demand else self.static(k, middle)
            known = self.behind[k]
            first = goal if known is None else known
            last = [goal + (first - goal) * d for d in decay]
            self.behind[k] = last[1]
            for part, x in enumerate((first, *last)):
                out[part, k] = self.static(k, x) if of_demand else x
        return out[0], out[1], out[2]


class _Motion:
    """The fitted model's rates of change, for all logs at once."""

    def __init__(self, programme: Programme, drawn: dict[str, Array], count: int) -> None:
        declared_errors: Any = {k: x for k, x in drawn.items() if k.startswith("~rudder.")}
        self.vehicle, self.log = programme.vehicle, programme.log
        self.h = replace(programme.h, declared_errors=declared_errors)
        self.mass = Mass(self.vehicle, self.h.terms, self.h.values)
        self.wide = np.zeros(count)
        self.thrusters = len(self.log.demands)

    def start(self, at: Array) -> Array:
        """u, v, r, psi, x, y of all logs at the first sample, shape (6, count)."""
        log = self.log
        x = np.zeros((6, self.wide.size))
        x[:3] = at[:, None]
        x[3] = 0.0 if log.psi is None else log.psi[0]
        if log.place is not None:
            x[4:] = log.place[:, :1]
        return x

    def rates(self, x: Array, push: Array, sent: Array, i: int, time: float) -> Array:
        """At states x under thrusts and what is sent, during the step after sample i, shape (6, count)."""
        log, m = self.log, self.thrusters
        p = Points(
            x[:3],
            x[3],
            x[4:],
            self.wide + time,
            push,
            sent[2 * m :],
            self.wide + log.force[:, i, None],
            None if log.wind is None else self.wide + log.wind[:, i, None],
            sent[m : 2 * m],
        )
        nudot = acceleration(self.vehicle, self.h, p, self.mass)
        c, s = np.cos(x[3]), np.sin(x[3])
        return np.concatenate([nudot, x[2:3], (x[0] * c - x[1] * s)[None], (x[0] * s + x[1] * c)[None]])


class _Helm:
    """What is sent: the log's own, and what the feedback adds where the motion is not the log's."""

    def __init__(self, programme: Programme, noise: dict[str, Array], count: int) -> None:
        log = programme.log
        self.logged = np.concatenate([log.demands, log.rudders, log.angles])
        self.back, self.reference, self.held = programme.feedback, programme.reference, log.held
        self.acting = self.back.at & np.any(self.back.feedback_gains != 0, axis=1, keepdims=True)
        none = np.zeros((count, log.n))
        self.noise = np.stack([noise.get(q, none) for q in ("u", "v", "r", "psi")])
        self.wide = np.zeros(count)

    def sent(self, x: Array, i: int) -> tuple[Array, Array]:
        """From sample i on, and at its end, shape (sent, count); the same array where it is held."""
        own = self.logged[:, i, None] + self.wide
        now = own
        if self.acting[:, i].any():
            felt = x[:4] - self.reference[:, i, None]
            if self.back.reads:
                felt = felt + self.noise[:, :, i]
            now = own + np.where(self.acting[:, i : i + 1], self.back.feedback_gains @ felt, 0.0)
            now = np.clip(now, self.back.lowest[:, None], self.back.highest[:, None])
        if self.held or i + 1 == self.logged.shape[1]:
            return now, now
        return now, self.logged[:, i + 1, None] + (now - own)


def _moved(
    programme: Programme, drawn: dict[str, Array], errors: list[Array | None], pushed: Array, noise: dict[str, Array]
) -> tuple[Array, Array, Array]:
    """States u, v, r, psi, x, y and rates at samples, shapes (6, n, count) and (3, n, count), and what was sent, shape (sent, n, count)."""
    log, n, count = programme.log, programme.log.n, pushed.shape[-1]
    drives, motion = _Drives(programme.vehicle, log, errors, count), _Motion(programme, drawn, count)
    helm = _Helm(programme, noise, count)
    parts = max(1, int(np.ceil(log.h / LONGEST - 1e-6)))
    step = log.h / parts
    x = motion.start(programme.start)
    states, rates = np.empty((6, n, count)), np.empty((3, n, count))
    sent = np.empty((len(helm.logged), n, count))
    ahead = np.zeros((6, count))
    with np.errstate(over="ignore", invalid="ignore"):
        for i in range(n):
            states[:, i] = x
            now, later = helm.sent(x, i)
            sent[:, i] = now
            ahead[:3] = pushed[:, i]
            for part in range(parts):
                first = last = middle = now
                if later is not now:
                    first, last = (now + (later - now) * (q / parts) for q in (part, part + 1))
                    middle = 0.5 * (first + last)
                push = drives.step(first, last, 1.0 / parts)
                time = float(log.t[i]) + (part + 0.5) * step
                k1 = motion.rates(x, push[0], middle, i, time) + ahead
                if not part:
                    rates[:, i] = k1[:3]
                k2 = motion.rates(x + 0.5 * step * k1, push[1], middle, i, time) + ahead
                k3 = motion.rates(x + 0.5 * step * k2, push[1], middle, i, time) + ahead
                k4 = motion.rates(x + step * k3, push[2], middle, i, time) + ahead
                x = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return states, rates, sent


def _readings(log: Channels, x: Array, nudot: Array, noise: dict[str, Array], drawn: dict[str, float]) -> Channels:
    """What the log's sensors read of a motion, with their noise and what they may be off."""
    n = log.n
    t = (np.arange(n) + 0.5) / n
    u, v, r = x[:3]

    def bias(name: str) -> Any:
        return sum(drawn.get(f"~bias.{name}.{j}", 0.0) * np.cos(np.pi * j * t) for j in range(3))

    scale = 1.0 + drawn.get("~scale.velocity", 0.0)
    specific = np.stack([nudot[0] - v * r, nudot[1] + u * r, nudot[2]])
    if log.averaged:
        # Means over the step before the row: the change of velocity, and Coriolis' part at its middle.
        cross = np.stack([-v * r, u * r, 0.0 * r])
        mean = np.diff(x[:3], axis=1) / log.h + 0.5 * (cross[:, 1:] + cross[:, :-1])
        specific = np.concatenate([specific[:, :1], mean], axis=1)
    a = tuple(
        None if log.acceleration[k] is None else specific[k] + bias(name) + noise[name]
        for k, name in enumerate(("ax", "ay", "rdot"))
    )
    return replace(
        log,
        nu=np.stack([scale * u + noise["u"], scale * v + noise["v"], r + bias("r") + noise["r"]]),
        acceleration=(a[0], a[1], a[2]),
        psi=None if log.psi is None else x[3] + noise["psi"],
        place=None if log.place is None else np.stack([x[4] + noise["x"], x[5] + noise["y"]]),
    )
