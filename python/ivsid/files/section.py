"""The base of a section of a TOML file, and the kinds of numbers that its keys take.

A section refuses unknown keys and is immutable. The vehicle file, its part ``[log]`` and the files of simulated programmes are
made of such sections.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Probability = Annotated[float, Field(gt=0, lt=1)]
Pair = tuple[Finite, Finite]


class Section(BaseModel):
    """A table of keys, each checked; immutable once read."""

    model_config = ConfigDict(extra="forbid", frozen=True)
