"""All rows that a log supports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final, TypeAlias

import numpy as np

from ivsid.effects import CHANNELS, Term
from ivsid.errors import IvsidError, meant
from ivsid.log import Log
from ivsid.memory.pieces import PIECE, over_pieces, pieces
from ivsid.rows.equations import Equations
from ivsid.rows.integral import integral
from ivsid.rows.pointwise import explain_absence, pointwise
from ivsid.rows.record import RegressionRows, Space, joined
from ivsid.rows.weak import weak
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle

# Length of the window of integral rows, where none is given [s].
# Source: measured: make constants
WINDOW: Final = 1.0
KINDS: Final = ("auto", "pointwise", "integral", "both", "weak")

Maker: TypeAlias = Callable[[Equations], RegressionRows | None]


def build_rows(
    bounded: BoundedLog,
    vehicle: Vehicle,
    terms: Sequence[Term],
    *,
    added_mass: bool = False,
    kind: str = "auto",
    window: float | Sequence[float] = WINDOW,
    piece: int = PIECE,
) -> RegressionRows:
    """All rows that a log supports.

    Args:
        bounded: the log in intervals.
        vehicle: thrusters, rigid body and limits.
        terms: the model.
        added_mass: the parameters leave out the rigid-body mass, which is then known (second form of eq. 6).
        kind: ``pointwise``, ``integral``, ``weak`` (weighted by a hat over two windows, for velocities that come from a pose),
            ``both`` (every kind), or ``auto`` (pointwise where accelerations are measured, else integral).
        window: length of integral rows [s], or several. Each row holds by itself, so rows of several windows narrow the set.
        piece: samples that are worked on at once; rows do not depend on it.

    Raises:
        IvsidError: the name of the channel, the section of sensors or the limit that is missing.
    """
    if kind not in KINDS:
        raise IvsidError(f"rows '{kind}' are unknown; {meant(kind, KINDS)}use {', '.join(KINDS)}")
    counts = _counts(bounded.log, (window,) if isinstance(window, float | int) else tuple(window), kind)
    equations = Equations(bounded, vehicle, tuple(terms), vehicle.hull.mass if added_mass else 0.0)
    plan = _plan(equations, counts, kind)
    further = 0 if kind in ("pointwise", "weak") else max(counts)
    # Rows from the pose look at the whole log at once, the others at pieces of it.
    own = [entry for entry in plan if entry[1] != "weak"]
    space = Space(tuple(terms), len(own), equations.t.size)

    def work(rows: slice) -> None:
        part = equations.part(rows.start, rows.stop, further)
        for k, (_, _, make) in enumerate(own):
            made = make(part)
            if made is not None:
                space.put(k, rows.start, made)

    if own:
        over_pieces(pieces(equations.t.size, max(piece, 4 * further)), work)
    for k, (channel, how, _) in enumerate(own):
        if how == "pointwise" and not space.rows(k):
            explain_absence(equations, channel)
    if len(own) == len(plan):
        parts: list[RegressionRows] = [space.done()]
    else:
        made = iter(range(len(own)))
        found = [make(equations) if how == "weak" else space.done(next(made)) for _, how, make in plan]
        parts = [p for p in found if p is not None]
    if kind == "weak" and bounded.stream:
        raise IvsidError(
            "rows 'weak' follow the pose over ground, and [model.fitted] states a current.steady; use rows 'auto', or leave the current out"
        )
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
    return joined(parts, equations.assumes)


def _plan(equations: Equations, counts: Sequence[int], kind: str) -> list[tuple[str, str, Maker]]:
    """Channel, kind and maker of each group of rows, in the order of the result."""
    plan: list[tuple[str, str, Maker]] = []
    for index, channel in enumerate(CHANNELS):
        if not equations.acts(channel):
            continue
        # Accelerations that follow from velocities give rows beside those over windows.
        if kind not in ("integral", "weak") and equations.known(channel):
            plan.append((channel, "pointwise", partial(pointwise, index=index, channel=channel)))
        if kind in ("integral", "both") or (kind == "auto" and not equations.measured(channel)):
            plan += [
                (channel, "integral", partial(integral, index=index, channel=channel, count=count)) for count in counts
            ]
        # The pose moves over ground, the equations through the water.
        if kind in ("weak", "both") and not equations.bounded.stream:
            plan += [(channel, "weak", partial(weak, index=index, channel=channel, half=count)) for count in counts]
    return plan


def window_count(window: float | Sequence[float]) -> int:
    """The number of lengths of windows, each of which adds one error a sample to the union bound where an ambient force acts."""
    return 1 if isinstance(window, float | int) else max(len(window), 1)


def _counts(log: Log, windows: Sequence[float], kind: str) -> list[int]:
    """Steps of each window; windows with the same number of steps count once."""
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
