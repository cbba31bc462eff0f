"""A scenario file: what a simulated vehicle does, where, and what is true of it (INTERFACE.md)."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ivsid.errors import IvsidError
from ivsid.programme.manoeuvres import Segment
from ivsid.vehicle import Finite, NonNegative, Positive, validated

Share = Annotated[float, Field(ge=0, lt=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Environment(_Section):
    """Where the vehicle is.

    ``current`` [m/s] north and east, as ``current.steady`` in the truth; ``wind_speed`` [m/s] and ``wind_direction`` [rad], the true
    wind and where it comes from, with gusts of rms ``wind_gust`` over ``wind_gust_time`` [s]; ``depth`` [m] under the keel; ``voltage``
    [V] of the supply at the start, falling by ``voltage_fall`` [V/s]. Wind, depth and voltage become columns of the log.
    """

    current: tuple[Finite, Finite] | None = None
    wind_speed: NonNegative | None = None
    wind_direction: Finite = 0.0
    wind_gust: NonNegative = 0.0
    wind_gust_time: Positive = 10.0
    depth: Positive | None = None
    voltage: Positive | None = None
    voltage_fall: NonNegative = 0.0


class Start(_Section):
    """The state at the first sample: ``u``, ``v`` [m/s], ``r`` [rad/s], ``psi`` [rad], ``x``, ``y`` [m]."""

    u: Finite = 0.0
    v: Finite = 0.0
    r: Finite = 0.0
    psi: Finite = 0.0
    x: Finite = 0.0
    y: Finite = 0.0


class Faults(_Section):
    """What else a sensor's column shows.

    ``period`` [s] of a sensor slower than the log, whose value is held in between, or with ``hold = false`` missing; the share of samples lost in ``drop_outs`` of
    mean length ``drop_out_time`` [s]; the share of ``outliers``, of rms ``outlier_size`` in the channel's unit.
    """

    period: Positive | None = None
    hold: bool = True
    drop_outs: Share = 0.0
    drop_out_time: Positive = 1.0
    outliers: Share = 0.0
    outlier_size: NonNegative = 0.0


class Sensing(_Section):
    """Faults by sensor, as in the vehicle file's [sensors]."""

    velocity: Faults | None = None
    acceleration: Faults | None = None
    yaw_rate: Faults | None = None
    yaw_acceleration: Faults | None = None
    heading: Faults | None = None
    position: Faults | None = None


class Scenario(_Section):
    """``duration`` [s], ``rate`` [Hz], ``seed``, ``noise``, true values by id, and the manoeuvres, repeated until the end."""

    duration: Positive
    rate: Positive
    seed: int = Field(default=0, ge=0)
    noise: Literal["gaussian", "uniform", "none"] = "gaussian"
    truth: dict[str, Finite]
    segments: tuple[Segment, ...] = Field(min_length=1)
    environment: Environment = Environment()
    start: Start = Start()
    sensing: Sensing = Sensing()

    @model_validator(mode="after")
    def _size(self) -> Self:
        if not 2 <= self.duration * self.rate <= 1e7:
            raise IvsidError(
                f"{self.duration:g} s at {self.rate:g} Hz is {self.duration * self.rate:g} samples; 2 to 1e7 are possible"
            )
        return self


def read_scenario(path: str | Path) -> Scenario:
    """Reads and checks a scenario file."""
    try:
        text = Path(path).read_text()
    except OSError as error:
        raise IvsidError(f"scenario {path} cannot be read ({error.strerror}); give the path of a TOML file") from None
    except UnicodeDecodeError:
        raise IvsidError(f"{path} is not a text file; a scenario is TOML") from None
    return parse_scenario(text, str(path))


def parse_scenario(text: str, source: str) -> Scenario:
    """Checks the text of a scenario; ``source`` names it in messages."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise IvsidError(f"{source} is not valid TOML: {error}; mend that line") from None
    return validated(Scenario, table, source)
