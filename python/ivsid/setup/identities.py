"""Identities of the kinematics: two channels that say the same, as integrals over windows.

No model of the vessel takes part. The integral of r is the change of psi, that of ax the change of u less the integral of v r, that of
the velocity the change of the position (Fossen 2021, sections 2.2 and 14.4).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log
from ivsid.sensors.lever_arms import at_origin
from ivsid.setup.windows import LEAST, LENGTHS, Course, angle_course, edges_of
from ivsid.vehicle import Sensors, Vehicle, VelocitySensor
from ivsid.vehicle.sensors import AccuracySensor

Array = NDArray[np.float64]
# Least rms of the change over a window, as a multiple of the sensor's stated accuracy: the reading error is then a tenth of the energy.
# Source: geometry: two readings of 1/3 of the change each add 2/9 of its energy at the worst, if they stand at their bounds
ABOVE: Final = 3.0
# Least rms of the change over a window where the vehicle file states no accuracy: heading [rad], velocity [m/s], position [m].
# Source: physics: a compass of 1 degree, a Doppler log of 1 cm/s and a satellite receiver of 0.5 m, three times each
USUAL: Final[Mapping[str, float]] = {"heading": 0.05, "velocity": 0.03, "position": 1.5, "yaw_rate": 0.03}

# Largest misfit of an identity that holds: both sides then have a correlation of at least 0.9 and the same size within a third.
# Source: geometry: the misfit is at least 1 - correlation, and (1 - k)^2 / (1 + k^2) for sides of the ratio k
HOLDS: Final = 0.1


@dataclass(frozen=True)
class Identity:
    """One identity on the windows of one length.

    Attributes:
        says: both sides in words.
        channels: that take part.
        left: shape (m,).
        right: shape (m,).
        least: the rms below which a side is too small to tell.
    """

    says: str
    channels: frozenset[str]
    left: Array
    right: Array
    least: float

    @property
    def excited(self) -> bool:
        """Whether both sides stand above the errors of the readings."""
        return min(_rms(self.left), _rms(self.right)) >= self.least

    @property
    def told(self) -> bool:
        """Whether a side stands above the errors of the readings: of two that do not, the difference is these errors alone."""
        return max(_rms(self.left), _rms(self.right)) >= self.least

    @property
    def holds(self) -> bool:
        """Whether both sides agree, well above the errors of the readings."""
        return self.excited and self.misfit <= HOLDS

    @property
    def misfit(self) -> float:
        """Energy of the difference over that of both sides: 0 where they agree, 1 where they have nothing in common, 2 where one is reversed.

        A constant difference is a bias and counts only where it makes the sides more alike.
        """
        plain = _misfit(self.left, self.right)
        return min(plain, _misfit(self.left - self.left.mean(), self.right - self.right.mean()))


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x * x)))


def _misfit(a: Array, b: Array) -> float:
    whole = float(a @ a + b @ b)
    return float((a - b) @ (a - b)) / whole if whole > 0 else 1.0


def identities(log: Log, sensors: Sensors) -> dict[tuple[str, float], Identity]:
    """All identities that the log has both sides of, by name and length of the windows [s]."""
    log = at_origin(log, sensors)
    t, columns = log.t, log.columns
    sides = [*_turning(t, columns, sensors), *_accelerations(t, columns, sensors), *_displacements(t, columns, sensors)]
    found = {}
    for length in LENGTHS:
        edges = edges_of(t, length)
        if edges is None:
            break
        for s in sides:
            left, right = s.left(edges), s.right(edges)
            there = np.isfinite(left) & np.isfinite(right)
            if int(there.sum()) >= LEAST:
                found[s.says, length] = Identity(s.says, s.channels, left[there], right[there], s.least)
    return found


@dataclass(frozen=True)
class _Sides:
    """Both sides of an identity as functions of the edges of windows."""

    says: str
    channels: frozenset[str]
    left: Callable[[Array], Array]
    right: Callable[[Array], Array]
    least: float


def _least(sensor: AccuracySensor | VelocitySensor | None, quantity: str) -> float:
    return USUAL[quantity] if sensor is None or not sensor.accuracy else ABOVE * sensor.accuracy


def _turning(t: Array, columns: Mapping[str, Array], sensors: Sensors) -> Iterator[_Sides]:
    """Heading and yaw acceleration against the yaw rate."""
    if "r" not in columns:
        return
    r = Course(t, columns["r"])
    if "psi" in columns:
        psi = angle_course(t, columns["psi"])
        least = _least(sensors.heading, "heading")
        yield _Sides("the change of psi and the integral of r", frozenset({"psi", "r"}), psi.change, r.integral, least)
    if "rdot" in columns:
        rdot = Course(t, columns["rdot"])
        both = frozenset({"rdot", "r"})
        yield _Sides("the integral of rdot and the change of r", both, rdot.integral, r.change, USUAL["yaw_rate"])


def _accelerations(t: Array, columns: Mapping[str, Array], sensors: Sensors) -> Iterator[_Sides]:
    """Accelerations against velocities: the specific force in body axes holds the Coriolis part."""
    if not {"u", "v", "r"} <= set(columns):
        return
    u, v, r = (columns[n] for n in ("u", "v", "r"))
    least = _least(sensors.velocity, "velocity")
    for specific, rate, own, coriolis, words in (
        ("ax", "udot", "u", -v * r, "the change of u less the integral of v r"),
        ("ay", "vdot", "v", u * r, "the change of v and the integral of u r"),
    ):
        moved = Course(t, columns[own])
        if specific in columns:
            turned, reading = Course(t, coriolis), Course(t, columns[specific])

            def both(edges: Array, moved: Course = moved, turned: Course = turned) -> Array:
                return moved.change(edges) + turned.integral(edges)

            channels = frozenset({specific, "u", "v", "r"})
            yield _Sides(f"the integral of {specific} and {words}", channels, reading.integral, both, least)
        if rate in columns:
            reading, channels = Course(t, columns[rate]), frozenset({rate, own})
            yield _Sides(
                f"the integral of {rate} and the change of {own}", channels, reading.integral, moved.change, least
            )


def _displacements(t: Array, columns: Mapping[str, Array], sensors: Sensors) -> Iterator[_Sides]:
    """Positions against velocities, in the body axes of the middle of each window."""
    if not {"u", "v", "psi", "x", "y"} <= set(columns):
        return
    psi = angle_course(t, columns["psi"])
    heading = psi.at(t)
    c, s = np.cos(heading), np.sin(heading)
    u, v = columns["u"], columns["v"]
    place = (Course(t, columns["x"]), Course(t, columns["y"]))
    way = (Course(t, u * c - v * s), Course(t, u * s + v * c))

    def ahead(north: Array, east: Array, edges: Array) -> Array:
        a = psi.at(0.5 * (edges[1:] + edges[:-1]))
        return north * np.cos(a) + east * np.sin(a)

    def aside(north: Array, east: Array, edges: Array) -> Array:
        a = psi.at(0.5 * (edges[1:] + edges[:-1]))
        return east * np.cos(a) - north * np.sin(a)

    least = _least(sensors.position, "position")
    channels = frozenset({"u", "v", "psi", "x", "y"})
    for direction, words in ((ahead, "ahead"), (aside, "to starboard")):

        def moved(edges: Array, d: Callable[[Array, Array, Array], Array] = direction) -> Array:
            return d(place[0].change(edges), place[1].change(edges), edges)

        def sailed(edges: Array, d: Callable[[Array, Array, Array], Array] = direction) -> Array:
            return d(way[0].integral(edges), way[1].integral(edges), edges)

        yield _Sides(f"the way {words} by x, y and the integral of u, v", channels, moved, sailed, least)


def vouched(vehicle: Vehicle, log: Log) -> frozenset[str]:
    """The channels that take part in an identity that holds."""
    holding = [i.channels for i in identities(log, vehicle.sensors).values() if i.holds]
    return frozenset().union(*holding)
