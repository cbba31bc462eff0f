"""The filters of a log: one an axis, by the sensors that the log has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.prediction.kalman import Axis, axis

AXES: Final = ("surge", "sway", "yaw", "north", "east")
# Error of the velocity over ground that heading and velocities give [m/s].
# Source: measured: make constants
TRACK: Final = 2e-3
# Correlation time of that error [s].
# Source: measured: make constants
TRACK_TIME: Final = 20.0
# The channel of each output of the filters of surge, sway and yaw.
MEASURED: Final[tuple[dict[str, str], ...]] = (
    {"velocity": "u", "acceleration": "ax"},
    {"velocity": "v", "acceleration": "ay"},
    {"position": "psi", "velocity": "r", "acceleration": "rdot"},
)


@dataclass(frozen=True)
class Ambient:
    """Random acceleration of surge, sway and yaw, a Gauss-Markov process each.

    Attributes:
        deviation: standard deviations [m/s^2, m/s^2, rad/s^2].
        time: correlation times [s].
    """

    deviation: tuple[float, float, float]
    time: tuple[float, float, float]


def motion_axes(log: Channels, ambient: Ambient) -> list[Axis]:
    """The filters of surge, sway and yaw under an ambient acceleration."""
    return [
        axis(
            log.h,
            {
                kind: log.rate_noise if name == "r" else log.noise[name]
                for kind, name in names.items()
                if name in log.noise
            },
            ambient.deviation[k],
            ambient.time[k],
        )
        for k, names in enumerate(MEASURED)
    ]


def track_axes(log: Channels) -> list[Axis]:
    """The filters of the position north and east, if position and heading are logged."""
    if log.place is None or log.psi is None:
        return []
    return [axis(log.h, {"velocity": log.noise[name]}, TRACK, TRACK_TIME) for name in ("x", "y")]


def labels_of(axes: list[Axis]) -> list[tuple[int, str]]:
    """The axis and the channel of each row of prediction errors."""
    labels = [(k, names[o]) for k, names in enumerate(MEASURED) for o in axes[k].outputs]
    return labels + [(k, "xy"[k - 3]) for k in range(3, len(axes))]
