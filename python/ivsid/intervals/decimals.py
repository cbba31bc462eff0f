"""Intervals of numbers that were read as decimals."""

from __future__ import annotations

import numpy as np

from ivsid.intervals.array import Interval


def of_decimals(ends: tuple[float, float]) -> Interval:
    """The interval that holds two decimals, each read as its nearest double: a double further on either side."""
    return Interval(float(np.nextafter(ends[0], -np.inf)), float(np.nextafter(ends[1], np.inf)))
