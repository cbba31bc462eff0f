"""Gain of the extended model on another log: the missing force, and simulated against measured motion, before and after.

Source: docs/theory.md, "Diagnosis"; for the bootstrap over windows Künsch, "The jackknife and the bootstrap for general stationary
observations", Annals of Statistics 17, 1989.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.statements.losses import gains, losses
from ivsid.diagnosis.statements.windows import RUNAWAY, windows
from ivsid.effects import CHANNELS

Array = NDArray[np.float64]
# Length of a window over which velocities are simulated [s].
# Source: definition: ``gain.windows`` of result.json
VELOCITY_WINDOW: Final = 10.0
# Length of a window over which positions are simulated [s].
# Source: definition: ``gain.windows`` of result.json
POSITION_WINDOW: Final = 30.0
# Cut-off of the low pass of forces [Hz]: the motion of the hull is slower, waves and the noise of differentiated velocities are faster.
# Source: measured: make constants
BAND: Final = 0.35
# Order of the low pass, a Butterworth filter that runs forward and backward.
# Source: measured: make constants
ORDER: Final = 4
# Length by which a row runs on beyond its ends, in periods of the cut-off.
# Source: geometry: a step has died away to 1e-4 behind so many periods of a filter of this order
REFLECTED: Final = 8.0
# Bootstrap draws: ten lie beyond each end of a 95 % interval.
# Source: resource: the time of the bootstrap grows with the draws
DRAWS: Final = 400
# Names of the missing forces.
# Source: definition: SNAME 1950
FORCES: Final = ("X", "Y", "N")
# Ends of a 95 % interval.
# Source: definition: equal tails of 2.5 %
ENDS: Final = (0.025, 0.975)

# Factor by which an error on the other log is larger where the model file is not handed out, whatever chance does.
# Source: definition: a quarter, as docs/guide.md says
GROWN: Final = 1.25


@dataclass(frozen=True)
class Gain:
    """Errors of the model before and after on one log.

    Attributes:
        force_rms: rms of the missing force before and after, by X, Y, N [N, N m].
        simulation_rms: median over windows of the rms error before and after, by u, v, r [m/s, rad/s].
        position_rms: median over windows of the rms distance before and after [m]; None without a position.
        interval: 95 % interval of the error before over the error after, by a bootstrap over windows, by u, v, r, position, X, Y, N; empty for
            a model that was not extended, and without u, v, r and position where one of the two diverges.
        residual: low-passed missing force before and after [N, N m], shape (2, 3, n).
        motion: simulated velocities before and after [m/s, rad/s], shape (2, 3, n), NaN outside windows.
        measured: measured velocities [m/s, rad/s], shape (3, n).
        time: of the samples [s], shape (n,).
        log: name of the log.
        net: low-passed mass times acceleration: measured, before and after [N, N m], shape (3, 3, n).
        losses: quantities in which the model after is worse than chance makes it, with the chance.
        gains: quantities in which it is better.
        diverges: times from which simulations before and after diverge [s], or None.
        extended: whether the model after is another one.
        noise: standard deviation of the white noise of measured u, v, r [m/s, rad/s], shape (3,).
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
    losses: dict[str, float]
    gains: dict[str, float]
    diverges: tuple[float | None, float | None]
    extended: bool
    noise: Array

    @property
    def factors(self) -> dict[str, tuple[float, float]]:
        """The intervals that may be said: none where a model diverges."""
        return {} if any(t is not None for t in self.diverges) else self.interval

    @property
    def errors(self) -> dict[str, tuple[float, float]]:
        """Errors before and after, by quantity: those of the simulation, then the missing forces."""
        place = {} if self.position_rms is None else {"position": self.position_rms}
        return {**self.simulation_rms, **place, **self.force_rms}

    @property
    def grown(self) -> tuple[str, ...]:
        """Quantities whose error is larger by ``GROWN`` with the model after, whether or not the log tells it from chance."""
        if any(t is not None for t in self.diverges):
            return ()
        return tuple(k for k, (before, after) in self.errors.items() if after > GROWN * before)

    def record(self) -> dict[str, object]:
        """The entry ``gain`` of result.json."""
        return {
            "force_rms": {k: list(v) for k, v in self.force_rms.items()},
            "simulation_rms": {k: list(v) for k, v in self.simulation_rms.items()},
            "position_rms": None if self.position_rms is None else list(self.position_rms),
            "windows": {"velocity": VELOCITY_WINDOW, "position": POSITION_WINDOW},
            "interval": {k: list(v) for k, v in self.factors.items()},
            "losses": self.losses,
            "gains": self.gains,
            "diverges": list(self.diverges),
            "extended": self.extended,
            "log": self.log,
        }


def compare(predictor: Predictor, before: Hypothesis, after: Hypothesis, seed: int = 0) -> Gain:
    """Errors of two hypotheses on a log, under its demands and on its clock.

    Args:
        predictor: of the log.
        before: the hypothesis of the vehicle file.
        after: the extended hypothesis.
        seed: of the bootstrap.
    """
    # An adequate model is simulated once.
    both = (before,) if after is before else (before, after)
    states_of = [predictor.settle(predictor.start(h), 2) for h in both]
    force = np.stack([missing(predictor, a) for a in states_of])[[0, -1]]
    placed = predictor.log.place is not None and predictor.log.psi is not None
    lengths = (VELOCITY_WINDOW, POSITION_WINDOW) if placed else (VELOCITY_WINDOW,)
    simulated = [windows(predictor, a, lengths) for a in states_of]
    velocity = [simulated[0][0], simulated[-1][0]]
    interval = {}
    rng = np.random.default_rng(seed)
    moved = {name: (velocity[0][1][:, k], velocity[-1][1][:, k]) for k, name in enumerate(("u", "v", "r"))}
    if placed and simulated[0][1][2].size:
        moved["position"] = (simulated[0][1][2], simulated[-1][1][2])
    diverges = (_first(simulated[0]), _first(simulated[-1]))
    extended = after is not before
    for name, (b, a) in moved.items() if extended and diverges == (None, None) else ():
        if not b.size:
            # Between lost rows no window is long enough.
            continue
        draws = rng.integers(0, b.size, (DRAWS, b.size))
        interval[name] = _middle(np.median(b[draws], axis=1), np.median(a[draws], axis=1))
    rms = {name: (_median(b), _median(a)) for name, (b, a) in moved.items()}
    position = rms.pop("position", None)
    pushed = _energies(force, predictor)
    if extended and np.isfinite(pushed).all():
        interval |= _force_interval(pushed, rng)
    size = np.sqrt(np.mean(force[:, :, predictor.log.good] ** 2, axis=2))
    forces = {n: (float(size[0, k]), float(size[1, k])) for k, n in enumerate(FORCES)}
    paired = {**moved, **{n: (np.sqrt(pushed[0, k]), np.sqrt(pushed[1, k])) for k, n in enumerate(FORCES)}}
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
        _net(predictor, states_of),
        losses(paired),
        gains(paired),
        diverges,
        extended,
        np.array([predictor.log.noise.get(name, 0.0) for name in ("u", "v", "r")]),
    )


def _first(simulated: Sequence[tuple[Array, Array, Array, Array]]) -> float | None:
    """The time from which simulations over windows of any length diverge [s], or None."""
    away = np.concatenate([w[3] for w in simulated])
    return float(np.nanmin(away)) if np.isfinite(away).any() else None


def _median(errors: Array) -> float:
    """Median over windows; none (NaN) where most of the windows run away."""
    middle = float(np.median(errors)) if errors.size else float("nan")
    return middle if middle < RUNAWAY else float("nan")


def _middle(before: Array, after: Array) -> tuple[float, float]:
    """Ends between which before over after lies in 95 % of the draws."""
    ratios = before / np.maximum(after, 1e-12)
    return float(np.quantile(ratios, ENDS[0])), float(np.quantile(ratios, ENDS[1]))


def _energies(force: Array, predictor: Predictor) -> Array:
    """Energies of the missing forces before and after in whole windows, shape (2, 3, windows)."""
    count = round(VELOCITY_WINDOW / predictor.log.h)
    blocks = predictor.log.n // count
    kept = np.where(predictor.log.good, force, 0.0)[:, :, : blocks * count]
    return np.asarray((kept**2).reshape(2, 3, blocks, count).sum(axis=3))


def _force_interval(energy: Array, rng: np.random.Generator) -> dict[str, tuple[float, float]]:
    """95 % intervals of before over after in the rms of the missing forces, by a bootstrap over whole windows."""
    blocks = energy.shape[2]
    if blocks < 2:
        return {}
    drawn = energy[:, :, rng.integers(0, blocks, (DRAWS, blocks))].sum(axis=3)
    return {n: _middle(*np.sqrt(drawn[:, k])) for k, n in enumerate(FORCES)}


def _net(predictor: Predictor, states_of: Sequence[FilteredStates]) -> Array:
    """Low-passed mass times acceleration: measured, of the first and of the last hypothesis, all with the masses of the last, shape (3, 3, n)."""
    mass = np.linalg.inv(predictor.mass(states_of[-1]).inverse).mean(axis=0)
    found = [_accelerations(predictor, a) for a in states_of]
    measured = found[-1][0]
    rows = [measured, found[0][0] - found[0][1], measured - found[-1][1]]
    return np.stack([low(predictor, mass @ x) for x in rows])


def low(predictor: Predictor, x: Array) -> Array:
    """Rows without all that is faster than the motion of the hull, without a shift in time, shape (k, n).

    A Butterworth low pass that runs forward and backward multiplies each frequency by its squared magnitude: with the bilinear transform
    1 / (1 + (tan(pi f h) / tan(pi f_c h))^(2 ORDER)). Beyond its ends a row runs on as its point reflection.

    Source: Oppenheim and Schafer, *Discrete-Time Signal Processing*, 2010, section 7.1.
    """
    h, n = predictor.log.h, x.shape[1]
    if BAND * h >= 0.5:
        # Samples so far apart hold nothing faster.
        return x
    beyond = min(n - 1, round(REFLECTED / (BAND * h)))
    ahead, behind = 2 * x[:, :1] - x[:, beyond:0:-1], 2 * x[:, -1:] - x[:, -2 : -beyond - 2 : -1]
    size = next_fast_len(n + 2 * beyond, real=True)
    spectrum = rfft(np.concatenate([ahead, x, behind], axis=1), size, axis=1)
    passed = 1.0 / (1.0 + (np.tan(np.pi * rfftfreq(size)) / np.tan(np.pi * BAND * h)) ** (2 * ORDER))
    return np.asarray(irfft(spectrum * passed, size, axis=1)[:, beyond : beyond + n])


def missing_force(predictor: Predictor, states: FilteredStates) -> dict[str, float]:
    """Rms of the low-passed force that a hypothesis lacks, by channel [N, N m]."""
    force = missing(predictor, states)[:, predictor.log.good]
    return dict(zip(CHANNELS, np.sqrt(np.mean(force**2, axis=1)).tolist(), strict=True))


def missing(predictor: Predictor, states: FilteredStates) -> Array:
    """Force that a hypothesis lacks, low-passed without a shift in time [N, N m], shape (3, n)."""
    mass = np.linalg.inv(predictor.mass(states).inverse)
    # A step of mass changes the force by little, so the mean of the masses serves.
    return low(predictor, mass.mean(axis=0) @ _accelerations(predictor, states)[1])


def _accelerations(predictor: Predictor, states: FilteredStates) -> tuple[Array, Array]:
    """Accelerations measured by the sensors of a hypothesis, and the part that the hypothesis does not explain, each of shape (3, n)."""
    n, log = predictor.log.n, predictor.log
    readings = predictor.readings(states)
    measured = np.stack([np.gradient(readings[k]["velocity"], log.h) for k in range(3)])
    mean = 0.5 * (states.nudot[:, n:] + np.concatenate([states.nudot[:, n : n + 1], states.nudot[:, n:-1]], 1))
    return measured, measured - mean
