"""Intervals in words: few digits, rounded outward, and arrays in a few lines."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np

from ivsid.display.table import html

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ivsid.intervals.array import IntervalArray

# Entries of an array that its text shows.
# Source: resource: with all digits of both bounds, a dozen lines of a terminal
MOST_ENTRIES: Final = 16
# Digits that tell any two doubles apart.
# Source: IEEE 754-2019, section 5.12.2
DIGITS: Final = 17


def shown(lower: float, upper: float, digits: int = 6) -> str:
    """An interval in decimals, rounded outward; open ends as words."""
    return f"[{_end(lower, digits, up=False)}, {_end(upper, digits, up=True)}]"


def _end(x: float, digits: int, *, up: bool) -> str:
    if not math.isfinite(x):
        return "no bound"
    rounded = Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR).create_decimal_from_float(x)
    text = f"{float(rounded):.{digits}g}"
    # Below the smallest normal double, digits are lost on the way.
    return text if Decimal(text) == rounded else str(rounded)


def array_text(array: IntervalArray, entry: Callable[[float, float], str]) -> str:
    """The array in nested brackets, with at most ``MOST_ENTRIES`` intervals, each in the words of ``entry``."""
    most = _side(array.ndim)

    def nested(lower: NDArray[np.float64], upper: NDArray[np.float64]) -> str:
        if lower.ndim == 0:
            return entry(float(lower), float(upper))
        inner = [nested(a, b) for a, b in zip(lower[:most], upper[:most], strict=True)]
        return "[" + ", ".join(inner + (["..."] if len(lower) > most else [])) + "]"

    rest = "" if max(array.shape, default=0) <= most else f", shape {array.shape}"
    return f"IntervalArray({nested(array.lower, array.upper)}{rest})"


def interval_html(lower: float, upper: float) -> str:
    """One interval in few digits, and below in as many as tell each double from its neighbours."""
    if lower > upper:
        return html("Interval [empty]", {})
    return html(f"Interval {shown(lower, upper)}", {"with all digits": [shown(lower, upper, DIGITS)]})


def array_html(array: IntervalArray) -> str:
    """A table with the first entries of the array, by their indices; those of a matrix side by side."""
    heading = f"IntervalArray of shape {array.shape}"
    if array.ndim != 2:
        return html(
            heading,
            {"index": [str(i) for i in _first(array.shape)], "interval": [_at(array, i) for i in _first(array.shape)]},
        )
    rows, columns = (range(min(n, _side(2))) for n in array.shape)
    cells = {"row": [str(r) for r in rows], **{f"column {c}": [_at(array, (r, c)) for r in rows] for c in columns}}
    return html(heading, cells)


def _side(dimensions: int) -> int:
    return max(int(MOST_ENTRIES ** (1 / max(dimensions, 1)) + 1e-9), 1)


def _first(shape: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    return product(*(range(min(n, _side(len(shape)))) for n in shape))


def _at(array: IntervalArray, index: tuple[int, ...]) -> str:
    lower, upper = float(array.lower[index]), float(array.upper[index])
    return "[empty]" if lower > upper else shown(lower, upper)
