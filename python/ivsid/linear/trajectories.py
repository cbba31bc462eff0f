"""Thin door to the core's guaranteed simulation: bounds of every trajectory of a set, and trajectories of single members."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid import _core
from ivsid.intervals import IntervalArray

Array: TypeAlias = NDArray[np.float64]
# Name, operands and number of an operation; operands are registers, of which 0, 1 and 2 hold u, v and r.
Operation: TypeAlias = tuple[str, int, int, float]
# Number of the term, register of its part without accelerations or None, and its factors of u', v', r'.
Column: TypeAlias = tuple[int, int | None, tuple[float, float, float]]
# Lower and upper ends, one a term.
Vertex: TypeAlias = tuple[list[float], list[float]]


@dataclass(frozen=True)
class Followed:
    """Bounds of all trajectories at the samples as far as they are proved.

    Attributes:
        bounds: of u, v [m/s], r [rad/s], psi [rad], x, y [m], shape (m, 6).
        steps: number of the step, of the cell of the yaw rate, and of the step's equal parts there, for each part of a step.
        parts: for each part, velocities at its start, accelerations over it and velocities at its end, shape (p, 9).
    """

    bounds: IntervalArray
    steps: list[tuple[int, int, int]]
    parts: IntervalArray


class Model:
    """The equations of motion with a polytope of parameters.

    Args:
        program: operations that compute the columns from u, v, r.
        channels: columns of surge, sway and yaw.
        vertices: of the parameters that act in each channel; each is a box, which holds what rounding leaves open.
        hull: of all parameters.
        free: which of u, v, r follow the equations.

    Raises:
        IvsidError: parts that do not fit each other.
    """

    def __init__(
        self,
        program: Sequence[Operation],
        channels: Sequence[Sequence[Column]],
        vertices: Sequence[Sequence[Vertex]],
        hull: Vertex,
        free: tuple[bool, bool, bool],
    ) -> None:
        self._core = _core.TubeModel(
            list(program), [list(c) for c in channels], [list(v) for v in vertices], hull, free
        )

    def follow(
        self,
        start: IntervalArray,
        h: IntervalArray,
        force: IntervalArray,
        given: IntervalArray | None = None,
        *,
        parts: int = 1,
        cutting: tuple[int, int, float] | None = None,
        certify: bool = False,
    ) -> Followed:
        """Follows a box of starts.

        Args:
            start: of u, v, r, psi, x, y, shape (6,).
            h: lengths of the steps [s], shape (n,).
            force: X, Y [N] and N [N m] at all moments of each step, shape (n, 3).
            given: velocities and accelerations of components that are not free, shape (n, 6).
            parts: equal parts into which each step is cut.
            cutting: cells of the yaw rate where all components are free: their number at most, the steps after which they are cut anew, and the
                width of the narrowest [rad/s]; None follows one box.
            certify: whether the parts are kept.

        Raises:
            IvsidError: shapes that do not fit each other, or a step that is not positive.
        """
        found = self._core.follow(
            (start.lower.tolist(), start.upper.tolist()),
            _both(h),
            _both(force),
            None if given is None else _both(given),
            parts,
            cutting,
            certify,
        )
        return Followed(
            IntervalArray(found["lower"], found["upper"]),
            found["steps"],
            IntervalArray(found["parts_lower"], found["parts_upper"]),
        )

    def members(
        self,
        theta: Sequence[float],
        start: Sequence[tuple[float, float]],
        h: Array,
        centre: Array,
        errors: Sequence[Array],
        given: Array | None,
        signs: tuple[Sequence[float], Sequence[float]],
        switched: Sequence[tuple[int, Sequence[float]]],
        towards: Sequence[tuple[int, Sequence[float]]],
    ) -> list[Array]:
        """Trajectories of one member in plain floats: under held errors, under those that switch once, and under those that push to each target.

        Args:
            theta: a parameter, one number a term.
            start: box of u, v, r, psi, x, y.
            h: steps [s], shape (n,).
            centre: forces without errors, shape (n, 3).
            errors: reaches of independent errors of the forces, each of shape (n, 3).
            given: velocities and accelerations of components that are not free, shape (n, 6).
            signs: held signs of the errors, and of the start.
            switched: steps from which other signs of the errors hold, with these.
            towards: number of a sample, and the weights of its six components.

        Returns:
            Trajectories of shape (m, 6), the first under the held signs.
        """
        return self._core.members(
            list(theta),
            list(start),
            np.ascontiguousarray(h),
            np.ascontiguousarray(centre),
            [np.ascontiguousarray(e) for e in errors],
            None if given is None else np.ascontiguousarray(given),
            (list(signs[0]), list(signs[1])),
            [(int(k), list(s)) for k, s in switched],
            [(int(k), list(w)) for k, w in towards],
        )


def _both(x: IntervalArray) -> tuple[Array, Array]:
    return np.ascontiguousarray(x.lower), np.ascontiguousarray(x.upper)
