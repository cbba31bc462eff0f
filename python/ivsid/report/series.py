"""Time series and curves of a page: data for its script, thinned by least and largest values so that no peak is lost."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.report.page import Part
from ivsid.report.scaling import robust_range

# Roles of lines that are alike, in turn.
ALIKE: Final = ("first", "second", "third", "fourth")
Array = NDArray[np.float64]
# Most values of all figures of a page: 2 MB in base64, and a page has 3 MB.
# Source: resource: the size of a mail
MOST: Final = 360_000
# Most values of the stretch of a figure that is kept whole beside the thinned log.
# Source: resource: the size of a mail
MOST_FINE: Final = 20_000
# Samples that are thinned at once.
# Source: resource: 8 MB
PART: Final = 1 << 20
# Values beyond this, of a simulation that diverges, are drawn here.
# Source: definition: single precision ends at 3.4e38
LARGEST: Final = 3e38
# Largest difference from a uniform clock that is one, in steps.
# Source: definition: far below what a pixel shows
UNIFORM: Final = 1e-3


@dataclass(frozen=True)
class Line:
    """A line of a panel.

    Attributes:
        label: what it shows.
        role: ``measured``, ``before``, ``after``, ``cause``, or ``first`` to ``fourth`` of several alike: its colour and its dashes.
        values: shape (n,); NaN is a gap.
        tube: half-width of the band around it, in the panel's unit; 0 without one.
        dots: whether its values are points that no line joins.
    """

    label: str
    role: str
    values: Array
    tube: float = 0.0
    dots: bool = False


@dataclass(frozen=True)
class Panel:
    """One axis over time, or over what the figure has across.

    Attributes:
        title: of the axis, with its unit.
        lines: over the clock of the figure.
        robust: whether spikes do not set its axis; they are marked as cut.
        log: whether its axis is logarithmic; values that are not positive are gaps.
    """

    title: str
    lines: tuple[Line, ...]
    robust: bool = False
    log: bool = False


@dataclass(frozen=True)
class Across:
    """The axis that the panels of a figure share, where it is not time.

    Attributes:
        label: with its unit.
        log: whether it is logarithmic.
    """

    label: str = "time [s]"
    log: bool = False


TIME: Final = Across()


@dataclass(frozen=True)
class Mark:
    """A stretch of time that a link of the page jumps to.

    Attributes:
        label: what is seen there.
        start: [s].
        end: [s].
    """

    label: str
    start: float
    end: float


def series(
    name: str,
    title: str,
    caption: str,
    time: Array,
    panels: Iterable[Panel],
    marks: Sequence[Mark] = (),
    beside: int = 1,
    across: Across = TIME,
) -> Part:
    """A figure of linked time series, or of curves over another axis.

    Args:
        name: of the figure in the page: letters, digits and hyphens.
        title: of the figure.
        caption: what is to be seen.
        time: increasing clock [s], or values of ``across``, shape (n,).
        panels: one below the other; they share the clock, the cursor and the zoom.
        marks: stretches to jump to.
        beside: figures of the page that share its size with this one.
        across: the axis that the panels share.
    """
    shown = [p for p in panels if p.lines]
    # The script draws logarithms as they are, and writes what they stand for beside the axes.
    rows = [_decades(line.values) if p.log else line.values for p in shown for line in p.lines]
    span = f"over {time[-1] - time[0]:.4g} s" if across is TIME else f"against {across.label}"
    time = _decades(time) if across.log else time
    levels = [_level(time, rows, MOST // (1 + beside))]
    if levels[0]["bucket"] != 1 and marks:
        # The stretch of the first mark is kept sample by sample beside the thinned log.
        first, end = np.searchsorted(time, [marks[0].start, marks[0].end])
        few = slice(int(first), int(min(end, first + MOST_FINE // len(rows))))
        if few.stop - few.start > 1:
            levels.append(_level(time[few], [r[few] for r in rows], MOST_FINE))
    data = {
        "levels": levels,
        "panels": [_panel(p) for p in shown],
        "marks": [{"label": m.label, "start": m.start, "end": m.end} for m in marks],
        "across": {"label": across.label, "log": across.log},
    }
    words = f"{title}: {'; '.join(p.title for p in shown)} {span}"
    return {"kind": "series", "name": name, "title": title, "caption": caption, "words": words, "data": data}


def _decades(x: Array) -> Array:
    """Decimal logarithms; NaN where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(x > 0, np.log10(x), np.nan)


def thinned(time: Array, rows: Sequence[Array] | Array, most: int) -> tuple[Array, Array, int]:
    """Least and largest values of equally many samples, in the order in which they come.

    Args:
        time: shape (n,).
        rows: k of shape (n,); NaN is missing.
        most: values that may be left.

    Returns:
        Times, shape (m,); values, shape (k, m), k m <= ``most`` if anything has to go; and the samples in a pair of values, 1 if nothing went.
    """
    k, n = len(rows), time.size
    if k * n <= most:
        return time, np.stack(list(rows)), 1
    size = -(-n // max(most // (2 * k), 1))
    count = -(-n // size)
    pairs = np.empty((k, count, 2))
    together = max(1, PART // size)
    for row, made in zip(rows, pairs, strict=True):
        for first in range(0, count, together):
            made[first : first + together] = _ends(row[first * size : (first + together) * size], size)
    starts = time[::size]
    # The second value stands in the middle of its samples.
    middles = np.minimum(starts + 0.5 * np.r_[np.diff(starts), time[-1] - starts[-1]], time[-1])
    times: Array = np.stack([starts, middles], axis=1).ravel()
    return times, pairs.reshape(k, -1), size


def _ends(values: Array, size: int) -> Array:
    """Least and largest value of every ``size`` samples, in the order in which they come, shape (buckets, 2)."""
    parts = np.r_[values, np.full(-values.size % size, np.nan)].reshape(-1, size)
    low, high = np.asarray(np.fmin.reduce(parts, axis=1)), np.asarray(np.fmax.reduce(parts, axis=1))
    rises = (parts == low[:, None]).argmax(axis=1) <= (parts == high[:, None]).argmax(axis=1)
    return np.stack([np.where(rises, low, high), np.where(rises, high, low)], axis=1)


def _level(time: Array, rows: Sequence[Array], most: int) -> dict[str, object]:
    t, values, bucket = thinned(time, rows, most)
    step = (t[-1] - t[0]) / max(t.size - 1, 1)
    uniform = np.abs(t - t[0] - step * np.arange(t.size)).max() <= UNIFORM * step
    clock = {"step": float(step)} if uniform else {"time": _base64(t - t[0])}
    return {
        "start": float(t[0]),
        "count": int(t.size),
        "bucket": bucket,
        **clock,
        "values": [_base64(row) for row in values],
    }


def _panel(p: Panel) -> dict[str, object]:
    ends = robust_range([q.values for q in p.lines]) if p.robust else None
    beyond = 0 if ends is None else sum(_beyond(q.values, ends) for q in p.lines)
    return {
        "title": p.title,
        "lines": [{"label": q.label, "role": q.role, "tube": q.tube, "dots": q.dots} for q in p.lines],
        "range": None if ends is None else [float(f"{x:.6g}") for x in ends],
        "cut": beyond,
        "log": p.log,
    }


def _beyond(values: Array, ends: tuple[float, float]) -> int:
    """The number of values outside of an axis."""
    parts = (values[k : k + PART] for k in range(0, values.size, PART))
    return sum(int(((x < ends[0]) | (x > ends[1])).sum()) for x in parts)


def _base64(x: Array) -> str:
    """Single precision, least byte first; what exceeds it stands at its end."""
    return base64.b64encode(np.clip(x, -LARGEST, LARGEST).astype("<f4").tobytes()).decode()
