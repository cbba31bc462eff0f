"""Arithmetic on columns in ``[log]``: ``u = "surge_dot - 0.02"``, enclosed in intervals.

A formula has columns, decimal numbers, ``+ - * /`` and parentheses. A name that is no word stands in backquotes, as in
:code:`-`gyr z` / 2`. Nothing is executed: the parts of the syntax tree are walked, and any other part is refused.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals.array import IntervalArray

Array = NDArray[np.float64]
_OPERATORS: Final = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
_QUOTED: Final = re.compile("`([^`]+)`")
_NAME: Final = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*")
# Brackets, powers and calls may nest this deep.
# Source: definition: no formula of columns is deeper
DEEPEST: Final = 50


@dataclass(frozen=True)
class Formula:
    """A formula of columns.

    Attributes:
        text: as it stands in the file.
        names: the columns that it has, in their order.
    """

    text: str
    names: tuple[str, ...]
    _tree: ast.expr
    _words: Mapping[str, str]

    def value(self, cells: Mapping[str, Array]) -> tuple[Array, Array]:
        """Values and bounds on their errors, shape (n,) each, from cells that are rounded decimals; NaN where a cell is missing.

        Args:
            cells: by name of the column, shape (n,) each.
        """
        missing = np.any([np.isnan(cells[n]) for n in self.names], axis=0)
        # A cell is a decimal rounded to a double.
        exact = {n: np.nan_to_num(cells[n]) for n in self.names}
        known = {n: IntervalArray.around(x, 0.5 * np.spacing(np.abs(x))) for n, x in exact.items()}
        made = self._walk(self._tree, known)
        size = missing.size
        lower, upper = (np.broadcast_to(x, (size,)) for x in (made.lower, made.upper))
        usable = ~missing & np.isfinite(lower) & np.isfinite(upper)
        lower, upper = (np.where(usable, x, np.nan) for x in (lower, upper))
        middle = 0.5 * lower + 0.5 * upper
        reach = np.maximum(upper - middle, middle - lower)
        return middle, np.where(usable, np.nextafter(reach, np.inf), 0.0)

    def _walk(self, part: ast.expr, known: Mapping[str, IntervalArray]) -> IntervalArray:
        match part:
            case ast.Constant(value=value):
                number = float(value)  # type: ignore[arg-type]
                return IntervalArray.around(np.array([number]), 0.0 if number.is_integer() else np.spacing(abs(number)))
            case ast.Name() | ast.Attribute():
                return known[_word(part, self._words)]
            case ast.UnaryOp(op=op, operand=operand):
                inner = self._walk(operand, known)
                return IntervalArray([0.0]) - inner if isinstance(op, ast.USub) else inner
            case ast.BinOp(left=left, op=op, right=right):
                a, b = self._walk(left, known), self._walk(right, known)
                match op:
                    case ast.Add():
                        return a + b
                    case ast.Sub():
                        return a - b
                    case ast.Mult():
                        return a * b
                    case _:
                        return a / b
        raise AssertionError(part)


def formula(text: str) -> Formula | None:
    """The formula of a text, or None where it is one name alone.

    Raises:
        IvsidError: anything but columns, numbers, ``+ - * /`` and parentheses.
    """
    quoted: list[str] = []

    def placeholder(match: re.Match[str]) -> str:
        quoted.append(match[1])
        return f"_column_{len(quoted) - 1}_"

    plain = _QUOTED.sub(placeholder, text)
    words = {f"_column_{k}_": name for k, name in enumerate(quoted)}
    if not quoted and not any(c in plain for c in "+-*/("):
        return None
    try:
        tree = ast.parse(plain.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    names: dict[str, None] = {}
    _check(tree, words, names, text, 0)
    return Formula(text, tuple(names), tree, words) if names else None


def _check(part: ast.expr, words: Mapping[str, str], names: dict[str, None], text: str, depth: int) -> None:
    """Collects the names of a formula, and refuses what is no arithmetic."""
    match part:
        case ast.Constant(value=bool() | str() | bytes() | complex()) | ast.Constant(value=None):
            pass
        case ast.Constant(value=value) if math.isfinite(float(value)):  # type: ignore[arg-type]
            return None
        case ast.Name() | ast.Attribute() if _NAME.fullmatch(ast.unparse(part)):
            names[_word(part, words)] = None
            return None
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand) if depth < DEEPEST:
            return _check(operand, words, names, text, depth + 1)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS and depth < DEEPEST:
            _check(left, words, names, text, depth + 1)
            return _check(right, words, names, text, depth + 1)
    raise IvsidError(
        f"[log] columns has the formula '{text}'; it may have columns, numbers, + - * / and parentheses (a name with other characters in backquotes)"
    )


def _word(part: ast.expr, words: Mapping[str, str]) -> str:
    """The name of a column: a word, or words with points between them."""
    name = ast.unparse(part)
    for placeholder, quoted in words.items():
        name = name.replace(placeholder, quoted)
    return name
