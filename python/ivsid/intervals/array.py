"""Arrays of intervals: two float64 bounds, every operation rounded outward by the core."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, Self, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ivsid import _core
from ivsid.errors import IvsidError

FloatArray: TypeAlias = NDArray[np.float64]

if not _core.environment_is_default():
    raise ImportError(
        "the processor does not round to nearest or flushes subnormal numbers to zero; ivsid cannot prove anything "
        "here: undo the change of the floating-point mode before importing it"
    )

Interval = _core.Interval


def _floats(values: ArrayLike, what: str) -> FloatArray:
    """Float64 without a copy where possible; refuses what has no exact double."""
    array = np.asarray(values)
    if array.dtype == np.float64:
        return cast(FloatArray, array)
    if array.dtype.kind in "biu" or array.dtype in (np.float32, np.float16):
        floats = array.astype(np.float64)
        large = np.abs(floats) >= 2.0**53
        if array.dtype.kind in "iu" and large.any():
            exact = all(int(f) == int(i) for f, i in zip(floats[large], array[large], strict=True))
            if not exact:
                raise IvsidError(
                    f"{what} has an integer beyond 2**53 without an exact double; enclose it by two bounds"
                )
        return floats
    raise IvsidError(f"{what} is of type {array.dtype}; give float64 numbers")


class IntervalArray:
    """An array of closed intervals.

    Args:
        lower: lower bounds, any shape; float64 arrays are kept without a copy.
        upper: upper bounds of the same shape; equal to ``lower`` where left out.

    Raises:
        IvsidError: NaN, reversed bounds, different shapes, or an interval without a finite point.

    Operators, matmul, and NumPy's arithmetic, elementary (exp, log, sin, arctan2, power, ...) and rounding functions give
    the tightest intervals of IEEE 1788; other operands are taken as exact numbers. The NumPy functions concatenate, stack,
    sum, where, reshape, ravel, transpose, broadcast_to and squeeze understand interval arrays too.
    """

    __slots__ = ("_lower", "_upper")
    __hash__ = None  # type: ignore[assignment]  # == compares entrywise

    def __init__(self, lower: ArrayLike, upper: ArrayLike | None = None) -> None:
        low = _floats(lower, "the lower bound")
        high = low if upper is None else _floats(upper, "the upper bound")
        if low.shape != high.shape:
            raise IvsidError(f"the lower bound has shape {low.shape}, the upper {high.shape}; they must be equal")
        _core.check_bounds(np.ascontiguousarray(low).ravel(), np.ascontiguousarray(high).ravel())
        self._set(low, high)

    def _set(self, lower: FloatArray, upper: FloatArray) -> None:
        self._lower, self._upper = lower.view(), upper.view()
        self._lower.flags.writeable = self._upper.flags.writeable = False

    @classmethod
    def _raw(cls, bounds: tuple[FloatArray, FloatArray] | FloatArray, shape: tuple[int, ...]) -> Self:
        # What comes here was made for this array, or is read-only already.
        new = cls.__new__(cls)
        lower, upper = bounds[0], bounds[1]
        if lower.shape != shape:
            lower, upper = lower.reshape(shape), upper.reshape(shape)
        new._lower, new._upper = lower, upper
        lower.flags.writeable = upper.flags.writeable = False
        return new

    @classmethod
    def around(cls, centre: ArrayLike, radius: ArrayLike) -> IntervalArray:
        """The intervals ``centre`` +- ``radius``, rounded outward; shapes broadcast."""
        r = np.asarray(radius, dtype=np.float64)
        return cls(centre) + cls(-r, r)

    @classmethod
    def concatenate(cls, parts: Sequence[IntervalArray], axis: int = 0) -> IntervalArray:
        """Joins arrays along an axis."""
        lower, upper = ([np.asarray(getattr(p, end)) for p in parts] for end in ("lower", "upper"))
        joined = np.concatenate(lower, axis)
        return IntervalArray._raw((joined, np.concatenate(upper, axis)), joined.shape)

    @classmethod
    def stack(cls, parts: Sequence[IntervalArray], axis: int = 0) -> IntervalArray:
        """Stacks arrays along a new axis."""
        joined = np.stack([p.lower for p in parts], axis)
        return IntervalArray._raw((joined, np.stack([p.upper for p in parts], axis)), joined.shape)

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
    def T(self) -> IntervalArray:  # noqa: N802 - NumPy's name
        """The transpose."""
        return IntervalArray._raw((self._lower.T, self._upper.T), self._lower.T.shape)

    def _measure(self, name: str) -> FloatArray:
        return _core.measure(name, *self._flat()).reshape(self.shape)

    @property
    def midpoint(self) -> FloatArray:
        """A double inside each interval, nearest to its centre."""
        return self._measure("midpoint")

    @property
    def radius(self) -> FloatArray:
        """The smallest double r with the interval inside midpoint +- r."""
        return self._measure("radius")

    @property
    def width(self) -> FloatArray:
        """Upper - lower, rounded up."""
        return self._measure("width")

    @property
    def magnitude(self) -> FloatArray:
        """The largest absolute value."""
        found: FloatArray = np.maximum(np.abs(self._lower), np.abs(self._upper))
        return self._measure("magnitude") if self.empty.any() else found

    @property
    def mignitude(self) -> FloatArray:
        """The smallest absolute value."""
        return self._measure("mignitude")

    @property
    def empty(self) -> NDArray[np.bool_]:
        """Where nothing is inside, as after an intersection of disjoint intervals."""
        return self._lower > self._upper

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each number is inside."""
        p = _floats(points, "the points")
        return np.isfinite(p) & (self._lower <= p) & (p <= self._upper)

    def subset(self, other: IntervalArray | Interval) -> NDArray[np.bool_]:
        """Whether each interval lies in the other's."""
        o = interval_array(other)
        return self.empty | ((o.lower <= self._lower) & (self._upper <= o.upper))

    def intersection(self, other: Operand) -> IntervalArray:
        """The common members; see ``empty``."""
        return binary("intersection", self, other)

    def hull(self, other: Operand) -> IntervalArray:
        """The smallest intervals that hold both."""
        return binary("hull", self, other)

    def signed_square(self) -> IntervalArray:
        """``x |x|``, the quadratic drag law."""
        # The square of the part above zero less that of the part below: vectorised, and each end rounded once as in one operation.
        above, below = binary("max", self, 0.0), binary("min", self, 0.0)
        return above.square() - below.square()

    def square(self) -> IntervalArray:
        """``x^2``."""
        return self._unary("square")

    def sum(self, axis: int | None = None) -> Any:
        """Sum along an axis, by halves, each step rounded outward; without an axis the sum of all, rounded once."""
        if axis is None:
            return Interval(*_core.exact_sum(*self._flat())) if not self.empty.any() else Interval.empty_set()
        lower, upper = np.moveaxis(self._lower, axis, 0), np.moveaxis(self._upper, axis, 0)
        rest = IntervalArray._raw((lower, upper), lower.shape)
        if not len(rest):
            return IntervalArray(np.zeros(rest.shape[1:]))
        while len(rest) > 1:
            half = len(rest) // 2
            pairs = rest[:half] + rest[half : 2 * half]
            rest = IntervalArray.concatenate([pairs, rest[2 * half :]]) if len(rest) % 2 else pairs
        return rest[0]

    def reshape(self, *shape: int) -> IntervalArray:
        """The same intervals in another shape."""
        lower = self._lower.reshape(*shape)
        return IntervalArray._raw((lower, self._upper.reshape(*shape)), lower.shape)

    def _flat(self) -> tuple[FloatArray, FloatArray]:
        return np.ascontiguousarray(self._lower).ravel(), np.ascontiguousarray(self._upper).ravel()

    def _unary(self, op: str) -> IntervalArray:
        return IntervalArray._raw(_core.unary(op, *self._flat()), self.shape)

    def __getitem__(self, index: Any) -> Any:
        lower, upper = self._lower[index], self._upper[index]
        if np.ndim(lower) == 0:
            return _interval(float(lower), float(upper))
        return IntervalArray._raw((lower, upper), lower.shape)

    def __len__(self) -> int:
        return len(self._lower)

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __add__(self, other: Operand) -> IntervalArray:
        return binary("add", self, other)

    def __radd__(self, other: Operand) -> IntervalArray:
        return binary("add", other, self)

    def __sub__(self, other: Operand) -> IntervalArray:
        return binary("sub", self, other)

    def __rsub__(self, other: Operand) -> IntervalArray:
        return binary("sub", other, self)

    def __mul__(self, other: Operand) -> IntervalArray:
        return binary("mul", self, other)

    def __rmul__(self, other: Operand) -> IntervalArray:
        return binary("mul", other, self)

    def __truediv__(self, other: Operand) -> IntervalArray:
        return binary("div", self, other)

    def __rtruediv__(self, other: Operand) -> IntervalArray:
        return binary("div", other, self)

    def __pow__(self, exponent: Operand) -> IntervalArray:
        return power(self, exponent)

    def __rpow__(self, base: Operand) -> IntervalArray:
        return power(base, self)

    def __pos__(self) -> IntervalArray:
        return self

    def __neg__(self) -> IntervalArray:
        return self._unary("neg")

    def __abs__(self) -> IntervalArray:
        return self._unary("abs")

    def __matmul__(self, other: Operand) -> IntervalArray:
        return matmul(self, other)

    def __rmatmul__(self, other: Operand) -> IntervalArray:
        return matmul(other, self)

    def __eq__(self, other: object) -> Any:
        if not isinstance(other, (IntervalArray, Interval)):
            return NotImplemented
        o = interval_array(other)
        return (self._lower == o.lower) & (self._upper == o.upper)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        from ivsid.intervals.protocol import ufunc as apply  # noqa: PLC0415 - it stands on this class

        return apply(ufunc, method, inputs, options)

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        from ivsid.intervals.protocol import function as apply  # noqa: PLC0415 - it stands on this class

        return apply(function, arguments, options)

    def __getstate__(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self._lower), np.array(self._upper)

    def __setstate__(self, state: tuple[FloatArray, FloatArray]) -> None:
        self._set(*state)

    def __repr__(self) -> str:
        def nested(lower: Any, upper: Any) -> str:
            if np.ndim(lower) == 0:
                return _text(float(lower), float(upper))
            shown = [nested(a, b) for a, b in zip(lower[:20], upper[:20], strict=True)]
            return "[" + ", ".join(shown + (["..."] if len(lower) > 20 else [])) + "]"

        return f"IntervalArray({nested(self._lower, self._upper)})"


Operand: TypeAlias = IntervalArray | Interval | ArrayLike


def _text(lower: float, upper: float) -> str:
    return "[empty]" if lower > upper else _core.format_interval(lower, upper)


def _interval(lower: float, upper: float) -> Interval:
    return Interval.empty_set() if lower > upper else Interval(lower, upper)


def scalar(result: IntervalArray) -> Any:
    """An interval from an array without dimensions; other arrays as they are."""
    return result if result.shape else _interval(float(result.lower), float(result.upper))


def bound(value: Any) -> float:
    """A bound that is neither a float nor a small integer: a NumPy number, or refused."""
    array = _floats(value, "the bound")
    if array.ndim:
        raise IvsidError(f"a bound of shape {array.shape} was given; an Interval has one number a side")
    return float(array)


def interval_array(value: Operand) -> IntervalArray:
    """The operand as an array of intervals; numbers are points."""
    if isinstance(value, IntervalArray):
        return value
    if isinstance(value, Interval):
        return IntervalArray._raw((np.array([value.lower]), np.array([value.upper])), ())
    return IntervalArray(value)


def _contiguous(bounds: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    if bounds.shape != shape:
        if not bounds.ndim:
            return np.full(math.prod(shape), bounds)
        bounds = np.broadcast_to(bounds, shape)
    flat = np.ascontiguousarray(bounds)
    return flat if flat.ndim == 1 else flat.reshape(-1)


def binary(op: str, a: Operand, b: Operand) -> IntervalArray:
    """An operation of the core on two operands, broadcast against each other."""
    x, y = interval_array(a), interval_array(b)
    try:
        shape = x.shape if x.shape == y.shape else np.broadcast_shapes(x.shape, y.shape)
    except ValueError:
        raise IvsidError(f"shapes {x.shape} and {y.shape} do not fit together") from None
    left = _contiguous(x.lower, shape), _contiguous(x.upper, shape)
    right = _contiguous(y.lower, shape), _contiguous(y.upper, shape)
    return IntervalArray._raw(_core.binary(op, left, right), shape)


def operate(op: str, a: Any, b: Any) -> Any:
    """An operator of an Interval with something that is no interval and no number."""
    if isinstance(a, str | bytes) or isinstance(b, str | bytes) or a is None or b is None:
        return NotImplemented
    return scalar(power(a, b) if op == "pow" else binary(op, a, b))


def power(base: Operand, exponent: Operand) -> IntervalArray:
    """``x^n`` for an integer ``n``, else ``x^y`` of the members ``x > 0``, and 0 to positive powers."""
    if isinstance(exponent, int | np.integer) and -(2**31) <= exponent < 2**31:
        x = interval_array(base)
        return IntervalArray._raw(_core.power(*x._flat(), int(exponent)), x.shape)
    return binary("pow", base, exponent)


def matmul(a: Operand, b: Operand) -> IntervalArray:
    """The tight product of matrices or vectors."""
    x, y = interval_array(a), interval_array(b)
    if not (x.ndim in (1, 2) and y.ndim in (1, 2)):
        raise IvsidError(f"a product of shapes {x.shape} and {y.shape} is not defined; give matrices or vectors")
    left = x.reshape(1, -1) if x.ndim == 1 else x
    right = y.reshape(-1, 1) if y.ndim == 1 else y

    def contiguous(v: IntervalArray) -> tuple[FloatArray, FloatArray]:
        return np.ascontiguousarray(v.lower), np.ascontiguousarray(v.upper)

    if left.shape[1] != right.shape[0]:
        raise IvsidError(f"a product of shapes {x.shape} and {y.shape} is not defined; the inner sizes differ")
    product = _core.matmul(contiguous(left), contiguous(right))
    shape = (*x.shape[:-1], *(y.shape[1:] if y.ndim == 2 else ()))
    result = IntervalArray._raw(product, shape)
    return result if shape else cast(IntervalArray, scalar(result))


def follow(
    start: tuple[float, float], goal: IntervalArray, decay: FloatArray, slack: FloatArray, whole: NDArray[np.bool_]
) -> IntervalArray:
    """What follows held goals behind a first-order lag, x' = e x + (1 - e) g for a share e that is within ``slack`` of ``decay``.

    Args:
        start: bounds at the first row, and again after a step that is not whole.
        goal: of each row, shape (n,).
        decay: shape (n - 1,).
        slack: shape (n - 1,).
        whole: shape (n - 1,).
    """
    found = _core.follow(start, goal._flat(), _contiguous(decay, decay.shape), _contiguous(slack, slack.shape), whole)
    return IntervalArray._raw(found, goal.shape)


def outward_decimal(x: float, *, up: bool) -> str:
    """The shortest decimal that reads back as ``x`` and does not lie above it, or with ``up`` below it."""
    return _core.outward_decimal(x, up)
