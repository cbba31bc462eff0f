"""Symbols: quantities that note down the operations done to them.

The catalogue's functions are written for clarity and build dictionaries of columns. Called at every stage of every step they would
cost ten times their own arithmetic. Therefore they run once, on symbols. A tape notes each operation once and leaves out products
with 0 and 1; ``compiled`` makes functions of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ivsid.effects.quantity import Quantity


class Line(NamedTuple):
    """One operation: the name of its result, its text, and the names of its operands."""

    name: str
    expression: str
    operands: tuple[str, ...]


class Tape:
    """The operations done to symbols, in order.

    Attributes:
        lines: the operations.
        provided: functions by name that the lines call beside those of ``compiled``.
    """

    def __init__(self) -> None:
        self.lines: list[Line] = []
        self.provided: dict[str, Callable[..., Quantity]] = {}
        self._known: dict[str, Symbol] = {}

    def provide(self, name: str, function: Callable[..., Quantity]) -> None:
        """Makes a function known to the compiled text, for operations noted by hand."""
        self.provided[name] = function

    def symbol(self, name: str) -> Symbol:
        """A symbol for an argument of the compiled function."""
        return Symbol(self, name)

    def note(self, expression: str, *operands: Quantity) -> Symbol:
        """The result of an operation; a repeated operation is noted once."""
        if expression not in self._known:
            name = f"q{len(self.lines)}"
            self.lines.append(Line(name, expression, tuple(o.name for o in operands if isinstance(o, Symbol))))
            self._known[expression] = Symbol(self, name)
        return self._known[expression]

    def needed(self, results: Sequence[Quantity]) -> list[Line]:
        """The lines that the results depend on, in order."""
        wanted = {r.name for r in results if isinstance(r, Symbol)}
        kept = []
        for line in reversed(self.lines):
            if line.name in wanted:
                wanted.update(line.operands)
                kept.append(line)
        return list(reversed(kept))


def text(x: Quantity) -> str:
    """The name of a symbol, or a number in full precision."""
    return x.name if isinstance(x, Symbol) else repr(float(x))


class Symbol:
    """A quantity without a value; operators and the catalogue's ``functions`` note themselves on its tape."""

    __slots__ = ("name", "tape")
    # Makes NumPy's scalars leave the operators to this class.
    __array_ufunc__ = None

    def __init__(self, tape: Tape, name: str) -> None:
        self.tape, self.name = tape, name

    def _binary(self, sign: str, a: Quantity, b: Quantity) -> Symbol:
        return self.tape.note(f"{text(a)} {sign} {text(b)}", a, b)

    def __add__(self, other: Quantity) -> Quantity:
        return self if _is(other, 0.0) else self._binary("+", self, other)

    def __radd__(self, other: Quantity) -> Quantity:
        return self if _is(other, 0.0) else self._binary("+", other, self)

    def __sub__(self, other: Quantity) -> Quantity:
        return self if _is(other, 0.0) else self._binary("-", self, other)

    def __rsub__(self, other: Quantity) -> Quantity:
        return -self if _is(other, 0.0) else self._binary("-", other, self)

    def __mul__(self, other: Quantity) -> Quantity:
        if _is(other, 0.0):
            return 0.0
        return self if _is(other, 1.0) else self._binary("*", self, other)

    def __rmul__(self, other: Quantity) -> Quantity:
        if _is(other, 0.0):
            return 0.0
        return self if _is(other, 1.0) else self._binary("*", other, self)

    def __truediv__(self, other: Quantity) -> Quantity:
        return self if _is(other, 1.0) else self._binary("/", self, other)

    def __rtruediv__(self, other: Quantity) -> Quantity:
        return 0.0 if _is(other, 0.0) else self._binary("/", other, self)

    def __neg__(self) -> Symbol:
        return self.tape.note(f"-{self.name}", self)

    def __abs__(self) -> Symbol:
        return self.tape.note(f"abs({self.name})", self)

    def _call(self, function: str, *others: Quantity) -> Symbol:
        return self.tape.note(f"{function}({', '.join(map(text, (self, *others)))})", self, *others)

    def cos(self) -> Symbol:
        """Cosine."""
        return self._call("cos")

    def sin(self) -> Symbol:
        """Sine."""
        return self._call("sin")

    def tanh(self) -> Symbol:
        """Hyperbolic tangent."""
        return self._call("tanh")

    def sqrt(self) -> Symbol:
        """Square root."""
        return self._call("sqrt")

    def arctan2(self, other: Quantity) -> Symbol:
        """The angle whose tangent is self / other, by the signs of both."""
        return self._call("arctan2", other)

    def square(self) -> Quantity:
        """``x^2``."""
        return self * self

    def signed_square(self) -> Quantity:
        """``x |x|``."""
        return self * abs(self)

    def astern_square(self) -> Symbol:
        """``x |x|`` where x is negative, else 0."""
        return self._call("astern_square")

    def after(self, start: float) -> Symbol:
        """The step function: 1 from ``start`` on."""
        return self._call("after", start)

    def cross_flow(self, r: Quantity, half: float, power: int) -> Symbol:
        """``functions.cross_flow_force`` for power 0, ``functions.cross_flow_moment`` for 1."""
        both = self.tape.note(f"cross_flow({self.name}, {text(r)}, {half!r})", self, r)
        return self.tape.note(f"{both.name}[{power}]", both)


def _is(x: Quantity, value: float) -> bool:
    return not isinstance(x, Symbol) and float(x) == value


def solve(matrix: list[list[Quantity]], right: Sequence[Quantity]) -> tuple[Quantity, Quantity, Quantity]:
    """The solution x of ``matrix`` x = ``right``, 3 by 3: by a numerical inverse if the matrix has no symbol, else by cofactors."""
    if not any(isinstance(q, Symbol) for row in matrix for q in row):
        inverse: NDArray[np.float64] = np.linalg.inv(np.array(matrix, dtype=np.float64))
        rows = [[float(q) for q in row] for row in inverse]
        divisor: Quantity = 1.0
    else:
        m = matrix
        rows = [
            [
                m[(j + 1) % 3][(i + 1) % 3] * m[(j + 2) % 3][(i + 2) % 3]
                - m[(j + 1) % 3][(i + 2) % 3] * m[(j + 2) % 3][(i + 1) % 3]
                for j in range(3)
            ]
            for i in range(3)
        ]
        divisor = m[0][0] * rows[0][0] + m[0][1] * rows[1][0] + m[0][2] * rows[2][0]
    found = [(row[0] * right[0] + row[1] * right[1] + row[2] * right[2]) / divisor for row in rows]
    return found[0], found[1], found[2]
