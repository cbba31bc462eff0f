"""Manoeuvres of a scenario: the commands of each segment, open loop or by feedback of the motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Final, Literal, NamedTuple, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from ivsid.errors import IvsidError
from ivsid.vehicle import Finite, NonNegative, Positive

Manoeuvre = Literal[
    "coast",
    "steady",
    "steps",
    "zigzag",
    "circle",
    "prbs",
    "chirp",
    "sweep",
    "spiral",
    "heading_zigzag",
    "pull_out",
    "free_decay",
    "station",
]
# Manoeuvres that take a list of levels, by the key of the list.
_LISTS: Final = {"demand": ("steps",), "differential": ("steps", "spiral"), "rudder": ("steps", "spiral")}
Levels = Finite | Annotated[tuple[Finite, ...], Field(min_length=1)]


# Turns of a manoeuvre beyond which their number is no longer exact: a period far below the time of a sample.
# Source: definition: 53 bits of a double
MOST_TURNS: Final = 2.0**53


class Segment(BaseModel):
    """One manoeuvre.

    ``demand`` is common to all thrusters. ``sway`` goes to thrusters that push sideways. ``differential`` is added to thrusters that
    turn the vehicle to starboard and subtracted from those that turn it to port. ``rudder`` and ``azimuth`` [rad] are the angles of
    rudders and azimuth thrusters. ``duration``, ``period`` and ``period_end`` are in seconds. A feedback of the yaw rate adds
    ``yaw_gain`` [demand per rad/s] times (``yaw_rate`` - r) to the differential, at most ``differential_limit``.

    - coast, free_decay: every thruster stops.
    - steady: the demands hold.
    - steps: ``demand`` is a list of levels, each for one ``period``.
    - zigzag, circle: the yaw rate is +-``yaw_rate``; a zigzag changes its sign every ``period``.
    - prbs: +-``amplitude`` is added to the common demand, and the differential gets a sign; both signs are drawn every ``period``.
      Rudder and azimuth take the sign of the differential.
    - chirp: a sine of ``amplitude`` from ``period`` to ``period_end`` is added to the differential, and the rudder follows the sine.
    - sweep: the sine is added to the common demand.
    - spiral: the differential or the rudder steps through its levels, each for one ``period``.
    - heading_zigzag: differential, rudder and azimuth change their sign whenever the heading is ``heading`` [rad] past the first
      one (Kempf).
    - pull_out: differential, rudder and azimuth hold for one ``period`` and are then 0.
    - station: ``position`` [m] and ``heading`` [rad] are kept by ``position_gain`` [demand/m], ``position_damping`` [demand/(m/s)],
      ``heading_gain`` [demand/rad] and ``yaw_gain``, each demand at most ``differential_limit``.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    manoeuvre: Manoeuvre
    duration: Positive = 30.0
    demand: Levels = 0.0
    sway: Finite = 0.0
    differential: Levels = 0.0
    rudder: Levels = 0.0
    azimuth: Finite = 0.0
    amplitude: NonNegative = 0.0
    period: Positive = 5.0
    period_end: Positive | None = None
    yaw_rate: Finite = 0.0
    yaw_gain: NonNegative = 0.0
    differential_limit: Positive = 10.0
    heading: Finite = 0.0
    position: tuple[Finite, Finite] = (0.0, 0.0)
    position_gain: NonNegative = 0.0
    position_damping: NonNegative = 0.0
    heading_gain: NonNegative = 0.0

    @model_validator(mode="after")
    def _levels(self) -> Self:
        for key, allowed in _LISTS.items():
            if isinstance(getattr(self, key), tuple) and self.manoeuvre not in allowed:
                raise IvsidError(
                    f"a list of {key}s belongs to {' and '.join(allowed)}, not to {self.manoeuvre}; give one number"
                )
        if self.manoeuvre == "heading_zigzag" and not self.heading > 0:
            raise IvsidError("heading_zigzag turns when the heading has come this far; give heading [rad] above 0")
        if self.manoeuvre == "station" and not (self.position_gain or self.heading_gain):
            raise IvsidError("station holds nothing without a gain; give position_gain, heading_gain or both")
        return self


class Command(NamedTuple):
    """A command from one sample to the next.

    Attributes:
        surge: demand of thrusters ahead.
        sway: demand of thrusters sideways.
        turn: demand of thrusters that turn the vehicle, positive to starboard.
        rudder: angle of the rudders [rad].
        azimuth: angle of azimuth thrusters [rad].
        yaw_rate: reference of the yaw-rate feedback [rad/s].
    """

    surge: float
    sway: float
    turn: float
    rudder: float
    azimuth: float
    yaw_rate: float


class Programme:
    """The segments in turn, repeated until the end.

    Args:
        segments: the manoeuvres.
        samples: number of samples.
        rate: of the samples [Hz].
        rng: source of the signs of every prbs.
    """

    def __init__(self, segments: Sequence[Segment], samples: int, rate: float, rng: np.random.Generator) -> None:
        # Open-loop commands are computed once: two for a heading zigzag, one for each side, and twice the same for the others.
        self._plan: list[tuple[Segment, float, Command, Command]] = []
        step = 1.0 / rate
        while len(self._plan) < samples:
            for segment in segments:
                signs, drawn = (1.0, 1.0), -1
                # A product that overflows is longer than any scenario.
                for k in range(max(1, round(min(segment.duration * rate, samples)))):
                    if len(self._plan) == samples:
                        break
                    time = k * step
                    turn = math.floor(min(time / segment.period + 1e-9, MOST_TURNS))
                    if turn != drawn and segment.manoeuvre == "prbs":
                        signs = (float(rng.choice((-1, 1))), float(rng.choice((-1, 1))))
                        drawn = turn
                    one = _open_loop(segment, time, turn, signs, 1.0)
                    other = (
                        _open_loop(segment, time, turn, signs, -1.0) if segment.manoeuvre == "heading_zigzag" else one
                    )
                    self._plan.append((segment, time, one, other))

    def pilot(self) -> Pilot:
        """A pilot at the first sample of the programme."""
        return Pilot(self._plan)


class Pilot:
    """A follower of a programme, sample by sample in order, with the memory of a manoeuvre."""

    def __init__(self, plan: Sequence[tuple[Segment, float, Command, Command]]) -> None:
        self._plan = plan
        self._side, self._first = 1.0, 0.0

    def command(self, k: int, state: tuple[float, ...]) -> Command:
        """The command from sample k on, at the state u, v, r, psi, x, y."""
        segment, time, one, other = self._plan[k]
        if time == 0.0:
            self._side, self._first = 1.0, state[3]
        if segment.manoeuvre == "station":
            return _station(segment, state)
        if other is not one:
            if self._side * (state[3] - self._first) >= segment.heading:
                self._side = -self._side
            one = one if self._side > 0 else other
        if not segment.yaw_gain:
            return one
        limit = segment.differential_limit
        correction = min(max(segment.yaw_gain * (one.yaw_rate - state[2]), -limit), limit)
        return Command(one.surge, one.sway, one.turn + correction, one.rudder, one.azimuth, one.yaw_rate)


def _open_loop(s: Segment, time: float, turn: int, signs: tuple[float, float], side: float) -> Command:
    common, sway, differential, rudder = (
        _level(s.demand, turn),
        s.sway,
        _level(s.differential, turn),
        _level(s.rudder, turn),
    )
    azimuth, reference = s.azimuth, s.yaw_rate
    match s.manoeuvre:
        case "coast" | "free_decay":
            return Command(0.0, 0.0, 0.0, 0.0, azimuth, reference)
        case "zigzag":
            reference = s.yaw_rate if turn % 2 == 0 else -s.yaw_rate
        case "prbs":
            common += signs[0] * s.amplitude
            differential, rudder, azimuth = (signs[1] * q for q in (differential, rudder, azimuth))
        case "chirp" | "sweep":
            end = s.period_end or s.period
            f0, f1 = 1 / s.period, 1 / end
            wave = math.sin(2 * math.pi * (f0 + (f1 - f0) * time / (2 * s.duration)) * time)
            if s.manoeuvre == "sweep":
                common += s.amplitude * wave
            else:
                differential += s.amplitude * wave
                rudder *= wave
        case "heading_zigzag":
            differential, rudder, azimuth = (side * q for q in (differential, rudder, azimuth))
        case "pull_out":
            if turn > 0:
                differential = rudder = azimuth = 0.0
        case _:
            pass
    return Command(common, sway, differential, rudder, azimuth, reference)


def _level(levels: float | tuple[float, ...], turn: int) -> float:
    return levels[turn % len(levels)] if isinstance(levels, tuple) else levels


def _station(s: Segment, state: tuple[float, ...]) -> Command:
    u, v, r, psi, x, y = state
    north, east = s.position[0] - x, s.position[1] - y
    c, sn = math.cos(psi), math.sin(psi)
    # The remainder gives the shorter way round.
    error = math.remainder(s.heading - psi, 2 * math.pi)
    wanted = (
        s.position_gain * (north * c + east * sn) - s.position_damping * u,
        s.position_gain * (east * c - north * sn) - s.position_damping * v,
        s.heading_gain * error - s.yaw_gain * r,
    )
    surge, sway, turn = (min(max(q, -s.differential_limit), s.differential_limit) for q in wanted)
    return Command(surge, sway, turn, 0.0, s.azimuth, 0.0)
