"""Thrusters of the vehicle file: position, direction, thrust curve, and the accuracy of that curve."""

from __future__ import annotations

from itertools import pairwise
from typing import Final, Literal, Self

from pydantic import Field, model_validator

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.files.section import Finite, NonNegative, Pair, Positive, Section
from ivsid.vehicle.rudder import Rudder

# Largest thrust [N], demand and slope of a table, for which the formulas of the interpolation do not overflow.
# Source: physics: beyond any thruster
MOST_THRUST: Final = 1e100


class ThrustTable(Section):
    """A bollard-pull table: ``thrust`` [``unit``] at each ``demand``, which increases strictly."""

    demand: tuple[Finite, ...] = Field(min_length=2)
    thrust: tuple[Finite, ...] = Field(min_length=2)
    unit: str = "N"

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        units.factor(self.unit, units.FORCE, "a thrust table")
        if len(self.demand) != len(self.thrust):
            raise IvsidError(f"{len(self.demand)} demands but {len(self.thrust)} thrusts; a table needs one for each")
        if any(b <= a for a, b in zip(self.demand, self.demand[1:], strict=False)):
            raise IvsidError("the demands of a table must increase strictly")
        knots = list(zip(self.demand, self.thrust, strict=True))
        slopes = [(g - f) / (b - a) for (a, f), (b, g) in pairwise(knots)]
        if not all(abs(x) <= MOST_THRUST for x in (*self.demand, *self.thrust, *slopes)):
            raise IvsidError(
                f"a demand or a thrust of a table, or its change over a demand, is beyond {MOST_THRUST:g}; check its unit"
            )
        return self


class Quadratic(Section):
    """The thrust curve T = k n|n| [N] of a demand n.

    The coefficient k is ``forward`` for positive demands and ``reverse`` for negative ones; ``reverse`` is ``forward`` by default.
    """

    forward: NonNegative
    reverse: NonNegative | None = None

    @property
    def astern(self) -> float:
        """The coefficient of negative demands."""
        return self.forward if self.reverse is None else self.reverse


class Accuracy(Section):
    """The bound on the thrust error: ``absolute`` [N] plus ``relative`` times the thrust."""

    absolute: NonNegative = 0.0
    relative: NonNegative = 0.0


class Thruster(Section):
    """One thruster, with exactly one of the curves ``table``, ``polynomial``, ``gain``, ``quadratic``.

    Attributes:
        name: its demand is the column ``demand_NAME`` of the log.
        position: from the body origin, forward and to starboard [m].
        azimuth: direction of the thrust, from forward to starboard [rad].
        table: bollard pull; the curve is monotone between its points.
        polynomial: coefficients of powers of the demand, highest power first [N].
        gain: thrust of a unit demand [N].
        quadratic: T = k n|n|.
        accuracy: the bound on the error of the curve.
        neutral: the demand that stands for zero.
        outside: whether a demand beyond the table is refused or keeps the thrust of its end.
        demand_range: the lowest and the highest demand of a curve without a table.
        time_constant: of a first-order lag [s].
        dead_band: demands below it give no thrust.
        limit: the largest thrust [N].
        reverse_factor: of thrusts astern.
        advance_loss: share of the thrust that is lost per speed of the inflow [s/m].
        lag: whether the lag acts on the thrust, or on the demand (the speed of a shaft).
        steering: ``azimuth`` takes the direction from the column ``azimuth_NAME``.
        steering_rate: the largest rate of that direction [rad/s].
        rudder: behind the propeller.
    """

    name: str = Field(pattern=r"^[A-Za-z0-9_]+$")
    position: Pair = (0.0, 0.0)
    azimuth: Finite = 0.0
    table: ThrustTable | None = None
    polynomial: tuple[Finite, ...] | None = Field(default=None, min_length=1, max_length=10)
    gain: Finite | None = None
    quadratic: Quadratic | None = None
    accuracy: Accuracy = Accuracy()
    neutral: Finite = 0.0
    outside: Literal["refuse", "hold"] = "refuse"
    demand_range: Pair | None = None
    time_constant: NonNegative | None = None
    dead_band: NonNegative | None = None
    limit: Positive | None = None
    reverse_factor: Positive | None = None
    advance_loss: NonNegative | None = None
    lag: Literal["thrust", "demand"] = "thrust"
    steering: Literal["fixed", "azimuth"] = "fixed"
    steering_rate: Positive | None = None
    rudder: Rudder | None = None

    @property
    def column(self) -> str:
        """The name of its demand in a log."""
        return f"demand_{self.name}"

    @property
    def own(self) -> bool:
        """Whether it is a force of its own, and no further part of another one's error."""
        return True

    @property
    def words(self) -> str:
        """What it gives, in words."""
        return f"the thrust of {self.name}"

    @model_validator(mode="after")
    def _one_curve(self) -> Self:
        given = [k for k in ("table", "polynomial", "gain", "quadratic") if getattr(self, k) is not None]
        if len(given) != 1:
            raise IvsidError(
                f"has {' and '.join(given) or 'no thrust curve'}; give one of table, polynomial, gain, quadratic"
            )
        if self.demand_range is not None and (
            self.table is not None or not self.demand_range[0] < self.demand_range[1]
        ):
            raise IvsidError(
                "demand_range = [lowest, highest] ends a curve that has no table; a table ends with its own demands: leave demand_range out"
            )
        return self
