"""Pointwise rows: the equations at a sample, for logs with accelerations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Place, State
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.rows.equations import ColumnsOf, Equations
from ivsid.rows.forces import above
from ivsid.rows.record import RegressionRows


def pointwise(equations: Equations, index: int, channel: str) -> RegressionRows:
    """A channel's equation at every complete sample that the part owns.

    Args:
        equations: of the log, or of a part of it.
        index: of the channel.
        channel: its name.
    """
    limits = equations.vehicle.sensors.limits
    # The stated limit bounds a yaw acceleration that is not measured, where the equation has one.
    limited = "rdot" not in equations.channels and limits.yaw_acceleration is not None and equations.needs_rdot(channel)
    assumes = [f"|rdot| never exceeds {limits.yaw_acceleration!r} rad/s^2"] if limited else []
    shape = equations.t.shape

    def column(columns: ColumnsOf) -> IntervalArray:
        state = equations.once(("state", limited), lambda: _state(equations, limited=limited))
        made = equations.once((columns, limited), lambda: columns(state))
        return _array(made.get(channel), shape)

    columns = [column(term.columns) for term in equations.terms]
    right = equations.forces.values[index] - equations.known_force(column)
    right = right + equations.ambient(channel)
    matrix = IntervalArray.stack(columns, axis=1)
    usable = equations.forces.present & _finite(columns) & _finite([right])
    usable[equations.owned :] = False
    time = equations.t
    if not usable.all():
        rows = slice(equations.owned) if usable[: equations.owned].all() else usable
        matrix, right, time = matrix[rows], right[rows], time[rows]
    return equations.rows("pointwise", index, matrix, right, time, np.zeros(time.shape), assumes)


def _state(equations: Equations, *, limited: bool) -> State:
    """Velocities and accelerations at the samples; an acceleration that is not known is the whole line."""
    channels = equations.channels
    u, v, r = (channels[n] for n in ("u", "v", "r"))
    shape = equations.t.shape
    entire = IntervalArray(np.full(shape, -np.inf), np.full(shape, np.inf))
    ax, ay = channels.get("ax"), channels.get("ay")
    udot = channels["udot"] if "udot" in channels else ax + v * r if ax is not None else entire
    vdot = channels["vdot"] if "vdot" in channels else ay - u * r if ay is not None else entire
    rdot = channels.get("rdot", entire)
    if limited:
        most = above(equations.vehicle.sensors.limits.yaw_acceleration or 0.0)
        rdot = IntervalArray(np.full(shape, -most), np.full(shape, most))
    place = Place(channels["psi"], entire, entire, equations.clock) if equations.turning else None
    return State(u, v, r, udot, vdot, rdot, ax, ay, place=place)


def explain_absence(equations: Equations, channel: str) -> None:
    """Refuses a channel without rows where the log or the vehicle file can be completed.

    Raises:
        IvsidError: the yaw acceleration is missing.
    """
    if equations.needs_rdot(channel) and "rdot" not in equations.channels:
        raise IvsidError(
            f"the {channel} equation needs the yaw acceleration (the centre of gravity is off the origin, or a term has it): "
            "log rdot with [sensors.yaw_acceleration], or state [sensors.limits] yaw_acceleration"
        )


def _array(column: IntervalArray | float | None, shape: tuple[int, ...]) -> IntervalArray:
    """A column with one entry for each row."""
    if isinstance(column, IntervalArray) and column.shape == shape:
        return column
    zero = IntervalArray(np.zeros(shape))
    return zero if column is None else zero + column


def _finite(columns: Sequence[IntervalArray]) -> NDArray[np.bool_]:
    there = np.ones(columns[0].shape, dtype=bool)
    for column in columns:
        there &= np.isfinite(column.lower) & np.isfinite(column.upper)
    return there
