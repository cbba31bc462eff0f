"""The ``[log]`` section of a vehicle file: how a foreign log maps to the contract's columns (INTERFACE.md)."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from ivsid.files import units

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class TimeColumn(_Section):
    """A column of stamps: ``from`` its name, in ``unit``."""

    from_: str = Field(default="t", alias="from")
    unit: str = "s"

    @model_validator(mode="after")
    def _known(self) -> Self:
        units.factor(self.unit, units.TIME, "the time column")
        return self


class Column(_Section):
    """A foreign column: ``from`` its name, in ``unit``, times ``scale`` plus ``offset``.

    Cells that equal ``missing`` are no samples. ``time`` names the column that holds this sensor's own stamps, where they
    are not those of the rows.
    """

    from_: str = Field(alias="from")
    scale: Finite = 1.0
    offset: Finite = 0.0
    unit: str | None = None
    missing: Finite | None = None
    time: TimeColumn | None = None

    @model_validator(mode="after")
    def _known(self) -> Self:
        if self.unit is not None:
            units.factor(self.unit, units.COLUMN, f"column {self.from_}")
        return self

    @property
    def factor(self) -> float:
        """What a cell is multiplied by to be in SI units."""
        return self.scale * (1.0 if self.unit is None else units.COLUMN[self.unit])


def _name_or_table(given: object) -> str:
    return "table" if isinstance(given, (dict, Column)) else "name"


# Told apart before they are checked, so that a fault in a table is not reported as a wrong name.
Given = Annotated[Annotated[str, Tag("name")] | Annotated[Column, Tag("table")], Discriminator(_name_or_table)]


class LogMap(_Section):
    """How a foreign log maps to the contract's columns, and what may be assumed between the samples of several clocks.

    Attributes:
        columns: foreign names by the contract's names.
        frame: of body and earth axes; ``flu`` is REP 103.
        time: the clock of the rows, where it is not ``t`` in seconds.
        demand: how a demand runs from one row to the next.
        base: the channel or table whose samples become the rows, where there are several clocks.
        rates: the largest rate of change of a channel [its unit per second]. Only a channel with a stated rate is brought to
            another clock, and its interval there is widened by all that it can move.
        clock_error: how far two clocks may disagree [s].
    """

    columns: dict[str, Given] = {}
    frame: Literal["frd", "flu"] = "frd"
    time: TimeColumn | None = None
    demand: Literal["hold", "linear"] = "hold"
    base: str | None = None
    rates: dict[str, Positive] = {}
    clock_error: NonNegative = 0.0
