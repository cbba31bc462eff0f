"""The section ``[log]`` of a vehicle file: the map from a foreign log to the columns that ivsid knows (docs/guide.md)."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from ivsid.files import units
from ivsid.files.section import Finite, NonNegative, Positive, Section


class TimeColumn(Section):
    """A column of stamps.

    Attributes:
        from_: its name; the key of the file is ``from``.
        unit: of a stamp; None for seconds, or for what the size of an epoch says. Dates know their own.
        nanoseconds: the column of nanoseconds beside one of whole seconds, as in a ROS stamp.
    """

    from_: str = Field(default="t", alias="from")
    unit: str | None = None
    nanoseconds: str | None = None

    @model_validator(mode="after")
    def _known(self) -> Self:
        if self.unit is not None:
            units.factor(self.unit, units.TIME, "the time column")
        if self.nanoseconds is not None and self.unit not in (None, "s"):
            raise ValueError(f"unit {self.unit} stands beside nanoseconds; a stamp of two columns has whole seconds")
        return self


class Column(Section):
    """A foreign column: cells in ``unit``, times ``scale``, plus ``offset``.

    Attributes:
        from_: name of the column; the key of the file is ``from``.
        scale: factor of a cell.
        offset: added in SI units, after the scale.
        unit: of a cell; None for SI.
        missing: cells of this value are missing samples.
        time: the column of the sensor's own stamps, where they differ from the stamps of the rows.
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
        """The factor from a cell to SI units."""
        return self.scale * (1.0 if self.unit is None else units.COLUMN[self.unit])


def _name_or_table(given: object) -> str:
    return "table" if isinstance(given, (dict, Column)) else "name"


# Told apart before they are checked, so that a fault in a table is not reported as a wrong name.
Given = Annotated[Annotated[str, Tag("name")] | Annotated[Column, Tag("table")], Discriminator(_name_or_table)]


class LogMap(Section):
    """The map from a foreign log, and the assumptions between the samples of several clocks.

    Attributes:
        columns: foreign names by ivsid's names.
        frame: of body and earth axes; ``flu`` is REP 103.
        time: the clock of the rows, where it is not ``t`` in seconds.
        demand: the course of a demand from one row to the next.
        base: the channel or table whose samples become the rows, where there are several clocks.
        rates: the largest rate of change of a channel [its unit per second]. Only a channel with a stated rate is brought to
            another clock. Its interval there is widened by the largest change under that rate.
        clock_error: the largest difference between two clocks [s].
        span: the part of the log that is read, from one time to another [s]: on the clock of the log, which counts from its first stamp
            where stamps are dates or epochs; of a bag, since its first message by the recorder's clock.
    """

    columns: dict[str, Given] = Field(default_factory=dict)
    frame: Literal["frd", "flu"] = "frd"
    time: TimeColumn | None = None
    demand: Literal["hold", "linear"] = "hold"
    base: str | None = None
    rates: dict[str, Positive] = Field(default_factory=dict)
    clock_error: NonNegative = 0.0
    span: tuple[Finite, Finite] | None = None

    @model_validator(mode="after")
    def _forward(self) -> Self:
        if self.span is not None and not self.span[0] < self.span[1]:
            raise ValueError(f"span goes from {self.span[0]:g} to {self.span[1]:g} s; its second time is the later one")
        return self
