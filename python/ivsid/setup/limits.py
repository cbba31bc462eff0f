"""Readings that the vehicle file's own limits rule out by far: a unit is wrong, or a limit."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log
from ivsid.setup.finding import Checked, SetupFinding
from ivsid.setup.suspects import column_of
from ivsid.setup.windows import Course, edges_of
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Multiple of a stated limit that no log of the vessel reaches: the smallest wrong unit, km/h for m/s, is a factor of 3.6. A limit that was
# stated somewhat too small is for the fit to find.
# Source: definition: below 3.6
BEYOND: Final = 3.0
# Length of the windows over which a change is taken [s]: noise and single outliers average out.
# Source: definition: limits are stated per second
WINDOW: Final = 1.0
# Fewest windows beyond the limit: one may be a glimpse of another object or a shock.
# Source: definition: more than two accidents
FEWEST: Final = 3
# Channels, the limit of each, its unit, and the unit that it is most likely in.
LIMITED: Final = {
    "r": ("yaw_acceleration", "rad/s", "deg/s"),
    "rdot": ("yaw_acceleration", "rad/s^2", "deg/s^2"),
    "u": ("acceleration", "m/s", "km/h"),
    "v": ("acceleration", "m/s", "km/h"),
    "ax": ("acceleration", "m/s^2", "g"),
    "ay": ("acceleration", "m/s^2", "g"),
    "udot": ("acceleration", "m/s^2", "g"),
    "vdot": ("acceleration", "m/s^2", "g"),
}


def limits(vehicle: Vehicle, log: Log) -> Checked:
    """Velocities and yaw rates that change, and accelerations that stand, far beyond ``[sensors.limits]``."""
    stated = vehicle.sensors.limits
    sensor = vehicle.sensors.acceleration
    tilted = sensor is not None and bool(sensor.gravity)
    findings = []
    for name, (key, unit, other) in LIMITED.items():
        limit = getattr(stated, key)
        if limit is None or name not in log.columns or name in log.derived or (tilted and name in ("ax", "ay")):
            continue
        change, allowed = _changes(log, name, limit)
        beyond = change > BEYOND * allowed
        if int(beyond.sum()) >= FEWEST:
            worst = int(np.argmax(np.where(beyond, change / allowed, 0.0)))
            findings.append(
                _finding(vehicle, log, name, key, limit, unit, other, float(change[worst]), int(beyond.sum()))
            )
    return Checked(tuple(findings), log)


def _changes(log: Log, name: str, limit: float) -> tuple[Array, Array]:
    """Sizes over windows of the change of a velocity, or of the mean of an acceleration, and the largest that the limit allows."""
    t = log.t
    edges = edges_of(t, max(WINDOW, 2 * log.period))
    if edges is None:
        return np.zeros(0), np.ones(0)
    x = Course(t, log.columns[name])
    length = float(edges[1] - edges[0])
    if name in ("u", "v", "r"):
        # Means of neighbouring windows differ by at most the limit times their distance.
        return _known(np.abs(np.diff(x.integral(edges) / length)), np.full(edges.size - 2, limit * length))
    mean = x.integral(edges) / length
    # A constant part is a bias or a tilt, not a unit.
    mean = np.abs(mean - np.nanmedian(mean)) if np.isfinite(mean).any() else mean
    allowed = np.full(mean.size, limit)
    if name in ("ax", "ay") and {"u", "v", "r"} <= set(log.columns):
        # A specific force holds the Coriolis part beside the acceleration.
        other = "v" if name == "ax" else "u"
        turned = Course(t, np.abs(log.columns[other] * log.columns["r"])).integral(edges) / length
        allowed = allowed + turned
    return _known(mean, allowed)


def _known(size: Array, allowed: Array) -> tuple[Array, Array]:
    there = np.isfinite(size) & np.isfinite(allowed)
    return size[there], allowed[there]


def _finding(
    vehicle: Vehicle, log: Log, name: str, key: str, limit: float, unit: str, other: str, worst: float, count: int
) -> SetupFinding:
    changes = name in ("u", "v", "r")
    does = f"changes by {worst:.3g} {unit} within a second" if changes else f"leaves its median by {worst:.3g} {unit}"
    words = f"{log.name}: {name} {does}, in {count} windows, against [sensors.limits] {key} = {limit:g}: its unit or that limit is wrong"
    column = column_of(vehicle, name)
    unit_key = (
        f'{name} = {{ from = "{column.from_}", unit = "{other}" }}'
        if column.unit is None
        else f"the true unit of {name}"
    )
    remedy = f"state {unit_key} under [log.columns], or the true limit"
    evidence = {"largest": worst, "limit": limit, "windows": float(count)}
    return SetupFinding(f"setup.{name}.limit", words, evidence, remedy, certain=True)
