"""Operators and shape of interval arrays, in terms of the two arrays of bounds and of named operations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals.floats import FloatArray

if TYPE_CHECKING:
    from ivsid.intervals.array import IntervalArray, Operand


class Operators:
    """The arithmetic operators, the shape and NumPy's hooks of ``IntervalArray``."""

    __slots__ = ("_lower", "_upper")

    _lower: FloatArray
    _upper: FloatArray

    if TYPE_CHECKING:

        def _unary(self, op: str) -> IntervalArray: ...
        def _binary(self, op: str, other: Operand) -> IntervalArray: ...
        def _reflected(self, op: str, other: Operand) -> IntervalArray: ...

    @property
    def lower(self) -> FloatArray:
        """Lower bounds (a read-only view)."""
        return self._lower

    @property
    def upper(self) -> FloatArray:
        """Upper bounds (a read-only view)."""
        return self._upper

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of either array of bounds."""
        return self._lower.shape

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return self._lower.ndim

    @property
    def size(self) -> int:
        """Number of intervals."""
        return self._lower.size

    @property
    def empty(self) -> NDArray[np.bool_]:
        """Whether each interval is empty, as after an intersection of disjoint intervals."""
        return self._lower > self._upper

    def __add__(self, other: Operand) -> IntervalArray:
        return self._binary("add", other)

    def __radd__(self, other: Operand) -> IntervalArray:
        return self._reflected("add", other)

    def __sub__(self, other: Operand) -> IntervalArray:
        return self._binary("sub", other)

    def __rsub__(self, other: Operand) -> IntervalArray:
        return self._reflected("sub", other)

    def __mul__(self, other: Operand) -> IntervalArray:
        return self._binary("mul", other)

    def __rmul__(self, other: Operand) -> IntervalArray:
        return self._reflected("mul", other)

    def __truediv__(self, other: Operand) -> IntervalArray:
        return self._binary("div", other)

    def __rtruediv__(self, other: Operand) -> IntervalArray:
        return self._reflected("div", other)

    def __pos__(self) -> Self:
        return self

    def __neg__(self) -> IntervalArray:
        return self._unary("neg")

    def __abs__(self) -> IntervalArray:
        return self._unary("abs")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        from ivsid.intervals.protocol import ufunc as apply  # noqa: PLC0415 - it stands on this class

        return apply(ufunc, method, inputs, options)

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        from ivsid.intervals.protocol import function as apply  # noqa: PLC0415 - it stands on this class

        return apply(function, arguments, options)
