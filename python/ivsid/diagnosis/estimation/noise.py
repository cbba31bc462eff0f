"""What is random in a log: the ambient force, estimated from what no effect explains, and a causal whitening of the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.linear.filters import whiten as whitened
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Memory of the whitening [s] and most lags.
MEMORY: Final = 0.6
MOST_LAGS: Final = 12
# Axes are whitened together where their pasts say more of each other than chance, by so many standard deviations of chi^2.
COUPLED: Final = 6.0
# What the filter takes of the log's start, and of the time after a gap [s].
SETTLING: Final = 4.0
_TIMES: Final = (1.0, 5.0)
# A filter forgets so many times faster than the vehicle.
QUICKER: Final = 2.0
# And never more slowly than this [1/s].
SLOWEST: Final = 0.3
# An axis moves where its velocity is so many times the error of its filter.
MOVING: Final = 20.0
# A still axis's filter believes its model so many times less.
LOOSE: Final = 100.0
# A hull of 1 m turns where its yaw rate is more than this [rad/s]; longer ones more slowly, after Froude.
TURNING: Final = 0.015


def declared_ambient(vehicle: Vehicle) -> Ambient:
    """What the vehicle file says of the ambient force, as accelerations; else a share of the thrusters' accuracy."""
    m = vehicle.hull.mass
    length = vehicle.hull.length or (m / 60.0) ** (1 / 3)
    inertia = m * length**2 / 8
    a = vehicle.ambient
    if a is not None and (a.force or a.moment):
        deviation = (max(a.force, 1e-4 * m) / m, max(a.force, 1e-4 * m) / m, max(a.moment, 1e-4 * inertia) / inertia)
        return Ambient(deviation, (a.time, a.time, a.time))
    force = sum(t.accuracy.absolute for t in vehicle.thrusters) or 0.01 * m
    arm = 0.3 * length
    return Ambient((0.2 * force / m, 0.2 * force / m, 0.2 * force * arm / inertia), (2.0, 2.0, 2.0))


def ambient_of(
    predictor: Predictor, residual: Array, rows: NDArray[np.bool_], left_out: frozenset[int] = frozenset()
) -> Ambient:
    """The ambient acceleration behind prediction errors that no effect explains.

    The errors are put through the filter's inverse, which gives the velocity that they stand for. Its mean slopes over a second,
    correlated at lags where the sensors' noise is not shared, give deviation and time.
    """
    h = predictor.log.h
    q = max(2, round(0.5 / h))
    deviations, times = [], []
    row = 0
    for k in range(3):
        here = predictor.axes[k]
        count = len(here.outputs)
        velocity = _data_of(predictor, k, residual[row : row + count])
        row += count
        mean = uniform_filter1d(velocity, q)
        slope = (mean[2 * q :] - mean[: -2 * q]) / (2 * q * h)
        good = rows[q:-q][: slope.size]
        near, far = (_covariance(slope, good, round(s / h)) for s in (2.0, 4.0))
        if near <= 0:
            deviations.append(predictor.ambient.deviation[k] * 0.3)
            times.append(predictor.ambient.time[k])
            continue
        ratio = np.clip(far / near, 1e-3, 0.9)
        time = float(np.clip(-2.0 / np.log(ratio), *_TIMES))
        deviations.append(float(np.sqrt(near * np.exp(2.0 / time))))
        times.append(time)
    said = declared_ambient(predictor.vehicle)
    given = predictor.vehicle.ambient is not None
    # A filter that is too quick is whitened afterwards; one that is too slow is wrong about the motion in between.
    # What is declared is no discovery, and slow noise that is taken for less than it is makes every slow signature look certain.
    low, high = (1.0, 30.0) if given else (0.05, 1e3)
    d = [float(np.clip(a, low * b, high * b)) for a, b in zip(deviations, said.deviation, strict=True)]
    # Nobody asks what moves a still axis, but other axes need its velocity: it is the sensor's, whatever steady moment the model lacks.
    d = [x * (LOOSE if k in left_out else 1.0) for k, x in enumerate(d)]
    if given:
        times = list(said.time)
    return Ambient((d[0], d[1], d[2]), (times[0], times[1], times[2]))


def _covariance(x: Array, good: NDArray[np.bool_], lag: int) -> float:
    both = good[lag:] & good[:-lag]
    x = np.where(good, x, 0.0)
    x = x - x.sum() / max(good.sum(), 1)
    return float(np.sum((x[lag:] * x[:-lag])[both]) / max(both.sum(), 1))


def _data_of(predictor: Predictor, k: int, errors: Array) -> Array:
    """The velocity reading that would have given these errors without a model: the filter's inverse."""
    here = predictor.axes[k]
    h = predictor.log.h
    decay = float(np.exp(-h / predictor.ambient.time[k]))
    at = here.outputs.index("velocity")
    K = here.kalman_gain
    # Velocity and ambient states alone: the position does not act on them.
    out = np.empty(errors.shape[1])
    kalman_gain = K[1:]
    pushes = kalman_gain @ errors
    own = errors[at]
    w0, w1 = pushes.tolist()
    velocity, wind = 0.0, 0.0
    for i, e in enumerate(own.tolist()):
        out[i] = velocity + e
        velocity += w0[i]
        wind += w1[i]
        velocity += h * wind
        wind *= decay
    return out


@dataclass(frozen=True)
class Whitening:
    """A causal filter of each axis's prediction errors, to unit and uncorrelated variance.

    Attributes:
        groups: rows of each axis, or of axes that are coupled.
        taps: by group, shape (lags + 1, rows, rows).
    """

    groups: tuple[tuple[int, ...], ...]
    taps: tuple[Array, ...]

    def __call__(self, x: Array) -> Array:
        """Whitens errors or signatures, shape (..., rows, n)."""
        n = x.shape[-1]
        flat = list(x.reshape(-1, *x.shape[-2:]))
        return whitened(flat, self.groups, self.taps, n)[0].reshape(x.shape) if flat and n else np.zeros_like(x)

    def blocks(
        self, columns: Sequence[Array], good: NDArray[np.bool_], length: int, *, unit: bool = True
    ) -> tuple[Array, Array]:
        """Whitened rows of each block side by side, those that do not count as zeros, and what each column was divided by.

        Args:
            columns: each of shape (rows, n).
            good: samples that count, shape (n,).
            length: samples in a block.
            unit: whether columns are brought to unit length.

        Returns:
            Shape (columns, blocks, rows length), and (columns,).
        """
        return whitened(columns, self.groups, self.taps, length, good.astype(np.float64), unit=unit)


def axes_left_out(predictor: Predictor) -> frozenset[int]:
    """The axes to leave out where the vehicle hardly turns beyond what the filter can know: yaw, and sway with it.

    An autopilot that holds a heading answers to the motion itself; where little else moves the vehicle, demands and errors are of one
    piece, and inertia and damping come out wrong. Such an axis is left out, and its causes are not tested.
    """
    # A steady turn, as under a gyro's bias, tells no more of inertia and damping than none.
    turning = float(uniform_filter1d(predictor.log.nu[2], max(2, round(0.5 / predictor.log.h))).std())
    # Sway turns with u r: without the yaw rate it is not known either.
    hull = predictor.vehicle.hull
    least = TURNING / np.sqrt(hull.length or (hull.mass / 60.0) ** (1 / 3))
    return frozenset() if turning >= max(MOVING * predictor.axes[2].spread, least) else frozenset({1, 2})


def whiten(
    predictor: Predictor, residual: Array, good: NDArray[np.bool_], left_out: frozenset[int] = frozenset()
) -> Whitening:
    """An autoregression of the errors that no effect explains, by least squares; nothing is left of still axes.

    Each axis by itself, unless another's past foretells it: where a rudder or a fast turn couples them, the error of one axis's state
    pushes the other, and a signature at that state would not be new to it.
    """
    rows_of: dict[int, list[int]] = {}
    for i, (k, _) in enumerate(predictor.labels):
        rows_of.setdefault(k, []).append(i)
    lags = int(np.clip(round(MEMORY / predictor.log.h), 3, MOST_LAGS))
    usable = good.copy()
    for lag in range(1, lags + 1):
        usable[lag:] &= good[:-lag]
    usable[:lags] = False
    at = np.flatnonzero(usable)
    groups = [[k] for k in rows_of]
    for first, second in _coupled(residual, rows_of, [k for k in rows_of if k not in left_out], at, lags):
        one, other = (next(g for g in groups if k in g) for k in (first, second))
        if one is not other:
            one += other
            groups.remove(other)
    taps = []
    found = []
    for axes in groups:
        rows = [i for k in sorted(axes) for i in rows_of[k]]
        found.append(tuple(rows))
        if axes[0] in left_out:
            taps.append(np.zeros((1, len(rows), len(rows))))
            continue
        past = np.concatenate([residual[rows][:, at - lag] for lag in range(1, lags + 1)])
        now = residual[rows][:, at]
        scale = np.maximum(np.abs(past).max(axis=1), 1e-300)
        A = np.linalg.lstsq((past / scale[:, None]).T, now.T, rcond=1e-10)[0].T / scale
        left = now - A @ past
        root = np.linalg.inv(np.linalg.cholesky(left @ left.T / at.size + 1e-24 * np.eye(len(rows))))
        each = [root] + [-root @ A[:, lag * len(rows) : (lag + 1) * len(rows)] for lag in range(lags)]
        taps.append(np.stack(each))
    return Whitening(tuple(found), tuple(taps))


def _coupled(
    x: Array, rows_of: dict[int, list[int]], moving: list[int], at: NDArray[np.int64], lags: int
) -> list[tuple[int, int]]:
    """Pairs of axes of which either one's past says more of the other than chance would, by the fall of log determinants."""
    own = {k: rows_of[k] for k in moving if k <= 2}
    rows = [i for k in own for i in own[k]]
    place = {i: j for j, i in enumerate(rows)}
    past = np.concatenate([x[rows][:, at - lag] for lag in range(1, lags + 1)])
    size = np.maximum(np.sqrt(np.mean(past**2, axis=1)), 1e-300)
    past /= size[:, None]
    now = x[rows][:, at]
    inner, cross, total = past @ past.T, past @ now.T, now @ now.T

    def left(of: list[int], by: list[int]) -> float:
        p = [place[i] for i in of]
        q = [lag * len(rows) + place[i] for lag in range(lags) for i in by]
        c = cross[np.ix_(q, p)]
        trace = 1e-12 * at.size * np.eye(len(q))
        return float(np.linalg.slogdet(total[np.ix_(p, p)] - c.T @ np.linalg.solve(inner[np.ix_(q, q)] + trace, c))[1])

    found = []
    for j, first in enumerate(own):
        for second in list(own)[j + 1 :]:
            both = [*own[first], *own[second]]
            more = len(own[first]) * len(own[second]) * lags
            least = more + COUPLED * np.sqrt(2 * more)
            if any(at.size * (left(own[k], own[k]) - left(own[k], both)) > least for k in (first, second)):
                found.append((first, second))
    return found


def usable_rows(predictor: Predictor) -> NDArray[np.bool_]:
    """Samples whose errors count: not those of a gap, nor those that the filter's start or a gap still shapes, shape (n,)."""
    good = predictor.log.good.copy()
    settle = round(SETTLING / predictor.log.h)
    bad = ~good
    bad[0] = True
    reach = np.convolve(bad.astype(float), np.ones(settle))[: good.size] > 0
    return ~reach


def quick_enough(predictor: Predictor, damping: tuple[float, float, float]) -> Predictor:
    """The bench with filters that forget faster than the vehicle does, so that their states hardly depend on the hypothesis.

    Args:
        predictor: with filters of the estimated ambient force.
        damping: of each axis [1/s].
    """
    deviation = list(predictor.ambient.deviation)
    for _ in range(8):
        slow = [k for k in range(3) if predictor.axes[k].memory * max(QUICKER * damping[k], SLOWEST) > 1]
        if not slow:
            return predictor
        for k in slow:
            deviation[k] *= 1.6
        predictor = predictor.adopt(Ambient((deviation[0], deviation[1], deviation[2]), predictor.ambient.time))
    return predictor
