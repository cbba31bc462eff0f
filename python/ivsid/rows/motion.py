"""Quantities that move in time: an interval of the value over a step, and an interval of its rate of change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ivsid.effects.cross_flow import cross_flow_over, steepest_over
from ivsid.intervals import IntervalArray

# NumPy's functions take intervals, but its type stubs do not.
_minimum: Any = np.minimum
_tanh: Any = np.tanh
_cos: Any = np.cos
_sin: Any = np.sin

Scalar: TypeAlias = "Motion | float"


@dataclass(frozen=True)
class Motion:
    """A value and its time derivative; the operators follow the rules of differentiation.

    Rates that are bounded by stated limits give the Lipschitz constant of a quadrature (docs/theory.md, "Rows").

    Attributes:
        value: its range, any shape.
        rate: range of its time derivative, of a shape that broadcasts with the value's.
    """

    value: IntervalArray
    rate: IntervalArray

    def __add__(self, other: Scalar) -> Motion:
        if isinstance(other, Motion):
            return Motion(self.value + other.value, self.rate + other.rate)
        return Motion(self.value + other, self.rate)

    __radd__ = __add__

    def __neg__(self) -> Motion:
        return Motion(-self.value, -self.rate)

    def __sub__(self, other: Scalar) -> Motion:
        return self + (-other)

    def __rsub__(self, other: float) -> Motion:
        return (-self) + other

    def __mul__(self, other: Scalar) -> Motion:
        if isinstance(other, Motion):
            return Motion(self.value * other.value, self.rate * other.value + self.value * other.rate)
        return Motion(self.value * other, self.rate * other)

    __rmul__ = __mul__

    def __abs__(self) -> Motion:
        both = self.rate.hull(-self.rate)
        return Motion(abs(self.value), both)

    def square(self) -> Motion:
        """``x^2``."""
        return Motion(self.value.square(), 2.0 * self.value * self.rate)

    def signed_square(self) -> Motion:
        """``x |x|``."""
        return Motion(self.value.signed_square(), 2.0 * abs(self.value) * self.rate)

    def cube(self) -> Motion:
        """``x^3``."""
        return Motion(self.value**3, 3.0 * self.value.square() * self.rate)

    def astern_square(self) -> Motion:
        """``x |x|`` where x is negative, else 0."""
        negative = _minimum(self.value, 0.0)
        return Motion(negative.signed_square(), 2.0 * abs(negative) * self.rate)

    def tanh(self) -> Motion:
        """Hyperbolic tangent."""
        value = _tanh(self.value)
        return Motion(value, (1.0 - value.square()) * self.rate)

    def cos(self) -> Motion:
        """Cosine of an angle [rad]."""
        return Motion(_cos(self.value), -(_sin(self.value) * self.rate))

    def sin(self) -> Motion:
        """Sine of an angle [rad]."""
        return Motion(_sin(self.value), _cos(self.value) * self.rate)

    def cross_flow(self, r: Motion, half: float, power: int) -> Motion:
        """The integral of ``x^power w |w|``, w = self + x r, over x from -half to half, with its rate (``cross_flow``)."""
        plain, first, second = steepest_over(self.value, r.value, half)
        by_v, by_r = (plain, first) if power == 0 else (first, second)
        return Motion(cross_flow_over(self.value, r.value, half, power), (by_v * self.rate + by_r * r.rate) * 2.0)
