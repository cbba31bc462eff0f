"""Tubes over windows of a log: each starts from the measured state, and holds every later one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.linear.trajectories import Followed
from ivsid.tubes.equations import Equations, Piece
from ivsid.tubes.inputs import Course

Array: TypeAlias = NDArray[np.float64]
# Steps after which a tube that may end early is asked how far it turns.
# Source: resource: a tenth of a second
TRIED: Final = 1200
# Largest turn in a step [rad] with which it goes on.
# Source: resource: beyond some tenths steps are cut into parts, up to 64, and so wide a tube bounds no reading
TURN: Final = 0.1

# Time [s] after which the yaw rates of a tube are cut into cells anew.
# Source: own choice: 1 s is as narrow for SWAN and 0.25 s wider, because each cut takes the hull of neighbours (docs/measurements.md, "Tubes")
CUT: Final = 0.5
# Width of the narrowest cell of the yaw rate [rad/s].
# Source: own choice: half of what readings and errors of the moment leave of the yaw rate of SWAN after half a second
NARROWEST: Final = 0.02


@dataclass(frozen=True)
class Window:
    """One run from a measured state: rows from ``first`` to ``last``, both included; proved up to ``proved``."""

    first: int
    last: int
    proved: int


@dataclass(frozen=True)
class Horizon:
    """Tubes that restart from the measured state after a length of time.

    Attributes:
        length: of the windows [s]; None without restarts (dead reckoning).
        windows: in order.
        bounds: of u, v, r, psi, x, y at the rows, shape (n, 6); entire where there is no tube. A row that ends one window and starts the
            next holds the end. Heading and position count from the start of the window.
    """

    length: float | None
    windows: tuple[Window, ...]
    bounds: IntervalArray


def windows_of(course: Course, length: float | None, given: IntervalArray | None) -> list[tuple[int, int]]:
    """First and last rows of windows that follow each other, over whole steps, each from a complete measured state."""
    n = course.log.t.size
    usable = course.whole if given is None else np.asarray(course.whole & _finite(given).all(axis=1))
    readings = course.measured if given is None else course.measured[:, :1]
    start = np.asarray(_finite(readings).all(axis=1))
    most = n if length is None else max(1, round(length / course.log.period))
    found, first = [], 0
    while first < n - 1:
        if not (usable[first] and start[first]):
            first += 1
            continue
        broken = np.flatnonzero(~usable[first : first + most])
        last = first + (int(broken[0]) if broken.size else min(most, n - 1 - first))
        found.append((first, last))
        first = last
    return found


def spaced(windows: list[tuple[int, int]], steps: int | None) -> list[tuple[int, int]]:
    """Evenly spaced ones of some windows, of about ``steps`` steps in all; all where they have no more."""
    total = sum(last - first for first, last in windows)
    return windows if steps is None or total <= steps else windows[:: -(-total // steps)]


def _finite(x: IntervalArray) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(x.lower) & np.isfinite(x.upper))


def start_of(course: Course, row: int, given: IntervalArray | None) -> IntervalArray:
    """The box of starts at a row: measured velocities, and a heading and position of 0, from which they are counted."""
    x = course.measured[row]
    lower, upper = (np.where(np.isfinite(e), e, 0.0) for e in (x.lower, x.upper))
    if given is not None:
        # Components that are given start in their range over the first step.
        lower[1:], upper[1:] = (
            given.lower[min(row, given.shape[0] - 1), 1:3],
            given.upper[min(row, given.shape[0] - 1), 1:3],
        )
    return IntervalArray(np.r_[lower, 0.0, 0.0, 0.0], np.r_[upper, 0.0, 0.0, 0.0])


def follow(
    equations: Equations,
    course: Course,
    length: float | None,
    given: IntervalArray | None = None,
    *,
    parts: int = 1,
    steps: int | None = None,
    early: bool = False,
) -> Horizon:
    """The tubes of the windows of one length.

    Args:
        equations: of the fit.
        course: of the log.
        length: of the windows [s]; None for one without restarts.
        given: v, r and their rates over each step where surge alone is followed, shape (n - 1, 6).
        parts: equal parts into which each step is cut.
        steps: of all windows together, at most; evenly spaced windows are followed where there are more. None follows all.
        early: whether a tube whose yaw rate has grown beyond ``TURN`` a step after ``TRIED`` steps ends there.
    """
    n = course.log.t.size
    lower, upper = np.full((n, 6), -np.inf), np.full((n, 6), np.inf)
    windows: list[Window] = []
    for first, last in spaced(windows_of(course, length, given), steps):
        bounds = window(equations, course, first, last, given, parts=parts, early=early)
        proved = first + bounds.shape[0] - 1
        # The end of the window before says more about a row than the reading from which the next one starts.
        begin = 0 if not windows or windows[-1].proved < first else 1
        lower[first + begin : proved + 1], upper[first + begin : proved + 1] = (
            bounds.lower[begin:],
            bounds.upper[begin:],
        )
        windows.append(Window(first, last, proved))
    return Horizon(length, tuple(windows), IntervalArray(lower, upper))


def of_piece(
    equations: Equations,
    piece: Piece,
    course: Course,
    first: int,
    last: int,
    given: IntervalArray | None,
    *,
    parts: int,
    certify: bool = False,
) -> Followed:
    """The tube of one piece of the parameters from row ``first`` on, with its parts where they are asked for."""
    steps = slice(first, last)
    cutting = (equations.yaw_cells, max(1, round(CUT / course.log.period)), NARROWEST)
    return piece.model.follow(
        start_of(course, first, given),
        course.h[steps],
        course.force[steps],
        None if given is None else given[steps],
        parts=parts,
        cutting=cutting if equations.yaw_cells > 1 else None,
        certify=certify,
    )


def window(
    equations: Equations,
    course: Course,
    first: int,
    last: int,
    given: IntervalArray | None,
    *,
    parts: int = 1,
    early: bool = False,
) -> IntervalArray:
    """Bounds at the rows from ``first`` as far as they are proved, at most to ``last``, shape (m, 6).

    Each parameter lies in a piece, so that the hull of the pieces' tubes holds every trajectory.
    """
    if early and given is None and last - first > TRIED:
        begun = window(equations, course, first, first + TRIED, given, parts=parts)
        if float(begun[-1, 2].magnitude) * course.log.period > TURN:
            return begun
    found = [of_piece(equations, p, course, first, last, given, parts=parts).bounds for p in equations.pieces]
    count = min(b.shape[0] for b in found)
    hull: IntervalArray = reduce(lambda a, b: a.hull(b), (b[:count] for b in found))
    return hull
