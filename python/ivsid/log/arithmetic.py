"""Arithmetic on columns in ``[log]``: ``u = "surge_dot - 0.02"``, with a bound on the error of each value.

A formula has columns, decimal numbers, ``+ - * /`` and parentheses. A name that is no word stands in backquotes: "-`gyr z` / 2". Nothing is
executed: the parts of the syntax tree are walked, and any other part is refused. The bound follows each operation; it is no interval arithmetic, which the checker of ``ivsid verify`` must not share with what it checks.

Source: running error analysis, Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, section 3.3.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError

Array = NDArray[np.float64]
# A value and the bound on its error.
Bounded = tuple[Array, Array]
_OPERATORS: Final = (ast.Add, ast.Sub, ast.Mult, ast.Div)
_QUOTED: Final = re.compile("`([^`]+)`")
_NAME: Final = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*")
# Operations may nest this deep.
# Source: definition: no formula of columns is deeper
DEEPEST: Final = 50
# More than a few roundings of subnormal numbers.
# Source: definition: the smallest normal double is 2e-308, the smallest of all 5e-324
TINY: Final = 1e-322


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
        known = {n: (x, np.spacing(np.abs(x))) for n, x in ((n, np.nan_to_num(cells[n])) for n in self.names)}
        with np.errstate(all="ignore"):
            middle, reach = (np.broadcast_to(x, missing.shape) for x in self._walk(self._tree, known))
        usable = ~missing & np.isfinite(middle) & np.isfinite(reach)
        return np.where(usable, middle, np.nan), np.where(usable, reach, 0.0)

    def _walk(self, part: ast.expr, known: Mapping[str, Bounded]) -> Bounded:
        match part:
            case ast.Constant(value=value):
                number = np.asarray(float(value))  # type: ignore[arg-type]
                # Whole numbers of 53 bits are doubles.
                exact = number == np.floor(number) and abs(number) < 2**53
                return number, np.zeros(()) if exact else np.spacing(np.abs(number))
            case ast.UnaryOp(op=op, operand=operand):
                x, e = self._walk(operand, known)
                return (-x if isinstance(op, ast.USub) else x), e
            case ast.BinOp(left=left, op=op, right=right):
                return _rounded(op, self._walk(left, known), self._walk(right, known))
        return known[_word(part, self._words)]


def _rounded(op: ast.operator, a: Bounded, b: Bounded) -> Bounded:
    """An operation on two values, and the bound on its error: what both errors make of it, and its own rounding."""
    (x, d), (y, e) = a, b
    match op:
        case ast.Add():
            z, moved = x + y, d + e
        case ast.Sub():
            z, moved = x - y, d + e
        case ast.Mult():
            z, moved = x * y, np.abs(x) * e + np.abs(y) * d + d * e
        case _:
            # |x/y - X/Y| <= (d + |x/y| e) / (|y| - e); a divisor that may be zero has no bound.
            z = x / y
            least = np.abs(y) - e
            moved = np.where(least > 0, (d + (np.abs(z) + np.spacing(np.abs(z))) * e) / least, np.inf)
    # The slack holds the roundings of the bound itself, five at most and those of products that are subnormal.
    return z, (moved + np.spacing(np.abs(z))) * (1 + 1e-14) + TINY


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
        case ast.Constant(value=int() | float() as value) if abs(value) <= sys.float_info.max:
            return None
        case ast.Name() | ast.Attribute() if _NAME.fullmatch(ast.unparse(part)):
            names[_word(part, words)] = None
            return None
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand) if depth < DEEPEST:
            return _check(operand, words, names, text, depth + 1)
        case ast.BinOp(left=left, op=op, right=right) if isinstance(op, _OPERATORS) and depth < DEEPEST:
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
