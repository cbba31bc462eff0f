"""Components of the motion that are taken as given where surge alone is followed."""

from __future__ import annotations

import numpy as np

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.rows.forces import above
from ivsid.tubes.inputs import Course
from ivsid.vehicle import Vehicle


def straight(course: Course) -> IntervalArray:
    """A run without drift and turn: v = r = 0 and their rates, over each step, shape (n - 1, 6)."""
    return IntervalArray(np.zeros((course.h.size, 6)))


def measured(course: Course, vehicle: Vehicle) -> IntervalArray:
    """Drift and turn, v and r, between their readings under the stated limits, over each step, shape (n - 1, 6): u, v, r, u', v', r'; u is not used.

    A quantity that moves at most L a second stays within L h / 2 of the hull of its values at both ends of a step.

    Raises:
        IvsidError: a limit that the vehicle file does not state.
    """
    limits = vehicle.sensors.limits
    if limits.acceleration is None or limits.yaw_acceleration is None:
        raise IvsidError(
            "a tube of surge alone takes v and r from the log, and bounds them between samples by [sensors.limits] acceleration and "
            "yaw_acceleration; state both in the vehicle file, or follow all channels"
        )
    columns, rates = [IntervalArray(np.zeros(course.h.size))], [IntervalArray(np.zeros(course.h.size))]
    for k, limit in ((1, limits.acceleration), (2, limits.yaw_acceleration)):
        most = above(limit)
        x = course.measured[:, k]
        columns.append(x[:-1].hull(x[1:]) + IntervalArray(-most, most) * (course.h * 0.5))
        rates.append(IntervalArray(np.full(course.h.size, -most), np.full(course.h.size, most)))
    return IntervalArray.stack([*columns, *rates], axis=1)
