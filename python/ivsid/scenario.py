"""A scenario file: what a simulated vehicle does, and what is true of it (INTERFACE.md)."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from ivsid.errors import IvsidError
from ivsid.vehicle import Finite, NonNegative, Positive, validated

Manoeuvre = Literal["coast", "steady", "steps", "zigzag", "circle", "prbs", "chirp"]


class Segment(BaseModel):
    """One manoeuvre.

    ``demand`` is common to all thrusters (steps: a list of levels, each for one ``period``); ``differential`` adds to those that
    turn the vehicle to starboard and is taken from the others. zigzag and circle hold the yaw rate at +-``yaw_rate`` with the
    proportional ``yaw_gain`` [demand per rad/s], at most ``differential_limit``. prbs adds +-``amplitude`` to the common and
    +-``differential`` to the differential demand, drawn every ``period``. chirp sweeps a differential sine of ``amplitude`` from
    ``period`` to ``period_end``.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    manoeuvre: Manoeuvre
    duration: Positive = 30.0
    demand: Finite | Annotated[tuple[Finite, ...], Field(min_length=1)] = 0.0
    differential: Finite = 0.0
    amplitude: NonNegative = 0.0
    period: Positive = 5.0
    period_end: Positive | None = None
    yaw_rate: Finite = 0.0
    yaw_gain: NonNegative = 0.0
    differential_limit: Positive = 10.0

    @model_validator(mode="after")
    def _levels(self) -> Self:
        if isinstance(self.demand, tuple) and self.manoeuvre != "steps":
            raise IvsidError(f"a list of demands belongs to steps, not to {self.manoeuvre}; give one number")
        return self


class Scenario(BaseModel):
    """``duration`` [s], ``rate`` [Hz], ``seed``, ``noise``, true values by id, and the manoeuvres, repeated until the end."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    duration: Positive
    rate: Positive
    seed: int = Field(default=0, ge=0)
    noise: Literal["gaussian", "uniform", "none"] = "gaussian"
    truth: dict[str, Finite]
    segments: tuple[Segment, ...] = Field(min_length=1)
    environment: dict[str, Finite] = {}

    @model_validator(mode="after")
    def _size(self) -> Self:
        if not 2 <= self.duration * self.rate <= 1e7:
            raise IvsidError(
                f"{self.duration:g} s at {self.rate:g} Hz is {self.duration * self.rate:g} samples; 2 to 1e7 are possible"
            )
        if self.environment:
            known = ", ".join(self.environment)
            raise IvsidError(f"environment ({known}) is not simulated in this version; leave the section out")
        return self

    def commands(self, rng: np.random.Generator) -> Iterator[tuple[float, float, float, float, float]]:
        """For each sample: common and differential demand, yaw-rate reference, its gain, and the differential limit."""
        step = 1.0 / self.rate
        samples = round(self.duration * self.rate)
        made = 0
        while True:
            for segment in self.segments:
                signs = (1.0, 1.0)
                drawn = -1
                for k in range(max(1, round(segment.duration * self.rate))):
                    if made == samples:
                        return
                    time = k * step
                    turn = math.floor(time / segment.period + 1e-9)
                    if turn != drawn and segment.manoeuvre == "prbs":
                        signs = (float(rng.choice((-1, 1))), float(rng.choice((-1, 1))))
                        drawn = turn
                    yield _command(segment, time, turn, signs)
                    made += 1


def _command(
    s: Segment, time: float, turn: int, signs: tuple[float, float]
) -> tuple[float, float, float, float, float]:
    levels = s.demand if isinstance(s.demand, tuple) else (s.demand,)
    common, differential, reference, gain = levels[0], s.differential, s.yaw_rate, s.yaw_gain
    match s.manoeuvre:
        case "coast":
            common = differential = 0.0
        case "steps":
            common = levels[turn % len(levels)]
        case "zigzag":
            reference = s.yaw_rate if turn % 2 == 0 else -s.yaw_rate
        case "prbs":
            common, differential = levels[0] + signs[0] * s.amplitude, signs[1] * s.differential
        case "chirp":
            end = s.period_end or s.period
            f0, f1 = 1 / s.period, 1 / end
            differential += s.amplitude * math.sin(2 * math.pi * (f0 + (f1 - f0) * time / (2 * s.duration)) * time)
    return common, differential, reference, gain, s.differential_limit


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
