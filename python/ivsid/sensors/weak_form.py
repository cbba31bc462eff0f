"""Means of velocities over half windows from the pose alone, for the double-integral weak form.

The test function is the hat phi that rises from 0 at t_a to 1 at t_c and falls to 0 at t_b. Weighted by it, the equation of surge
contains udot only as

    integral phi udot dt = (mean of u over [t_c, t_b]) - (mean of u over [t_a, t_c]),

and positions give these means almost exactly, while u itself is wide (``pose``). With the heading psi,

    integral u dt = integral cos psi dx + integral sin psi dy.

Let c and s be piecewise linear, with the values cos and sin of the measured headings at the rows. By parts, integral c dx needs x at the
rows and the total variation TV of c. Bounds of the remaining errors:

    position errors e            e (|c_i| + |c_j| + TV(c)), and the same with y and s
    x between the rows           TV A h^2 / 12, A a bound of the acceleration in earth axes
    heading errors q, with the bend of the heading between the rows, W h^2 / 8:   q |v| + q^2 |u| / 2 a second
    chords of cos and sin        (largest step of the heading)^2 / 8 sqrt(2) (|u| + |v|) a second

The yaw rate follows in the same way from the double difference of the heading, exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.log.angles import unwrapped
from ivsid.sensors.pose import DIAGONAL, POSE
from ivsid.vehicle import Sensors

# Relative slack for bounds of errors, which are evaluated in floats.
# Source: definition: far above the few units of 2^-53 by which a dozen operations are off.
ROUNDING: Final = 1e-9
# Slack for each term of a running sum, as a share of the sum of absolute values.
# Source: theorem: Jeannerod and Rump 2013, 2^-53 a term, times 16 for the rounding of the terms themselves.
SUM: Final = 2.0**-49

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PoseMeans:
    """The pose at rows, and bounds of the motion between them.

    Attributes:
        log: readings and clock.
        sensors: their accuracies, and the limits of the vessel.
        channels: enclosures of u, v [m/s], r [rad/s] at the rows, each of shape (n,).
        steps: lengths of the steps [s] in intervals, shape (n - 1,).
        turned: headings [rad] without jumps of whole turns, shape (n,).
        there: whether a row has a pose and velocities, shape (n,).
    """

    log: Log
    sensors: Sensors
    channels: dict[str, IntervalArray]
    steps: IntervalArray
    turned: Array
    there: NDArray[np.bool_]

    def rising(self, starts: NDArray[np.int64], half: int) -> dict[str, IntervalArray]:
        """Mean over the second half minus mean over the first half of windows, of u and v [m/s] and r [rad/s].

        Args:
            starts: first rows of the windows, shape (m,).
            half: steps in each half.

        Returns:
            Intervals by channel, each of shape (m,).
        """
        clock = IntervalArray.around(self.log.t, self.log.time_error)
        middle, end = starts + half, starts + 2 * half
        first, second = clock[middle] - clock[starts], clock[end] - clock[middle]
        heading = self._heading()
        result = {"r": (heading[end] - heading[middle]) / second - (heading[middle] - heading[starts]) / first}
        for name, way in self._ways(half).items():
            result[name] = way(middle, end) / second - way(starts, middle) / first
        return result

    def _heading(self) -> IntervalArray:
        assert self.sensors.heading is not None
        reach = np.nextafter(self.sensors.heading.accuracy, np.inf)
        lost = self.log.error("psi") + 4 * np.spacing(np.abs(self.turned) + 7.0)
        return IntervalArray.around(self.turned, lost) + IntervalArray(-reach, reach)

    def _ways(self, half: int) -> dict[str, _Way]:
        """The integrals of u and v over stretches of ``half`` steps."""
        sensors, log = self.sensors, self.log
        assert sensors.position is not None and sensors.heading is not None
        assert sensors.limits.acceleration is not None and sensors.limits.yaw_acceleration is not None
        # Missing poses are filled by straight lines, which keep the sums finite and are never used.
        filled = {n: _bridged(log.t, log.columns[n]) for n in ("x", "y")}
        error = {n: sensors.position.accuracy + float(log.error(n).max()) for n in ("x", "y")}
        c, s = np.cos(self.turned), np.sin(self.turned)
        h = self.steps.upper
        most = {n: self._largest(n, half) for n in ("u", "v", "r")}
        speed = most["u"] + most["v"]
        longest = _largest_near(np.r_[h, h[-1]], half)
        earth = DIAGONAL * sensors.limits.acceleration + most["r"] * speed
        lost = float((log.error("psi") + 4 * np.spacing(np.abs(self.turned) + 7.0)).max())
        off = sensors.heading.accuracy + lost + sensors.limits.yaw_acceleration * longest**2 / 8
        turn = _largest_near(np.r_[np.abs(np.diff(self.turned)), 0.0], half)
        chord = turn**2 / 8 * DIAGONAL * speed
        ways = {}
        for name, along, across in (("u", {"x": c, "y": s}, "v"), ("v", {"x": -s, "y": c}, "u")):
            rate = off * most[across] + 0.5 * off**2 * most[name] + chord
            total = np.zeros(log.t.size)
            variation, ends, bend = np.zeros(log.t.size), np.zeros(log.t.size), np.zeros(log.t.size)
            summed = 0.0
            for axis, share in along.items():
                parts = 0.5 * (share[1:] + share[:-1]) * np.diff(filled[axis])
                total[1:] += np.cumsum(parts)
                moved = np.r_[0.0, np.cumsum(np.abs(np.diff(share)))]
                variation += error[axis] * moved
                ends += error[axis] * np.abs(share)
                bend += moved
                summed += float(np.abs(parts).sum() + np.abs(filled[axis]).max() + variation[-1] + bend[-1])
            bulge, time = earth * longest**2 / 12, np.r_[0.0, np.cumsum(h)]
            # The rounding of a running sum of n terms is at most n units of the sum of absolute values.
            slack = SUM * log.t.size * (summed + bend[-1] * float(bulge.max()) + time[-1] * float(rate.max()))
            ways[name] = _Way(total, variation, ends, bend, bulge, rate, time, slack)
        return ways

    def _largest(self, name: str, half: int) -> Array:
        """The largest |channel| within ``half`` rows, at rows and between them."""
        x, limits = self.channels[name], self.sensors.limits
        limit = limits.yaw_acceleration if name == "r" else limits.acceleration
        known = np.where(self.there, x.magnitude, 0.0)
        between = 0.5 * (limit or 0.0) * float(self.steps.upper[self.there[1:] & self.there[:-1]].max(initial=0.0))
        return _largest_near(known, half) + between


def _largest_near(x: Array, half: int) -> Array:
    """The largest value within ``half`` rows of each row."""
    from scipy.ndimage import maximum_filter1d  # noqa: PLC0415 - slow to import, and only rows from a pose need it

    return np.asarray(maximum_filter1d(x, 2 * half + 1), dtype=np.float64)


@dataclass(frozen=True)
class _Way:
    """The integral [m] of a velocity between two rows, by sums from the first row, and bounds of its error."""

    total: Array
    variation: Array
    ends: Array
    bend: Array
    bulge: Array
    rate: Array
    time: Array
    slack: float

    def __call__(self, i: NDArray[np.int64], j: NDArray[np.int64]) -> IntervalArray:
        middle = (i + j) // 2
        error = (
            self.variation[j]
            - self.variation[i]
            + self.ends[i]
            + self.ends[j]
            + (self.bend[j] - self.bend[i]) * self.bulge[middle]
            + (self.time[j] - self.time[i]) * self.rate[middle]
        )
        reach = error * (1 + ROUNDING) + self.slack
        way = self.total[j] - self.total[i]
        return IntervalArray(way - reach, way + reach)


def pose_means(
    log: Log, sensors: Sensors, channels: dict[str, IntervalArray], steps: IntervalArray
) -> PoseMeans | None:
    """The pose and the limits for the weak form; None if the velocities do not come from the pose, or not as bounds."""
    limits = sensors.limits
    stated = (sensors.position, sensors.heading, limits.acceleration, limits.yaw_acceleration)
    if log.derived.get("u") != POSE or "r" not in channels or sensors.from_pose != "enclosed" or None in stated:
        return None
    there = np.all([np.isfinite(log.columns[c]) for c in POSE], axis=0)
    there &= np.all([np.isfinite(channels[n].lower) for n in ("u", "v", "r")], axis=0)
    known = ~np.isnan(log.columns["psi"])
    psi = log.columns["psi"].copy()
    psi[known] = unwrapped(psi[known])[0]
    return PoseMeans(log, sensors, channels, steps, _bridged(log.t, psi), there)


def _bridged(t: Array, x: Array) -> Array:
    known = ~np.isnan(x)
    return np.asarray(np.interp(t, t[known], x[known]), dtype=np.float64)
