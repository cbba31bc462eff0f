"""Forms: how the numbers of an effect enter the errors of a model, and with it how a diagnosis searches for them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, TypeAlias

# Lower and upper end of an interval by part.
Ends: TypeAlias = Mapping[str, tuple[float, float]]
# Lags and delays that are tried [s].
# Source: geometry: neighbours differ by a factor of 2.5 at most, less than the factor that a coefficient corrects (kinds.grid.SECANT)
DELAYS: Final = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
# Dead bands that are tried, in the demand below which most demands stay: levels lie closer below, because a small band shows little of the
# signature of a larger one.
# Source: measured: make constants
BANDS: Final = (0.03, 0.05, 0.08, 0.125, 0.19, 0.28, 0.4, 0.55, 0.75, 1.0)
# Limits that are tried, in the largest thrust of the log.
# Source: measured: make constants
LIMITS: Final = (0.97, 0.92, 0.85, 0.77, 0.68, 0.58, 0.47, 0.35)
# Longest period that a log can show, in lengths of the log.
# Source: geometry/physics: less than a third of a sine hardly differs from a parabola in time
PERIODS: Final = 3.0


@dataclass(frozen=True)
class Form:
    """How the numbers of an effect enter the errors.

    Attributes:
        bends: whether the errors bend or jump with the first number, which is then profiled.
        place: indices of the numbers that are a place over ground, which has to be searched.
        rough: whether its curve over a velocity is known in rough outline, so that what remains of it looks like a small cause of its own.
    """

    bends: ClassVar[bool] = False
    place: ClassVar[tuple[int, ...]] = ()
    rough: ClassVar[bool] = False

    @property
    def jumps(self) -> bool:
        """Whether the errors jump with the first number, so that it has no slope."""
        return False

    @property
    def edged(self) -> bool:
        """Whether the errors have an edge at one demand or one thrust, as an error of a thrust curve that jumps."""
        return self.jumps or self.limits

    @property
    def limits(self) -> bool:
        """Whether the first number caps the thrusts; masses and drags are then known up to a scale that follows it."""
        return False

    def held(self, numbers: tuple[float, ...]) -> tuple[float, ...]:
        """What the slopes of the errors with the numbers are multiplied by to give the whole effect, where it is their sum.

        Args:
            numbers: of the effect, from those at which it vanishes on.
        """
        return numbers

    def shown(self, _numbers: Mapping[str, float], _duration: float, _fastest: float) -> bool:
        """Whether a log can show an effect with these numbers.

        Args:
            numbers: of the effect, by part.
            duration: of the log [s].
            fastest: its largest speed ahead or astern [m/s].
        """
        return True

    def inside(self, numbers: tuple[float, ...], _fastest: float) -> tuple[float, ...]:
        """The nearest numbers that a log can show, where those of a fit move together.

        Args:
            numbers: of the effect, in the order of its parts.
            _fastest: largest speed of the log ahead or astern [m/s].
        """
        return numbers

    def over_declared(self, _numbers: Mapping[str, float], _ambient: float, _push: Callable[[], float]) -> float:
        """Size of an effect in the declared ambient force, where it is a part of that by its nature; infinite where it is none.

        Args:
            numbers: of the effect, by part.
            ambient: declared rms of the ambient force ahead, and that sideways [N]; 0 where none is declared.
            push: gives the rms of its force on the hull in the plane [N], infinite where that is not known.
        """
        return math.inf

    def canonical(self, ends: Ends) -> Ends:
        """One of several equal descriptions of an effect, by the ends of its numbers' intervals."""
        return ends

    def asks(self, _draws: Sequence[str], _parts: Sequence[str]) -> str | None:
        """The parameters that the form asks for, in words, if those of an effect are others.

        Args:
            draws: rules by which the effect's parameters are drawn.
            parts: their names.
        """
        return None


@dataclass(frozen=True)
class Linear(Form):
    """Errors in proportion to each number: a column a number, the slope at none."""


@dataclass(frozen=True)
class Grid(Form):
    """Errors that bend or jump with the only number: a column for each value that is tried, the whole effect at it.

    Attributes:
        of: ``seconds`` (a time by which something is late), ``demand`` (a band of demands, in the demand below which most of the log's stay) or
            ``thrust`` (a cap, in the largest thrust of the log).
        own: values that are tried instead of the usual ones, in ``of``.
    """

    bends: ClassVar[bool] = True
    of: Literal["seconds", "demand", "thrust"]
    own: tuple[float, ...] = ()

    @property
    def values(self) -> tuple[float, ...]:
        """Values that are tried, in ``of``."""
        return self.own or {"seconds": DELAYS, "demand": BANDS, "thrust": LIMITS}[self.of]

    def asks(self, draws: Sequence[str], _parts: Sequence[str]) -> str | None:
        """One parameter."""
        return None if tuple(draws) == ("size",) else "a single parameter, of draw size"

    @property
    def jumps(self) -> bool:
        """Whether the errors jump with the number: where demands are sent, at the edge of a band."""
        return self.of == "demand"

    @property
    def limits(self) -> bool:
        """Whether the number caps the thrusts."""
        return self.of == "thrust"


@dataclass(frozen=True)
class Step(Form):
    """An effect that starts at a time, the parameter of draw ``time``: its size has a column from each moment on."""

    def asks(self, draws: Sequence[str], _parts: Sequence[str]) -> str | None:
        """One size, one time."""
        return (
            None
            if draws.count("size") == draws.count("time") == 1
            else "one parameter of draw size and one of draw time"
        )


@dataclass(frozen=True)
class Harmonic(Form):
    """A sine in time along one direction over ground, of unknown period, with the parts ``period`` and ``phase``.

    Its size is ``amplitude`` with ``direction``, or ``north`` with ``east``.

    Attributes:
        of: ``force``, a swell of 1 N, or ``flow``, a tide of 1 m/s.
    """

    of: Literal["force", "flow"]

    def shown(self, numbers: Mapping[str, float], duration: float, _fastest: float) -> bool:
        """A period of a few lengths of the log."""
        return numbers["period"] <= PERIODS * duration

    def over_declared(self, numbers: Mapping[str, float], ambient: float, push: Callable[[], float]) -> float:
        """The rms of a swell, or of what a tide does to the hull, over that of the ambient force, both over two axes."""
        if not ambient:
            return math.inf
        if self.of == "flow":
            return push() / (math.sqrt(2.0) * ambient)
        amplitude = numbers.get("amplitude") or math.hypot(numbers.get("north", 0.0), numbers.get("east", 0.0))
        return abs(amplitude) / (2.0 * ambient)

    def asks(self, _draws: Sequence[str], parts: Sequence[str]) -> str | None:
        """The parts of a sine."""
        known = ({"amplitude", "direction"}, {"north", "east"})
        fits = {"period", "phase"} <= set(parts) and set(parts) - {"period", "phase"} in known
        return None if fits else "the parts period, phase and either amplitude and direction, or north and east"

    def canonical(self, ends: Ends) -> Ends:
        """The wave with its larger component positive, or its direction in [0, pi): half a turn later, the opposite direction is the same."""
        found = dict(ends)
        shift = 0.0
        parts = {q: ends[q] for q in ("north", "east") if q in ends}
        if parts:
            # The larger component is counted positive.
            lower, upper = max(parts.values(), key=lambda b: abs(b[0] + b[1]))
            if lower + upper < 0:
                shift = math.pi
                found |= {q: (-b[1], -b[0]) for q, b in parts.items()}
        if "direction" in ends:
            lower, upper = ends["direction"]
            shift = math.floor(0.5 * (lower + upper) / math.pi) * math.pi
            found["direction"] = (lower - shift, upper - shift)
        if "phase" in ends:
            lower, upper = ends["phase"]
            shift -= math.floor((0.5 * (lower + upper) + shift) / (2 * math.pi)) * 2 * math.pi
            found["phase"] = (lower + shift, upper + shift)
        return found


@dataclass(frozen=True)
class Anchored(Form):
    """A constant pull toward a place over ground: the numbers are the pull, the place north and east, and the arm."""

    place: ClassVar[tuple[int, ...]] = (1, 2)

    def asks(self, draws: Sequence[str], _parts: Sequence[str]) -> str | None:
        """A pull, a place and an arm."""
        return (
            None
            if tuple(draws[:3]) == ("size", "north", "east") and len(draws) == 4
            else "a pull, a place north and east, and an arm"
        )


@dataclass(frozen=True)
class Hump(Form):
    """A force that stands out about one speed, with the parts ``height``, ``speed`` and ``width``: in proportion to the height alone."""

    rough: ClassVar[bool] = True

    def shown(self, numbers: Mapping[str, float], _duration: float, fastest: float) -> bool:
        """A hump that leaves rest without a force, and of which one flank is sailed."""
        return numbers["width"] <= numbers["speed"] <= fastest + numbers["width"]

    def inside(self, numbers: tuple[float, ...], fastest: float) -> tuple[float, ...]:
        """A hump whose flank is sailed, as narrow as leaves rest without a force."""
        height, speed, width = numbers
        speed = min(speed, fastest + width)
        return height, speed, min(width, speed)

    def held(self, numbers: tuple[float, ...]) -> tuple[float, ...]:
        """The height: it is the only number of which the force is a multiple."""
        return numbers[0], 0.0, 0.0

    def asks(self, draws: Sequence[str], parts: Sequence[str]) -> str | None:
        """A height, a speed and a width."""
        fits = tuple(parts) == ("height", "speed", "width") and tuple(draws) == ("size", "fixed", "fixed")
        return None if fits else "the parts height (draw size), speed and width (draw fixed), in this order"
