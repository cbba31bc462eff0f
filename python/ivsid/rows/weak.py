"""Weak rows: the equations weighted by a hat over two windows, with means of velocities from the pose itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.rows.equations import ColumnsOf, Equations, complete, unit
from ivsid.rows.integral import Quadrature
from ivsid.rows.record import RegressionRows
from ivsid.sensors.weak_form import ROUNDING, pose_means


def weak(equations: Equations, index: int, channel: str, half: int) -> RegressionRows | None:
    """A channel's equation weighted by a hat.

    Args:
        equations: of the whole log.
        index: of the channel.
        channel: its name.
        half: steps of the hat on either side.

    Returns:
        The rows; None where the velocities do not come from the pose, an ambient force acts, or a lagging thrust depends on the flow,
        a rudder or an azimuth angle.
    """
    steps = equations.clock[1:] - equations.clock[:-1]
    means = pose_means(equations.bounded.log, equations.vehicle.sensors, dict(equations.bounded.channels), steps)
    # These change a lagging force within a step, so that its values at both rows do not enclose it between them.
    mixed = any(
        t.time_constant and (t.advance_loss or t.rudder is not None or t.steering == "azimuth")
        for t in equations.vehicle.thrusters
    )
    if means is None or mixed or equations.bounded.ambient != (0.0, 0.0):
        return None
    there = equations.forces.present & means.there
    starts = complete(equations.whole_steps(there, equations.bounded.log.period, heading=True), 2 * half)
    hat = _Hat(equations, starts, half, means.rising(starts, half))
    columns = [hat.mean(term.columns, channel) for term in equations.terms]
    values, over = equations.forces.values[index], equations.forces.steps[index]
    right = hat.weighted(over, over.hull(values[:-1].hull(values[1:])))
    right = right - equations.known_force(lambda columns: hat.mean(columns, channel))
    durations = equations.t[starts + 2 * half] - equations.t[starts]
    return equations.rows(
        "weak",
        index,
        IntervalArray.stack(columns, axis=1),
        right,
        equations.t[starts],
        durations,
        hat.quadrature.assumes,
    )


class _Hat:
    """Means weighted by a hat over two halves of ``half`` steps each; ``rising`` holds the means of velocities of both halves."""

    def __init__(
        self, equations: Equations, starts: NDArray[np.int64], half: int, rising: dict[str, IntervalArray]
    ) -> None:
        clock = equations.clock
        self.starts, self.half, self.rising = starts, half, rising
        middle, end = starts + half, starts + 2 * half
        self.first, self.second = clock[middle] - clock[starts], clock[end] - clock[middle]
        self.area = (clock[end] - clock[starts]) * 0.5
        self.quadrature = Quadrature(equations, np.diff(equations.t), starts, 2 * half, clock[end] - clock[starts])
        self.clock = clock

    def weighted(self, per_step: IntervalArray, within: IntervalArray) -> IntervalArray:
        """The weighted mean of a quantity given by its mean and its range over each step.

        Within a step the weight differs from its mean by a line. The line adds at most a quarter of its rise times the radius of the
        range.
        """
        steps = self.quadrature.steps
        radius = within.radius * (1 + ROUNDING)
        total = IntervalArray(np.zeros(self.starts.shape))
        for offset in range(2 * self.half):
            k = self.starts + offset
            if offset < self.half:
                span, out = self.first, self.clock[self.starts]
                twice = (self.clock[k] - out) + (self.clock[k + 1] - out)
            else:
                span, out = self.second, self.clock[self.starts + 2 * self.half]
                twice = (out - self.clock[k]) + (out - self.clock[k + 1])
            caught = IntervalArray(-radius[k], radius[k]) * (steps[k] / span) * 0.25
            total = total + (per_step[k] * (twice / span) * 0.5 + caught) * steps[k]
        mean: IntervalArray = total / self.area
        return mean

    def mean(self, columns: ColumnsOf, channel: str) -> IntervalArray:
        """The weighted mean of a column: its accelerations through the means of both halves, the rest by a bounded quadrature."""
        total = IntervalArray(np.zeros(self.starts.shape))
        for name, derivative in (("u", "udot"), ("v", "vdot"), ("r", "rdot")):
            coefficient = columns(unit(derivative)).get(channel, 0.0) - columns(unit("")).get(channel, 0.0)
            if coefficient:
                total = total + self.rising[name] * coefficient / self.area
        if self.quadrature.has_velocity_part(columns, channel):
            total = total + self.weighted(*self.quadrature.step_parts(columns, channel))
        return total
