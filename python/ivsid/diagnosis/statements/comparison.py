"""Stage 11: what a hypothesis is worth on another log: force residuals, and simulated motion against measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from ivsid.diagnosis.plant.physics import Hypothesis, Mass, acceleration
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.effects import Change

Array = NDArray[np.float64]
VELOCITY_WINDOW: Final = 10.0
POSITION_WINDOW: Final = 30.0
BAND: Final = 0.35
DRAWS: Final = 400


@dataclass(frozen=True)
class Gain:
    """Before and after, on one log.

    Attributes:
        force_rms: by X, Y, N: [before, after] [N, N m].
        simulation_rms: by u, v, r: medians over windows [m/s, rad/s].
        position_rms: [m], or None without a place.
        interval: before/after of u, v, r, position, X, Y, N: 95 % of a bootstrap over windows (of 10 s for forces).
        residual: low-passed force residuals before and after, shape (2, 3, n), for figures.
        motion: simulated velocities before and after, shape (2, 3, n), NaN outside windows.
        measured: velocities, shape (3, n).
        time: [s], shape (n,).
        log: name of the log.
        net: low-passed mass times acceleration, measured, of the model before and of that after, shape (3, 3, n) [N, N m].
    """

    force_rms: dict[str, tuple[float, float]]
    simulation_rms: dict[str, tuple[float, float]]
    position_rms: tuple[float, float] | None
    interval: dict[str, tuple[float, float]]
    residual: Array
    motion: Array
    measured: Array
    time: Array
    log: str
    net: Array

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        return {
            "force_rms": {k: list(v) for k, v in self.force_rms.items()},
            "simulation_rms": {k: list(v) for k, v in self.simulation_rms.items()},
            "position_rms": None if self.position_rms is None else list(self.position_rms),
            "windows": {"velocity": VELOCITY_WINDOW, "position": POSITION_WINDOW},
            "interval": {k: list(v) for k, v in self.interval.items()},
            "log": self.log,
        }


def compare(predictor: Predictor, before: Hypothesis, after: Hypothesis, seed: int = 0) -> Gain:
    """Both hypotheses on the log of the bench, from its measured states, under its demands, on its own clock."""
    # What is adequate is simulated once.
    both = (before,) if after is before else (before, after)
    states_of = [predictor.settle(h, predictor.start(h), 2) for h in both]
    force = np.stack([missing(predictor, h, a) for h, a in zip(both, states_of, strict=True)])[[0, -1]]
    placed = predictor.log.place is not None and predictor.log.psi is not None
    lengths = (VELOCITY_WINDOW, POSITION_WINDOW) if placed else (VELOCITY_WINDOW,)
    windows = [_windows(predictor, h, a, lengths) for h, a in zip(both, states_of, strict=True)]
    velocity = [windows[0][0], windows[-1][0]]
    rms, interval = {}, {}
    rng = np.random.default_rng(seed)
    for k, name in enumerate(("u", "v", "r")):
        b, a = velocity[0][1][:, k], velocity[-1][1][:, k]
        rms[name] = (float(np.median(b)), float(np.median(a)))
        draws = rng.integers(0, max(b.size, 1), (DRAWS, max(b.size, 1)))
        interval[name] = _middle(np.median(b[draws], axis=1), np.median(a[draws], axis=1))
    position = None
    if placed:
        errors = [w[1][2] for w in windows]
        if errors[0].size:
            position = (float(np.median(errors[0])), float(np.median(errors[-1])))
            draws = rng.integers(0, errors[0].size, (DRAWS, errors[0].size))
            interval["position"] = _middle(np.median(errors[0][draws], axis=1), np.median(errors[-1][draws], axis=1))
    interval |= _force_interval(force, predictor, rng)
    size = np.sqrt(np.mean(force[:, :, predictor.log.good] ** 2, axis=2))
    forces = {n: (float(size[0, k]), float(size[1, k])) for k, n in enumerate(("X", "Y", "N"))}
    motion = np.stack([v[0] for v in velocity])
    return Gain(
        forces,
        rms,
        position,
        interval,
        force,
        motion,
        predictor.log.nu,
        predictor.log.t,
        predictor.log.name,
        _net(predictor, both, states_of),
    )


def _middle(before: Array, after: Array) -> tuple[float, float]:
    """Between which before/after lies in 95 % of the draws."""
    ratios = before / np.maximum(after, 1e-12)
    return float(np.quantile(ratios, 0.025)), float(np.quantile(ratios, 0.975))


def _force_interval(force: Array, predictor: Predictor, rng: np.random.Generator) -> dict[str, tuple[float, float]]:
    """Of before/after in the rms of the missing forces, whole windows drawn anew."""
    count = round(VELOCITY_WINDOW / predictor.log.h)
    blocks = predictor.log.n // count
    if blocks < 2:
        return {}
    kept = np.where(predictor.log.good, force, 0.0)[:, :, : blocks * count]
    energy = (kept**2).reshape(2, 3, blocks, count).sum(axis=3)
    drawn = energy[:, :, rng.integers(0, blocks, (DRAWS, blocks))].sum(axis=3)
    return {n: _middle(*np.sqrt(drawn[:, k])) for k, n in enumerate(("X", "Y", "N"))}


def _net(predictor: Predictor, both: Sequence[Hypothesis], states_of: Sequence[FilteredStates]) -> Array:
    """Mass times acceleration, low-passed: measured, of the first hypothesis and of the last, by the last's masses."""
    mass = np.linalg.inv(predictor.mass(both[-1], states_of[-1]).inverse).mean(axis=0)
    found = [_accelerations(predictor, h, a) for h, a in zip(both, states_of, strict=True)]
    measured = found[-1][0]
    rows = [measured, found[0][0] - found[0][1], measured - found[-1][1]]
    return np.stack([_low(predictor, mass @ x) for x in rows])


def _low(predictor: Predictor, x: Array) -> Array:
    """Low-passed without a shift in time."""
    sos = butter(4, BAND, fs=1 / predictor.log.h, output="sos")
    return np.asarray(sosfiltfilt(sos, x, axis=1))


def missing_force(predictor: Predictor, h: Hypothesis, states: FilteredStates) -> dict[str, float]:
    """Rms of the low-passed force that a hypothesis lacks, by channel [N, N m]."""
    force = missing(predictor, h, states)[:, predictor.log.good]
    return dict(zip(("surge", "sway", "yaw"), np.sqrt(np.mean(force**2, axis=1)).tolist(), strict=True))


def missing(predictor: Predictor, h: Hypothesis, states: FilteredStates) -> Array:
    """The force that a hypothesis lacks [N, N m], low-passed without a shift in time, shape (3, n)."""
    mass = np.linalg.inv(predictor.mass(h, states).inverse)
    # A step of mass is small beside what it multiplies here: its mean serves.
    return _low(predictor, mass.mean(axis=0) @ _accelerations(predictor, h, states)[1])


def _accelerations(predictor: Predictor, h: Hypothesis, states: FilteredStates) -> tuple[Array, Array]:
    """Measured accelerations as the hypothesis reads its sensors, and what of them it does not explain, shape (3, n)."""
    n, log = predictor.log.n, predictor.log
    readings = predictor.readings(h, states)
    measured = np.stack([np.gradient(readings[k]["velocity"], log.h) for k in range(3)])
    mean = 0.5 * (states.nudot[:, n:] + np.concatenate([states.nudot[:, n : n + 1], states.nudot[:, n:-1]], 1))
    return measured, measured - mean


def _windows(
    predictor: Predictor, h: Hypothesis, states: FilteredStates, lengths: Sequence[float]
) -> list[tuple[Array, Array, Array]]:
    """For each length of windows [s]: simulated u, v, r (NaN outside windows), their rms by window, and the rms distance of each window.

    All windows sail side by side; the shorter ones leave first.
    """
    log, n = predictor.log, predictor.log.n
    counts = [round(length / log.h) for length in lengths]
    starts = [np.arange(0, n - count, count) for count in counts]
    starts = [
        some[[bool(log.good[s : s + count + 1].all()) for s in some]]
        for some, count in zip(starts, counts, strict=True)
    ]
    out = _sailed(predictor, h, states, starts, counts)
    readings = predictor.readings(h, states)
    real = np.stack([readings[k]["velocity"] for k in range(3)])
    return [_held_against(predictor, real, *w) for w in zip(out, starts, counts, strict=True)]


def _sailed(
    predictor: Predictor,
    h: Hypothesis,
    states: FilteredStates,
    starts: Sequence[NDArray[np.int64]],
    counts: Sequence[int],
) -> list[Array]:
    """Simulated u, v, r, psi, x, y from the states at each start, for each group of starts: shape (count + 1, 6, starts)."""
    log, n = predictor.log, predictor.log.n
    thrusts, bollard = (x[:, n:] for x in predictor.driving.force(h))
    points = states.points
    place = np.zeros((2, n)) if log.place is None else log.place
    step = log.h
    # Masses that change in time, as with a payload, are worked out anew at each step.
    steady = not any(isinstance(g.effect.acts, Change) for g in h.given)
    mass = Mass(predictor.vehicle, h.terms, h.values) if steady else None

    def rates(x: Array, t: Array, at: NDArray[np.int64]) -> Array:
        p = Points(
            x[:3],
            x[3],
            x[4:],
            t,
            thrusts[:, at],
            predictor.driving.turned[:, n + at],
            predictor.driving.sent[:, n + at],
            None if log.wind is None else log.wind[:, at],
            predictor.driving.steered[:, n + at],
            bollard[:, at],
        )
        nudot = acceleration(predictor.vehicle, h, p, mass)
        c, s = np.cos(x[3]), np.sin(x[3])
        return np.concatenate([nudot, x[2:3], (x[0] * c - x[1] * s)[None], (x[0] * s + x[1] * c)[None]])

    order = np.argsort([-c for c in counts], kind="stable")
    begin = np.concatenate([starts[k] for k in order])
    state = np.concatenate([points.nu[:, begin], points.psi[None, begin], place[:, begin]])
    edges = np.cumsum([0, *(starts[k].size for k in order)])
    out = [np.empty((count + 1, 6, some.size)) for some, count in zip(starts, counts, strict=True)]
    with np.errstate(over="ignore", invalid="ignore"):
        for i in range(max(counts) + 1):
            for k, first, last in zip(order, edges, edges[1:], strict=False):
                if i <= counts[k]:
                    out[k][i] = state[:, first:last]
            # Those that last longer stand first.
            left = int(max((e for k, e in zip(order, edges[1:], strict=True) if counts[k] > i), default=0))
            state, at = state[:, :left], begin[:left] + i
            if not left:
                break
            t = log.t[at]
            k1 = rates(state, t, at)
            k2 = rates(state + 0.5 * step * k1, t + 0.5 * step, at)
            k3 = rates(state + 0.5 * step * k2, t + 0.5 * step, at)
            k4 = rates(state + step * k3, t + step, at)
            state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return out


def _held_against(
    predictor: Predictor, real: Array, out: Array, starts: NDArray[np.int64], count: int
) -> tuple[Array, Array, Array]:
    """Windows of one length against the measured motion."""
    log, n = predictor.log, predictor.log.n
    where = starts[None, :] + np.arange(count + 1)[:, None]
    error = np.nan_to_num(out[:, :3] - real[:, where].transpose(1, 0, 2), nan=1e3, posinf=1e3, neginf=-1e3)
    each = np.sqrt(np.mean(np.clip(error, -1e3, 1e3) ** 2, axis=0)).T
    shown = np.full((3, n), np.nan)
    shown[:, where.ravel()] = out[:, :3].transpose(1, 0, 2).reshape(3, -1)
    far = np.zeros(0)
    if log.place is not None:
        off = np.nan_to_num(out[:, 4:] - log.place[:, where].transpose(1, 0, 2), nan=1e3, posinf=1e3, neginf=-1e3)
        off = off - off[:1]
        far = np.sqrt(np.mean(np.clip(off, -1e3, 1e3) ** 2, axis=0).sum(axis=0))
    return shown, each, far


def shares(before: Gain) -> Mapping[str, float]:
    """Force residuals of the first hypothesis, by channel."""
    return {k: v[0] for k, v in before.force_rms.items()}


__all__ = ["Gain", "compare", "replace", "shares"]
