"""Intervals of other libraries, both ways: exact where the other format holds two doubles, outward where it does not.

- mpmath (``mpmath.iv``): ends of any precision. Towards it exact, from it rounded outward.
- python-flint (``flint.arb``): midpoint and radius. Both ways outward; an unbounded interval becomes the whole line.
- codac (``codac.Interval``) and pyinterval (``interval.interval``): two doubles. Exact; a union of several intervals becomes its hull. When it is
  loaded, codac leaves the processor rounding upward, where ivsid refuses to compute: set the mode back to nearest, or use another process.
- Polars: a column of structs ``lower``, ``upper``, which Parquet and Arrow keep bit by bit; empty entries are null.

None of these libraries is needed unless a function names it.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Iterable
from fractions import Fraction
from types import ModuleType
from typing import TYPE_CHECKING, Final, Protocol, TypeAlias, cast

import numpy as np

from ivsid.errors import IvsidError
from ivsid.intervals.array import Interval, IntervalArray

if TYPE_CHECKING:
    import polars as pl


# An interval of another library, whose classes cannot be named where it is not installed.
Foreign: TypeAlias = object
# Sign, mantissa, exponent and bits of a number of mpmath.
_Number: TypeAlias = tuple[int, int, int, int]


class _Mpmath(Protocol):
    _mpi_: tuple[_Number, _Number]


class _Arb(Protocol):
    def mid(self) -> _Arb: ...
    def rad(self) -> _Arb: ...
    def man_exp(self) -> tuple[int, int]: ...
    def is_finite(self) -> bool: ...
    def is_nan(self) -> bool: ...


class _Codac(Protocol):
    def lb(self) -> float: ...
    def ub(self) -> float: ...
    def is_empty(self) -> bool: ...


def _library(name: str, package: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise IvsidError(f"{name} is not installed; pip install {package}") from None


def _down(x: Fraction) -> float:
    """The largest double not above a rational."""
    try:
        nearest = x.numerator / x.denominator
    except OverflowError:
        return float(np.finfo(np.float64).max) if x > 0 else -math.inf
    return nearest if Fraction(nearest) <= x else math.nextafter(nearest, -math.inf)


def _outward(lower: Fraction, upper: Fraction) -> Interval:
    return Interval(_down(lower), -_down(-upper))


def _dyadic(mantissa: int, exponent: int) -> Fraction:
    power = int(exponent)
    return Fraction(int(mantissa)) * (Fraction(2) ** power)


# Bits of a midpoint of two doubles at most, which lie between 2^1024 and 2^-1074, and some to spare.
# Source: definition: exponents of a double
WIDEST: Final = 4400


def _not_empty(x: Interval, library: str) -> None:
    if x.empty:
        raise IvsidError(f"{library} has no empty interval; ask x.empty first")


def to_mpmath(x: Interval) -> Foreign:
    """The same interval as ``mpmath.iv.mpf``, exactly.

    Raises:
        IvsidError: mpmath is not installed, or the interval is empty.
    """
    mpmath = _library("mpmath", "mpmath")
    _not_empty(x, "mpmath")
    convert = mpmath.libmp.from_float
    return cast(Foreign, mpmath.iv.make_mpf((convert(x.lower), convert(x.upper))))


def _mpmath_end(value: _Number, libmp: ModuleType) -> Fraction | float:
    if value == libmp.finf:
        return math.inf
    if value == libmp.fninf:
        return -math.inf
    if value == libmp.fnan:
        return math.nan
    sign, mantissa, exponent, _ = value
    return _dyadic(-mantissa if sign else mantissa, exponent)


def from_mpmath(x: Foreign) -> Interval:
    """An interval of ``mpmath.iv``, rounded outward.

    Raises:
        IvsidError: another type, or NaN.
    """
    if not hasattr(x, "_mpi_"):
        raise IvsidError(f"from_mpmath takes an interval of mpmath.iv, and {type(x).__name__} was given")
    libmp = _library("mpmath", "mpmath").libmp
    lower, upper = (_mpmath_end(end, libmp) for end in cast(_Mpmath, x)._mpi_)
    low = _down(lower) if isinstance(lower, Fraction) else lower
    return Interval(low, -_down(-upper) if isinstance(upper, Fraction) else upper)


def to_arb(x: Interval) -> Foreign:
    """A ball of python-flint around the interval: its midpoint is exact, its radius rounded up.

    Raises:
        IvsidError: python-flint is not installed, or the interval is empty.
    """
    flint = _library("flint", "python-flint")
    _not_empty(x, "python-flint")
    if not (math.isfinite(x.lower) and math.isfinite(x.upper)):
        return cast(Foreign, flint.arb(0, math.inf))
    # Twice the midpoint and twice the radius over a power of two: the constructor takes integers exactly.
    twice, width = (Fraction(x.upper) + Fraction(x.lower)), (Fraction(x.upper) - Fraction(x.lower))
    exponent = max(twice.denominator.bit_length(), width.denominator.bit_length()) - 1
    mid, radius = (int(v * 2**exponent) for v in (twice, width))
    ball = flint.arb(mid, flint.arb(radius)) if radius else flint.arb(mid)
    before = flint.ctx.prec
    try:
        # Enough bits that the midpoint stays exact under a power of two.
        flint.ctx.prec = WIDEST
        return cast(Foreign, ball * flint.arb((1, -exponent - 1)))
    finally:
        flint.ctx.prec = before


def from_arb(x: Foreign) -> Interval:
    """The tightest interval around a ball of python-flint.

    Raises:
        IvsidError: another type, or NaN.
    """
    if not all(hasattr(x, name) for name in ("mid", "rad", "is_finite")):
        raise IvsidError(f"from_arb takes a ball of python-flint, and {type(x).__name__} was given")
    ball = cast(_Arb, x)
    if ball.is_nan():
        raise IvsidError("from_arb takes a ball around numbers, and NaN was given")
    if not ball.is_finite():
        return Interval.entire()
    mid, radius = (_dyadic(*part.man_exp()) for part in (ball.mid(), ball.rad()))
    return _outward(mid - radius, mid + radius)


def to_codac(x: Interval) -> Foreign:
    """The same interval as ``codac.Interval``, exactly.

    Raises:
        IvsidError: codac is not installed, or has changed the rounding mode.
    """
    codac = _library("codac", "codac")
    return cast(Foreign, codac.Interval.empty() if x.empty else codac.Interval(x.lower, x.upper))


def from_codac(x: Foreign) -> Interval:
    """An interval of codac, exactly.

    Raises:
        IvsidError: another type.
    """
    if not all(hasattr(x, name) for name in ("lb", "ub", "is_empty")):
        raise IvsidError(f"from_codac takes an interval of codac, and {type(x).__name__} was given")
    found = cast(_Codac, x)
    return Interval.empty_set() if found.is_empty() else Interval(float(found.lb()), float(found.ub()))


def to_pyinterval(x: Interval) -> Foreign:
    """The same interval as ``interval.interval`` of pyinterval, exactly.

    Raises:
        IvsidError: pyinterval is not installed.
    """
    interval = _library("interval", "pyinterval").interval
    return cast(Foreign, interval() if x.empty else interval([x.lower, x.upper]))


def from_pyinterval(x: Foreign) -> Interval:
    """The hull of an interval of pyinterval, which may be a union of several, exactly.

    Raises:
        IvsidError: another type.
    """
    if not hasattr(x, "extrema"):
        raise IvsidError(f"from_pyinterval takes an interval of pyinterval, and {type(x).__name__} was given")
    ends = [end for part in cast(Iterable[tuple[float, float]], x) for end in part]
    return Interval(min(ends), max(ends)) if ends else Interval.empty_set()


_FROM: Final[dict[str, Callable[[Foreign], Interval]]] = {
    "mpmath": from_mpmath,
    "flint": from_arb,
    "codac": from_codac,
    "interval": from_pyinterval,
}


def interval_of(x: Foreign) -> Interval:
    """An interval of any of these libraries, told by the module of its type.

    Raises:
        IvsidError: a type of none of them.
    """
    if isinstance(x, Interval):
        return x
    home = type(x).__module__.split(".")[0]
    if home not in _FROM:
        raise IvsidError(
            f"{type(x).__name__} of {home} is no interval of mpmath, python-flint, codac or pyinterval; give Interval(lower, upper)"
        )
    return _FROM[home](x)


def to_polars(x: IntervalArray, name: str = "interval") -> pl.Series:
    """A column of structs ``lower`` and ``upper``; empty intervals are null.

    Args:
        x: shape (n,).
        name: of the column.

    Raises:
        IvsidError: another shape.
    """
    import polars as pl  # noqa: PLC0415 - takes a quarter of a second, which intervals alone need not wait for

    if x.ndim != 1:
        raise IvsidError(f"a column takes intervals of shape (n,), and {x.shape} was given; flatten them")
    frame = pl.DataFrame({"lower": x.lower, "upper": x.upper, "_empty": x.empty})
    both = pl.struct("lower", "upper")
    return frame.select(pl.when(~pl.col("_empty")).then(both).alias(name)).to_series()


def from_polars(column: pl.Series) -> IntervalArray:
    """The intervals of a column of structs ``lower`` and ``upper``; null is the empty interval.

    Raises:
        IvsidError: a column of another kind, or bounds that are no interval.
    """
    import polars as pl  # noqa: PLC0415 - as above

    kind = column.dtype
    if not isinstance(kind, pl.Struct) or {f.name for f in kind.fields} != {"lower", "upper"}:
        raise IvsidError(f"column {column.name} is of type {kind}; give structs of lower and upper")
    ends = [column.struct.field(n) for n in ("lower", "upper")]
    missing = column.is_null()
    if any((end.is_null() & ~missing).any() for end in ends):
        raise IvsidError(
            f"column {column.name} has an interval with one bound; give both, or null for the empty interval"
        )
    lower, upper = (end.fill_null(0.0).to_numpy() for end in ends)
    found = IntervalArray(lower, upper)
    empty = missing.to_numpy()
    if not empty.any():
        return found
    low, high = np.where(empty, math.inf, found.lower), np.where(empty, -math.inf, found.upper)
    return IntervalArray._raw((low, high), low.shape)
