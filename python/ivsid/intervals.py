"""Intervals and arrays of intervals: two float64 bounds, every operation rounded outward by the core."""

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

_BINARY = {
    np.add: "add",
    np.subtract: "sub",
    np.multiply: "mul",
    np.true_divide: "div",
    np.minimum: "min",
    np.maximum: "max",
}
_UNARY = {np.negative: "neg", np.absolute: "abs", np.square: "square", np.sqrt: "sqrt"}


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

    Operators and the NumPy functions add, subtract, multiply, divide, negative, absolute, square, sqrt, minimum, maximum
    and matmul round outward (IEEE 1788, tightest); other operands are taken as exact numbers.
    """

    __slots__ = ("_lower", "_upper")
    __hash__ = None  # type: ignore[assignment]  # == compares entrywise

    def __init__(self, lower: ArrayLike, upper: ArrayLike | None = None) -> None:
        low = _floats(lower, "the lower bound")
        high = low if upper is None else _floats(upper, "the upper bound")
        if low.shape != high.shape:
            raise IvsidError(f"the lower bound has shape {low.shape}, the upper {high.shape}; they must be equal")
        try:
            _core.check_bounds(np.ascontiguousarray(low).ravel(), np.ascontiguousarray(high).ravel())
        except ValueError as refusal:
            raise IvsidError(str(refusal)) from None
        self._set(low, high)

    def _set(self, lower: FloatArray, upper: FloatArray) -> None:
        self._lower, self._upper = lower.view(), upper.view()
        self._lower.flags.writeable = self._upper.flags.writeable = False

    @classmethod
    def _raw(cls, bounds: tuple[FloatArray, FloatArray], shape: tuple[int, ...]) -> Self:
        new = cls.__new__(cls)
        new._set(bounds[0].reshape(shape), bounds[1].reshape(shape))
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
        return self._measure("magnitude")

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
        o = _interval_array(other)
        return self.empty | ((o.lower <= self._lower) & (self._upper <= o.upper))

    def intersection(self, other: Operand) -> IntervalArray:
        """The common members; see ``empty``."""
        return _binary("intersection", self, other)

    def hull(self, other: Operand) -> IntervalArray:
        """The smallest intervals that hold both."""
        return _binary("hull", self, other)

    def signed_square(self) -> IntervalArray:
        """``x |x|``, the quadratic drag law."""
        return self._unary("signed_square")

    def square(self) -> IntervalArray:
        """``x^2``."""
        return self._unary("square")

    def sum(self, axis: int = 0) -> IntervalArray:
        """Sum along an axis, in order, each step rounded outward."""
        lower, upper = np.moveaxis(self._lower, axis, 0), np.moveaxis(self._upper, axis, 0)
        total = IntervalArray(np.zeros(lower.shape[1:]))
        for low, high in zip(lower, upper, strict=True):
            total = total + IntervalArray._raw((low, high), low.shape)
        return total

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
            return Interval(float(lower), float(upper))
        return IntervalArray._raw((lower, upper), lower.shape)

    def __len__(self) -> int:
        return len(self._lower)

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __add__(self, other: Operand) -> IntervalArray:
        return _binary("add", self, other)

    def __radd__(self, other: Operand) -> IntervalArray:
        return _binary("add", other, self)

    def __sub__(self, other: Operand) -> IntervalArray:
        return _binary("sub", self, other)

    def __rsub__(self, other: Operand) -> IntervalArray:
        return _binary("sub", other, self)

    def __mul__(self, other: Operand) -> IntervalArray:
        return _binary("mul", self, other)

    def __rmul__(self, other: Operand) -> IntervalArray:
        return _binary("mul", other, self)

    def __truediv__(self, other: Operand) -> IntervalArray:
        return _binary("div", self, other)

    def __rtruediv__(self, other: Operand) -> IntervalArray:
        return _binary("div", other, self)

    def __neg__(self) -> IntervalArray:
        return self._unary("neg")

    def __abs__(self) -> IntervalArray:
        return self._unary("abs")

    def __matmul__(self, other: Operand) -> IntervalArray:
        return _matmul(self, other)

    def __rmatmul__(self, other: Operand) -> IntervalArray:
        return _matmul(other, self)

    def __eq__(self, other: object) -> Any:
        if not isinstance(other, (IntervalArray, Interval)):
            return NotImplemented
        o = _interval_array(other)
        return (self._lower == o.lower) & (self._upper == o.upper)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        if method == "__call__" and not options:
            if ufunc in _BINARY:
                return _binary(_BINARY[ufunc], *inputs)
            if ufunc in _UNARY:
                return _interval_array(inputs[0])._unary(_UNARY[ufunc])
            if ufunc is np.matmul:
                return _matmul(*inputs)
            if ufunc is np.positive:
                return self
        names = ", ".join(sorted(u.__name__ for u in (*_BINARY, *_UNARY, np.matmul)))
        raise TypeError(f"np.{ufunc.__name__} is not defined for intervals in this version; there are {names}")

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


class Interval:
    """One closed interval.

    Args:
        lower: the lower bound as it is, or text such as ``"[0.1, 0.2]"`` or ``"0.1"``, which is enclosed.
        upper: the upper bound; equal to ``lower`` where left out.

    Raises:
        IvsidError: NaN, reversed bounds, no finite point, or text that is no interval.
    """

    __slots__ = ("_lower", "_upper")
    __array_ufunc__ = None  # NumPy operands defer to the operators below

    def __init__(self, lower: float | str, upper: float | None = None) -> None:
        try:
            if isinstance(lower, str):
                if upper is not None:
                    raise IvsidError("give either text or two bounds, not both")
                self._lower, self._upper = _core.parse_interval(lower)
            else:
                bounds = IntervalArray([lower], [lower if upper is None else upper])
                self._lower, self._upper = float(bounds.lower[0]), float(bounds.upper[0])
        except IvsidError:
            raise
        except ValueError as refusal:
            raise IvsidError(str(refusal)) from None

    @property
    def lower(self) -> float:
        """Lower bound."""
        return self._lower

    @property
    def upper(self) -> float:
        """Upper bound."""
        return self._upper

    def _array(self) -> IntervalArray:
        return IntervalArray._raw((np.array([self._lower]), np.array([self._upper])), ())

    @property
    def midpoint(self) -> float:
        """A double inside, nearest to the centre."""
        return float(self._array().midpoint)

    @property
    def radius(self) -> float:
        """The smallest double r with the interval inside midpoint +- r."""
        return float(self._array().radius)

    @property
    def width(self) -> float:
        """Upper - lower, rounded up."""
        return float(self._array().width)

    @property
    def magnitude(self) -> float:
        """The largest absolute value."""
        return float(self._array().magnitude)

    @property
    def empty(self) -> bool:
        """Whether nothing is inside."""
        return self._lower > self._upper

    def contains(self, point: float) -> bool:
        """Whether the number is inside."""
        return math.isfinite(point) and self._lower <= point <= self._upper

    def subset(self, other: Interval) -> bool:
        """Whether this lies in the other."""
        return self.empty or (other.lower <= self._lower and self._upper <= other.upper)

    def intersection(self, other: Interval) -> Interval:
        """The common members."""
        return cast(Interval, self._binary("intersection", other))

    def hull(self, other: Interval) -> Interval:
        """The smallest interval that holds both."""
        return cast(Interval, self._binary("hull", other))

    def _binary(self, op: str, other: Operand, *, reverse: bool = False) -> Any:
        result = _binary(op, other, self) if reverse else _binary(op, self, other)
        return _scalar(result)

    def __add__(self, other: Operand) -> Any:
        return self._binary("add", other)

    def __radd__(self, other: Operand) -> Any:
        return self._binary("add", other, reverse=True)

    def __sub__(self, other: Operand) -> Any:
        return self._binary("sub", other)

    def __rsub__(self, other: Operand) -> Any:
        return self._binary("sub", other, reverse=True)

    def __mul__(self, other: Operand) -> Any:
        return self._binary("mul", other)

    def __rmul__(self, other: Operand) -> Any:
        return self._binary("mul", other, reverse=True)

    def __truediv__(self, other: Operand) -> Any:
        return self._binary("div", other)

    def __rtruediv__(self, other: Operand) -> Any:
        return self._binary("div", other, reverse=True)

    def __neg__(self) -> Interval:
        return cast(Interval, _scalar(-self._array()))

    def __abs__(self) -> Interval:
        return cast(Interval, _scalar(abs(self._array())))

    def sqrt(self) -> Interval:
        """The square root of the non-negative part."""
        return cast(Interval, _scalar(self._array()._unary("sqrt")))

    def square(self) -> Interval:
        """The squares of the members."""
        return cast(Interval, _scalar(self._array().square()))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Interval) and (self._lower, self._upper) == (other._lower, other._upper)

    def __hash__(self) -> int:
        return hash((self._lower, self._upper))

    def __getstate__(self) -> tuple[float, float]:
        return self._lower, self._upper

    def __setstate__(self, state: tuple[float, float]) -> None:
        self._lower, self._upper = state

    def __repr__(self) -> str:
        # The decimals are outward, and as float literals they read back as the same doubles.
        return f"Interval({outward_decimal(self._lower, up=False)}, {outward_decimal(self._upper, up=True)})"

    def __str__(self) -> str:
        return _text(self._lower, self._upper)


Operand: TypeAlias = IntervalArray | Interval | ArrayLike


class EndpointPair:
    """Two arrays of bounds that may be reversed: what the published method gives. It has no arithmetic and no claim.

    Attributes:
        lower: what the method calls lower bounds.
        upper: what the method calls upper bounds.
        improper: where the lower bound lies above the upper one.
    """

    __slots__ = ("improper", "lower", "upper")

    def __init__(self, lower: FloatArray, upper: FloatArray) -> None:
        self.lower, self.upper = lower, upper
        self.improper: NDArray[np.bool_] = lower > upper

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of either array."""
        return self.lower.shape

    def __repr__(self) -> str:
        return f"EndpointPair(lower={self.lower!r}, upper={self.upper!r}, improper={int(self.improper.sum())})"


def _text(lower: float, upper: float) -> str:
    return "[empty]" if lower > upper else _core.format_interval(lower, upper)


def _scalar(result: IntervalArray) -> Any:
    """An interval from an array without dimensions; other arrays as they are."""
    if result.shape:
        return result
    new = Interval.__new__(Interval)
    new._lower, new._upper = float(result.lower), float(result.upper)
    return new


def _interval_array(value: Operand) -> IntervalArray:
    if isinstance(value, IntervalArray):
        return value
    if isinstance(value, Interval):
        return value._array()
    return IntervalArray(value)


def _binary(op: str, a: Operand, b: Operand) -> IntervalArray:
    x, y = _interval_array(a), _interval_array(b)
    try:
        shape = np.broadcast_shapes(x.shape, y.shape)
    except ValueError:
        raise IvsidError(f"shapes {x.shape} and {y.shape} do not fit together") from None

    def flat(v: IntervalArray) -> tuple[FloatArray, FloatArray]:
        spread = (np.broadcast_to(end, shape) for end in (v.lower, v.upper))
        lower, upper = (np.ascontiguousarray(s, dtype=np.float64).ravel() for s in spread)
        return lower, upper

    return IntervalArray._raw(_core.binary(op, flat(x), flat(y)), shape)


def _matmul(a: Operand, b: Operand) -> IntervalArray:
    x, y = _interval_array(a), _interval_array(b)
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
    return result if shape else cast(IntervalArray, _scalar(result))


def outward_decimal(x: float, *, up: bool) -> str:
    """The shortest decimal that reads back as ``x`` and does not lie above it, or with ``up`` below it."""
    return _core.outward_decimal(x, up)
