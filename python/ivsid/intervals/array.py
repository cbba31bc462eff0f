"""Arrays of intervals: two arrays of float64 bounds, every operation rounded outward by the core (IEEE 1788)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, Self, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ivsid import _core
from ivsid.errors import IvsidError
from ivsid.intervals.floats import FloatArray, exact_floats
from ivsid.intervals.operators import Operators
from ivsid.intervals.recommended import RecommendedFunctions
from ivsid.intervals.reverses import ReverseOperations
from ivsid.intervals.shown import array_html, array_text

Interval = _core.Interval


class IntervalArray(Operators, RecommendedFunctions, ReverseOperations):
    """An array of closed intervals.

    Operators, matmul, and NumPy's arithmetic, elementary (exp, log, sin, arctan2, power, ...) and rounding functions give the
    tightest intervals of IEEE 1788. Operands that are no intervals count as exact numbers. NumPy's functions that rearrange
    entries (concatenate, stack, sum, where, reshape, ravel, transpose, broadcast_to, squeeze) take interval arrays, too.

    Args:
        lower: lower bounds, any shape; float64 arrays are kept without a copy.
        upper: upper bounds of the same shape; equal to ``lower`` where left out.

    Raises:
        IvsidError: NaN, reversed bounds, different shapes, or an interval without a finite point.
    """

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]  # == compares entrywise

    def __init__(self, lower: ArrayLike, upper: ArrayLike | None = None) -> None:
        low = exact_floats(lower, "the lower bound")
        high = low if upper is None else exact_floats(upper, "the upper bound")
        if low.shape != high.shape:
            raise IvsidError(f"the lower bound has shape {low.shape}, the upper {high.shape}; they must be equal")
        _core.check_bounds(np.ascontiguousarray(low).ravel(), np.ascontiguousarray(high).ravel())
        self._set(low, high)

    def _set(self, lower: FloatArray, upper: FloatArray) -> None:
        self._lower, self._upper = lower.view(), upper.view()
        self._lower.flags.writeable = self._upper.flags.writeable = False

    @classmethod
    def _raw(cls, bounds: tuple[FloatArray, FloatArray] | FloatArray, shape: tuple[int, ...]) -> Self:
        # The bounds were made for this array, or are read-only already.
        new = cls.__new__(cls)
        lower, upper = bounds[0], bounds[1]
        if lower.shape != shape:
            lower, upper = lower.reshape(shape), upper.reshape(shape)
        new._lower, new._upper = lower, upper
        lower.flags.writeable = upper.flags.writeable = False
        return new

    @classmethod
    def around(cls, centre: ArrayLike, radius: ArrayLike) -> IntervalArray:
        """The intervals ``centre`` +- ``radius``, rounded outward; the shapes of the two broadcast.

        Raises:
            IvsidError: no numbers, NaN, an integer without an exact double, or a negative radius.
        """
        r = exact_floats(radius, "the radius")
        return cls(centre) + cls(-r, r)

    @classmethod
    def concatenate(cls, parts: Sequence[IntervalArray], axis: int = 0) -> IntervalArray:
        """The arrays joined along an axis."""
        lower, upper = ([np.asarray(getattr(p, end)) for p in parts] for end in ("lower", "upper"))
        joined = np.concatenate(lower, axis)
        return IntervalArray._raw((joined, np.concatenate(upper, axis)), joined.shape)

    @classmethod
    def stack(cls, parts: Sequence[IntervalArray], axis: int = 0) -> IntervalArray:
        """The arrays stacked along a new axis."""
        joined = np.stack([p.lower for p in parts], axis)
        return IntervalArray._raw((joined, np.stack([p.upper for p in parts], axis)), joined.shape)

    @property
    def T(self) -> IntervalArray:  # noqa: N802 - NumPy's name
        """The transpose."""
        return IntervalArray._raw((self._lower.T, self._upper.T), self._lower.T.shape)

    def _measure(self, name: str) -> FloatArray:
        return _core.measure(name, *self._flat()).reshape(self.shape)

    @property
    def midpoint(self) -> FloatArray:
        """The double nearest to the centre of each interval, inside it."""
        return self._measure("midpoint")

    @property
    def radius(self) -> FloatArray:
        """The smallest double r with the interval inside midpoint +- r."""
        return self._measure("radius")

    @property
    def width(self) -> FloatArray:
        """``upper`` less ``lower``, rounded up."""
        return self._measure("width")

    @property
    def magnitude(self) -> FloatArray:
        """The largest absolute value."""
        _check_mode()
        found: FloatArray = np.maximum(np.abs(self._lower), np.abs(self._upper))
        return self._measure("magnitude") if self.empty.any() else found

    @property
    def mignitude(self) -> FloatArray:
        """The smallest absolute value."""
        return self._measure("mignitude")

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether each number is inside its interval; shapes broadcast.

        Raises:
            IvsidError: points that are no numbers.
        """
        p = exact_floats(points, "the points")
        _check_mode()
        return np.isfinite(p) & (self._lower <= p) & (p <= self._upper)

    def subset(self, other: IntervalArray | Interval) -> NDArray[np.bool_]:
        """Whether each interval is a subset of the other's; the empty one is a subset of all."""
        o = interval_array(other)
        _check_mode()
        return self.empty | ((o.lower <= self._lower) & (self._upper <= o.upper))

    def intersection(self, other: Operand) -> IntervalArray:
        """The intersection with another array; shapes broadcast. See ``empty``."""
        return binary("intersection", self, other)

    def hull(self, other: Operand) -> IntervalArray:
        """The convex hull with another array; shapes broadcast."""
        return binary("hull", self, other)

    def signed_square(self) -> IntervalArray:
        """``x |x|``, the quadratic drag law."""
        # The square of the part above zero less the square of the part below: each end is rounded once.
        above, below = binary("max", self, 0.0), binary("min", self, 0.0)
        return above.square() - below.square()

    def square(self) -> IntervalArray:
        """``x^2``."""
        return self._unary("square")

    def rootn(self, n: int) -> IntervalArray:
        """The n-th roots: of all members for an odd ``n``, of those from 0 on for an even one, and not of 0 for a negative one.

        Raises:
            IvsidError: ``n`` is no integer of 32 bits.
        """
        if not -(2**31) <= n < 2**31:
            raise IvsidError(f"rootn takes an integer between -2^31 and 2^31, and {n} was given")
        return IntervalArray._raw(_core.root(*self._flat(), n), self.shape)

    def sum(self, axis: int | None = None) -> Any:
        """The sum along an axis, by halves, each step rounded outward; without an axis the sum of all entries, rounded once."""
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

    def _binary(self, op: str, other: Operand) -> IntervalArray:
        return binary(op, self, other)

    def _reflected(self, op: str, other: Operand) -> IntervalArray:
        return binary(op, other, self)

    def __pow__(self, exponent: Operand) -> IntervalArray:
        return power(self, exponent)

    def __rpow__(self, base: Operand) -> IntervalArray:
        return power(base, self)

    def __matmul__(self, other: Operand) -> IntervalArray:
        return matmul(self, other)

    def __rmatmul__(self, other: Operand) -> IntervalArray:
        return matmul(other, self)

    def __eq__(self, other: object) -> Any:
        if not isinstance(other, (IntervalArray, Interval, int, float, np.number, np.bool_)):
            return NotImplemented
        return equal(self, other)

    def __ne__(self, other: object) -> NDArray[np.bool_]:  # type: ignore[override]  # compares entrywise
        # Python would ask for the truth of the whole array.
        found: NDArray[np.bool_] = self.__eq__(other)
        return found if found is NotImplemented else ~found

    def __contains__(self, _: object) -> bool:
        raise TypeError("whether a number is in an array of intervals is asked entry by entry; use contains")

    def __getstate__(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self._lower), np.array(self._upper)

    def __setstate__(self, state: tuple[FloatArray, FloatArray]) -> None:
        lower, upper = (exact_floats(end, "a stored bound") for end in state)
        if lower.shape != upper.shape:
            raise IvsidError(f"stored bounds have shapes {lower.shape} and {upper.shape}; they must be equal")
        # Empty intervals are stored as reversed infinities.
        empty = (lower == np.inf) & (upper == -np.inf)
        _core.check_bounds(np.where(empty, 0.0, lower).ravel(), np.where(empty, 0.0, upper).ravel())
        self._set(lower, upper)

    def __repr__(self) -> str:
        return array_text(self, _text)

    def _repr_html_(self) -> str:
        return array_html(self)


Operand: TypeAlias = IntervalArray | Interval | ArrayLike


def _text(lower: float, upper: float) -> str:
    return "[empty]" if lower > upper else _core.format_interval(lower, upper)


def _interval(lower: float, upper: float) -> Interval:
    return Interval.empty_set() if lower > upper else Interval(lower, upper)


def _check_mode() -> None:
    """Refuses a changed floating-point mode: where denormals count as zero, comparisons of doubles are wrong, too."""
    if not _core.environment_is_default():
        # The core has the sentence.
        _core.check_bounds(np.zeros(0), np.zeros(0))


def equal(x: Operand, y: Operand) -> NDArray[np.bool_]:
    """Whether the intervals are the same, entry by entry; shapes broadcast."""
    a, b = interval_array(x), interval_array(y)
    _check_mode()
    return np.asarray((a.lower == b.lower) & (a.upper == b.upper))


def scalar(result: IntervalArray) -> Any:
    """An ``Interval`` from an array without dimensions; other arrays unchanged."""
    return result if result.shape else _interval(float(result.lower), float(result.upper))


def bound(value: ArrayLike) -> float:
    """A bound of an ``Interval`` from a number that is neither a float nor a small integer, such as NumPy's.

    Raises:
        IvsidError: no number, an array, or an integer without an exact double.
    """
    array = exact_floats(value, "the bound")
    if array.ndim:
        raise IvsidError(f"a bound of shape {array.shape} was given; an Interval has one number a side")
    return float(array)


def interval_array(value: Operand) -> IntervalArray:
    """The operand as an array of intervals; a number is the interval of that point alone.

    Raises:
        IvsidError: no numbers, or NaN.
    """
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
    """The operation ``op`` of the core on two operands, broadcast against each other.

    Raises:
        IvsidError: shapes that do not fit together.
    """
    x, y = interval_array(a), interval_array(b)
    try:
        shape = x.shape if x.shape == y.shape else np.broadcast_shapes(x.shape, y.shape)
    except ValueError:
        raise IvsidError(f"shapes {x.shape} and {y.shape} do not fit together") from None
    left = _contiguous(x.lower, shape), _contiguous(x.upper, shape)
    right = _contiguous(y.lower, shape), _contiguous(y.upper, shape)
    return IntervalArray._raw(_core.binary(op, left, right), shape)


def solve_rows(
    op: str, rows: list[tuple[FloatArray, FloatArray]], n: int | None, shape: tuple[int, ...]
) -> IntervalArray:
    """The reverse operation ``op`` of the core on flat rows of bounds, or with an integer ``n`` that of its power."""
    found = _core.reverse(op, rows) if n is None else _core.power_reverse(rows[0], rows[1], n)
    return IntervalArray._raw(found, shape)


def operate(op: str, a: Any, b: Any) -> Any:
    """An operator of an ``Interval`` with an operand that is no interval and no float, such as an array."""
    if isinstance(a, str | bytes) or isinstance(b, str | bytes) or a is None or b is None:
        return NotImplemented
    return scalar(power(a, b) if op == "pow" else binary(op, a, b))


def power(base: Operand, exponent: Operand) -> IntervalArray:
    """``x^n`` for integers ``n``, else ``x^y`` of the members ``x > 0``, and of 0 for positive ``y`` (IEEE 1788, pown and pow).

    Args:
        base: any intervals.
        exponent: an integer, an array of integers, or any intervals; shapes broadcast.
    """
    if isinstance(exponent, int | np.integer):
        return _whole_power(interval_array(base), int(exponent))
    whole = np.asarray(exponent) if isinstance(exponent, np.ndarray | list | tuple) else None
    if whole is None or whole.dtype.kind not in "biu":
        return binary("pow", base, exponent)
    x = interval_array(base)
    shape = np.broadcast_shapes(x.shape, whole.shape)
    lower, upper = (np.broadcast_to(end, shape).copy() for end in (x.lower, x.upper))
    n = np.broadcast_to(whole, shape)
    for each in np.unique(whole):
        at = n == each
        found = _whole_power(IntervalArray._raw((lower[at], upper[at]), (int(at.sum()),)), int(each))
        lower[at], upper[at] = found.lower, found.upper
    return IntervalArray._raw((lower, upper), shape)


def _whole_power(x: IntervalArray, n: int) -> IntervalArray:
    """``x^n``; the members below zero have the power of their magnitude, with a sign where ``n`` is odd."""
    if -(2**31) <= n < 2**31:
        return IntervalArray._raw(_core.power(*x._flat(), n), x.shape)
    largest = float(np.finfo(np.float64).max)
    nearest = float(n) if abs(n) <= int(largest) else (largest if n > 0 else -largest)
    # Beyond 2^53 an integer lies between two doubles.
    between = IntervalArray(
        nearest if int(nearest) <= n else math.nextafter(nearest, -math.inf),
        nearest if int(nearest) >= n else math.nextafter(nearest, math.inf),
    )
    above = binary("pow", x, between)
    below = binary("pow", -x, between)
    return above.hull(-below if n % 2 else below)


def matmul(a: Operand, b: Operand) -> IntervalArray:
    """The product of matrices or vectors, each entry the tightest interval.

    Raises:
        IvsidError: operands of other dimensions, or inner sizes that differ.
    """
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
    """The output x of a first-order lag whose input g has a zero-order hold.

    Over each step x becomes e x + (1 - e) g, for any e within ``slack`` of ``decay``.

    Args:
        start: bounds of x at the first row, and again after a step that is not whole.
        goal: the input at each row, shape (n,).
        decay: e of each step, shape (n - 1,).
        slack: bound on the error of each e, shape (n - 1,).
        whole: steps over which the input is known, shape (n - 1,).

    Returns:
        Intervals of x at the rows, shape (n,).
    """
    found = _core.follow(start, goal._flat(), _contiguous(decay, decay.shape), _contiguous(slack, slack.shape), whole)
    return IntervalArray._raw(found, goal.shape)


def outward_decimal(x: float, *, up: bool) -> str:
    """The shortest decimal that reads back as ``x`` and is at most ``x``, or with ``up`` at least ``x``."""
    return _core.outward_decimal(x, up)
