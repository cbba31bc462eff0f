"""The equations of motion written out once: the catalogue's functions run on symbols, and what they did becomes one function.

The catalogue is written for clarity: small functions that build dictionaries of columns. Called at every stage of every step they
would cost ten times the arithmetic in them. So they are called once, with symbols for the state; each operation is noted, the same
operation once only, products with 0 and 1 are left out, and the notes are compiled to a straight list of assignments.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ivsid.effects.functions import after, astern_square, cross_flow_array, cross_flow_both

_SCALAR: Final[dict[str, Any]] = {
    "cos": math.cos,
    "sin": math.sin,
    "tanh": math.tanh,
    "sqrt": math.sqrt,
    "arctan2": math.atan2,
    "after": after,
    "astern_square": astern_square,
    "cross_flow": cross_flow_both,
}
_ARRAY: Final[dict[str, Any]] = {
    "cos": np.cos,
    "sin": np.sin,
    "tanh": np.tanh,
    "sqrt": np.sqrt,
    "arctan2": np.arctan2,
    "after": after,
    "astern_square": astern_square,
    "cross_flow": lambda v, r, half: (cross_flow_array(v, r, half, 0), cross_flow_array(v, r, half, 1)),
}


# Where in a step its thrusts may differ.
_MOMENTS: Final = ("first", "middle", "last")


class Steps(NamedTuple):
    """Steps of a motion, compiled.

    Attributes:
        held: from what holds between samples to what ``steady`` takes after time, length and state.
        steady: a step of thrusts that hold; gives the new state.
        varied: a step whose thrusts differ at its start, middle and end: after time, length and state come the other held numbers, then
            the thrusts of each moment.
    """

    held: Callable[..., tuple[float, ...]]
    steady: Callable[..., Any]
    varied: Callable[..., Any]


class Tape:
    """What was done to symbols: one line an operation, in order."""

    def __init__(self) -> None:
        self._lines: list[tuple[str, str, tuple[str, ...]]] = []
        self._known: dict[str, Symbol] = {}
        self._provided: dict[str, Any] = {}

    def provide(self, name: str, function: Callable[..., Any]) -> None:
        """Makes a function known to the compiled text, for operations noted by hand."""
        self._provided[name] = function

    def symbol(self, name: str) -> Symbol:
        """An argument of the function."""
        return Symbol(self, name)

    def note(self, expression: str, *operands: Any) -> Symbol:
        """The result of an operation; the same one twice is noted once."""
        if expression not in self._known:
            name = f"q{len(self._lines)}"
            self._lines.append((name, expression, tuple(o.name for o in operands if isinstance(o, Symbol))))
            self._known[expression] = Symbol(self, name)
        return self._known[expression]

    def function(self, arguments: Sequence[str], results: Sequence[Any], *, arrays: bool = False) -> Callable[..., Any]:
        """The function of the arguments that gives the results: of floats, or of NumPy arrays of one shape."""
        return self._compiled(arguments, self._kept(results), [_text(r) for r in results], arrays=arrays)

    def steps(
        self, state: Sequence[str], held: Sequence[str], varying: Sequence[str], results: Sequence[Any], inside: float
    ) -> Steps:
        """One step of the classical Runge-Kutta method, written out, where the results are the rates of the state.

        Args:
            state: names of what moves; the time t is one more argument.
            held: what holds over a step.
            varying: those of them that may differ at its start, its middle and its end.
            results: rates of the state, in its order.
            inside: share of the step by which its ends are looked at from inside.
        """
        kept = self._kept(results)
        fixed, first, rest = set(held), [], []
        for line in kept:
            if set(line[2]) <= fixed:
                fixed.add(line[0])
                first.append(line)
            else:
                rest.append(line)
        used = {q for line in rest for q in line[2]} | {r.name for r in results if isinstance(r, Symbol)}
        passed = [q for q in (*held, *(line[0] for line in first)) if q in used]
        texts = [_text(r) for r in results]
        return Steps(
            self._compiled(held, first, passed, arrays=False),
            self._made(["at", "h", *state, *passed], _runge_kutta(state, (), rest, texts, inside), arrays=False),
            self._made(
                [
                    *("at", "h", *state, *(q for q in held if q not in varying)),
                    *(f"{q}_{moment}" for moment in _MOMENTS for q in varying),
                ],
                _runge_kutta(state, varying, kept, texts, inside),
                arrays=False,
            ),
        )

    def _kept(self, results: Sequence[Any]) -> list[tuple[str, str, Sequence[str]]]:
        """The lines that the results need, in order."""
        wanted = {r.name for r in results if isinstance(r, Symbol)}
        kept = []
        for line in reversed(self._lines):
            if line[0] in wanted:
                wanted.update(line[2])
                kept.append(line)
        return list(reversed(kept))

    def _compiled(
        self,
        arguments: Sequence[str],
        lines: Sequence[tuple[str, str, Sequence[str]]],
        results: Sequence[str],
        *,
        arrays: bool,
    ) -> Callable[..., Any]:
        body = [*(f"{name} = {expression}" for name, expression, _ in lines), f"return ({', '.join([*results, ''])})"]
        return self._made(arguments, body, arrays=arrays)

    def _made(self, arguments: Sequence[str], body: Sequence[str], *, arrays: bool) -> Callable[..., Any]:
        source = "\n    ".join([f"def function({', '.join(arguments)}):", *body])
        space = {**(_ARRAY if arrays else _SCALAR), **self._provided}
        # Only names and numbers that this module made stand in the text: nothing of a user's file reaches it.
        exec(compile(source, "<equations of motion>", "exec"), space)
        made: Callable[..., Any] = space["function"]
        return made


def _runge_kutta(
    state: Sequence[str],
    varying: Sequence[str],
    lines: Sequence[tuple[str, str, Sequence[str]]],
    rates: Sequence[str],
    inside: float,
) -> list[str]:
    """The body of a step: the lines four times, each time those alone whose operands have changed."""
    used = {q for line in lines for q in line[2]} | set(rates)
    body = ["half = 0.5 * h", *(f"from_{q} = {q}" for q in state)]
    times = (f"at + {inside!r} * h", "at + half", None, f"at + h - {inside!r} * h")
    for stage, (time, moment) in enumerate(zip(times, (*_MOMENTS[:2], None, _MOMENTS[2]), strict=True)):
        changed: set[str] = set()
        if time is not None:
            body.append(f"t = {time}")
            changed.add("t")
        if stage:
            far = "h" if stage == 3 else "half"
            moved = [(k, q) for k, q in enumerate(state) if q in used]
            body += [f"{q} = from_{q} + {far} * k{stage - 1}_{k}" for k, q in moved]
            changed.update(q for _, q in moved)
        if moment is not None:
            body += [f"{q} = {q}_{moment}" for q in varying]
            changed.update(varying)
        for name, expression, operands in lines:
            if not stage or changed & set(operands):
                body.append(f"{name} = {expression}")
                changed.add(name)
        body += [f"k{stage}_{k} = {rate}" for k, rate in enumerate(rates)]
    sums = (f"from_{q} + sixth * (k0_{k} + 2.0 * (k1_{k} + k2_{k}) + k3_{k})" for k, q in enumerate(state))
    return [*body, "sixth = h / 6.0", f"return ({', '.join([*sums, ''])})"]


def _text(x: Any) -> str:
    return x.name if isinstance(x, Symbol) else repr(float(x))


class Symbol:
    """A quantity of the motion, for operators and for the catalogue's ``functions``."""

    __slots__ = ("name", "tape")
    # NumPy's scalars leave the operators to this class.
    __array_ufunc__ = None

    def __init__(self, tape: Tape, name: str) -> None:
        self.tape, self.name = tape, name

    def _binary(self, sign: str, a: Any, b: Any) -> Symbol:
        return self.tape.note(f"{_text(a)} {sign} {_text(b)}", a, b)

    def __add__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._binary("+", self, other)

    def __radd__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._binary("+", other, self)

    def __sub__(self, other: Any) -> Any:
        return self if _is(other, 0.0) else self._binary("-", self, other)

    def __rsub__(self, other: Any) -> Any:
        return -self if _is(other, 0.0) else self._binary("-", other, self)

    def __mul__(self, other: Any) -> Any:
        if _is(other, 0.0):
            return 0.0
        return self if _is(other, 1.0) else self._binary("*", self, other)

    def __rmul__(self, other: Any) -> Any:
        if _is(other, 0.0):
            return 0.0
        return self if _is(other, 1.0) else self._binary("*", other, self)

    def __truediv__(self, other: Any) -> Any:
        return self if _is(other, 1.0) else self._binary("/", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if _is(other, 0.0) else self._binary("/", other, self)

    def __neg__(self) -> Symbol:
        return self.tape.note(f"-{self.name}", self)

    def __abs__(self) -> Symbol:
        return self.tape.note(f"abs({self.name})", self)

    def _call(self, function: str, *others: Any) -> Symbol:
        return self.tape.note(f"{function}({', '.join(map(_text, (self, *others)))})", self, *others)

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

    def arctan2(self, other: Any) -> Symbol:
        """The angle of (other, self)."""
        return self._call("arctan2", other)

    def square(self) -> Any:
        """``x^2``."""
        return self * self

    def signed_square(self) -> Any:
        """``x |x|``."""
        return self * abs(self)

    def astern_square(self) -> Symbol:
        """``x |x|`` where x is negative."""
        return self._call("astern_square")

    def after(self, start: float) -> Symbol:
        """1 from ``start`` on."""
        return self._call("after", start)

    def cross_flow(self, r: Any, half: float, power: int) -> Symbol:
        """The integrals of ``functions.cross_flow_force`` and ``cross_flow_moment``."""
        both = self.tape.note(f"cross_flow({self.name}, {_text(r)}, {half!r})", self, r)
        return self.tape.note(f"{both.name}[{power}]", both)


def _is(x: Any, value: float) -> bool:
    return not isinstance(x, Symbol) and float(x) == value


def solve(matrix: list[list[Any]], right: Sequence[Any]) -> tuple[Any, Any, Any]:
    """The solution of three equations: by an inverse in numbers where the matrix has no symbol, else by cofactors."""
    if not any(isinstance(q, Symbol) for row in matrix for q in row):
        inverse: NDArray[np.float64] = np.linalg.inv(np.array(matrix, dtype=np.float64))
        rows = [[float(q) for q in row] for row in inverse]
        divisor: Any = 1.0
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
