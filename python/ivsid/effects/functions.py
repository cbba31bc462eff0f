"""Functions of the physics for every kind of ``Quantity``.

Floats use the standard library. Intervals, values with rates and symbols bring a method of the function's name; arrays, and types
without such a method, use NumPy's function.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ivsid.effects.cross_flow import cross_flow_over
from ivsid.effects.quantity import Quantity
from ivsid.intervals import FloatArray, Interval, IntervalArray


def _apply(name: str, x: Quantity, scalar: Callable[[float], float]) -> Quantity:
    if isinstance(x, float):
        return scalar(x)
    method = getattr(x, name, None)
    return getattr(np, name)(x) if method is None else method()


def cos(x: Quantity) -> Quantity:
    """Cosine of an angle [rad]."""
    return _apply("cos", x, math.cos)


def sin(x: Quantity) -> Quantity:
    """Sine of an angle [rad]."""
    return _apply("sin", x, math.sin)


def tanh(x: Quantity) -> Quantity:
    """Hyperbolic tangent."""
    return _apply("tanh", x, math.tanh)


def sqrt(x: Quantity) -> Quantity:
    """Square root."""
    return _apply("sqrt", x, math.sqrt)


def signed_square(x: Quantity) -> Quantity:
    """``x |x|``; for intervals the exact range, also where they hold both signs."""
    return x.signed_square() if hasattr(x, "signed_square") else x * abs(x)


def square(x: Quantity) -> Quantity:
    """``x^2``; for intervals the exact range, also where they hold both signs."""
    return x.square() if hasattr(x, "square") else x * x


def cube(x: Quantity) -> Quantity:
    """``x^3``; for intervals the exact range, also where they hold both signs."""
    if isinstance(x, Interval | IntervalArray):
        return x**3
    # Products, because NumPy takes powers of an array by logarithms.
    return x.cube() if hasattr(x, "cube") else x * x * x


def astern_square(x: Quantity) -> Quantity:
    """``x |x|`` where x is negative, else 0."""
    if isinstance(x, float):
        return x * abs(x) if x < 0 else 0.0
    if hasattr(x, "astern_square"):
        return x.astern_square()
    return signed_square(np.minimum(x, 0.0))


def after(time: Quantity, start: float) -> Quantity:
    """The step function: 0 before ``start`` [s], 1 from then on."""
    if hasattr(time, "after"):
        return time.after(start)
    return np.where(time >= start, 1.0, 0.0) if isinstance(time, np.ndarray) else float(time >= start)


def cross_flow_force(v: Quantity, r: Quantity, half: float) -> Quantity:
    """The integral of (v + x r)|v + x r| over x from -half to half [m^3/s^2]; v [m/s], r [rad/s], half [m]."""
    return _cross_flow(v, r, half, 0)


def cross_flow_moment(v: Quantity, r: Quantity, half: float) -> Quantity:
    """The integral of x (v + x r)|v + x r| over x from -half to half [m^4/s^2]; v [m/s], r [rad/s], half [m]."""
    return _cross_flow(v, r, half, 1)


def _cross_flow(v: Quantity, r: Quantity, half: float, power: int) -> Quantity:
    if hasattr(v, "cross_flow"):
        return v.cross_flow(r, half, power)
    if isinstance(v, float):
        return cross_flow_value(v, r, half, power)
    if isinstance(v, np.ndarray):
        return cross_flow_array(v, r, half, power)
    return cross_flow_over(v, r, half, power)


def cross_flow_value(v: float, r: float, half: float, power: int) -> float:
    """The integral of x^power w|w|, w = v + x r, for floats: the moment where ``power`` is 1, else the force."""
    return cross_flow_both(v, r, half)[power]


def cross_flow_both(v: float, r: float, half: float) -> tuple[float, float]:
    """Force and moment in closed form: polynomials where the flow has one sign along the hull, else split at its zero."""
    if abs(v) >= abs(r) * half:
        sign = math.copysign(1.0, v)
        return sign * (2 * half * v * v + 2 * half**3 * r * r / 3), sign * (4 * v * r * half**3 / 3)
    # With w = v + x r and dx = dw / r: w|w| integrates to w^2|w| / 3, w^2|w| to w^3|w| / 4. The ends have different signs.
    low, high = v - r * half, v + r * half
    first = (high * high * abs(high) - low * low * abs(low)) / (3 * r)
    second = (high**3 * abs(high) - low**3 * abs(low)) / (4 * r * r)
    return first, second - v * first / r


def cross_flow_array(v: FloatArray, r: FloatArray, half: float, power: int) -> FloatArray:
    """``cross_flow_value`` for arrays that broadcast."""
    one_sign = np.abs(v) >= np.abs(r) * half
    rate = np.where(one_sign, 1.0, r)
    low, high = v - r * half, v + r * half
    first = (high * high * np.abs(high) - low * low * np.abs(low)) / (3 * rate)
    if power == 0:
        smooth = np.sign(v) * (2 * half * v * v + 2 * half**3 * r * r / 3)
        return np.where(one_sign, smooth, first)
    # Products, because NumPy takes powers of an array by logarithms.
    second = (high * high * high * np.abs(high) - low * low * low * np.abs(low)) / (4 * rate * rate)
    return np.where(one_sign, np.sign(v) * 4 * v * r * half**3 / 3, second - v * first / rate)
