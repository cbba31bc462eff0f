"""Figures that the page draws itself, in its own colours: intervals as bars, and a force against what orders it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ivsid.report.page import Part
from ivsid.report.scaling import narrow_axis, padded, ticks

Array = NDArray[np.float64]
# Width and height of a curve's figure, and its margins left, top, right and bottom [units of its own].
# Source: definition: letters of 12 units stay legible at the width of a phone
FRAME = (440.0, 270.0, 56.0, 12.0, 12.0, 44.0)

# A bar over the whole axis, with an arrow at both ends.
ENDLESS = {"left": 0.0, "width": 100.0, "less": True, "more": True}


@dataclass(frozen=True)
class Bar:
    """An interval of a number.

    Attributes:
        label: whose it is.
        lower: end; infinite without one.
        upper: end; infinite without one.
        words: the interval in words.
        proved: whether it is guaranteed.
    """

    label: str
    lower: float
    upper: float
    words: str
    proved: bool = False


@dataclass(frozen=True)
class Bars:
    """Intervals of one number over one axis.

    Attributes:
        number: its name with its unit.
        rows: its intervals.
        points: further values of it with their names, as a claim.
    """

    number: str
    rows: tuple[Bar, ...]
    points: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Dots:
    """Values against a quantity.

    Attributes:
        label: what they are.
        role: as of a line of a series.
        x: shape (k,).
        y: shape (k,).
        error: half-length of a bar up and down, shape (k,); None for a line without bars.
    """

    label: str
    role: str
    x: Array
    y: Array
    error: Array | None = None


def bars(caption: str, numbers: Sequence[Bars]) -> Part:
    """Intervals of numbers as bars, each number over an axis that its narrow intervals set; a wide one runs off with an arrow."""
    return {"kind": "bars", "caption": caption, "numbers": [_number(n) for n in numbers]}


def _number(n: Bars) -> dict[str, object]:
    ends = narrow_axis([(b.lower, b.upper) for b in n.rows], [p for _, p in n.points])
    if ends is None:
        return {
            "number": n.number,
            "rows": [{"label": b.label, "words": b.words, "proved": b.proved, "bar": ENDLESS} for b in n.rows],
            "axis": [],
            "points": [],
        }
    low, high = ends

    def place(x: float) -> float:
        return round(100.0 * min(max((x - low) / (high - low), 0.0), 1.0), 2)

    rows = [
        {
            "label": b.label,
            "words": b.words,
            "proved": b.proved,
            "bar": {
                "left": place(b.lower),
                "width": round(place(b.upper) - place(b.lower), 2),
                "less": b.lower < low,
                "more": b.upper > high,
            },
        }
        for b in n.rows
    ]
    points = [
        {"label": label, "words": f"{x:.4g}", "at": place(x), "less": x < low, "more": x > high}
        for label, x in n.points
        if math.isfinite(x)
    ]
    return {
        "number": n.number,
        "rows": rows,
        "points": points,
        "axis": [{"at": place(x), "text": f"{x:.4g}"} for x in ticks(low, high, 4)],
    }


def curve(title: str, caption: str, x_label: str, y_label: str, dots: Sequence[Dots]) -> Part:
    """Values against a quantity, as dots with their errors or as a dashed line."""
    width, height, left, top, right, bottom = FRAME
    xs = np.concatenate([d.x for d in dots])
    ys = np.concatenate(
        [np.r_[d.y - e, d.y + e] for d in dots for e in (np.zeros(d.y.size) if d.error is None else d.error,)]
    )
    x_ends, y_ends = (
        padded(float(xs.min()), float(xs.max())),
        padded(float(min(ys.min(), 0.0)), float(max(ys.max(), 0.0))),
    )

    def across(x: float) -> float:
        return round(left + (x - x_ends[0]) / (x_ends[1] - x_ends[0]) * (width - left - right), 1)

    def up(y: float) -> float:
        return round(height - bottom - (y - y_ends[0]) / (y_ends[1] - y_ends[0]) * (height - top - bottom), 1)

    sets = [
        {
            "label": d.label,
            "role": d.role,
            "line": d.error is None,
            "dots": [
                {"x": across(x), "y": up(y), "low": up(y - e), "high": up(y + e)}
                for x, y, e in zip(
                    d.x.tolist(), d.y.tolist(), (d.y * 0 if d.error is None else d.error).tolist(), strict=True
                )
            ],
        }
        for d in dots
    ]
    return {
        "kind": "curve",
        "title": title,
        "caption": caption,
        "x_label": x_label,
        "y_label": y_label,
        "frame": {
            "width": width,
            "height": height,
            "left": left,
            "top": top,
            "right": width - right,
            "bottom": height - bottom,
        },
        "zero": up(0.0),
        "x_ticks": [{"at": across(x), "text": f"{x:.4g}"} for x in ticks(*x_ends)],
        "y_ticks": [{"at": up(y), "text": f"{y:.4g}"} for y in ticks(*y_ends)],
        "sets": sets,
    }
