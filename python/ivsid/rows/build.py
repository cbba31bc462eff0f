"""All rows that a log supports."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ivsid.effects import CHANNELS, Term
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.rows.equations import Equations
from ivsid.rows.integral import integral
from ivsid.rows.pointwise import pointwise
from ivsid.rows.record import RegressionRows
from ivsid.rows.weak import weak
from ivsid.sensors import BoundedLog
from ivsid.vehicle import Vehicle

WINDOW: Final = 1.0
KINDS: Final = ("auto", "pointwise", "integral", "both", "weak")


def build_rows(
    bounded: BoundedLog,
    vehicle: Vehicle,
    terms: Sequence[Term],
    *,
    added_mass: bool = False,
    kind: str = "auto",
    window: float | Sequence[float] = WINDOW,
) -> RegressionRows:
    """All rows that the log supports.

    Args:
        bounded: the log in intervals.
        vehicle: thrusters, rigid body and limits.
        terms: the model.
        added_mass: the parameters leave out the rigid-body mass, which is then known (second form of eq. 6).
        kind: ``pointwise``, ``integral``, ``weak`` (hat-weighted over two windows, for velocities that come from a pose), ``both``
            (every kind that there is), or ``auto`` (pointwise where accelerations are measured, else integral).
        window: length of integral rows [s], or several: each row holds by itself, so what is consistent with all is an intersection.

    Raises:
        IvsidError: naming the channel, sensor section or limit that is missing.
    """
    if kind not in KINDS:
        raise IvsidError(f"rows '{kind}' are unknown; use {', '.join(KINDS)}")
    counts = _counts(bounded.log, (window,) if isinstance(window, float | int) else tuple(window), kind)
    equations = Equations(bounded, vehicle, tuple(terms), vehicle.hull.mass if added_mass else 0.0)
    parts = []
    for index, channel in enumerate(CHANNELS):
        if not equations.acts(channel):
            continue
        measured = equations.measured(channel)
        # An acceleration that only follows from velocities adds its rows to those over windows.
        if kind not in ("integral", "weak") and equations.known(channel):
            parts.append(pointwise(equations, index, channel))
        if kind in ("integral", "both") or (kind == "auto" and not measured):
            parts += [integral(equations, index, channel, count) for count in counts]
        if kind in ("weak", "both"):
            parts += [w for count in counts if (w := weak(equations, index, channel, count)) is not None]
    if kind == "weak" and not parts:
        raise IvsidError(
            f"rows 'weak' need velocities that are enclosed from the pose, and {bounded.log.name} measures them or its vehicle file has "
            "[ambient]; use rows 'auto'"
        )
    parts = [p for p in parts if p.time.size]
    if not parts:
        raise IvsidError(
            f"{bounded.log.name} has no row with every channel that the model needs; look at the missing samples and the gaps"
        )
    return RegressionRows(
        tuple(terms),
        IntervalArray.concatenate([p.matrix for p in parts]),
        IntervalArray.concatenate([p.right for p in parts]),
        np.concatenate([p.channel for p in parts]),
        np.concatenate([p.time for p in parts]),
        np.concatenate([p.duration for p in parts]),
        np.concatenate([p.kind for p in parts]),
        tuple(dict.fromkeys((*equations.forces.assumes, *(s for p in parts for s in p.assumes)))),
    )


def _counts(log: Log, windows: Sequence[float], kind: str) -> list[int]:
    """Steps of each window; windows of as many steps count once."""
    if not windows:
        raise IvsidError("no window is given; give a length, such as 1.0, or several")
    length = log.t[-1] - log.t[0]
    for window in windows:
        if not 0 < window < np.inf:
            raise IvsidError(f"a window of {window} s is not usable; give a positive length, such as 1.0")
        if kind != "pointwise" and window > length:
            raise IvsidError(
                f"a window of {window:g} s is longer than {log.name}, {length:.4g} s; give a shorter --window"
            )
    return list(dict.fromkeys(max(1, round(window / log.period)) for window in windows))
