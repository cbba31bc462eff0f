"""What an effect is: one definition for the terms of a model, for simulation, for identification and for diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal, TypeAlias

from ivsid.effects.scaling import froude_power
from ivsid.effects.terms import Columns, State, Term

Numbers: TypeAlias = tuple[Any, ...]
# The mass of the vehicle that typical sizes belong to [kg].
REFERENCE_MASS: Final = 58.0

Draw: TypeAlias = Literal["size", "north", "east", "angle", "time", "thruster", "fixed"]


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Attributes:
        part: what follows the id, as ``north`` in ``current.steady.north``; empty for the only parameter.
        symbol: in SNAME notation, where there is one.
        unit: SI; ``demand`` is the thruster's own.
        typical: size for a vehicle of 58 kg and 1 m at about 1 m/s.
        draw: how a hidden value is drawn: ``size`` (the typical size times a factor), ``north`` and ``east`` (components of such
            a size in any direction), ``angle`` (any), ``time`` (within the log), ``thruster`` (an index), ``fixed`` (typical).
        signed: whether both signs occur.
        inverse: a limit, which acts the more the smaller it is.
        none: the value at which there is no effect: 1 for a factor.
        lowest: the smallest value that the physics can take.
        exclusive: that value itself is not possible: a period of 0.
    """

    part: str
    symbol: str
    unit: str
    typical: float
    draw: Draw = "size"
    signed: bool = False
    inverse: bool = False
    none: float = 0.0
    lowest: float | None = None
    exclusive: bool = False

    def scaled(self, mass: float) -> float:
        """The typical size for a vehicle of another mass [kg], after Froude."""
        return float(self.typical * (mass / REFERENCE_MASS) ** (froude_power(self.unit) / 3.0))

    def fault(self, value: float) -> str | None:
        """Why a value cannot be, or None."""
        if self.draw == "thruster" and (value < 0 or value != round(value)):
            return "it is the thruster's place in the file, 0 for the first"
        if self.lowest is None or value > self.lowest or (value == self.lowest and not self.exclusive):
            return None
        return f"it must be above {self.lowest:g}" if self.exclusive else f"it must not be below {self.lowest:g}"


@dataclass(frozen=True)
class Terms:
    """Linear in each parameter: their columns on the left of the equations of motion, one ``Term`` a parameter."""

    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Force:
    """A force on the right: from a state with its place, and the parameters, to X, Y [N] and N [N m] by channel."""

    function: Callable[[State, Numbers], Columns]


@dataclass(frozen=True)
class Change:
    """Other parameters change: from theirs by id, this effect's, and the time [s], to those that differ."""

    function: Callable[[Mapping[str, Any], Numbers, Any], dict[str, Any]]


@dataclass(frozen=True)
class Current:
    """The water moves: from the parameters and the time [s] to its velocity north, east [m/s] and the rates of both."""

    function: Callable[[Numbers, Any], tuple[Any, Any, Any, Any]]


@dataclass(frozen=True)
class Drive:
    """What a thrust depends on beside its demand.

    Attributes:
        demand: from the neutral, in the thruster's own unit.
        time: of the log [s].
        index: the thruster's place in the vehicle file, from 0.
        y: its arm to starboard [m].
        reference: the largest thrust of its curve [N].
        voltage: the supply's, as a share of its first value; None where it is not logged.
    """

    demand: Any
    time: Any
    index: int
    y: float
    reference: float
    voltage: Any = None


@dataclass(frozen=True)
class Thrust:
    """A thrust at rest changes: from it [N], its drive and the parameters to the new one."""

    function: Callable[[Any, Drive, Numbers], Any]


@dataclass(frozen=True)
class Inflow:
    """A thrust changes with the water's speed along its axis [m/s]: from thrust [N], inflow and the parameters."""

    function: Callable[[Any, Any, Numbers], Any]


@dataclass(frozen=True)
class Response:
    """A thrust comes late by its one parameter [s]: by a first-order lag, or by a pure delay."""

    kind: Literal["lag", "delay"]


@dataclass(frozen=True)
class Reading:
    """A sensor's reading changes: from the channels that it senses, and the parameters, to the channels that differ.

    The channels are arrays by the log's names, ``thrust`` [N] beside them; ``r_v`` is the yaw rate at the moment of the velocity
    reading, and ``at`` gives u, v and r_v at an earlier time.
    """

    function: Callable[[Mapping[str, Any], Numbers], dict[str, Any]]
    sensor: Literal["velocity", "acceleration", "yaw_rate"]
    order: int = 0


Acts: TypeAlias = Terms | Force | Change | Current | Thrust | Inflow | Response | Reading


@dataclass(frozen=True)
class Effect:
    """A cause that a diagnosis can name.

    Attributes:
        id: as in EFFECTS.md.
        cause: in a sentence.
        parameters: in EFFECTS.md's order.
        acts: the physics: columns, a force, or a transformation.
        needs: log channels without which the effect cannot be seen, beyond u, v, r and the demands; ``a|b`` is either.
        equivalents: ids that no log tells apart from this one under the condition of EFFECTS.md 3.1.
        confusable: ids that take a good log to tell apart.
        separate: the manoeuvre that does.
        plain: a term of the plain model, which counts as an effect only where a model lacks it.
        per_thruster: ``id.NAME`` is the effect on one thruster alone.
        measured: the form used where the log has the cause itself (wind columns), with parameters of its own.
    """

    id: str
    cause: str
    parameters: tuple[Parameter, ...]
    acts: Acts
    needs: tuple[str, ...] = ()
    equivalents: tuple[str, ...] = ()
    confusable: tuple[str, ...] = ()
    separate: str = ""
    plain: bool = False
    per_thruster: bool = False
    measured: Effect | None = None

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of the parameters: the id, or id.part where there are several."""
        return tuple(f"{self.id}.{p.part}" if p.part else self.id for p in self.parameters)


def term_effect(term: Term, typical: float, cause: str, *, signed: bool = False, **described: Any) -> Effect:
    """An effect that is one term, linear in its only parameter."""
    parameter = Parameter("", term.symbol, term.unit, typical, signed=signed)
    return Effect(term.id, cause, (parameter,), Terms((term,)), **described)
