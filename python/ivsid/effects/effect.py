"""Effects: one definition of a cause for models, simulation, identification and diagnosis."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, TypeAlias, TypedDict, Unpack

from ivsid.effects.forms import Form, Grid, Linear, Step
from ivsid.effects.quantity import Quantity
from ivsid.effects.scaling import froude_power
from ivsid.effects.terms import Columns, State, Term

# An effect's parameters in their order: floats, or symbols and arrays where many values are tried at once.
Numbers: TypeAlias = tuple[Quantity, ...]
# The mass of the vehicle that typical sizes belong to [kg].
# Source: definition: the catalogue's reference vehicle, 58 kg and 1 m.
REFERENCE_MASS: Final = 58.0

Draw: TypeAlias = Literal["size", "north", "east", "angle", "time", "thruster", "fixed"]


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Attributes:
        part: the name after the effect's id, as ``north`` in ``current.steady.north``; empty for an only parameter.
        symbol: in SNAME notation, where there is one.
        unit: SI; ``demand`` is the thruster's own.
        typical: size for a vehicle of 58 kg and 1 m at about 1 m/s.
        draw: the rule by which a hidden value is drawn: ``size`` (the typical size times a factor), ``north`` and ``east``
            (components of such a size in any direction), ``angle`` (any), ``time`` (within the log), ``thruster`` (an index),
            ``fixed`` (typical).
        signed: whether both signs occur.
        inverse: whether the effect grows as the value falls, as for a limit.
        none: the value at which the effect vanishes: 1 for a factor.
        lowest: the smallest value that the physics can take.
        exclusive: whether ``lowest`` itself is impossible, as for a period of 0.
        most: the largest value that is drawn or fitted first, as for a share.
        of_thrust: the typical size in the largest thrust of the vehicle file's curves, where those have an end; 0 where it follows the mass.
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
    most: float = math.inf
    of_thrust: float = 0.0

    def scaled(self, mass: float, thrust: float = 0.0) -> float:
        """The typical size for a vehicle of another mass [kg], by Froude's law of similarity, or for its largest thrust [N], where that is given."""
        if self.of_thrust and thrust:
            return self.of_thrust * thrust
        return float(self.typical * (mass / REFERENCE_MASS) ** (froude_power(self.unit) / 3.0))

    def fault(self, value: float) -> str | None:
        """The reason why a value is impossible, or None."""
        if self.draw == "thruster" and (value < 0 or value != round(value)):
            return "it is the thruster's place in the file, 0 for the first"
        if self.lowest is None or value > self.lowest or (value == self.lowest and not self.exclusive):
            return None
        return f"it must be above {self.lowest:g}" if self.exclusive else f"it must not be below {self.lowest:g}"


class Physics:
    """A class of physics.

    Attributes:
        form: in which a diagnosis searches for such effects, where they declare none.
        at_thruster: whether it acts at each thruster.
        additive: whether it leaves the masses, the water and all other forces as they are.
        late: whether it stands between demand and thrust, or between motion and reading, with a memory or a sensor of its own.
    """

    form: ClassVar[Form] = Linear()
    at_thruster: ClassVar[bool] = False
    additive: ClassVar[bool] = False
    late: ClassVar[bool] = False

    @property
    def in_time(self) -> bool:
        """Whether it may change in the course of a log."""
        return False


@dataclass(frozen=True)
class Terms(Physics):
    """Physics that is linear in each parameter: columns on the left of the equations of motion, one ``Term`` a parameter."""

    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Force(Physics):
    """A force on the right-hand side: from a state with its place, and the parameters, to X, Y [N] and N [N m] by channel."""

    additive: ClassVar[bool] = True
    function: Callable[[State, Numbers], Columns]


@dataclass(frozen=True)
class Change(Physics):
    """A change of other parameters: from their values by id, this effect's parameters and the time [s] to the new values."""

    function: Callable[[Mapping[str, Quantity], Numbers, Quantity], dict[str, Quantity]]

    @property
    def in_time(self) -> bool:
        """A change is given the time."""
        return True


@dataclass(frozen=True)
class Current(Physics):
    """A current: from the parameters and the time [s] to the water's velocity north, east [m/s] and the rates of both."""

    function: Callable[[Numbers, Quantity], tuple[Quantity, Quantity, Quantity, Quantity]]


@dataclass(frozen=True)
class Drive:
    """Everything but the thrust itself that a change of a thrust may depend on.

    Attributes:
        demand: from the neutral, in the thruster's own unit.
        time: of the log [s].
        index: the thruster's place in the vehicle file, from 0.
        y: its arm to starboard [m].
        reference: the largest thrust of its curve [N].
        voltage: the supply's, as a share of its first value; None where it is not logged.
    """

    demand: Quantity
    time: Quantity
    index: int
    y: float
    reference: float
    voltage: Quantity = None


@dataclass(frozen=True)
class Thrust(Physics):
    """A change of a thrust at rest: from the thrust [N], its drive and the parameters to the new thrust [N].

    Attributes:
        function: the change.
        timed: whether it depends on the time or the voltage of its drive.
    """

    at_thruster: ClassVar[bool] = True
    additive: ClassVar[bool] = True
    function: Callable[[Quantity, Drive, Numbers], Quantity]
    timed: bool = False

    @property
    def in_time(self) -> bool:
        """Whether it depends on the time or the voltage."""
        return self.timed


@dataclass(frozen=True)
class Inflow(Physics):
    """A change of a thrust by inflow: from thrust [N], the water's speed along its axis [m/s] and the parameters to [N]."""

    at_thruster: ClassVar[bool] = True
    additive: ClassVar[bool] = True
    function: Callable[[Quantity, Quantity, Numbers], Quantity]


@dataclass(frozen=True)
class Response(Physics):
    """A late thrust, whose time [s] is the only parameter: a first-order lag of the thrust or of its demand (a shaft), or a pure delay."""

    form: ClassVar[Form] = Grid("seconds")
    at_thruster: ClassVar[bool] = True
    additive: ClassVar[bool] = True
    late: ClassVar[bool] = True
    kind: Literal["lag", "shaft", "delay"]


@dataclass(frozen=True)
class Reading(Physics):
    """A change of a sensor's reading: from the channels it senses and the parameters to the channels that differ.

    The channels are arrays by the log's names, and ``thrust`` [N]. Two more entries serve velocity sensors: ``r_v`` is the yaw
    rate at the moment of the velocity reading, and ``at`` is a function that gives u, v and r_v a delay [s] earlier.

    Attributes:
        function: the change.
        sensor: the section of the vehicle file's [sensors].
        order: place among the changes of the same log, lowest first.
    """

    additive: ClassVar[bool] = True
    late: ClassVar[bool] = True
    function: Callable[[Mapping[str, Quantity], Numbers], dict[str, Quantity]]
    sensor: Literal["velocity", "acceleration", "yaw_rate"]
    order: int = 0


@dataclass(frozen=True)
class Key:
    """A key of a vehicle file's thruster that states an effect.

    Attributes:
        name: of the key.
        share_left: whether the key states one minus the effect's number: the share that is left.
    """

    name: str
    share_left: bool = False

    def __call__(self, value: float) -> float:
        """The key's number from the effect's, and the other way round."""
        return 1.0 - value if self.share_left else value


Ask: TypeAlias = Literal["both_sides", "largest_thrust"]
Acts: TypeAlias = Terms | Force | Change | Current | Thrust | Inflow | Response | Reading


@dataclass(frozen=True)
class Effect:
    """A cause that a diagnosis can name.

    Attributes:
        id: stable name in files and results, as ``drag.surge.linear``.
        cause: in a sentence.
        parameters: in the order in which the command line takes them.
        acts: the physics: columns, a force, or a transformation.
        needs: log channels without which the effect is invisible, beyond u, v, r and the demands; ``a|b`` is either.
        equivalents: ids that no log tells apart from this one under the condition of docs/theory.md, "Equivalent effects".
        equivalent_odds: for equivalents that no log whatever tells apart: the odds of each against this effect, in their order,
            with which a finding lists them. Empty where the equivalence holds only in some logs.
        confusable: ids that only an exciting log tells apart.
        separate: the manoeuvre that tells them apart.
        of_hull: least and most that a hull has of an only parameter, in its mass [kg], or in mass times squared length [kg m^2].
        plain: whether it is a term of the plain model, which is an effect only for a model that lacks it.
        per_thruster: whether ``id.NAME`` is the effect on one thruster alone.
        measured: the form for logs that hold the cause itself (wind columns), with parameters of its own.
        searched: how a diagnosis searches for it, where its physics does not say (``form``).
        key: of a vehicle file's thruster that states the same.
        asks: what it needs of a vehicle: thrusters on both sides, or thrust curves with an end.
        turning: whether it has no signature of its own where the vehicle does not turn.
        shares: the plain term with which it shares one column in the paper's model.
        needed: whether every model has it, since no mass matrix is regular without it.
        one_factor: whether it changes all masses and drags by one factor: no log without a claimed number, or a stated centre of gravity off the origin, shows it.
        hidden: the reason why no single log shows it; empty for all others.
        stated: the entry of a scenario's environment that states it.
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
    equivalent_odds: tuple[float, ...] = ()
    of_hull: tuple[float, float] | None = None
    searched: Form | None = None
    key: Key | None = None
    asks: tuple[Ask, ...] = ()
    turning: bool = False
    shares: str = ""
    needed: bool = False
    one_factor: bool = False
    hidden: str = ""
    stated: str = ""

    @property
    def form(self) -> Form:
        """How a diagnosis searches for it: as declared, else by its start, else as usual for its physics."""
        return self.searched or (Step() if "time" in self.draws else self.acts.form)

    @property
    def draws(self) -> tuple[Draw, ...]:
        """The rules by which hidden values of its parameters are drawn."""
        return tuple(p.draw for p in self.parameters)

    @property
    def terms(self) -> tuple[Term, ...]:
        """The terms that it adds to a model; none for physics that is not linear in its parameters."""
        return self.acts.terms if isinstance(self.acts, Terms) else ()

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parameters: the id alone for an only parameter, else id.part."""
        return tuple(f"{self.id}.{p.part}" if p.part else self.id for p in self.parameters)

    @property
    def always_equivalent(self) -> dict[str, float]:
        """Ids that no log whatever tells apart from this one, with their odds against it."""
        return dict(zip(self.equivalents, self.equivalent_odds, strict=True)) if self.equivalent_odds else {}


class Described(TypedDict, total=False):
    """Fields of ``Effect`` that describe it, for ``term_effect``."""

    equivalents: tuple[str, ...]
    equivalent_odds: tuple[float, ...]
    confusable: tuple[str, ...]
    separate: str
    plain: bool
    of_hull: tuple[float, float] | None
    turning: bool
    shares: str
    needed: bool


def term_effect(
    term: Term, typical: float, cause: str, *, signed: bool = False, **described: Unpack[Described]
) -> Effect:
    """An effect that is one term, linear in its only parameter."""
    parameter = Parameter("", term.symbol, term.unit, typical, signed=signed)
    return Effect(term.id, cause, (parameter,), Terms((term,)), **described)
