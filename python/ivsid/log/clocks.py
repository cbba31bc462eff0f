"""Channels of several clocks brought to one, with a stated bound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.log.record import GAP, Clock
from ivsid.log.stamps import Times

Array = NDArray[np.float64]


def together(times: Mapping[tuple[str, str], Times], source: str) -> dict[tuple[str, str], Times]:
    """All clocks from one common zero: the files' own, or the earliest stamp where any clock counts from its first.

    Raises:
        IvsidError: two clocks never run at the same time, so that they count from different zeros.
    """
    shifted = dict(times)
    if len(times) > 1 and any(x.counted for x in times.values()):
        origin = min(x.first for x in times.values())
        shifted = {key: _shifted(x, float(x.first - origin)) for key, x in times.items()}
    last, first = max(shifted, key=lambda k: shifted[k].t[0]), min(shifted, key=lambda k: shifted[k].t[-1])
    if shifted[last].t[0] > shifted[first].t[-1]:
        spans = [
            f"{'/'.join(k).lstrip('/')} from {shifted[k].t[0]:.6g} to {shifted[k].t[-1]:.6g} s" for k in (first, last)
        ]
        raise IvsidError(
            f"{source}: the clocks {spans[0]} and {spans[1]} never run at the same time; they count from different zeros, "
            "or in other units than [log] time says: bring them to one zero first"
        )
    return shifted


def within(
    times: Mapping[tuple[str, str], Times], span: tuple[float, float], source: str
) -> dict[tuple[str, str], Times]:
    """The samples of all clocks from one time to another [s].

    Raises:
        IvsidError: a clock has fewer than two samples there.
    """
    found: dict[tuple[str, str], Times] = {}
    for key, x in times.items():
        a, b = np.searchsorted(x.t, span[0]), np.searchsorted(x.t, span[1], side="right")
        if b - a < 2:
            raise IvsidError(
                f"{source} has {b - a} samples of {'/'.join(key).lstrip('/')} from {span[0]:g} to {span[1]:g} s, the span of [log], and goes from "
                f"{x.t[0]:.6g} to {x.t[-1]:.6g} s; at least 2 are needed"
            )
        rows = np.arange(a, b) if x.rows is None else x.rows[a:b]
        found[key] = replace(x, t=x.t[a:b], rows=rows)
    return found


def _shifted(x: Times, by: float) -> Times:
    if x.counted:
        since, lost = x.t, x.lost
    else:
        # Stamps in plain seconds are rounded decimals, this one and the first, and so is their difference.
        since = x.t - x.t[0]
        lost = x.lost + float(np.spacing(np.abs(x.t).max()) + np.spacing(since[-1]))
    t = since + by
    return replace(x, t=t, lost=lost + float(np.spacing(abs(by)) + np.spacing(np.abs(t).max())))


def held(rows: Array, t: Array, values: Array, clock_error: float) -> tuple[Array, Array]:
    """A demand under a zero-order hold, as its range from each row to the next.

    The demand is missing before its first sample, after its last one, and in rows that reach into a hole of its samples: it may have
    changed there.

    Args:
        rows: times of the rows [s], shape (n,).
        t: times of the samples [s], shape (m,).
        values: samples, shape (m,).
        clock_error: the largest difference between the two clocks [s].

    Returns:
        Middle and half-width of each range, shape (n,) each; NaN is missing.
    """
    until = np.r_[rows[1:], rows[-1]]
    first = np.searchsorted(t, rows - clock_error, side="right") - 1
    last = np.maximum(np.searchsorted(t, until + clock_error, side="left") - 1, first)
    last[-1] = max(int(np.searchsorted(t, rows[-1] + clock_error, side="right")) - 1, int(first[-1]))
    padded = np.r_[values, np.nan]
    begin = np.maximum(first, 0)
    pairs = np.c_[begin, np.maximum(last, begin) + 1].ravel()
    low = np.minimum.reduceat(padded, pairs)[::2]
    high = np.maximum.reduceat(padded, pairs)[::2]
    begins, ends = next_hole(rows, t)
    # The next row is missing if a row's end lies in a hole.
    away = (first < 0) | (begins < rows) | ((begins < until) & (ends <= until))
    middle = np.where(away, np.nan, low + 0.5 * (high - low))
    return middle, np.where(high > low, np.nextafter(0.5 * (high - low), np.inf) + 2 * np.spacing(np.abs(middle)), 0.0)


def next_hole(moments: Array, t: Array) -> tuple[Array, Array]:
    """Begin and end [s] of the first hole of the samples that ends after each moment.

    A hole begins when the last sample is as old as a gap is long, and ends with the next sample.
    """
    longest = GAP * np.median(np.diff(t))
    long = np.r_[np.diff(t) > longest, True]
    begins, ends = t[long] + longest, np.r_[t[1:], np.inf][long]
    place = np.searchsorted(ends, moments, side="right")
    return begins[place], ends[place]


def nearest(rows: Array, t: Array, within: float) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The index of the sample next to each row, and whether their times agree within ``within`` [s], shape (n,) each."""
    after = np.clip(np.searchsorted(t, rows), 0, t.size - 1)
    before = np.maximum(after - 1, 0)
    place = np.where(np.abs(t[before] - rows) < np.abs(t[after] - rows), before, after)
    return place, np.abs(t[place] - rows) <= within


def between(
    rows: Array, t: Array, values: Array, lost: Array, rate: float, clock_error: float, jitter: float = 0.0
) -> tuple[Array, Array]:
    """A channel on other times: linear between its two neighbours, with a bound on its distance from the truth.

    At a time a after one sample and b before the next, a quantity that moves at most ``rate`` a second is at most
    2 rate a b / (a + b) from the straight line between them. The channel is missing outside its samples and inside gaps.

    Args:
        rows: times wanted [s], shape (n,).
        t: times of the samples [s], shape (m,).
        values: samples, shape (m,), none missing.
        lost: bound on the error of each, shape (m,).
        rate: bound on the rate of change.
        clock_error: the largest difference between the two clocks, rounding of stamps included [s].
        jitter: bound on the error of each time beyond the rounding of its decimals [s].

    Returns:
        Values and half-widths, shape (n,); NaN is missing.
    """
    j = np.clip(np.searchsorted(t, rows, side="right") - 1, 0, t.size - 2)
    a, b = rows - t[j], t[j + 1] - rows
    span = t[j + 1] - t[j]
    usable = (a >= 0) & (b >= 0) & (span <= GAP * np.median(np.diff(t)))
    change = values[j + 1] - values[j]
    line = values[j] + change * (a / span)
    # a and b are off by two stamps each: that moves the bound by at most 4 rate, the line by 4 |change| / span for each of them.
    stamps = 4 * (jitter + max(float(np.spacing(np.abs(x).max())) for x in (rows, t)))
    reach = (
        2 * rate * np.maximum(a, 0) * np.maximum(b, 0) / span
        + rate * (clock_error + stamps)
        + stamps * np.abs(change) / span
    )
    size = np.maximum(np.abs(values[j]), np.abs(values[j + 1]))
    off = reach * (1 + 1e-12) + np.maximum(lost[j], lost[j + 1]) + 8 * np.spacing(size)
    exact = (a == 0) | (b == 0)
    line = np.where(a == 0, values[j], np.where(b == 0, values[j + 1], line))
    own = np.where(a == 0, lost[j], lost[j + 1]) + rate * clock_error
    return np.where(usable | exact, line, np.nan), np.where(exact, own, off)


def clock_of(t: Array) -> Clock:
    """The number of samples of a channel, and the shortest step between them."""
    return Clock(t.size, float(np.diff(t).min()) if t.size > 1 else 0.0)
