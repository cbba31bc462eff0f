"""Intervals and arrays of intervals: two float64 bounds, every operation rounded outward by the core."""

from ivsid.intervals.array import FloatArray, Interval, IntervalArray, Operand, bound, follow, operate, outward_decimal
from ivsid.intervals.endpoints import EndpointPair
from ivsid.intervals.protocol import ufunc

# What the core's Interval calls for operands that are neither intervals nor numbers.
_bound, _operate, _ufunc = bound, operate, ufunc

__all__ = ["EndpointPair", "FloatArray", "Interval", "IntervalArray", "Operand", "follow", "outward_decimal"]
