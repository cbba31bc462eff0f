"""Scenario files: the programme, the surroundings and the true values of a simulation (docs/guide.md)."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ivsid.errors import IvsidError
from ivsid.files.parsed import toml_table
from ivsid.files.shipped import near_shipped
from ivsid.programme.manoeuvres import Segment
from ivsid.vehicle import Finite, NonNegative, Positive, validated

Share = Annotated[float, Field(ge=0, lt=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Environment(_Section):
    """The surroundings of the vehicle. Wind, depth and voltage become columns of the log.

    Attributes:
        current: velocity of the water north and east [m/s], as ``current.steady`` in the truth.
        wind_speed: of the true wind [m/s].
        wind_direction: the direction that the wind comes from [rad].
        wind_gust: rms of the gusts [m/s].
        wind_gust_time: their correlation time [s].
        depth: of the water under the keel [m].
        voltage: of the supply at the start [V].
        voltage_fall: its fall [V/s].
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
    """Faults in the columns of a sensor.

    Attributes:
        period: of a sensor slower than the log [s].
        hold: whether its value is repeated between its samples (zero-order hold); else it is missing there.
        drop_outs: share of samples that are lost.
        drop_out_time: mean length of a drop-out [s].
        outliers: share of samples that are outliers.
        outlier_size: their rms, in the channel's unit.
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
    """A scenario.

    Attributes:
        duration: of the log [s].
        rate: of its samples [Hz].
        seed: of all draws.
        noise: kind of the sensors' noise.
        truth: true values by id or id.part; those of the vehicle file's ``[model.fitted]`` where it states none.
        segments: the manoeuvres in turn, repeated until the end.
        environment: current, wind, depth and voltage.
        start: the state at the first sample.
        sensing: faults by sensor.
    """

    duration: Positive
    rate: Positive
    seed: int = Field(default=0, ge=0)
    noise: Literal["gaussian", "uniform", "none"] = "gaussian"
    truth: dict[str, Finite] = Field(default_factory=dict)
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
    """Reads and checks a scenario file.

    Raises:
        IvsidError: a file that cannot be read, or as ``parse_scenario``.
    """
    try:
        text = Path(path).read_text()
    except OSError as error:
        raise IvsidError(
            f"scenario {path} cannot be read ({error.strerror}); {near_shipped(path, '_programme')}give the path of a TOML file"
        ) from None
    except UnicodeDecodeError:
        raise IvsidError(f"{path} is not a text file; a scenario is TOML") from None
    return parse_scenario(text, str(path))


def parse_scenario(text: str, source: str) -> Scenario:
    """Checks the text of a scenario.

    Args:
        text: in TOML.
        source: name of the file, for messages.

    Raises:
        IvsidError: text that is not TOML, or an unknown key or unusable value, named by its path.
    """
    try:
        table = toml_table(text)
    except tomllib.TOMLDecodeError as error:
        raise IvsidError(f"{source} is not valid TOML: {error}; mend that line") from None
    return validated(Scenario, table, source)
