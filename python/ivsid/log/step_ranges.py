"""Ranges of a channel over the steps from row to row, from all samples of the log there."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ivsid.log.clocks import between, next_hole
from ivsid.log.record import GAP

Array = NDArray[np.float64]
Manner = Literal["hold", "between"]


def step_range(
    rows: Array,
    t: Array,
    values: Array,
    lost: Array,
    *,
    manner: Manner,
    rate: float | None = None,
    clock_error: float = 0.0,
    jitter: float = 0.0,
) -> tuple[Array, Array]:
    """The range of readings over the step after each row.

    Args:
        rows: times of the rows [s], shape (n,).
        t: times of the samples [s], shape (m,).
        values: samples, shape (m,), none missing.
        lost: bound on the error of each, decimals included, shape (m,).
        manner: ``hold`` holds each value until the next sample; under ``between`` it lies between the values of neighbouring samples.
            A ``rate`` takes the place of either.
        rate: the largest rate of change, where one is stated.
        clock_error: the largest difference between the two clocks [s].
        jitter: bound on the error of each time beyond the rounding of its decimals [s].

    Returns:
        Lower and upper ends, shape (n - 1,); NaN outside the samples, and where a step reaches into a gap between two of them.
    """
    low, high = np.nextafter(values - lost, -np.inf), np.nextafter(values + lost, np.inf)
    if rate is not None:
        return _moving(rows, t, values, (low, high), lost, rate, clock_error, jitter)
    start, end = rows[:-1] - clock_error, rows[1:] + clock_error
    first = np.searchsorted(t, start, side="right") - 1
    last = np.searchsorted(t, end, side="left") - (manner == "hold")
    known = (first >= 0) & (last < t.size)
    first = np.maximum(first, 0)
    last = np.clip(last, first, t.size - 1)
    if manner == "hold":
        known &= next_hole(start, t)[0] >= end
    else:
        gaps = np.r_[0, np.cumsum(np.diff(t) > GAP * np.median(np.diff(t)))]
        known &= gaps[last] == gaps[first]
    lower, upper = _reduced(np.minimum, low, first, last), _reduced(np.maximum, high, first, last)
    return np.where(known, lower, np.nan), np.where(known, upper, np.nan)


def _moving(
    rows: Array,
    t: Array,
    values: Array,
    ends: tuple[Array, Array],
    lost: Array,
    rate: float,
    clock_error: float,
    jitter: float,
) -> tuple[Array, Array]:
    """The range under a stated rate.

    A quantity that is in [a, b] at one moment and in [c, e] a time d later stays below (b + e + rate d) / 2 between the two.
    """
    line, reach = between(rows, t, values, lost, rate, 0.0, jitter)
    moments = np.r_[t, rows]
    order = np.argsort(moments, kind="stable")
    moments = moments[order]
    low = np.r_[ends[0], np.nextafter(line - reach, -np.inf)][order]
    high = np.r_[ends[1], np.nextafter(line + reach, np.inf)][order]
    steps = np.diff(moments)
    far = rate * steps
    slack = 4 * np.spacing(np.abs(low[:-1]) + np.abs(low[1:]) + np.abs(high[:-1]) + np.abs(high[1:]) + far)
    # Clocks that disagree and stamps that were rounded can hide a change at each end.
    slack += rate * (clock_error + 4 * (jitter + float(np.spacing(np.abs(moments).max())))) * (1 + 1e-12)
    lower = 0.5 * (low[:-1] + low[1:] - far) - slack
    upper = 0.5 * (high[:-1] + high[1:] + far) + slack
    gap = steps > GAP * np.median(np.diff(t))
    lower, upper = np.where(gap, np.nan, lower), np.where(gap, np.nan, upper)
    place = np.searchsorted(moments, rows)
    first, last = place[:-1], np.maximum(place[1:] - 1, place[:-1])
    return _reduced(np.minimum, lower, first, last), _reduced(np.maximum, upper, first, last)


def _reduced(how: np.ufunc, values: Array, first: NDArray[np.intp], last: NDArray[np.intp]) -> Array:
    """The least or the largest of each stretch of values, both ends included; NaN where the stretch has one."""
    padded = np.r_[values, np.nan]
    pairs = np.c_[first, last + 1].ravel()
    result: Array = how.reduceat(padded, pairs)[::2]
    return result
