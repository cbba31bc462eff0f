"""A causal whitening of prediction errors, learnt from a log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.sensor_noise import NORMAL_MEDIAN
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.linear.filters import whiten as whitened

Array = NDArray[np.float64]
# Memory of the whitening [s].
# Source: measured: make constants
MEMORY: Final = 0.6
# Fewest lags of the whitening.
# Source: measured: make constants
FEWEST_LAGS: Final = 3
# Most lags of the whitening.
# Source: resource: time of the whitening of every column
MOST_LAGS: Final = 12
# Threshold of the likelihood ratio for coupled axes, in standard deviations of chi-squared above its mean.
# Source: theorem: without coupling the ratio is chi-squared, of mean k and variance 2 k (Wilks 1938)
COUPLED: Final = 6.0
# Least singular value of past errors that counts in an autoregression, in the largest.
# Source: geometry: a million times the rounding of a double
RCOND: Final = 1e-10
# Variance that is added to the errors that an autoregression leaves, in their unit squared.
# Source: geometry: keeps the covariance of channels without noise positive definite, far below that of any sensor
LEAST_VARIANCE: Final = 1e-24
# Variance that is added to past errors of unit variance.
# Source: geometry: ten thousand times the rounding of a double
TRACE: Final = 1e-12
# Least size of a row of errors, in its unit.
# Source: geometry: keeps the inverse of a row without errors a finite number
LEAST_ROW: Final = 1e-12
# Length of the means in which sway counts where the vehicle hardly turns [s].
# Source: geometry: over 5 s a heading gives the yaw rate to a tenth of the gyro's error, and half a block holds whole means
SLOW: Final = 5.0
# Least square of the length of a column.
# Source: definition: that of the core's whitening
NOTHING: Final = 1e-300


@dataclass(frozen=True)
class Whitening:
    """A causal filter of prediction errors, after which they are uncorrelated and of unit variance.

    Attributes:
        groups: rows of errors that are filtered together: those of an axis, or of coupled axes.
        taps: coefficients of each group, shape (lags + 1, rows, rows).
        slow: rows of which means over ``span`` samples count alone.
        span: of these means, in samples.
    """

    groups: tuple[tuple[int, ...], ...]
    taps: tuple[Array, ...]
    slow: tuple[int, ...] = ()
    span: int = 1

    def __call__(self, x: Array) -> Array:
        """Whitens errors or signatures, shape (..., rows, n)."""
        n = x.shape[-1]
        flat = list(x.reshape(-1, *x.shape[-2:]))
        return whitened(flat, self.groups, self.taps, n)[0].reshape(x.shape) if flat and n else np.zeros_like(x)

    def undone(self, x: Array) -> Array:
        """Errors that whitened ones stand for, shape (rows, n); none of rows whose means count alone, and of those that do not count."""
        out = np.zeros_like(x)
        for rows, taps in zip(self.groups, self.taps, strict=True):
            if set(rows) & set(self.slow) or not taps.any():
                continue
            at, lags = list(rows), len(taps) - 1
            root = np.linalg.inv(taps[0])
            # The newest of the past errors first, as the coefficients stand.
            before = np.concatenate([-root @ t for t in taps[1:]], axis=1) if lags else np.zeros((len(at), 0))
            now, past = (root @ x[at]).T, np.zeros(before.shape[1])
            for i, new in enumerate(now):
                error = new + before @ past
                past = np.concatenate([error, past[: past.size - error.size]]) if lags else past
                out[at, i] = error
        return out

    def blocks(
        self, columns: Sequence[Array], good: NDArray[np.bool_], length: int, *, unit: bool = True
    ) -> tuple[Array, Array]:
        """Whitened rows of each block side by side, with zeros in place of samples that do not count, and the length of each column.

        Args:
            columns: each of shape (rows, n).
            good: samples that count, shape (n,).
            length: samples in a block.
            unit: whether columns are divided by their length.

        Returns:
            Shape (columns, blocks, rows length), and (columns,).
        """
        if not self.slow:
            return whitened(columns, self.groups, self.taps, length, good.astype(np.float64), unit=unit)
        x, size = whitened(columns, self.groups, self.taps, length, good.astype(np.float64))
        edges = np.linspace(0, length, max(1, round(length / self.span)) + 1).round().astype(np.int64)
        count = np.diff(edges)
        rows = x.reshape(*x.shape[:2], -1, length)
        for k in self.slow:
            # Whitened rows are projected on constants: their sums of squares stay those of independent numbers.
            rows[:, :, k] = np.repeat(np.add.reduceat(rows[:, :, k], edges[:-1], axis=-1) / count, count, axis=-1)
        if unit:
            size = np.sqrt(np.maximum(np.einsum("cbi,cbi->c", x, x), NOTHING))
            x /= size[:, None, None]
        return x, size

    def slowed(self, predictor: Predictor, left_out: frozenset[int]) -> Whitening:
        """The same whitening, with means alone of sway and of the gyro where the axis of yaw is left out."""
        if not left_out:
            return self
        rows = tuple(i for i, (k, _) in enumerate(predictor.labels) if k in (1, 2))
        return replace(self, slow=rows, span=max(1, round(SLOW / predictor.log.h)))


def lags_of(h: float) -> int:
    """Lags of the autoregression at a step h [s]."""
    return int(np.clip(round(MEMORY / h), FEWEST_LAGS, MOST_LAGS))


def whiten(
    predictor: Predictor, residual: Array, good: NDArray[np.bool_], left_out: frozenset[int] = frozenset()
) -> Whitening:
    """A whitening by an autoregression of errors, which least squares gives; axes that are left out become zero.

    Each axis is whitened by itself, unless the past of another foretells it. A rudder or a fast turn couples two axes: the error of one
    axis's state pushes the other, and a signature at that state would not be new to it.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that any column explains, shape (rows, n).
        good: samples that count, shape (n,).
        left_out: indices of the axes that are left out.
    """
    rows_of, silent = _counting(predictor, left_out)
    lags = lags_of(predictor.log.h)
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
        past = np.concatenate([residual[rows][:, at - lag] for lag in range(1, lags + 1)])
        now = residual[rows][:, at]
        scale = np.maximum(np.abs(past).max(axis=1), 1e-300)
        A = np.linalg.lstsq((past / scale[:, None]).T, now.T, rcond=RCOND)[0].T / scale
        left = now - A @ past
        root = np.linalg.inv(np.linalg.cholesky(left @ left.T / at.size + LEAST_VARIANCE * np.eye(len(rows))))
        each = [root] + [-root @ A[:, lag * len(rows) : (lag + 1) * len(rows)] for lag in range(lags)]
        taps.append(np.stack(each))
    if silent:
        found.append(tuple(silent))
        taps.append(np.zeros((1, len(silent), len(silent))))
    return _of_means(Whitening(tuple(found), tuple(taps)).slowed(predictor, left_out), residual, good)


def _of_means(white: Whitening, residual: Array, good: NDArray[np.bool_]) -> Whitening:
    """The whitening with slow rows divided by the deviation of their means, where that is above one.

    An autoregression of half a second knows little of the noise over several.
    """
    if not white.slow:
        return white
    span = white.span
    count = good.size // span
    whole = good[: count * span].reshape(count, span).all(axis=1)
    means = white(residual)[:, : count * span].reshape(-1, count, span).mean(axis=2)[:, whole] * np.sqrt(span)
    scale = np.ones(len(residual))
    if whole.any():
        scale[list(white.slow)] = np.maximum(np.sqrt(np.mean(means[list(white.slow)] ** 2, axis=1)), 1.0)
    taps = [t / scale[list(rows)][:, None] for rows, t in zip(white.groups, white.taps, strict=True)]
    return replace(white, taps=tuple(taps))


def _counting(predictor: Predictor, left_out: frozenset[int]) -> tuple[dict[int, list[int]], list[int]]:
    """Rows that count by axis, and those that do not.

    Of an axis that is left out only its gyro beside a heading counts, and a yaw rate that is made of the heading does nowhere.
    """
    rows_of: dict[int, list[int]] = {}
    silent = []
    for i, (k, channel) in enumerate(predictor.labels):
        known = predictor.rate is not None and predictor.rate.heading is not None and channel == "r"
        if (k in left_out and not known) or (channel == "r" and predictor.log.turned):
            silent.append(i)
        else:
            rows_of.setdefault(k, []).append(i)
    return rows_of, silent


def _coupled(
    x: Array, rows_of: dict[int, list[int]], moving: list[int], at: NDArray[np.int64], lags: int
) -> list[tuple[int, int]]:
    """Pairs of axes of which either one's past foretells the other's errors, by a likelihood ratio of autoregressions with and without it."""
    own = {k: rows_of[k] for k in moving if k <= 2}
    rows = [i for k in own for i in own[k]]
    place = {i: j for j, i in enumerate(rows)}
    past = np.concatenate([x[rows][:, at - lag] for lag in range(1, lags + 1)])
    size = np.maximum(np.sqrt(np.mean(past**2, axis=1)), 1e-300)
    past /= size[:, None]
    now = x[rows][:, at]
    inner, cross, total = past @ past.T, past @ now.T, now @ now.T

    def left(of: list[int], by: list[int]) -> float:
        """Log determinant of the covariance of rows that the pasts of others leave."""
        p = [place[i] for i in of]
        q = [lag * len(rows) + place[i] for lag in range(lags) for i in by]
        c = cross[np.ix_(q, p)]
        trace = TRACE * at.size * np.eye(len(q))
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


def plain_scale(
    errors: Array, good: NDArray[np.bool_], predictor: Predictor, left_out: frozenset[int] = frozenset()
) -> Whitening:
    """A first whitening: each row is divided by its usual size, and axes that are left out become zero."""
    size = np.maximum(np.median(np.abs(errors[:, good]), axis=1) / NORMAL_MEDIAN, LEAST_ROW)
    rows_of, silent = _counting(predictor, left_out)
    groups = list(rows_of.values())
    taps = [np.diag(1.0 / size[r])[None] for r in groups]
    if silent:
        groups.append(silent)
        taps.append(np.zeros((1, len(silent), len(silent))))
    return Whitening(tuple(tuple(r) for r in groups), tuple(taps))
