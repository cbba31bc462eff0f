"""Ends of axes: of residuals without their spikes, and of intervals of very different widths."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

# Share of the samples at each end that may not set an axis: filters ring at the ends of a log and beside gaps.
# Source: definition: a twelfth of a minute in ten minutes
SPIKES: Final = 0.005
# Samples of a row that the quantiles are taken of, and that are looked at at once.
# Source: resource: 8 MB
SAMPLES: Final = 1 << 20
# Room beyond the quantiles, in distances between them: normal errors do not reach it.
# Source: theorem: normal distribution; the 0.5 % quantiles lie 5.15 standard deviations apart, so that 5.15 lie inside on each side
ROOM: Final = 0.5
# Margin of an axis beside what it shows, in shares of the shown.
# Source: definition: the width of a mark in a figure
MARGIN: Final = 0.06
# Widths of the narrowest interval that others may have and still set the axis.
# Source: definition: the narrowest is drawn at least a twentieth of the axis wide
WIDEST: Final = 20.0
# Marks of an axis, about.
# Source: definition: legible beside each other at the width of a phone
TICKS: Final = 5


def robust_range(rows: Iterable[NDArray[np.float64]]) -> tuple[float, float] | None:
    """Ends of an axis that spikes do not set.

    Args:
        rows: values that share the axis, of any shape; NaN is missing.

    Returns:
        Lowest and highest value of the axis; None without a finite value.
    """
    some, ends = [np.zeros(0)], [np.inf, -np.inf]
    for row in map(np.ravel, rows):
        some.append(row[:: 1 + row.size // SAMPLES])
        for first in range(0, row.size, SAMPLES):
            here = row[first : first + SAMPLES]
            here = here[np.isfinite(here)]
            if here.size:
                ends = [min(ends[0], float(here.min())), max(ends[1], float(here.max()))]
    x = np.concatenate(some)
    x = x[np.isfinite(x)]
    if not x.size:
        return None
    low, high = (float(q) for q in np.quantile(x, [SPIKES, 1.0 - SPIKES]))
    room = ROOM * (high - low)
    return padded(max(ends[0], low - room), min(ends[1], high + room))


def padded(low: float, high: float) -> tuple[float, float]:
    """An axis with a margin; one of a single value has a width all the same."""
    margin = MARGIN * (high - low) or max(abs(low), 1.0) * MARGIN
    return low - margin, high + margin


def narrow_axis(intervals: Sequence[tuple[float, float]], points: Sequence[float] = ()) -> tuple[float, float] | None:
    """Ends of an axis that the narrow intervals set: a wide one runs off, and a point far away lies outside.

    Args:
        intervals: lower and upper ends, finite or not.
        points: single values that are shown if they are not far off.

    Returns:
        Lowest and highest value of the axis; None where nothing is finite.
    """
    finite = [(a, b) for a, b in intervals if math.isfinite(a) and math.isfinite(b)]
    if not finite:
        ends = [x for pair in intervals for x in pair if math.isfinite(x)] + [p for p in points if math.isfinite(p)]
        return padded(min(ends), max(ends)) if ends else None
    least = min(b - a for a, b in finite)
    kept = [(a, b) for a, b in finite if b - a <= WIDEST * least] or finite
    low, high = min(a for a, _ in kept), max(b for _, b in kept)
    reach = WIDEST * (high - low) / 2
    near = [p for p in points if low - reach <= p <= high + reach]
    return padded(min([low, *near]), max([high, *near]))


def ticks(low: float, high: float, most: int = TICKS) -> list[float]:
    """Round numbers inside an axis: multiples of one, two or five powers of ten."""
    span = high - low
    if not (math.isfinite(span) and span > 0):
        return []
    power = 10.0 ** math.floor(math.log10(span / most))
    step = next(m * power for m in (1, 2, 5, 10, 20) if span / (m * power) <= most)
    first = math.ceil(low / step)
    return [float(f"{k * step:.12g}") for k in range(first, math.floor(high / step) + 1)]
