"""Suspects: wrong signs, wrong units and swapped axes of channels, each with the change that mends it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final

from ivsid.files.log_map import Column
from ivsid.files.units import COLUMN
from ivsid.log import Log
from ivsid.vehicle import Vehicle


@dataclass(frozen=True)
class Suspect:
    """A fault that a log may have.

    Attributes:
        id: of the fault.
        says: the fault, as the beginning of a sentence.
        factors: by channel, its right value over that of the log.
        sources: by channel, the channel under whose name its readings stand.
        unit: that a foreign column would have to state, or None.
    """

    id: str
    says: str
    factors: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    unit: str | None = None

    @property
    def channels(self) -> frozenset[str]:
        """The channels that it changes."""
        return frozenset({*self.factors, *self.sources})

    def possible(self, log: Log) -> bool:
        """Whether the log has these channels as they were logged, not worked out from others."""
        return self.channels <= set(log.columns) and not self.channels & set(log.derived)

    def mended(self, log: Log) -> Log:
        """The log without the fault."""
        columns = dict(log.columns)
        for name in self.channels:
            columns[name] = log.columns[self.sources.get(name, name)] * self.factors.get(name, 1.0)
        return replace(log, columns=columns)

    def remedy(self, vehicle: Vehicle) -> str:
        """The lines of ``[log.columns]`` that mend it."""
        return (
            "state " + ", ".join(self._entry(vehicle, name) for name in sorted(self.channels)) + " under [log.columns]"
        )

    def _entry(self, vehicle: Vehicle, name: str) -> str:
        source = self.sources.get(name, name)
        if name in self.sources:
            return renamed(vehicle, name, source)
        return in_unit(vehicle, name, self.unit, self.factors[name])


def column_of(vehicle: Vehicle, name: str) -> Column:
    """The foreign column of a channel, as the vehicle file maps it."""
    given = vehicle.log.columns.get(name, name)
    return given if isinstance(given, Column) else Column.model_validate({"from": given})


def renamed(vehicle: Vehicle, name: str, source: str) -> str:
    """The line of ``[log.columns]`` that takes a channel from the foreign column of another."""
    return f'{name} = "{column_of(vehicle, source).from_}"'


def in_unit(vehicle: Vehicle, name: str, unit: str | None, factor: float) -> str:
    """The line of ``[log.columns]`` that reads a channel in another unit: by its name where the file states none, else by its factor."""
    column = column_of(vehicle, name)
    if unit is not None and column.unit is None and column.scale == 1.0:
        return f'{name} = {{ from = "{column.from_}", unit = "{unit}" }}'
    return scaled(vehicle, name, factor)


def scaled(vehicle: Vehicle, name: str, factor: float) -> str:
    """The line of ``[log.columns]`` that multiplies a channel by a factor more than now."""
    column = column_of(vehicle, name)
    unit = "" if column.unit is None else f', unit = "{column.unit}"'
    return f'{name} = {{ from = "{column.from_}", scale = {column.scale * factor:.6g}{unit} }}'


def sign(name: str, quantity: str, *channels: str) -> Suspect:
    """The wrong sign of a channel."""
    return Suspect(f"setup.{name}.sign", f"{quantity} has the wrong sign", dict.fromkeys(channels, -1.0))


def taken(name: str, quantity: str, unit: str, read: str, factor: float, *channels: str) -> Suspect:
    """Channels in another unit than the one as which they are read."""
    known = unit if unit in COLUMN else None
    return Suspect(
        f"setup.{name}.unit",
        f"{quantity} {'is' if len(channels) == 1 else 'are'} in {unit} and taken for {read}",
        dict.fromkeys(channels, factor),
        unit=known,
    )


def swapped(name: str, quantity: str, a: str, b: str) -> Suspect:
    """Two channels under each other's name."""
    return Suspect(f"setup.{name}.axes", f"{quantity} are swapped", sources={a: b, b: a})


# Radians of one degree.
# Source: definition
DEGREE: Final = math.pi / 180.0
# Standard gravity [m/s^2].
# Source: definition: CGPM 1901
G: Final = 9.80665

SIGNS: Final = (
    sign("yaw_rate", "yaw rate r", "r"),
    sign("heading", "heading psi", "psi"),
    sign("surge_velocity", "surge velocity u", "u"),
    sign("sway_velocity", "sway velocity v", "v"),
    sign("surge_acceleration", "acceleration ax", "ax"),
    sign("sway_acceleration", "acceleration ay", "ay"),
    sign("surge_acceleration", "acceleration udot", "udot"),
    sign("sway_acceleration", "acceleration vdot", "vdot"),
    sign("yaw_acceleration", "yaw acceleration rdot", "rdot"),
)

UNITS: Final = (
    taken("yaw_rate", "yaw rate r", "deg/s", "rad/s", DEGREE, "r"),
    taken("heading", "heading psi", "deg", "rad", DEGREE, "psi"),
    taken("angles", "yaw rate r and heading psi", "degrees", "radians", DEGREE, "psi", "r"),
    taken("yaw_rate", "yaw rate r", "rad/s", "deg/s", 1 / DEGREE, "r"),
    taken("heading", "heading psi", "rad", "deg", 1 / DEGREE, "psi"),
    taken("yaw_acceleration", "yaw acceleration rdot", "deg/s^2", "rad/s^2", DEGREE, "rdot"),
    *(
        taken("acceleration", f"accelerations {' and '.join(pair)}", unit, read, factor, *pair)
        for pair in (("ax", "ay"), ("udot", "vdot"))
        for unit, read, factor in (
            ("g", "m/s^2", G),
            ("milli-g", "m/s^2", 1e-3 * G),
            ("m/s^2", "g", 1 / G),
            ("m/s^2", "milli-g", 1e3 / G),
        )
    ),
    *(
        taken("velocity", "velocities u and v", unit, read, factor, "u", "v")
        for unit, read, factor in (
            ("kn", "m/s", COLUMN["kn"]),
            ("km/h", "m/s", COLUMN["km/h"]),
            ("m/s", "kn", 1 / COLUMN["kn"]),
            ("m/s", "km/h", 1 / COLUMN["km/h"]),
        )
    ),
)

AXES: Final = (
    swapped("velocity", "velocities u and v", "u", "v"),
    swapped("acceleration", "accelerations ax and ay", "ax", "ay"),
    swapped("acceleration", "accelerations udot and vdot", "udot", "vdot"),
)

SUSPECTS: Final = (*SIGNS, *UNITS, *AXES)
