"""Inverses, regularity and square systems of interval matrices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ivsid import _core
from ivsid.errors import IvsidError
from ivsid.intervals import EndpointPair, FloatArray, Interval, IntervalArray, Operand

INVERSE_METHODS: Final = ("exact", "hansen-bliek-rohn", "krawczyk", "cramer", "kuttler", "published", "published-hull")
SOLVE_METHODS: Final = ("krawczyk", "cramer", "hansen-bliek-rohn")
DEFAULT_PARTITIONS: Final = 1000


@dataclass(frozen=True)
class Result:
    """What a method answers.

    Attributes:
        method: its name.
        status: ``enclosed``, ``singular``, ``not_proved`` or ``not_applicable``.
        value: the enclosure; an ``EndpointPair`` for the published methods, which claim nothing; None without bounds.
        certificate: why the status holds.
        reason: why nothing was proved, in one sentence.
    """

    method: str
    status: str
    value: IntervalArray | EndpointPair | None
    certificate: dict[str, Any] | None
    reason: str | None

    @property
    def guaranteed(self) -> bool:
        """Whether every step was proved."""
        return self.status in ("enclosed", "singular")


@dataclass(frozen=True)
class Regularity:
    """Whether every member is nonsingular: ``status`` is ``regular``, ``singular`` or ``not_proved``."""

    status: str
    certificate: dict[str, Any] | None


def inverse(A: Operand, method: str = "exact", partitions: int | None = None) -> Any:
    """The inverse of an interval matrix.

    Args:
        A: shape (n, n), or a batch (k, n, n), which gives a list of k results.
        method: ``exact`` (hull by vertices, n <= 4), ``hansen-bliek-rohn`` (hull of the preconditioned columns),
            ``krawczyk`` (paper eq. 8-10, corrected), ``cramer`` (Nirmala-Ganesan), ``kuttler`` (extreme members with non-negative inverses: the hull), ``published`` (eq. 11-13 literally), ``published-hull`` (hull over both of its sets).
        partitions: N of the published methods; 1000 by default.

    Returns:
        A ``Result``. A failed proof is a status, never an exception.

    Raises:
        IvsidError: wrong shape, NaN, reversed bounds, or an unknown method.
    """
    check_method(method, INVERSE_METHODS)
    number = partition_count(partitions)
    matrix = _matrix(A)
    if matrix.ndim == 3:
        return [_inverse(matrix[k], method, number) for k in range(matrix.shape[0])]
    return _inverse(matrix, method, number)


def _inverse(matrix: IntervalArray, method: str, partitions: int) -> Result:
    found = _core.inverse(*_square(matrix), method, partitions)
    return make_result(method, found, matrix.shape)


def solve(A: Operand, b: Operand, method: str = "krawczyk") -> Result:
    """Encloses every solution of ``A x = b``.

    Args:
        A: shape (n, n).
        b: shape (n,).
        method: ``krawczyk`` (paper eq. 8-10, corrected), ``cramer`` (Nirmala-Ganesan) or ``hansen-bliek-rohn`` (hull of the
            preconditioned system in closed form).

    Raises:
        IvsidError: wrong shapes, NaN, reversed bounds, or an unknown method.
    """
    check_method(method, SOLVE_METHODS)
    matrix = _matrix(A)
    right = b if isinstance(b, IntervalArray) else IntervalArray(_points(b))
    if right.shape != matrix.shape[-1:]:
        raise IvsidError(f"the right-hand side has shape {right.shape}; for this matrix it must be {matrix.shape[-1:]}")
    lower, upper = np.ascontiguousarray(right.lower), np.ascontiguousarray(right.upper)
    return make_result(method, _core.solve(*_square(matrix), (lower, upper), method), right.shape)


def regularity(A: Operand) -> Regularity:
    """Decides whether every member of ``A`` (n, n) is nonsingular, with a certificate."""
    status, certificate = _core.regularity(*_square(_matrix(A)))
    return Regularity(status, certificate)


def norm(A: Operand) -> float:
    """The maximum row sum of magnitudes, rounded up (paper, section IV.A)."""
    matrix = _matrix(A, square=False)
    return _core.norm(np.ascontiguousarray(matrix.lower), np.ascontiguousarray(matrix.upper))


def partition_count(partitions: int | None) -> int:
    """N of the published methods, checked; 1000 where none is given."""
    number = DEFAULT_PARTITIONS if partitions is None else partitions
    if not isinstance(number, (int, np.integer)) or not 0 < number < 2**63:
        raise IvsidError(f"partitions = {number!r} is not usable; give a whole number of at least 1")
    return int(number)


def check_method(method: str, methods: tuple[str, ...]) -> None:
    """Refuses a name that is not among the methods."""
    if method not in methods:
        raise IvsidError(f"method '{method}' is not available; choose one of {', '.join(methods)}")


def _points(value: Any) -> FloatArray:
    if isinstance(value, Interval):
        raise IvsidError("one interval was given where an array is needed; use IntervalArray")
    return np.asarray(value, dtype=np.float64)


def _matrix(value: Operand, *, square: bool = True) -> IntervalArray:
    matrix = value if isinstance(value, IntervalArray) else IntervalArray(_points(value))
    usable = matrix.ndim in ((2, 3) if square else (2,)) and (not square or matrix.shape[-1] == matrix.shape[-2])
    if not usable or matrix.size == 0:
        needed = "(n, n) or (k, n, n)" if square else "(m, n)"
        raise IvsidError(f"an array of shape {matrix.shape} was given; a matrix of shape {needed} is needed")
    return matrix


def _square(matrix: IntervalArray) -> tuple[FloatArray, FloatArray]:
    if matrix.ndim != 2:
        raise IvsidError(f"an array of shape {matrix.shape} was given; one matrix of shape (n, n) is needed")
    return np.ascontiguousarray(matrix.lower), np.ascontiguousarray(matrix.upper)


def make_result(method: str, found: dict[str, Any], shape: tuple[int, ...]) -> Result:
    """The core's answer as a ``Result``; only an enclosure becomes an ``IntervalArray``."""
    value: IntervalArray | EndpointPair | None = None
    if found["value"] is not None:
        lower, upper = (end.reshape(shape) for end in found["value"])
        value = IntervalArray(lower, upper) if found["status"] == "enclosed" else EndpointPair(lower, upper)
    return Result(method, found["status"], value, found["certificate"], found["reason"])
