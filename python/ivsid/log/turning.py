"""The angle of an azimuth thruster or a rudder, at the rows of a log and over the steps between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.log.angles import unwrapped
from ivsid.log.record import Log


@dataclass(frozen=True)
class Turned:
    """The angle of a thruster or a rudder at the rows and over the steps between them.

    Attributes:
        at_rows: angles [rad], shape (n,).
        over_steps: range of the angle over each step [rad], shape (n - 1,); beyond pi where the angle crosses that end.
        present: where the log has the angle, shape (n,).
        whole: steps over which the angle is known, shape (n - 1,).
        assumes: a sentence that the ranges rely on.
    """

    at_rows: IntervalArray
    over_steps: IntervalArray
    present: NDArray[np.bool_]
    whole: NDArray[np.bool_]
    assumes: str


def angle_of(log: Log, column: str, why: str, *, held: bool) -> Turned:
    """An angle of the log, from every sample at its rows and between them.

    Args:
        log: with the column.
        column: ``azimuth_NAME`` or ``rudder_NAME``.
        why: purpose of the column, for messages.
        held: the angle holds from row to row; else it turns the shorter way from one to the next.

    Raises:
        IvsidError: the log lacks the column.
    """
    angle = log.column(column, why)
    present = ~np.isnan(angle)
    filled, error = np.where(present, angle, 0.0), np.where(present, log.error(column), 0.0)
    rows = IntervalArray.around(filled, error)
    between_rows = log.over.get(column)
    if between_rows is not None:
        whole = np.isfinite(between_rows.lower) & np.isfinite(between_rows.upper)
        steps = IntervalArray(np.where(whole, between_rows.lower, 0.0), np.where(whole, between_rows.upper, 0.0))
        return Turned(rows, steps, present, whole, between_rows.assumes)
    whole = present[:-1] & present[1:]
    if held:
        return Turned(rows, rows[:-1], present, whole, f"{column} holds from each row to the next")
    followed, lost = unwrapped(filled)
    ends = IntervalArray.around(followed, error + lost)
    steps = ends[:-1].hull(ends[1:])
    # Half a turn, where it is not excluded, may go either way.
    either = steps.upper - steps.lower > np.pi * (1 - 1e-12)
    steps = IntervalArray(np.where(either, -4.0, steps.lower), np.where(either, 4.0, steps.upper))
    return Turned(
        rows, steps, present, whole, f"{column} turns the shorter way from each row to the next, and no further"
    )
