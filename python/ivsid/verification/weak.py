"""Rows weighted by a hat over two windows, with means of velocities straight from the pose, in fractions.

The hat rises over the first window and falls over the second. The weighted mean of an acceleration is then (mean of the velocity over
the second window) - (mean over the first), divided by half the length of both. Along the vehicle u = cos(psi) x' + sin(psi) y'. With
c, s linear between the cosines and sines of the measured headings, the integral of c x' over a step is exactly

    (c_k + c_k+1) / 2 (x_k+1 - x_k) - (c_k+1 - c_k) (mean of x over the step - mean of its ends),

and the last bracket is at most A h^2 / 12 for a bound A of the acceleration in earth axes. Summed over the steps, each position has one
weight, and its error counts once. The difference of c, s from the true heading's cosine and sine turns the velocity: an angle d changes
u by at most |d v| + d^2 |u| / 2, and the chord of an arc D by at most D^2 / 8 of the speed. Each step is bounded by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from ivsid.verification.columns import Row, moves, share
from ivsid.verification.errors import UnprovedError
from ivsid.verification.physics import CHANNELS, Column
from ivsid.verification.rational import Range, cosine, pi, root, sided, sine
from ivsid.verification.thrusters import GAP

if TYPE_CHECKING:
    from ivsid.verification.rows import Rows

POSE: Final = ("x", "y", "psi")


class Weak:
    """Weak rows of a log, from the readings and thrusters of its other rows."""

    def __init__(self, rows: Rows) -> None:
        self.rows, self.readings, self.log = rows, rows.readings, rows.log
        self._ways: dict[int, tuple[Range, Range]] = {}
        self._places: dict[int, tuple[Range, Range]] = {}
        self._unit: dict[int, tuple[Range, Range]] = {}
        self._within: dict[tuple[str, str, int], Range] = {}
        self._forces: dict[int, tuple[tuple[Range, Range, Range], tuple[Range, Range, Range]]] = {}

    def row(self, channel: str, first: int, last: int) -> Row:
        """The channel's equation weighted by a hat from one row of the log to another, with its top half way between.

        Raises:
            UnprovedError: no such row can be made, and why.
        """
        self._possible(first, last)
        hat = _Hat(self, first, last)
        index = CHANNELS.index(channel)
        forces = [self._force(k, index) for k in range(first, last)]
        right = hat.mean([f[0] for f in forces], [f[1] for f in forces])
        matrix = {id_: self._column(id_, m.columns, channel, hat) for id_, m in self.rows.terms.items()}
        return Row(matrix, right - self._column("", self.rows.known, channel, hat))

    def _possible(self, first: int, last: int) -> None:
        start, pose = self.log.t[first], self.readings.pose
        if pose is None or not pose.moving:
            raise UnprovedError("rows straight from the pose need velocities that follow from it")
        if any(reach.high for reach in self.readings.ambient):
            raise UnprovedError("rows straight from the pose leave no room for an ambient force")
        if any(
            t.time_constant and (t.advance_loss or t.rudder is not None or t.steering == "azimuth")
            for t in self.rows.vehicle.thrusters
        ):
            raise UnprovedError("behind a lag a force that turns or depends on the motion is not bounded by its rows")
        if (last - first) % 2:
            raise UnprovedError(f"the window from t = {start!r} s has no middle")
        if not (np.diff(self.log.t[first : last + 1]) <= GAP * self.log.period).all():
            raise UnprovedError(f"the window from t = {start!r} s has a gap")
        if pose.piece[first] != pose.piece[last]:
            raise UnprovedError(f"the way round within the window from t = {start!r} s is not certain")
        for i in range(first, last + 1):
            if not self.rows.thrusters.present(i) or any(self.readings.raw(c, i) is None for c in POSE):
                raise UnprovedError(f"a demand, a force or the pose is missing at t = {self.log.t[i]!r} s")

    def _force(self, k: int, index: int) -> tuple[Range, Range]:
        """The mean of a force over a step, and its range within the step."""
        if k not in self._forces:
            thrusters = self.rows.thrusters
            mean = thrusters.over_step(k, self.rows.swept(k))
            ends = [thrusters.at_row(i, self.rows.motion(i)) for i in (k, k + 1)]
            hulls = [m.hull(a).hull(b) for m, a, b in zip(mean, *ends, strict=True)]
            self._forces[k] = mean, (hulls[0], hulls[1], hulls[2])
        mean, within = self._forces[k]
        return mean[index], within[index]

    def _column(self, id_: str, columns: Column, channel: str, hat: _Hat) -> Range:
        total = Range(0)
        for name, unit in (("u", "udot"), ("v", "vdot"), ("r", "rdot")):
            factor = share(columns, unit, channel)
            if factor.magnitude:
                total = total + hat.rising(name) * factor / hat.area
        if moves(columns, channel):
            steps = range(hat.first, hat.last)
            means = [self.rows.step_mean(id_, columns, channel, k) for k in steps]
            total = total + hat.mean(means, [self._over(id_, columns, channel, k) for k in steps])
        return total

    def _over(self, id_: str, columns: Column, channel: str, k: int) -> Range:
        key = (id_, channel, k)
        if key not in self._within:
            self._within[key] = self.rows.step_range(columns, channel, k)
        return self._within[key]

    def heading(self, i: int) -> Range:
        """The heading of a row [rad], unwrapped."""
        assert self.readings.pose is not None
        return self.readings.pose.turned(i)

    def _measured(self, i: int) -> Range:
        """The measured heading of a row [rad], unwrapped, without its error."""
        assert self.readings.pose is not None
        return Range(Fraction(float(self.log.columns["psi"][i]))) + pi() * (2 * int(self.readings.pose.turns[i]))

    def way(self, name: str, first: int, last: int) -> Range:
        """The integral of u or v from one row to another [m]: positions with one weight each, and the error of each step."""
        total = Range(0)
        for i in range(first, last + 1):
            # A position's weight: half the difference of the neighbours' cosines and sines, at an end that of the row and its neighbour.
            (c0, s0), (c1, s1) = self._direction(max(i - 1, first)), self._direction(min(i + 1, last))
            c, s = ((c0 - c1), (s0 - s1)) if first < i < last else self._ended(i, first)
            x, y = self._place(i)
            total = total + (x * c + y * s if name == "u" else y * c - x * s)
        open_ = sum((self._left(k)[name == "v"] for k in range(first, last)), Range(0))
        return total / 2 + sided(open_)

    def _ended(self, i: int, first: int) -> tuple[Range, Range]:
        (c0, s0), (c1, s1) = self._direction(i), self._direction(i + 1 if i == first else i - 1)
        sign = -1 if i == first else 1
        return (c0 + c1) * sign, (s0 + s1) * sign

    def _place(self, i: int) -> tuple[Range, Range]:
        """The position at a row [m]."""
        if i not in self._places:
            x, y = (self.readings.raw(n, i) for n in ("x", "y"))
            assert x is not None and y is not None and self.readings.pose is not None
            error = sided(self.readings.pose.place)
            self._places[i] = x + error, y + error
        return self._places[i]

    def _direction(self, i: int) -> tuple[Range, Range]:
        """Cosine and sine of the measured heading."""
        if i not in self._unit:
            psi = Range(Fraction(float(self.log.columns["psi"][i])))
            self._unit[i] = cosine(psi), sine(psi)
        return self._unit[i]

    def _left(self, k: int) -> tuple[Range, Range]:
        """Bounds of the errors of the integrals of u and v over a step [m]."""
        if k not in self._ways:
            pose, h = self.readings.pose, self.rows.step_length(k)
            assert pose is not None
            u, v, r = (x.largest() for x in self.rows.swept(k)())
            speed = root(u.square() + v.square())
            here, there = self._measured(k), self._measured(k + 1)
            off = (self.heading(k) - here).largest().hull((self.heading(k + 1) - there).largest())
            angle = off.largest() + pose.yaw * h.square() / 8
            chord = (there - here).square() / 8 * speed
            (c0, s0), (c1, s1) = self._direction(k), self._direction(k + 1)
            bulge = (root(Range(2)) * pose.limit + r * speed) * h.square() / 12
            bent = (abs(c1 - c0) + abs(s1 - s0)) * bulge
            turned = (
                (angle * across + angle.square() * along / 2 + chord) * h + bent for along, across in ((u, v), (v, u))
            )
            self._ways[k] = next(turned), next(turned)
        return self._ways[k]


class _Hat:
    """A hat over two windows of equal numbers of steps."""

    def __init__(self, weak: Weak, first: int, last: int) -> None:
        self.weak, self.first, self.last, self.middle = weak, first, last, (first + last) // 2
        start, top, end = (weak.readings.time(i) for i in (first, self.middle, last))
        self.up, self.down, self.area = top - start, end - top, (end - start) / 2
        self._rising: dict[str, Range] = {}

    def rising(self, name: str) -> Range:
        """Mean of u, v or r over the second window minus that over the first."""
        if name not in self._rising:
            if name == "r":
                start, top, end = (self.weak.heading(i) for i in (self.first, self.middle, self.last))
                over = top - start, end - top
            else:
                over = self.weak.way(name, self.first, self.middle), self.weak.way(name, self.middle, self.last)
            self._rising[name] = over[1] / self.down - over[0] / self.up
        return self._rising[name]

    def mean(self, per_step: Sequence[Range], within: Sequence[Range]) -> Range:
        """The weighted mean of a quantity from its mean over each step and its range within.

        Within a step the weight differs from its own mean by at most half its rise, by a quarter of it in the mean; this difference
        multiplies the distance of the quantity from the middle of its range.
        """
        total = Range(0)
        for (weight, quarter), mean, all_ in zip(self._weights, per_step, within, strict=True):
            radius = Range.raw(0, -(-(all_.high - all_.low) // 2))
            total = total + mean * weight + sided(radius * quarter)
        return total

    @cached_property
    def _weights(self) -> list[tuple[Range, Range]]:
        """For each step the weights of its mean and of its radius, as shares of the hat."""
        found, time = [], self.weak.readings.time
        for k in range(self.first, self.last):
            h, span = self.weak.rows.step_length(k), self.up if k < self.middle else self.down
            out = time(self.first if k < self.middle else self.last)
            height = abs(time(k) - out + time(k + 1) - out) / (span * 2)
            share = h / self.area
            found.append((height * share, h / (span * 4) * share))
        return found
