"""Rows at samples: the equations as they stand, for logs with accelerations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Place, State
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.rows.equations import Equations
from ivsid.rows.forces import above
from ivsid.rows.record import RegressionRows


def pointwise(equations: Equations, index: int, channel: str) -> RegressionRows:
    """The channel's equation at every complete sample."""
    channels = equations.bounded.channels
    u, v, r = (equations.channel(n) for n in ("u", "v", "r"))
    assumes: list[str] = []
    entire = IntervalArray(np.full(equations.t.shape, -np.inf), np.full(equations.t.shape, np.inf))
    ax, ay = channels.get("ax"), channels.get("ay")
    udot = channels["udot"] if "udot" in channels else ax + v * r if ax is not None else entire
    vdot = channels["vdot"] if "vdot" in channels else ay - u * r if ay is not None else entire
    rdot = channels.get("rdot", entire)
    limits = equations.vehicle.sensors.limits
    if "rdot" not in channels and limits.yaw_acceleration is not None and equations.needs_rdot(channel):
        most = above(limits.yaw_acceleration)
        rdot = IntervalArray(np.full(equations.t.shape, -most), np.full(equations.t.shape, most))
        assumes.append(f"|rdot| never exceeds {limits.yaw_acceleration!r} rad/s^2")
    place = Place(equations.channel("psi"), entire, entire, equations.clock) if equations.turning else None
    state = State(u, v, r, udot, vdot, rdot, ax, ay, place=place)
    zero = IntervalArray(np.zeros(equations.t.shape))
    columns = [_array(term.columns(state).get(channel), zero) for term in equations.terms]
    right = equations.forces.values[index] - equations.known_force(lambda f: _array(f(state).get(channel), zero))
    right = right + equations.ambient(channel)
    matrix = IntervalArray.stack(columns, axis=1)
    usable = equations.forces.present & _finite(matrix) & _finite(right.reshape(-1, 1))
    if not usable.any():
        _explain(equations, channel)
    time = equations.t
    if not usable.all():
        matrix, right, time = matrix[usable], right[usable], time[usable]
    return equations.rows("pointwise", index, matrix, right, time, np.zeros(time.shape), assumes)


def _explain(equations: Equations, channel: str) -> None:
    if equations.needs_rdot(channel) and "rdot" not in equations.bounded.channels:
        raise IvsidError(
            f"the {channel} equation needs the yaw acceleration (the centre of gravity is off the origin, or a term has it): "
            "log rdot with [sensors.yaw_acceleration], or state [sensors.limits] yaw_acceleration"
        )


def _array(column: Any, zero: IntervalArray) -> IntervalArray:
    result: IntervalArray = zero if column is None else column + zero
    return result


def _finite(a: IntervalArray) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(a.lower).all(axis=1) & np.isfinite(a.upper).all(axis=1))
