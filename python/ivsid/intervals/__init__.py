"""Intervals and arrays of intervals: two float64 bounds, every operation rounded outward by the core (IEEE 1788).

- ``array``: ``IntervalArray`` over two NumPy arrays. ``Interval`` is the core's, which this module alone imports here.
- ``floats``: numbers of a user as float64, without a rounding.
- ``protocol``: NumPy's functions of interval arrays; ``recommended`` and ``reverses``: functions of IEEE 1788 that NumPy lacks.
- ``decimals``: intervals of numbers that a file states.
- ``exchange``: intervals of other libraries, and columns of intervals.
- ``endpoints``: bounds that may be reversed, the result of the published method.
- ``shown``: intervals and arrays in words, rounded outward.
- ``pieces``: work over many rows in pieces that stay in the cache, on all processors.
- ``apart``: a task in a process of its own; ``turns``: tasks that two processes take in turn.

The chapter may use ``errors`` and the compiled core. Every other chapter may use it, except the checker.
"""

from ivsid.intervals.array import Interval, IntervalArray, Operand, bound, follow, operate, outward_decimal
from ivsid.intervals.decimals import of_decimals
from ivsid.intervals.endpoints import EndpointPair
from ivsid.intervals.floats import FloatArray
from ivsid.intervals.protocol import ufunc
from ivsid.intervals.reverses import power_reverse, reverse
from ivsid.intervals.shown import interval_html, shown

# The core's Interval calls these for operands that are neither intervals nor numbers, and in a notebook.
_bound, _operate, _ufunc, _html = bound, operate, ufunc, interval_html
_reverse, _power_reverse = reverse, power_reverse

__all__ = [
    "EndpointPair",
    "FloatArray",
    "Interval",
    "IntervalArray",
    "Operand",
    "follow",
    "of_decimals",
    "outward_decimal",
    "shown",
]
