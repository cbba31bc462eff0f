"""Parameters of interval rows: the feasible set, and interval least squares.

Source: docs/theory.md, "The feasible set" and "Least squares".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final, Literal, TypeAlias, TypedDict

import numpy as np

from ivsid import _core
from ivsid.errors import IvsidError, choice
from ivsid.intervals import EndpointPair, FloatArray, IntervalArray, Operand
from ivsid.linear.linalg import INVERSE_METHODS, bounds_of, check_method, make_result, partition_count
from ivsid.linear.results import Bounds, Result, Status

FEASIBLE_STATUSES: Final = _core.FEASIBLE_STATUSES
LEAST_SQUARES_STATUSES: Final = _core.LEAST_SQUARES_STATUSES


class FeasibleStatus(StrEnum):
    """The status of a feasible set: ``FEASIBLE_STATUSES`` of the core, by name."""

    ENCLOSED = "enclosed"
    EMPTY = "empty"
    UNBOUNDED = "unbounded"
    NOT_APPLICABLE = "not_applicable"


FEASIBLE_PROVED: Final = (FeasibleStatus.ENCLOSED, FeasibleStatus.EMPTY, FeasibleStatus.UNBOUNDED)
"""Statuses of a feasible set that are proved."""

FEASIBLE_BOUNDED: Final = (FeasibleStatus.ENCLOSED, FeasibleStatus.UNBOUNDED, FeasibleStatus.NOT_APPLICABLE)
"""Statuses of a feasible set with bounds, of which unproved ones are infinite."""


class LeastSquaresStatus(StrEnum):
    """The status of an enclosure of least-squares solutions: ``LEAST_SQUARES_STATUSES`` of the core, by name."""

    ENCLOSED = "enclosed"
    NOT_PROVED = "not_proved"
    NOT_APPLICABLE = "not_applicable"


DataRow: TypeAlias = tuple[int, bool, float]
"""Row number, whether its lower right-hand side is meant, multiplier (an approximation)."""

SignRow: TypeAlias = tuple[int, float]
"""Parameter whose sign constraint is used, multiplier (an approximation)."""


class BoundProof(TypedDict):
    """One end of one parameter in one orthant, and the rows that prove it."""

    column: int
    end: Literal["lower", "upper"]
    bound: float
    rows: list[DataRow]
    signs: list[SignRow]


class EmptyOrthant(TypedDict):
    """An orthant without a consistent parameter, and the rows that contradict each other."""

    signs: list[int]
    dropped: list[int]
    empty: Literal[True]
    rows: list[DataRow]


class BoundedOrthant(TypedDict):
    """An orthant that the set may meet, with two ends for each parameter."""

    signs: list[int]
    dropped: list[int]
    empty: Literal[False]
    bounds: list[BoundProof]


OrthantProof: TypeAlias = EmptyOrthant | BoundedOrthant


class SignProof(TypedDict):
    """Proof that the set meets no orthant but one: decided signs, the orthant's signs, columns with their rows, and their reach."""

    decided: list[int]
    home: list[int]
    columns: list[tuple[int, list[DataRow], list[SignRow]]]
    vector: list[float]
    reach: list[float]
    branch: int | None


@dataclass(frozen=True)
class FeasibleSet:
    """The proved hull of all parameters that are consistent with every row.

    Attributes:
        status: ``enclosed``, ``empty`` (no parameter is consistent), ``unbounded`` or ``not_applicable``.
        value: bounds, shape (n,); unproved ends are infinite; None where the set is empty.
        inflation: the smallest factor on all radii at which a parameter is consistent (an estimate); None if there is none.
        centre: the parameter that attains this factor, shape (n,).
        directions: those in which the set is unbounded, each of shape (n,).
        certificate: per orthant that the set may meet, the rows and multipliers of every bound, or of the contradiction; with
            ``outliers`` each entry names the rows that it leaves out (``dropped``).
        reason: the condition that the method lacks, in one sentence.
        sign_proofs: proofs that the set meets no orthant beside those of ``certificate``; empty where all are listed.
        fewest_outliers: with ``outliers``, the least number of rows without which no contradiction is left; None where more
            than the allowed number are needed.
        outliers: with ``outliers``, the sets of that many rows, each a tuple of row numbers.
    """

    status: FeasibleStatus
    value: IntervalArray | None
    inflation: float | None
    centre: FloatArray | None
    directions: list[FloatArray]
    certificate: list[OrthantProof]
    reason: str | None
    sign_proofs: list[SignProof] = field(default_factory=list)
    fewest_outliers: int | None = None
    outliers: tuple[tuple[int, ...], ...] = ()

    @property
    def guaranteed(self) -> bool:
        """Whether every bound that is given was proved."""
        return self.status in FEASIBLE_PROVED


@dataclass(frozen=True)
class NormalEquations:
    """Interval least squares, theta = (A'A)^-1 A'y (paper eq. 14).

    Attributes:
        status: that of the inverse; only ``enclosed`` is proved.
        value: bounds, shape (n,); an ``EndpointPair`` for the published methods, which prove nothing; None where the inverse has none.
        improper: number of entries of the inverse whose lower bound is above the upper one.
        gram: A'A, shape (n, n).
        inverse: the inverse that was used.
    """

    status: Status
    value: IntervalArray | EndpointPair | None
    improper: int
    gram: IntervalArray
    inverse: Result

    @property
    def guaranteed(self) -> bool:
        """Whether every step was proved."""
        return self.status is Status.ENCLOSED


LEAST_SQUARES_METHODS: Final = _core.LEAST_SQUARES_METHODS
"""Methods of ``least_squares``."""


@dataclass(frozen=True)
class LeastSquares:
    """An enclosure of the least-squares solutions of all members.

    Attributes:
        method: its name.
        status: ``enclosed``, ``not_proved`` or ``not_applicable``.
        value: bounds, shape (n,); None where there are none.
        reason: the missing proof and its cause, in one sentence; None with bounds.
    """

    method: str
    status: LeastSquaresStatus
    value: IntervalArray | None
    reason: str | None

    @property
    def guaranteed(self) -> bool:
        """Whether the enclosure was proved."""
        return self.status is LeastSquaresStatus.ENCLOSED


def feasible_set(A: Operand, y: Operand, outliers: int = 0, signs: Sequence[int] | None = None) -> FeasibleSet:
    """The hull of {theta: some member of A and of y gives A theta = y} (Oettli and Prager 1964).

    C-contiguous float64 bounds are used where they lie, memory-mapped ones too.

    Args:
        A: interval rows, shape (m, n).
        y: right-hand sides, shape (m,).
        outliers: number of rows that may be wrong; the hull is that of all parameters that contradict at most this many rows.
        signs: for each parameter 1 or -1 where its sign is known beforehand, else 0; the result holds under this assumption.

    Raises:
        IvsidError: wrong shapes, NaN or reversed bounds, signs that do not fit.
    """
    rows, right = _rows(A, y)
    if outliers < 0:
        raise IvsidError(f"outliers = {outliers} was given; a number of rows, at least 0, is needed")
    if signs is not None and (len(signs) != rows[0].shape[1] or any(s not in (-1, 0, 1) for s in signs)):
        raise IvsidError(f"signs = {list(signs)} was given; {rows[0].shape[1]} of 1, -1 and 0 are needed")
    found = _core.feasible_set(rows, right, None if signs is None else list(signs), int(outliers))
    lower, upper = found["parameters"]
    status = FeasibleStatus(found["status"])
    directions = [np.array(d) for d in found["directions"]]
    return FeasibleSet(
        status,
        IntervalArray(lower, upper) if status in FEASIBLE_BOUNDED else None,
        found["inflation"],
        found["centre"],
        directions,
        found["orthants"],
        found["reason"],
        found["sign_proofs"],
        found["fewest_outliers"],
        tuple(tuple(rows) for rows in found["outliers"] or ()),
    )


def normal_equations(A: Operand, y: Operand, method: str = "exact", partitions: int | None = None) -> NormalEquations:
    """Interval least squares with the named inverse; arguments as in ``feasible_set`` and ``linalg.inverse``."""
    check_method(method, INVERSE_METHODS)
    rows, right = _rows(A, y)
    found = _core.normal_equations(rows, right, method, partition_count(partitions, method))
    value = bounds_of(found["parameters"], found["proved"])
    gram = IntervalArray(*found["gram"])
    matrix = (np.ascontiguousarray(gram.lower), np.ascontiguousarray(gram.upper))
    inverse = make_result(method, found["inverse"], matrix, gram.shape)
    return NormalEquations(Status(found["status"]), value, found["improper"], gram, inverse)


def least_squares(A: Operand, y: Operand, method: str = "qr") -> LeastSquares:
    """Every least-squares solution of every member of A and y, and so every consistent parameter.

    Args:
        A: interval rows or points, shape (m, n).
        y: right-hand sides, shape (m,).
        method: ``qr``, a verified QR factorisation (Rump 2012, with the rows' radii to first order), in one pass over the rows; or
            ``augmented``, Rump's square system of order m + n, far wider, up to an order of 1000.

    Raises:
        IvsidError: wrong shapes, NaN or reversed bounds, an unknown method.
    """
    if method not in LEAST_SQUARES_METHODS:
        raise IvsidError(f"method '{method}' is not available; {choice(method, LEAST_SQUARES_METHODS)}")
    rows, right = _rows(A, y)
    found = _core.least_squares(rows, right, method)
    value = None if found["parameters"] is None else IntervalArray(*found["parameters"])
    return LeastSquares(method, LeastSquaresStatus(found["status"]), value, found["reason"])


def _rows(A: Operand, y: Operand) -> tuple[Bounds, Bounds]:
    rows = A if isinstance(A, IntervalArray) else IntervalArray(np.asarray(A, dtype=np.float64))
    right = y if isinstance(y, IntervalArray) else IntervalArray(np.asarray(y, dtype=np.float64))
    if rows.ndim != 2 or 0 in rows.shape:
        raise IvsidError(f"rows of shape {rows.shape} were given; shape (m, n) with m, n >= 1 is needed")
    if right.shape != rows.shape[:1]:
        raise IvsidError(f"right-hand sides of shape {right.shape} were given; {rows.shape[:1]} is needed")

    def contiguous(v: IntervalArray) -> Bounds:
        return np.ascontiguousarray(v.lower), np.ascontiguousarray(v.upper)

    return contiguous(rows), contiguous(right)


def gram(A: Operand) -> IntervalArray:
    """A'A with squares on its diagonal, as ``normal_equations`` forms it; A has shape (m, n)."""
    rows = A if isinstance(A, IntervalArray) else IntervalArray(np.asarray(A, dtype=np.float64))
    if rows.ndim != 2 or 0 in rows.shape:
        raise IvsidError(f"rows of shape {rows.shape} were given; shape (m, n) with m, n >= 1 is needed")
    return IntervalArray(*_core.gram(np.ascontiguousarray(rows.lower), np.ascontiguousarray(rows.upper)))
