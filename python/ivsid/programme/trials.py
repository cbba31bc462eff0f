"""Trials: a small library of manoeuvres for a next trial, sized for a vehicle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.programme.manoeuvres import Manoeuvre, Segment
from ivsid.programme.scenario import Scenario
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster, Vehicle

# Length of a trial [s] for a hull of 1 m; other hulls scale it by Froude's law.
# Source: measured: make constants
LENGTH: Final = 150.0
# Samples of a trial at most, as long as that leaves it ``LENGTH`` seconds.
# Source: resource: bounds the time of an isolability study.
MOST: Final = 6000.0
# Yaw rate [rad/s] of a brisk turn of a hull of 1 m.
# Source: measured: make constants
BRISK: Final = 0.4
# Feedback of the yaw rate: the share of full demand for an error of ``BRISK``.
# Source: measured: make constants
HOLD: Final = 0.6
# A simulated yaw rate above this multiple of ``BRISK`` is not believed: the model lacks damping.
# Source: measured: make constants
SPIN: Final = 6.0

# Levels of a key of a segment: one, or one after the other.
Levels: TypeAlias = float | tuple[float, ...]


@dataclass(frozen=True)
class Trial:
    """A manoeuvre of the library.

    Attributes:
        name: short, for tables.
        words: description of the trial, in a sentence.
        segments: for a scenario, repeated until its end.
    """

    name: str
    words: str
    segments: tuple[Segment, ...]


def library(vehicle: Vehicle, full: float | None = None) -> tuple[Trial, ...]:
    """The manoeuvres that the vehicle can sail; none without thrusters.

    Args:
        vehicle: its thrusters and length.
        full: the largest demand from neutral; by default the end of the shortest curve.
    """
    if not vehicle.thrusters:
        return ()
    return _Sizes(vehicle, full_demand(vehicle) if full is None else full).trials()


def full_demand(vehicle: Vehicle) -> float:
    """The largest demand from neutral that every thruster can take; 0 if no curve has an end."""
    ends = [c.range[1] - t.neutral for t in vehicle.thrusters if math.isfinite((c := ThrustCurve(t)).range[1])]
    return min(ends, default=0.0)


def _fixed(vehicle: Vehicle) -> list[Thruster]:
    return [t for t in vehicle.thrusters if t.steering == "fixed" and t.rudder is None]


def spins(vehicle: Vehicle) -> bool:
    """Whether thrusters of a fixed direction turn the vehicle."""
    return any(
        abs(t.position[0] * math.sin(t.azimuth) - t.position[1] * math.cos(t.azimuth)) > 1e-9 for t in _fixed(vehicle)
    )


def pushes_sideways(vehicle: Vehicle) -> bool:
    """Whether thrusters of a fixed direction push the vehicle sideways."""
    return any(abs(math.sin(t.azimuth)) > 1e-9 for t in _fixed(vehicle))


def scenario(trial: Trial, vehicle: Vehicle, rate: float, truth: Mapping[str, float], noise: str = "none") -> Scenario:
    """The trial as a scenario.

    Args:
        trial: the manoeuvre.
        vehicle: its size sets the duration.
        rate: of the samples [Hz].
        truth: true values by id or id.part.
        noise: kind of the sensors' noise.
    """
    seconds = min(LENGTH * max(_slower(vehicle), 0.8), max(LENGTH, MOST / rate))
    return Scenario.model_validate(
        {
            "duration": seconds,
            "rate": rate,
            "seed": 0,
            "noise": noise,
            "truth": dict(truth),
            "segments": trial.segments,
        }
    )


def believable(vehicle: Vehicle, r: NDArray[np.float64]) -> bool:
    """Whether the vehicle could turn at the simulated rates r [rad/s], shape (n,): a model without damping may spin."""
    return bool(np.isfinite(r).all() and np.abs(r).max() < fastest_turn(vehicle))


def fastest_turn(vehicle: Vehicle) -> float:
    """The largest yaw rate [rad/s] that a simulation is believed."""
    return SPIN * brisk(vehicle)


def brisk(vehicle: Vehicle) -> float:
    """Yaw rate of a brisk turn [rad/s]."""
    return BRISK / _slower(vehicle)


def _slower(vehicle: Vehicle) -> float:
    return math.sqrt(vehicle.hull.length or (vehicle.hull.mass / 60.0) ** (1 / 3))


class _Sizes:
    """Demands, times and rates of trials for one vehicle."""

    def __init__(self, vehicle: Vehicle, full: float) -> None:
        self.full, self.slow = full, _slower(vehicle)
        self.spins, self.pushes_sideways = spins(vehicle), pushes_sideways(vehicle)

    def one(
        self, kind: Manoeuvre, seconds: float, demand: Levels = 0.0, *, turned: float = 0.0, **how: float
    ) -> Segment:
        """A segment: demands as shares of full, times [s] and rates for a hull of 1 m.

        Except while coasting, the yaw rate is fed back to thrusters that turn the vehicle, with a reference of 0 by default: a model
        without damping in yaw would spin otherwise.
        """
        levels = tuple(q * self.full for q in demand) if isinstance(demand, tuple) else demand * self.full
        numbers: dict[str, object] = {"manoeuvre": kind, "duration": seconds * self.slow, "demand": levels}
        if kind != "coast":
            numbers |= {"yaw_gain": HOLD * self.full / (BRISK / self.slow), "differential_limit": 0.6 * self.full}
        if turned:
            numbers |= self.turned(turned)
        for key, value in how.items():
            scaled = {"period": self.slow, "period_end": self.slow, "yaw_rate": 1 / self.slow}.get(key, 1.0)
            numbers[key] = value * (self.full if key in ("sway", "amplitude") else scaled)
        return Segment.model_validate(numbers)

    def turn(self, seconds: float, demand: float, share: float) -> Segment:
        """A steady turn at a share of a brisk one."""
        if self.spins:
            return self.one("circle", seconds, demand, yaw_rate=BRISK * share)
        return self.one("steady", seconds, demand, turned=share)

    def turned(self, share: float) -> dict[str, float]:
        """Keys of a segment that turn the vehicle by thrusters, rudders and azimuths, as a share of the usual levels."""
        return {"differential": 0.4 * self.full * share, "rudder": 0.6 * share, "azimuth": 0.5 * share}

    def trials(self) -> tuple[Trial, ...]:
        one = self.one
        quarter = 0.5 * math.pi / BRISK
        found = [
            Trial(
                "coast to rest",
                "full speed, then no thrust until it lies still; the same astern",
                (one("steady", 12, 0.8), one("coast", 24), one("steady", 7, -0.5), one("coast", 14)),
            ),
            Trial(
                "speed steps", "straight, at several speeds", (one("steps", 48, (0.3, 0.6, 0.9, 0.15), period=12.0),)
            ),
            Trial(
                "acceleration straights",
                "straight, full ahead and slow ahead in turn, each for some seconds",
                (one("steps", 36, (0.95, 0.2, 0.7, 0.1), period=9.0),),
            ),
            Trial(
                "zigzag 10/10",
                "a little helm, over each time the heading has come 10 degrees",
                (one("heading_zigzag", 75, 0.5, heading=math.radians(10), turned=0.5),),
            ),
            Trial(
                "zigzag 20/20",
                "more helm, over each time the heading has come 20 degrees, at two speeds",
                (
                    one("heading_zigzag", 40, 0.45, heading=math.radians(20), turned=1.0),
                    one("heading_zigzag", 35, 0.8, heading=math.radians(20), turned=1.0),
                ),
            ),
            Trial(
                "circles at two speeds",
                "steady turns both ways, slow and fast",
                tuple(self.turn(30, q, s) for q, s in ((0.35, 1.0), (0.8, 1.0), (0.35, -1.0), (0.8, -1.0))),
            ),
            Trial("PRBS", "random steps of speed and helm", (self.random(),)),
            Trial(
                "spiral",
                "the helm in steps from one side to the other",
                tuple(self.turn(15, 0.6, s) for s in (1.4, 0.8, 0.3, -0.3, -0.8, -1.4)),
            ),
            Trial(
                "chirp in yaw",
                "the helm to and fro, ever faster",
                (
                    one(
                        "chirp",
                        75,
                        0.5,
                        amplitude=0.3,
                        period=15.0,
                        period_end=2.5,
                        **({} if self.spins else {"turned": 0.5}),
                    ),
                ),
            ),
            Trial(
                "speed changes on four headings",
                "slow and fast on each of four headings",
                (
                    one("steps", 32, (0.2, 0.9), period=8.0),
                    self.turn(quarter if self.spins else 1.5 * quarter, 0.45, 1.0),
                ),
            ),
            Trial(
                "round the anchor",
                "one wide, slow circle after the other, round the place where a tether would be made fast",
                (self.turn(LENGTH, 0.5, 0.25),),
            ),
        ]
        if self.spins:
            found.append(
                Trial(
                    "turns on the spot",
                    "full turns both ways without speed, brisk and slow",
                    tuple(self.turn(18, 0.0, s) for s in (1.5, 0.5, -1.5, -0.5)),
                )
            )
        if self.pushes_sideways:
            found.append(
                Trial(
                    "sideways steps",
                    "pushed to either side, at rest and ahead",
                    (
                        one("steady", 12, 0.0, sway=0.5),
                        one("steady", 12, 0.0, sway=-0.5),
                        one("steady", 12, 0.4, sway=0.4),
                        one("coast", 8),
                    ),
                )
            )
        return tuple(found)

    def random(self) -> Segment:
        """Random steps of speed and helm."""
        return self.one("prbs", LENGTH, 0.5, amplitude=0.3, period=2.5, turned=0.4)
