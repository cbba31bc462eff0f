"""Functions of the physics for floats, arrays, intervals, motions and the symbols of the simulator alike.

What is no float or array brings its own method of the same name, or NumPy's function of it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ivsid.effects.cross_flow import cross_flow_over


def _apply(name: str, x: Any, scalar: Any) -> Any:
    if isinstance(x, float):
        return scalar(x)
    method = getattr(x, name, None)
    return getattr(np, name)(x) if method is None else method()


def cos(x: Any) -> Any:
    """Cosine of an angle [rad]."""
    return _apply("cos", x, math.cos)


def sin(x: Any) -> Any:
    """Sine of an angle [rad]."""
    return _apply("sin", x, math.sin)


def tanh(x: Any) -> Any:
    """Hyperbolic tangent."""
    return _apply("tanh", x, math.tanh)


def sqrt(x: Any) -> Any:
    """Square root."""
    return _apply("sqrt", x, math.sqrt)


def signed_square(x: Any) -> Any:
    """``x |x|``; tight for intervals that hold both signs."""
    return x.signed_square() if hasattr(x, "signed_square") else x * abs(x)


def square(x: Any) -> Any:
    """``x^2``; tight for intervals that hold both signs."""
    return x.square() if hasattr(x, "square") else x * x


def astern_square(x: Any) -> Any:
    """``x |x|`` where x is negative, else 0."""
    if isinstance(x, float):
        return x * abs(x) if x < 0 else 0.0
    if hasattr(x, "astern_square"):
        return x.astern_square()
    return signed_square(np.minimum(x, 0.0))


def after(time: Any, start: float) -> Any:
    """1 from ``start`` on, 0 before."""
    if hasattr(time, "after"):
        return time.after(start)
    return np.where(time >= start, 1.0, 0.0) if isinstance(time, np.ndarray) else float(time >= start)


def cross_flow_force(v: Any, r: Any, half: float) -> Any:
    """The integral of (v + x r)|v + x r| over x from -half to half [m^3/s^2]."""
    return _cross_flow(v, r, half, 0)


def cross_flow_moment(v: Any, r: Any, half: float) -> Any:
    """The integral of x (v + x r)|v + x r| over x from -half to half [m^4/s^2]."""
    return _cross_flow(v, r, half, 1)


def _cross_flow(v: Any, r: Any, half: float, power: int) -> Any:
    if hasattr(v, "cross_flow"):
        return v.cross_flow(r, half, power)
    if isinstance(v, float):
        return cross_flow_value(v, r, half, power)
    if isinstance(v, np.ndarray):
        return cross_flow_array(v, r, half, power)
    return cross_flow_over(v, r, half, power)


def cross_flow_value(v: float, r: float, half: float, power: int) -> float:
    """The integral in closed form: a polynomial where the flow has one sign along the hull, else split at its zero."""
    return cross_flow_both(v, r, half)[power]


def cross_flow_both(v: float, r: float, half: float) -> tuple[float, float]:
    """Force and moment at once."""
    if abs(v) >= abs(r) * half:
        sign = math.copysign(1.0, v)
        return sign * (2 * half * v * v + 2 * half**3 * r * r / 3), sign * (4 * v * r * half**3 / 3)
    # With w = v + x r and dx = dw / r: w|w| integrates to w^2|w| / 3, w^2|w| to w^3|w| / 4. The ends have different signs.
    low, high = v - r * half, v + r * half
    first = (high * high * abs(high) - low * low * abs(low)) / (3 * r)
    second = (high**3 * abs(high) - low**3 * abs(low)) / (4 * r * r)
    return first, second - v * first / r


def cross_flow_array(v: Any, r: Any, half: float, power: int) -> Any:
    """``cross_flow_value`` for arrays that broadcast."""
    one_sign = np.abs(v) >= np.abs(r) * half
    rate = np.where(one_sign, 1.0, r)
    low, high = v - r * half, v + r * half
    first = (high * high * np.abs(high) - low * low * np.abs(low)) / (3 * rate)
    if power == 0:
        smooth = np.sign(v) * (2 * half * v * v + 2 * half**3 * r * r / 3)
        return np.where(one_sign, smooth, first)
    # Products: a power of an array is worked out by logarithms.
    second = (high * high * high * np.abs(high) - low * low * low * np.abs(low)) / (4 * rate * rate)
    return np.where(one_sign, np.sign(v) * 4 * v * r * half**3 / 3, second - v * first / rate)
