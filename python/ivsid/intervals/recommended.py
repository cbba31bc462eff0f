"""Functions that IEEE 1788 recommends, of arrays: those for which NumPy has no ufunc, and the same names as those of ``Interval``.

Source: IEEE 1788-2015, table 10.5, and the reciprocals of the trigonometric and hyperbolic functions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ivsid.intervals.array import IntervalArray, Operand


class RecommendedFunctions:
    """Methods of arrays of intervals; each returns the tightest intervals around the values of all members that have one."""

    __slots__ = ()

    if TYPE_CHECKING:

        def _unary(self, op: str) -> IntervalArray: ...
        def _binary(self, op: str, other: Operand) -> IntervalArray: ...

    def exp10(self) -> IntervalArray:
        """Powers of 10."""
        return self._unary("exp10")

    def expm1(self) -> IntervalArray:
        """Exponentials less 1."""
        return self._unary("exp_m1")

    def exp2m1(self) -> IntervalArray:
        """Powers of 2 less 1."""
        return self._unary("exp2_m1")

    def exp10m1(self) -> IntervalArray:
        """Powers of 10 less 1."""
        return self._unary("exp10_m1")

    def log1p(self) -> IntervalArray:
        """Natural logarithms of 1 plus the members above -1."""
        return self._unary("ln_1p")

    def log2p1(self) -> IntervalArray:
        """Logarithms to base 2 of 1 plus the members above -1."""
        return self._unary("log2_1p")

    def log10p1(self) -> IntervalArray:
        """Logarithms to base 10 of 1 plus the members above -1."""
        return self._unary("log10_1p")

    def cbrt(self) -> IntervalArray:
        """Cube roots."""
        return self._unary("cbrt")

    def rsqrt(self) -> IntervalArray:
        """Reciprocals of the square roots of the positive members."""
        return self._unary("rsqrt")

    def sinpi(self) -> IntervalArray:
        """Sines, of half turns."""
        return self._unary("sin_pi")

    def cospi(self) -> IntervalArray:
        """Cosines, of half turns."""
        return self._unary("cos_pi")

    def tanpi(self) -> IntervalArray:
        """Tangents, of half turns."""
        return self._unary("tan_pi")

    def arcsinpi(self) -> IntervalArray:
        """Arc sines in half turns of the members in [-1, 1]."""
        return self._unary("asin_pi")

    def arccospi(self) -> IntervalArray:
        """Arc cosines in half turns of the members in [-1, 1]."""
        return self._unary("acos_pi")

    def arctanpi(self) -> IntervalArray:
        """Arc tangents in half turns."""
        return self._unary("atan_pi")

    def sec(self) -> IntervalArray:
        """Reciprocals of the cosines, of radians."""
        return self._unary("sec")

    def csc(self) -> IntervalArray:
        """Reciprocals of the sines, of radians."""
        return self._unary("csc")

    def cot(self) -> IntervalArray:
        """Cotangents, of radians."""
        return self._unary("cot")

    def arccot(self) -> IntervalArray:
        """Arc cotangents in (0, pi)."""
        return self._unary("acot")

    def sech(self) -> IntervalArray:
        """Reciprocals of the hyperbolic cosines."""
        return self._unary("sech")

    def csch(self) -> IntervalArray:
        """Reciprocals of the hyperbolic sines of the members other than 0."""
        return self._unary("csch")

    def coth(self) -> IntervalArray:
        """Hyperbolic cotangents of the members other than 0."""
        return self._unary("coth")

    def arccoth(self) -> IntervalArray:
        """Inverse hyperbolic cotangents of the members outside [-1, 1]."""
        return self._unary("acoth")

    def arctan2pi(self, x: Operand) -> IntervalArray:
        """The angles of the points (x, self) in half turns, in (-1, 1]; shapes broadcast."""
        return self._binary("atan2_pi", x)

    def hypot(self, other: Operand) -> IntervalArray:
        """The lengths of the vectors (self, other); shapes broadcast."""
        return self._binary("hypot", other)

    def compoundm1(self, exponent: Operand) -> IntervalArray:
        """``(1 + self)^exponent - 1``, of the members above -1; shapes broadcast."""
        return self._binary("compound_m1", exponent)
