"""What is random in a log: the ambient force, estimated from what no effect explains, and a causal whitening of the rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.bench import Ambient, Bench
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Memory of the whitening [s] and most lags.
MEMORY: Final = 0.6
MOST_LAGS: Final = 12
# Samples of a signature that one product whitens together.
STRETCH: Final = 24
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


def declared(vehicle: Vehicle) -> Ambient:
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


def ambient_of(bench: Bench, residual: Array, rows: NDArray[np.bool_], still: frozenset[int] = frozenset()) -> Ambient:
    """The ambient acceleration behind prediction errors that no effect explains.

    The errors are put through the filter's inverse, which gives the velocity that they stand for. Its mean slopes over a second,
    correlated at lags where the sensors' noise is not shared, give deviation and time.
    """
    h = bench.log.h
    q = max(2, round(0.5 / h))
    deviations, times = [], []
    row = 0
    for k in range(3):
        here = bench.axes[k]
        count = len(here.outputs)
        velocity = _data_of(bench, k, residual[row : row + count])
        row += count
        mean = uniform_filter1d(velocity, q)
        slope = (mean[2 * q :] - mean[: -2 * q]) / (2 * q * h)
        good = rows[q:-q][: slope.size]
        near, far = (_covariance(slope, good, round(s / h)) for s in (2.0, 4.0))
        if near <= 0:
            deviations.append(bench.ambient.deviation[k] * 0.3)
            times.append(bench.ambient.time[k])
            continue
        ratio = np.clip(far / near, 1e-3, 0.9)
        time = float(np.clip(-2.0 / np.log(ratio), *_TIMES))
        deviations.append(float(np.sqrt(near * np.exp(2.0 / time))))
        times.append(time)
    said = declared(bench.vehicle)
    given = bench.vehicle.ambient is not None
    # A filter that is too quick is whitened afterwards; one that is too slow is wrong about the motion in between.
    # What is declared is no discovery, and slow noise that is taken for less than it is makes every slow signature look certain.
    low, high = (1.0, 30.0) if given else (0.05, 1e3)
    d = [float(np.clip(a, low * b, high * b)) for a, b in zip(deviations, said.deviation, strict=True)]
    # Nobody asks what moves a still axis, but other axes need its velocity: it is the sensor's, whatever steady moment the model lacks.
    d = [x * (LOOSE if k in still else 1.0) for k, x in enumerate(d)]
    if given:
        times = list(said.time)
    return Ambient((d[0], d[1], d[2]), (times[0], times[1], times[2]))


def _covariance(x: Array, good: NDArray[np.bool_], lag: int) -> float:
    both = good[lag:] & good[:-lag]
    x = np.where(good, x, 0.0)
    x = x - x.sum() / max(good.sum(), 1)
    return float(np.sum((x[lag:] * x[:-lag])[both]) / max(both.sum(), 1))


def _data_of(bench: Bench, k: int, errors: Array) -> Array:
    """The velocity reading that would have given these errors without a model: the filter's inverse."""
    here = bench.axes[k]
    h = bench.log.h
    decay = float(np.exp(-h / bench.ambient.time[k]))
    at = here.outputs.index("velocity")
    K = here.gain
    # Velocity and ambient states alone: the position does not act on them.
    out = np.empty(errors.shape[1])
    gain = K[1:]
    pushes = gain @ errors
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
        groups: rows of each axis.
        taps: by axis, shape (lags + 1, rows, rows).
    """

    groups: tuple[tuple[int, ...], ...]
    taps: tuple[Array, ...]

    def __call__(self, x: Array) -> Array:
        """Whitens errors or signatures, shape (..., rows, n)."""
        out = np.empty_like(x)
        for rows, taps in zip(self.groups, self.taps, strict=True):
            out[..., rows, :] = _convolved(taps, x[..., rows, :])
        return out


def _convolved(taps: Array, x: Array) -> Array:
    """Each row's sum of all rows at the lags of the taps, what was before the first sample taken as nothing.

    A stretch of the result is one matrix times the stretch before and under it, so that all stretches are one product.
    """
    lags, r = taps.shape[0] - 1, taps.shape[1]
    n, leading = x.shape[-1], x.shape[:-2]
    if not np.any(taps):
        return np.zeros_like(x)
    if not lags:
        return np.asarray(np.matmul(taps[0], x))
    count = -(-n // STRETCH)
    band = np.zeros((r, lags + STRETCH, r, STRETCH))
    for lag in range(lags + 1):
        for k in range(STRETCH):
            band[:, lags + k - lag, :, k] = taps[lag].T
    band = band.reshape(r * (lags + STRETCH), r * STRETCH)
    out = np.empty((int(np.prod(leading)), r, count * STRETCH))
    padded = np.zeros((r, lags + count * STRETCH))
    windows = sliding_window_view(padded, lags + STRETCH, axis=1)[:, ::STRETCH].transpose(1, 0, 2)
    # One signature at a time stays in the cache.
    for one, into in zip(x.reshape(-1, r, n), out, strict=True):
        padded[:, lags : lags + n] = one
        product = windows.reshape(count, -1) @ band
        into.reshape(r, count, STRETCH)[:] = product.reshape(count, r, STRETCH).transpose(1, 0, 2)
    return out[..., :n].reshape(x.shape)


def still_axes(bench: Bench) -> frozenset[int]:
    """The axes to leave out where the vehicle hardly turns beyond what the filter can know: yaw, and sway with it.

    An autopilot that holds a heading answers to the motion itself; where little else moves the vehicle, demands and errors are of one
    piece, and inertia and damping come out wrong. Such an axis is left out, and its causes are not tested.
    """
    # A steady turn, as under a gyro's bias, tells no more of inertia and damping than none.
    turning = float(uniform_filter1d(bench.log.nu[2], max(2, round(0.5 / bench.log.h))).std())
    # Sway turns with u r: without the yaw rate it is not known either.
    hull = bench.vehicle.hull
    least = TURNING / np.sqrt(hull.length or (hull.mass / 60.0) ** (1 / 3))
    return frozenset() if turning >= max(MOVING * bench.axes[2].spread, least) else frozenset({1, 2})


def whiten(bench: Bench, residual: Array, good: NDArray[np.bool_], still: frozenset[int] = frozenset()) -> Whitening:
    """An autoregression of the errors that no effect explains, axis by axis, by least squares; nothing is left of still axes."""
    groups: dict[int, list[int]] = {}
    for i, (k, _) in enumerate(bench.labels):
        groups.setdefault(k, []).append(i)
    lags = int(np.clip(round(MEMORY / bench.log.h), 3, MOST_LAGS))
    taps = []
    for axis_index, rows in groups.items():
        if axis_index in still:
            taps.append(np.zeros((1, len(rows), len(rows))))
            continue
        x = residual[rows]
        usable = good.copy()
        for lag in range(1, lags + 1):
            usable[lag:] &= good[:-lag]
        usable[:lags] = False
        at = np.flatnonzero(usable)
        past = np.concatenate([x[:, at - lag] for lag in range(1, lags + 1)])
        now = x[:, at]
        scale = np.maximum(np.abs(past).max(axis=1), 1e-300)
        A = np.linalg.lstsq((past / scale[:, None]).T, now.T, rcond=1e-10)[0].T / scale
        left = now - A @ past
        root = np.linalg.inv(np.linalg.cholesky(left @ left.T / at.size + 1e-24 * np.eye(len(rows))))
        each = [root] + [-root @ A[:, lag * len(rows) : (lag + 1) * len(rows)] for lag in range(lags)]
        taps.append(np.stack(each))
    return Whitening(tuple(tuple(r) for r in groups.values()), tuple(taps))


def usable_rows(bench: Bench) -> NDArray[np.bool_]:
    """Samples whose errors count: not those of a gap, nor those that the filter's start or a gap still shapes, shape (n,)."""
    good = bench.log.good.copy()
    settle = round(SETTLING / bench.log.h)
    bad = ~good
    bad[0] = True
    reach = np.convolve(bad.astype(float), np.ones(settle))[: good.size] > 0
    return ~reach


def quick_enough(bench: Bench, damping: tuple[float, float, float]) -> Bench:
    """The bench with filters that forget faster than the vehicle does, so that their states hardly depend on the hypothesis.

    Args:
        bench: with filters of the estimated ambient force.
        damping: of each axis [1/s].
    """
    deviation = list(bench.ambient.deviation)
    for _ in range(8):
        slow = [k for k in range(3) if bench.axes[k].memory * max(QUICKER * damping[k], SLOWEST) > 1]
        if not slow:
            return bench
        for k in slow:
            deviation[k] *= 1.6
        bench = bench.adopt(Ambient((deviation[0], deviation[1], deviation[2]), bench.ambient.time))
    return bench
