"""NumPy's functions of interval arrays: as operations of the core, or as rearrangements of entries."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ivsid.intervals.array import Interval, IntervalArray, Operand, binary, equal, interval_array, matmul, power, scalar
from ivsid.intervals.floats import FloatArray

_BINARY: dict[np.ufunc, str] = {
    np.add: "add",
    np.subtract: "sub",
    np.multiply: "mul",
    np.true_divide: "div",
    np.minimum: "min",
    np.maximum: "max",
    np.arctan2: "atan2",
    np.hypot: "hypot",
}
_UNARY: dict[np.ufunc, str] = {
    np.negative: "neg",
    np.absolute: "abs",
    np.fabs: "abs",
    np.square: "square",
    np.sqrt: "sqrt",
    np.reciprocal: "recip",
    np.exp: "exp",
    np.exp2: "exp2",
    np.log: "ln",
    np.expm1: "exp_m1",
    np.log1p: "ln_1p",
    np.cbrt: "cbrt",
    np.log2: "log2",
    np.log10: "log10",
    np.sin: "sin",
    np.cos: "cos",
    np.tan: "tan",
    np.arcsin: "asin",
    np.arccos: "acos",
    np.arctan: "atan",
    np.sinh: "sinh",
    np.cosh: "cosh",
    np.tanh: "tanh",
    np.arcsinh: "asinh",
    np.arccosh: "acosh",
    np.arctanh: "atanh",
    np.sign: "sign",
    np.ceil: "ceil",
    np.floor: "floor",
    np.trunc: "trunc",
    np.rint: "round_ties_even",
}


def ufunc(ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], options: dict[str, object] | None) -> object:
    """The result of a NumPy ufunc for intervals; an array without dimensions becomes an ``Interval``.

    Raises:
        TypeError: the ufunc, its method or an option is not defined for intervals.
    """
    if method == "__call__" and not options:
        if ufunc in _BINARY:
            return scalar(binary(_BINARY[ufunc], *inputs))
        if ufunc in _UNARY:
            return scalar(interval_array(inputs[0])._unary(_UNARY[ufunc]))
        if ufunc in (np.power, np.float_power):
            return scalar(power(*inputs))
        if ufunc is np.matmul:
            return matmul(*inputs)
        if ufunc is np.positive:
            return inputs[0]
        if ufunc in (np.equal, np.not_equal):
            same = equal(*inputs)
            return same if ufunc is np.equal else ~same
    names = ", ".join(sorted(u.__name__ for u in (*_BINARY, *_UNARY, np.matmul, np.power)))
    if options:
        raise TypeError(f"np.{ufunc.__name__} of intervals takes no {', '.join(options)}")
    shown = ufunc.__name__ if method == "__call__" else f"{ufunc.__name__}.{method}"
    raise TypeError(f"np.{shown} is not defined for intervals; there are {names}")


def function(function: Callable[..., object], arguments: tuple[object, ...], options: dict[str, object]) -> object:
    """The result of a NumPy function that is no ufunc, for interval arrays.

    Raises:
        TypeError: the function is not defined for intervals.
    """
    handler = _FUNCTIONS.get(function)
    if handler is None:
        known = ", ".join(sorted(f.__name__ for f in _FUNCTIONS))
        raise TypeError(f"np.{function.__name__} is not defined for intervals; there are {known}")
    _refuse_out(function, arguments, options)
    return handler(*arguments, **options)


def _refuse_out(function: Callable[..., object], arguments: tuple[object, ...], options: dict[str, object]) -> None:
    """Refuses ``out``, by name and by place: the two ends of the intervals would be written into one array of numbers."""
    names = list(inspect.signature(function).parameters) if "out" not in options else []
    given = arguments[names.index("out") :] if "out" in names else ()
    if options.get("out") is not None or any(x is not None for x in given[:1]):
        raise TypeError(f"np.{function.__name__} of intervals takes no out; use the array that it returns")


def _ends(function: Callable[..., FloatArray], parts: Sequence[Operand], **options: object) -> IntervalArray:
    """A rearrangement of entries, the same for both bounds."""
    arrays = [interval_array(p) for p in parts]
    lower = function([a.lower for a in arrays], **options)
    return IntervalArray._raw((lower, function([a.upper for a in arrays], **options)), lower.shape)


def _each_end(function: Callable[..., FloatArray]) -> Callable[..., object]:
    def apply(array: IntervalArray, *arguments: object, **options: object) -> object:
        lower = function(array.lower, *arguments, **options)
        return scalar(IntervalArray._raw((lower, function(array.upper, *arguments, **options)), lower.shape))

    return apply


def _where(condition: ArrayLike, x: Operand, y: Operand) -> IntervalArray:
    if isinstance(condition, IntervalArray | Interval):
        raise TypeError(
            "the condition of np.where is an array of intervals; give truth values, such as those of contains"
        )
    a, b = interval_array(x), interval_array(y)
    lower = np.where(condition, a.lower, b.lower)
    return IntervalArray._raw((lower, np.where(condition, a.upper, b.upper)), lower.shape)


_FUNCTIONS: dict[Any, Any] = {
    np.concatenate: lambda parts, axis=0: _ends(np.concatenate, parts, axis=axis),
    np.stack: lambda parts, axis=0: _ends(np.stack, parts, axis=axis),
    np.vstack: lambda parts: _ends(np.vstack, parts),
    np.hstack: lambda parts: _ends(np.hstack, parts),
    np.sum: lambda array, axis=None: array.sum(axis),
    np.dot: matmul,
    np.where: _where,
    np.shape: lambda array: array.shape,
    np.ndim: lambda array: array.ndim,
    np.size: lambda array: array.size,
} | {
    function: _each_end(function)
    for function in (
        np.reshape,
        np.ravel,
        np.transpose,
        np.squeeze,
        np.broadcast_to,
        np.moveaxis,
        np.swapaxes,
        np.expand_dims,
        np.flip,
        np.roll,
        np.repeat,
        np.tile,
        np.take,
        np.diagonal,
    )
}
