"""Parameters of interval rows: the feasible set, and interval least squares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ivsid import _core
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, IntervalArray, Operand
from ivsid.linalg import INVERSE_METHODS, Result, check_method, make_result, partition_count


@dataclass(frozen=True)
class FeasibleSet:
    """The proved hull of all parameters that are consistent with every row.

    Attributes:
        status: ``enclosed``, ``empty`` (no parameter is consistent), ``unbounded`` or ``not_applicable``.
        value: bounds, shape (n,); unproved ends are infinite; None where the set is empty.
        inflation: the smallest factor on all radii at which a parameter is consistent (an estimate); None if none is.
        centre: where that factor is attained, shape (n,).
        directions: in which the set goes on for ever, each of shape (n,).
        certificate: per orthant, the rows and multipliers of every bound, or of the contradiction.
        reason: why the method does not apply.
    """

    status: str
    value: IntervalArray | None
    inflation: float | None
    centre: FloatArray | None
    directions: list[FloatArray]
    certificate: list[dict[str, Any]]
    reason: str | None

    @property
    def guaranteed(self) -> bool:
        """Whether every bound that is given was proved."""
        return self.status in ("enclosed", "empty", "unbounded")


@dataclass(frozen=True)
class NormalEquations:
    """Interval least squares, theta = (A'A)^-1 A'y (paper eq. 14).

    Attributes:
        status: that of the inverse; only ``enclosed`` is proved.
        value: bounds, shape (n,), or None where the inverse has none.
        improper: how many entries of the inverse had their lower bound above the upper one.
        gram: A'A, shape (n, n).
        inverse: the inverse that was used.
    """

    status: str
    value: IntervalArray | None
    improper: int
    gram: IntervalArray
    inverse: Result

    @property
    def guaranteed(self) -> bool:
        """Whether every step was proved."""
        return self.status == "enclosed"


def feasible_set(A: Operand, y: Operand) -> FeasibleSet:
    """The hull of {theta: some member of A and of y gives A theta = y} (Oettli-Prager; METHODS 4.3-4.5).

    Args:
        A: interval rows, shape (m, n).
        y: right-hand sides, shape (m,).

    Raises:
        IvsidError: wrong shapes, NaN or reversed bounds.
    """
    rows, right = _rows(A, y)
    found = _core.feasible_set(rows, right, None)
    lower, upper = found["parameters"]
    empty = found["status"] == "empty"
    directions = [np.array(d) for d in found["directions"]]
    return FeasibleSet(
        found["status"],
        None if empty else IntervalArray(lower, upper),
        found["inflation"],
        found["centre"],
        directions,
        found["orthants"],
        found["reason"],
    )


def normal_equations(A: Operand, y: Operand, method: str = "exact", partitions: int | None = None) -> NormalEquations:
    """Interval least squares with the named inverse; arguments as in ``feasible_set`` and ``linalg.inverse``."""
    check_method(method, INVERSE_METHODS)
    rows, right = _rows(A, y)
    found = _core.normal_equations(rows, right, method, partition_count(partitions, method))
    value = None if found["parameters"] is None else IntervalArray(*found["parameters"])
    gram = IntervalArray(*found["gram"])
    bounds = (np.ascontiguousarray(gram.lower), np.ascontiguousarray(gram.upper))
    inverse = make_result(method, found["inverse"], bounds, gram.shape)
    return NormalEquations(found["status"], value, found["improper"], gram, inverse)


def _rows(A: Operand, y: Operand) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    rows = A if isinstance(A, IntervalArray) else IntervalArray(np.asarray(A, dtype=np.float64))
    right = y if isinstance(y, IntervalArray) else IntervalArray(np.asarray(y, dtype=np.float64))
    if rows.ndim != 2 or 0 in rows.shape:
        raise IvsidError(f"rows of shape {rows.shape} were given; shape (m, n) with m, n >= 1 is needed")
    if right.shape != rows.shape[:1]:
        raise IvsidError(f"right-hand sides of shape {right.shape} were given; {rows.shape[:1]} is needed")

    def contiguous(v: IntervalArray) -> tuple[FloatArray, FloatArray]:
        return np.ascontiguousarray(v.lower), np.ascontiguousarray(v.upper)

    return contiguous(rows), contiguous(right)


def gram(A: Operand) -> IntervalArray:
    """A'A with squares on its diagonal, as ``normal_equations`` forms it; A has shape (m, n)."""
    rows = A if isinstance(A, IntervalArray) else IntervalArray(np.asarray(A, dtype=np.float64))
    if rows.ndim != 2 or 0 in rows.shape:
        raise IvsidError(f"rows of shape {rows.shape} were given; shape (m, n) with m, n >= 1 is needed")
    return IntervalArray(*_core.gram(np.ascontiguousarray(rows.lower), np.ascontiguousarray(rows.upper)))
