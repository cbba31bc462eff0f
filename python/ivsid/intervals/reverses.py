"""Reverse operations of arrays: the solutions of an equation in intervals, under the names that ``Interval`` has for them.

Source: IEEE 1788-2015, tables 10.1 and 10.6 (sqrRev, absRev, pownRev, sinRev, cosRev, tanRev, coshRev, mulRev, mulRevToPair, powRev1, powRev2, atan2Rev1, atan2Rev2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from ivsid.errors import IvsidError
from ivsid.intervals.floats import FloatArray

if TYPE_CHECKING:
    from ivsid.intervals.array import Interval, IntervalArray, Operand


class ReverseOperations:
    """Methods of arrays of intervals; each returns the tightest intervals around the solutions, and broadcasts shapes."""

    __slots__ = ()

    @property
    def _own(self) -> IntervalArray:
        return cast("IntervalArray", self)

    def sqr_rev(self, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with t^2 in these intervals."""
        return _solved("sqr_rev", self._own, x)

    def abs_rev(self, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with ``|t|`` in these intervals."""
        return _solved("abs_rev", self._own, x)

    def powi_rev(self, n: int, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with t^n in these intervals.

        Raises:
            IvsidError: ``n`` is no integer of 32 bits.
        """
        return _power_solved(self._own, n, x)

    def sin_rev(self, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with sin t in these intervals."""
        return _solved("sin_rev", self._own, x)

    def cos_rev(self, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with cos t in these intervals."""
        return _solved("cos_rev", self._own, x)

    def tan_rev(self, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with tan t in these intervals."""
        return _solved("tan_rev", self._own, x)

    def cosh_rev(self, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with cosh t in these intervals."""
        return _solved("cosh_rev", self._own, x)

    def mul_rev(self, c: Operand, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with b t in ``c`` for some b of these intervals."""
        return _solved("mul_rev", self._own, c, x)

    def mul_rev_to_pair(self, c: Operand) -> tuple[IntervalArray, IntervalArray]:
        """The numbers t with b t in ``c`` for some b, as two parts: below and above a gap, the second empty where there is none."""
        return _solved("mul_rev_first", self._own, c), _solved("mul_rev_second", self._own, c)

    def pow_rev_base(self, c: Operand, x: Operand | None = None) -> IntervalArray:
        """The members t >= 0 of ``x`` (all numbers if left out) with t^y in ``c`` for some y of these intervals."""
        return _solved("pow_rev_base", self._own, c, x)

    def pow_rev_exponent(self, c: Operand, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) with b^t in ``c`` for some b >= 0 of these intervals."""
        return _solved("pow_rev_exponent", self._own, c, x)

    def arctan2_rev_y(self, c: Operand, y: Operand | None = None) -> IntervalArray:
        """The members t of ``y`` (all numbers if left out) for which the angle of (s, t) is in ``c`` for some s of these intervals."""
        return _solved("arctan2_rev_y", self._own, c, y)

    def arctan2_rev_x(self, c: Operand, x: Operand | None = None) -> IntervalArray:
        """The members t of ``x`` (all numbers if left out) for which the angle of (t, s) is in ``c`` for some s of these intervals."""
        return _solved("arctan2_rev_x", self._own, c, x)


def _solved(op: str, *operands: Operand | None, n: int | None = None) -> IntervalArray:
    """The reverse operation ``op`` of the core, the interval that is searched last, and the real line if it is left out.

    Raises:
        IvsidError: shapes that do not fit together, or operands that are no numbers.
    """
    from ivsid.intervals.array import Interval, interval_array, solve_rows  # noqa: PLC0415 - it stands on this module

    found = [interval_array(Interval.entire() if each is None else each) for each in operands]
    try:
        shape = np.broadcast_shapes(*(x.shape for x in found))
    except ValueError:
        shapes = " and ".join(str(x.shape) for x in found)
        raise IvsidError(f"shapes {shapes} do not fit together") from None

    def row(end: FloatArray) -> FloatArray:
        return np.ascontiguousarray(np.broadcast_to(end, shape)).ravel()

    return solve_rows(op, [(row(x.lower), row(x.upper)) for x in found], n, shape)


def _power_solved(c: Operand, n: object, x: Operand | None) -> IntervalArray:
    if not isinstance(n, int | np.integer) or not -(2**31) <= n < 2**31:
        raise IvsidError(f"powi_rev takes an integer between -2^31 and 2^31, and {n!r} was given")
    return _solved("powi_rev", c, x, n=int(n))


def reverse(op: str, operands: tuple[Operand | None, ...]) -> IntervalArray | Interval:
    """A reverse operation of an ``Interval`` with an operand that is no interval and no float, such as an array."""
    from ivsid.intervals.array import scalar  # noqa: PLC0415 - it stands on this module

    found: IntervalArray | Interval = scalar(_solved(op, *operands))
    return found


def power_reverse(c: Operand, n: object, x: Operand | None) -> IntervalArray | Interval:
    """The reverse of an integer power, likewise."""
    from ivsid.intervals.array import scalar  # noqa: PLC0415 - it stands on this module

    found: IntervalArray | Interval = scalar(_power_solved(c, n, x))
    return found
