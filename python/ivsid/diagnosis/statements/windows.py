"""Simulated motion against measured motion, over windows that restart from the filtered states.

All windows of all lengths are integrated together by the Runge-Kutta method of fourth order.

Source: Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, 1993, section II.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.plant.physics import Dynamics
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor

Array = NDArray[np.float64]
# Error that a simulation which runs away is given [m/s, rad/s, m].
# Source: definition: beyond any error of a simulation that stays with the vehicle
RUNAWAY: Final = 1e3
# Factor on the largest measured speed, and turn rate, beyond which a simulated one is no motion of the vessel.
# Source: physics: drag grows with the square of the speed, so that ten times the speed takes a hundred times the thrust
BEYOND: Final = 10.0
# Longest step of a free run [s].
# Source: geometry: below a third of the time in which a small hull loses its way
LONGEST_STEP: Final = 0.2


def windows(
    predictor: Predictor, states: FilteredStates, lengths: Sequence[float]
) -> list[tuple[Array, Array, Array, Array]]:
    """Simulations over windows of several lengths, from the filtered states and without feedback from the log.

    Args:
        predictor: of the log.
        states: of the hypothesis.
        lengths: of the windows [s].

    Returns:
        For each length: simulated u, v, r [m/s, rad/s], shape (3, n), NaN outside windows; rms error of u, v, r by window, shape
        (windows, 3); rms distance [m] by window, shape (windows,), empty without a position; the time at which each window's simulation is
        no longer finite, or beyond ``BEYOND`` times what the vessel did [s], shape (windows,), NaN where it stays.
    """
    log, n = predictor.log, predictor.log.n
    counts = [round(length / log.h) for length in lengths]
    starts = [np.arange(0, n - count, count) for count in counts]
    starts = [
        some[[bool(log.good[s : s + count + 1].all()) for s in some]]
        for some, count in zip(starts, counts, strict=True)
    ]
    out = _simulated(predictor, states, starts, counts)
    readings = predictor.readings(states)
    real = np.stack([readings[k]["velocity"] for k in range(3)])
    return [(*_against(predictor, real, *w), _left(predictor, real, *w)) for w in zip(out, starts, counts, strict=True)]


def drift(predictor: Predictor, states: FilteredStates, length: float, apart: float) -> Array:
    """Distance at the end of free runs [m], shape (runs,).

    Args:
        predictor: of a log with a position.
        states: of the hypothesis, from which the runs start.
        length: of a run [s].
        apart: time between two starts [s].
    """
    log = predictor.log
    assert log.place is not None
    count = round(length / log.h)
    starts = np.arange(0, log.n - count, max(1, round(apart / log.h)))
    starts = starts[[bool(log.good[s : s + count + 1].all()) for s in starts]]
    if not starts.size:
        return np.zeros(0)
    stride = max(1, int(LONGEST_STEP / log.h + 1e-9))
    count -= count % stride
    (out,) = _simulated(predictor, states, [starts], [count], stride)
    off = (out[-1, 4:] - out[0, 4:]) - (log.place[:, starts + count] - log.place[:, starts])
    return np.asarray(np.hypot(*np.clip(np.nan_to_num(off, nan=RUNAWAY), -RUNAWAY, RUNAWAY)))


def _simulated(
    predictor: Predictor,
    states: FilteredStates,
    starts: Sequence[NDArray[np.int64]],
    counts: Sequence[int],
    stride: int = 1,
) -> list[Array]:
    """Simulated u, v, r, psi, x, y from the states at each start, for each group of starts, each of shape (count / stride + 1, 6, starts).

    Steps of several samples take the mean thrust over the step.
    """
    log, n = predictor.log, predictor.log.n
    h, points = states.h, states.points
    thrusts, bollard = (x[:, n:] for x in predictor.driving.force(h))
    place = np.zeros((2, n)) if log.place is None else log.place
    step = stride * log.h
    if stride > 1:
        thrusts, bollard = (
            uniform_filter1d(x, stride, origin=-(stride // 2), mode="nearest") for x in (thrusts, bollard)
        )
    dynamics = Dynamics(predictor.vehicle, h)

    def rates(x: Array, t: Array, at: NDArray[np.int64]) -> Array:
        p = Points(
            x[:3],
            x[3],
            x[4:],
            t,
            thrusts[:, at],
            predictor.driving.turned[:, n + at],
            None if log.wind is None else log.wind[:, at],
            predictor.driving.steered[:, n + at],
            bollard[:, at],
        )
        nudot = dynamics.acceleration(p)
        c, s = np.cos(x[3]), np.sin(x[3])
        return np.concatenate([nudot, x[2:3], (x[0] * c - x[1] * s)[None], (x[0] * s + x[1] * c)[None]])

    order = np.argsort([-c for c in counts], kind="stable")
    begin = np.concatenate([starts[k] for k in order])
    state = np.concatenate([points.nu[:, begin], points.psi[None, begin], place[:, begin]])
    edges = np.cumsum([0, *(starts[k].size for k in order)])
    counts = [count // stride for count in counts]
    out = [np.empty((count + 1, 6, some.size)) for some, count in zip(starts, counts, strict=True)]
    with np.errstate(over="ignore", invalid="ignore"):
        for i in range(max(counts) + 1):
            for k, first, last in zip(order, edges, edges[1:], strict=False):
                if i <= counts[k]:
                    out[k][i] = state[:, first:last]
            # Longer windows stand first, so those that go on are the leading columns.
            left = int(max((e for k, e in zip(order, edges[1:], strict=True) if counts[k] > i), default=0))
            state, at = state[:, :left], begin[:left] + i * stride
            if not left:
                break
            t = log.t[at]
            k1 = rates(state, t, at)
            k2 = rates(state + 0.5 * step * k1, t + 0.5 * step, at)
            k3 = rates(state + 0.5 * step * k2, t + 0.5 * step, at)
            k4 = rates(state + step * k3, t + step, at)
            state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return out


def _left(predictor: Predictor, real: Array, out: Array, starts: NDArray[np.int64], count: int) -> Array:
    """Time at which each window's simulation leaves every motion that the vessel can have [s], shape (windows,), NaN where it stays."""
    log = predictor.log
    good = real[:, log.good] if log.good.any() else real
    speed = float(np.max(np.hypot(good[0], good[1]), initial=0.0))
    # A vessel that hardly turned could turn within the time in which it sails its length.
    turn = max(float(np.max(np.abs(good[2]), initial=0.0)), speed / hull_length(predictor.vehicle))
    most = BEYOND * np.array([speed, speed, turn])[None, :, None]
    with np.errstate(invalid="ignore"):
        away = ~(np.abs(out[:, :3]) <= most).all(axis=1)
    first = np.argmax(away, axis=0)
    return np.where(away.any(axis=0), log.t[np.minimum(starts + np.minimum(first, count), log.n - 1)], np.nan)


def _against(
    predictor: Predictor, real: Array, out: Array, starts: NDArray[np.int64], count: int
) -> tuple[Array, Array, Array]:
    """Windows of one length against the measured motion: the simulated velocities, and the rms errors of velocities and position by window."""
    log, n = predictor.log, predictor.log.n
    where = starts[None, :] + np.arange(count + 1)[:, None]
    error = np.nan_to_num(out[:, :3] - real[:, where].transpose(1, 0, 2), nan=RUNAWAY, posinf=RUNAWAY, neginf=-RUNAWAY)
    each = np.sqrt(np.mean(np.clip(error, -RUNAWAY, RUNAWAY) ** 2, axis=0)).T
    shown = np.full((3, n), np.nan)
    shown[:, where.ravel()] = out[:, :3].transpose(1, 0, 2).reshape(3, -1)
    far = np.zeros(0)
    if log.place is not None:
        off = np.nan_to_num(
            out[:, 4:] - log.place[:, where].transpose(1, 0, 2), nan=RUNAWAY, posinf=RUNAWAY, neginf=-RUNAWAY
        )
        off = off - off[:1]
        far = np.sqrt(np.mean(np.clip(off, -RUNAWAY, RUNAWAY) ** 2, axis=0).sum(axis=0))
    return shown, each, far
