"""The catalogue's columns as a program of the core: each runs once, on symbols that note what is done to them.

A column is affine in the accelerations, with constant factors: that is what the mass matrix of an equation of motion means. A symbol
therefore has two parts, a register (of velocities alone) and the three factors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import Final

from ivsid.effects import CHANNELS, Columns, State, Term, rigid_body
from ivsid.effects.quantity import Quantity
from ivsid.errors import IvsidError
from ivsid.linear.trajectories import Column, Operation

Factors = tuple[float, float, float]
# Factors of u', v', r' of a quantity without accelerations.
# Source: definition: no factor
NONE: Final[Factors] = (0.0, 0.0, 0.0)


class Program:
    """The operations noted so far; registers 0, 1 and 2 hold u, v and r."""

    def __init__(self) -> None:
        self.operations: list[Operation] = []
        self._known: dict[Operation, int] = {}

    def note(self, name: str, a: int = 0, b: int = 0, number: float = 0.0) -> int:
        """The register of an operation's result; a repeated operation is noted once."""
        operation = (name, a, b, float(number))
        if operation not in self._known:
            self._known[operation] = len(self.operations) + 3
            self.operations.append(operation)
        return self._known[operation]


class Symbol:
    """A quantity without a value: a register, or None for zero, and factors of u', v', r'."""

    __slots__ = ("factors", "program", "register")
    # Makes NumPy's scalars leave the operators to this class.
    __array_ufunc__ = None

    def __init__(self, program: Program, register: int | None, factors: Factors = NONE) -> None:
        self.program, self.register, self.factors = program, register, factors

    def _of(self, other: Quantity) -> Symbol:
        if isinstance(other, Symbol):
            return other
        number = float(other)
        return Symbol(self.program, self.program.note("constant", number=number) if number else None)

    def _held(self, name: str) -> int:
        """The register of a symbol without accelerations."""
        if self.factors != NONE:
            raise IvsidError(
                f"a term of the model takes an acceleration by '{name}', and a tube follows terms that are linear in accelerations; "
                "leave the term out"
            )
        return self.program.note("constant") if self.register is None else self.register

    def _made(self, name: str, other: int = 0, *, number: float = 0.0) -> Symbol:
        return Symbol(self.program, self.program.note(name, self._held(name), other, number))

    def __add__(self, other: Quantity) -> Symbol:
        o = self._of(other)
        a, b, c = (_exact(x + y, Fraction(x) + Fraction(y)) for x, y in zip(self.factors, o.factors, strict=True))
        if self.register is None or o.register is None:
            return Symbol(self.program, o.register if self.register is None else self.register, (a, b, c))
        return Symbol(self.program, self.program.note("add", self.register, o.register), (a, b, c))

    __radd__ = __add__

    def __neg__(self) -> Symbol:
        register = None if self.register is None else self.program.note("neg", self.register)
        a, b, c = self.factors
        return Symbol(self.program, register, (-a, -b, -c))

    def __sub__(self, other: Quantity) -> Symbol:
        return self + (-self._of(other))

    def __rsub__(self, other: Quantity) -> Symbol:
        return self._of(other) - self

    def __mul__(self, other: Quantity) -> Symbol:
        if isinstance(other, Symbol):
            if self.register is None and self.factors == NONE:
                return self
            if other.register is None and other.factors == NONE:
                return other
            return self._made("mul", other._held("mul"))
        number = float(other)
        if number == 1.0:
            return self
        if number == 0.0:
            return Symbol(self.program, None)
        a, b, c = (_exact(x * number, Fraction(x) * Fraction(number)) for x in self.factors)
        if self.register is None:
            return Symbol(self.program, None, (a, b, c))
        scale = self.program.note("constant", number=number)
        return Symbol(self.program, self.program.note("mul", self.register, scale), (a, b, c))

    __rmul__ = __mul__

    def __abs__(self) -> Symbol:
        return self._made("abs")

    def square(self) -> Symbol:
        """``x^2``."""
        return self._made("square")

    def signed_square(self) -> Symbol:
        """``x |x|``."""
        return self._made("signed_square")

    def cube(self) -> Symbol:
        """``x^3``."""
        return self._made("cube")

    def tanh(self) -> Symbol:
        """Hyperbolic tangent."""
        return self._made("tanh")

    def astern_square(self) -> Symbol:
        """``x |x|`` where x is negative, else 0."""
        return self._made("astern_square")

    def cross_flow(self, r: Quantity, half: float, power: int) -> Symbol:
        """``functions.cross_flow_force`` for power 0, ``functions.cross_flow_moment`` for 1."""
        name = "cross_flow_moment" if power else "cross_flow_force"
        return self._made(name, self._of(r)._held(name), number=half)


def _exact(rounded: float, real: Fraction) -> float:
    if Fraction(rounded) != real:
        raise IvsidError(
            "a term's factor of an acceleration is no double; write the term with factors such as 1, -1 or 0.5"
        )
    return rounded


def columns_of(
    terms: Sequence[Term], known: tuple[bool, bool, bool]
) -> tuple[list[Operation], tuple[list[Column], list[Column], list[Column]]]:
    """The program of all columns, and the columns of surge, sway and yaw.

    Args:
        terms: the model, numbered from 0.
        known: whether the rigid body has a coupling m x_G, a coupling m y_G, and a mass beside the parameters; those that it has are
            numbered after the terms, each with the columns of one unit.

    Raises:
        IvsidError: a term that is not linear in accelerations, or made of operations that the core does not know.
    """
    program = Program()
    motion = State(
        *(Symbol(program, k) for k in range(3)),
        *(Symbol(program, None, f) for f in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
    )
    units = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    bodies = [partial(rigid_body, mx=a, my=b, mass=c) for has, (a, b, c) in zip(known, units, strict=True) if has]
    channels: tuple[list[Column], list[Column], list[Column]] = ([], [], [])
    makers: list[Callable[[State], Columns]] = [*(t.columns for t in terms), *bodies]
    for number, columns in enumerate(makers):
        id_ = terms[number].id if number < len(terms) else "the rigid body"
        for name, made in _noted(columns(motion), id_).items():
            symbol = made if isinstance(made, Symbol) else motion.u._of(made)
            channels[CHANNELS.index(name)].append((number, symbol.register, symbol.factors))
    return program.operations, channels


def _noted(made: Columns, id_: str) -> Columns:
    """The columns of a term, as symbols or numbers."""
    if any(not isinstance(x, Symbol | float | int) for x in made.values()):
        raise IvsidError(
            f"model term {id_} is made of operations that a tube does not follow; leave it out of the model"
        )
    return made
