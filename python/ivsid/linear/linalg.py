"""Inverses, regularity and square systems of interval matrices: the names of ``ivsid.linalg``.

Source: docs/theory.md, "Inverses", "Regularity" and "Square systems".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from ivsid import _core
from ivsid.errors import IvsidError, choice, meant
from ivsid.intervals import FloatArray, Interval, IntervalArray, Operand
from ivsid.linear.certificates import Certificate
from ivsid.linear.results import (
    PROVED,
    Batch,
    Bounds,
    Regularity,
    RegularityBatch,
    Result,
    ResultBatch,
    Status,
    Verdict,
    bounds_of,
)
from ivsid.linear.spread import Answers, Client, asker, swept

__all__ = [
    "DEFAULT_CELLS",
    "DEFAULT_PARTITIONS",
    "INVERSE_METHODS",
    "PARTITION_LIMIT",
    "PROVED",
    "SOLVE_METHODS",
    "STATUSES",
    "SWEEPS",
    "VERDICTS",
    "Batch",
    "Bounds",
    "Certificate",
    "Regularity",
    "RegularityBatch",
    "Result",
    "ResultBatch",
    "Status",
    "Verdict",
    "bounds_of",
    "check_method",
    "inverse",
    "inverse_batch",
    "inverse_one",
    "make_result",
    "norm",
    "partition_count",
    "regularity",
    "regularity_batch",
    "regularity_one",
    "solve",
    "solve_batch",
    "solve_one",
]

INVERSE_METHODS: Final = _core.INVERSE_METHODS
SOLVE_METHODS: Final = _core.SOLVE_METHODS
SWEEPS: Final = _core.SWEEPS
DEFAULT_PARTITIONS: Final = _core.DEFAULT_PARTITIONS
DEFAULT_CELLS: Final = _core.DEFAULT_CELLS
STATUSES: Final = _core.STATUSES
VERDICTS: Final = _core.VERDICTS
# Least number of partitions that is refused: beyond it doubles no longer tell the members of a sweep apart.
# Source: definition: integers up to 2^53 are doubles
PARTITION_LIMIT: Final = 2**53


# The number that each method of an inverse takes where none is given.
# Source: definition: the core's defaults
COUNTS: Final = {name: _core.default_count(name) for name in INVERSE_METHODS}
# Methods whose sweep is shared by a client.
SPREAD: Final = ("published", "published-hull")


def inverse(
    A: Operand,
    method: str = "exact",
    partitions: int | None = None,
    *,
    sweep: str = "members",
    progress: Callable[[int, int], object] | None = None,
    client: Client | None = None,
) -> Result | ResultBatch:
    """The inverse of an interval matrix, or the inverses of a batch.

    Args:
        A: shape (n, n), or a batch (k, n, n), which gives a ``ResultBatch``.
        method: ``exact`` (the hull; n <= 64 where the signs of the inverse are fixed, else n <= 12), ``partitioned`` (the hull by
            halving, or an enclosure with a stated gap), ``hansen-bliek-rohn`` (hull of the preconditioned columns), ``krawczyk``
            (paper eq. 8-10, corrected), ``cramer`` (Nirmala-Ganesan), ``kuttler`` (extreme members with non-negative inverses: the
            hull), ``neumaier`` (one norm bound), ``published`` (eq. 11-13 literally, n <= 64), ``published-hull`` (hull over both of its sets).
        partitions: N of the published methods, 1000 by default; cells of ``partitioned``, 4096 by default.
        sweep: of the published methods: ``members`` inverts all 2N matrices, ``extrema`` only those that can be extreme, with the same
            result up to rounding at any N.
        progress: called with (partitions done, N) some times a second during a long sweep of one matrix.
        client: of a cluster (``distributed.Client``), whose workers share the partitions of one matrix under ``published``,
            ``published-hull`` and ``partitioned``; the bits are those without one.

    Returns:
        A ``Result``, or a ``ResultBatch``: ``inverse_one`` and ``inverse_batch`` have one of them as their type. A failed proof is a
        status, never an exception.

    Raises:
        IvsidError: wrong shape, NaN, reversed bounds, or an unknown method or sweep.
    """
    number = _check(method, partitions, sweep)
    matrix = _intervals(A)
    # One call is some microseconds, of which the second look of `_matrix` would be one.
    lower, upper = matrix.lower, matrix.upper
    shape = lower.shape
    if client is None and len(shape) == 2 and 0 < shape[0] == shape[1]:
        return Result.of(method, _core.inverse(lower, upper, method, number, sweep, progress), (lower, upper))
    matrix = _matrix(matrix)
    if matrix.ndim == 2:
        return _inverse_one(matrix, method, number, sweep, progress, client)
    if client is not None:
        raise IvsidError("a batch is not shared by a client; give one matrix of shape (n, n), or leave client out")
    return inverse_batch(matrix, method, partitions, sweep=sweep)


def inverse_one(
    A: Operand,
    method: str = "exact",
    partitions: int | None = None,
    *,
    sweep: str = "members",
    progress: Callable[[int, int], object] | None = None,
    client: Client | None = None,
) -> Result:
    """``inverse`` of one matrix, shape (n, n)."""
    number = _check(method, partitions, sweep)
    return _inverse_one(_matrix(A), method, number, sweep, progress, client)


def _inverse_one(
    matrix: IntervalArray,
    method: str,
    number: int,
    sweep: str,
    progress: Callable[[int, int], object] | None,
    client: Client | None,
) -> Result:
    """``inverse_one`` of arguments that were checked."""
    lower, upper = _bounds(matrix, 2)
    if client is None:
        return Result.of(method, _core.inverse(lower, upper, method, number, sweep, progress), (lower, upper))
    found = _shared(client, lower, upper, method, number, sweep)
    return make_result(method, found, (lower, upper), lower.shape)


def _shared(
    client: Client, lower: FloatArray, upper: FloatArray, method: str, number: int, sweep: str
) -> _core._Outcome:
    """The core's answer with the partitions spread over a cluster."""
    if method == "partitioned":
        return _core.partitioned_shared(lower, upper, number, asker(client, _cells))
    if method not in SPREAD or sweep != "members":
        raise IvsidError(
            f"method {method} with sweep {sweep} has no partitions to share; use {' or '.join((*SPREAD, 'partitioned'))} with sweep members, or leave "
            "client out"
        )
    given = (lower, upper, method, number)
    return _core.inverse_of_parts(*given, swept(client, _part, given, number))


def _part(lower: FloatArray, upper: FloatArray, method: str, number: int, part: tuple[int, int]) -> FloatArray | None:
    """A worker's part of a sweep; arrays that come from another process need not be aligned in memory, so they are copied."""
    return _core.inverse_part(np.array(lower), np.array(upper), method, number, part)


def _cells(lower: FloatArray, upper: FloatArray) -> Answers:
    """A worker's answers to some cells."""
    return _core.cell_answers(np.array(lower), np.array(upper))


def inverse_batch(
    A: Operand, method: str = "exact", partitions: int | None = None, *, sweep: str = "members"
) -> ResultBatch:
    """``inverse`` of a batch, shape (k, n, n)."""
    number = _check(method, partitions, sweep)
    lower, upper = _bounds(_matrix(A), 3)
    codes, bounds = _core.inverse_batch(lower, upper, method, number, sweep)

    def single(k: int) -> Result:
        found = _core.inverse(lower[k], upper[k], method, number, sweep)
        return Result.of(method, found, (lower[k], upper[k]))

    return ResultBatch(method, np.array(STATUSES)[codes], bounds, single)


def solve(A: Operand, b: Operand, method: str = "hansen-bliek-rohn") -> Result | ResultBatch:
    """Encloses every solution of ``A x = b``.

    Args:
        A: shape (n, n), or a batch (k, n, n).
        b: shape (n,); for a batch (k, n), or (n,) for all of it.
        method: ``hansen-bliek-rohn`` (hull of the preconditioned system in closed form), ``exact`` (hull of the solution set by sign
            accord, n <= 12), ``krawczyk`` (paper eq. 8-10, corrected), ``gauss-seidel``, or ``cramer`` (Nirmala-Ganesan).

    Returns:
        A ``Result`` with bounds of shape (n,), or a ``ResultBatch`` with (k, n): ``solve_one`` and ``solve_batch`` have one of them
        as their type.

    Raises:
        IvsidError: wrong shapes, NaN, reversed bounds, or an unknown method.
    """
    check_method(method, SOLVE_METHODS)
    matrix = _matrix(A)
    return solve_one(matrix, b, method) if matrix.ndim == 2 else solve_batch(matrix, b, method)


def solve_one(A: Operand, b: Operand, method: str = "hansen-bliek-rohn") -> Result:
    """``solve`` of one system: shapes (n, n) and (n,)."""
    check_method(method, SOLVE_METHODS)
    matrix = _matrix(A)
    low, high = _bounds(matrix, 2)
    right = _right(matrix, b)
    return make_result(method, _core.solve(low, high, right, method), (low, high), right[0].shape)


def solve_batch(A: Operand, b: Operand, method: str = "hansen-bliek-rohn") -> ResultBatch:
    """``solve`` of a batch of systems: shapes (k, n, n), and (k, n) or (n,)."""
    check_method(method, SOLVE_METHODS)
    matrix = _matrix(A)
    low, high = _bounds(matrix, 3)
    lower, upper = _right(matrix, b)
    codes, bounds = _core.solve_batch(low, high, (lower.ravel(), upper.ravel()), method)

    def single(k: int) -> Result:
        found = _core.solve(low[k], high[k], (lower[k], upper[k]), method)
        return make_result(method, found, (low[k], high[k]), lower[k].shape)

    return ResultBatch(method, np.array(STATUSES)[codes], bounds, single)


def regularity(A: Operand) -> Regularity | RegularityBatch:
    """Decides whether every member of ``A`` is nonsingular, with a certificate.

    Args:
        A: shape (n, n), or a batch (k, n, n).

    Returns:
        A ``Regularity``, or a ``RegularityBatch``: ``regularity_one`` and ``regularity_batch`` have one of them as their type.
    """
    matrix = _matrix(A)
    return regularity_one(matrix) if matrix.ndim == 2 else regularity_batch(matrix)


def regularity_one(A: Operand) -> Regularity:
    """``regularity`` of one matrix, shape (n, n)."""
    return _regularity(*_bounds(_matrix(A), 2))


def regularity_batch(A: Operand) -> RegularityBatch:
    """``regularity`` of a batch, shape (k, n, n)."""
    low, high = _bounds(_matrix(A), 3)
    codes = _core.regularity_batch(low, high)
    return RegularityBatch(np.array(VERDICTS)[codes], lambda k: _regularity(low[k], high[k]))


def _regularity(lower: FloatArray, upper: FloatArray) -> Regularity:
    status, certificate = _core.regularity(lower, upper)
    return Regularity(Verdict(status), None if certificate is None else Certificate(certificate, lower, upper))


def norm(A: Operand) -> float:
    """The maximum row sum of magnitudes, rounded up (paper, section IV.A)."""
    matrix = _matrix(A, square=False)
    return _core.norm(np.ascontiguousarray(matrix.lower), np.ascontiguousarray(matrix.upper))


def partition_count(partitions: int | None, method: str = "published") -> int:
    """N of the published methods or the cells of ``partitioned``, checked; a default where none is given."""
    default = _core.default_count(method) if method in INVERSE_METHODS else DEFAULT_PARTITIONS
    number = default if partitions is None else partitions
    if not isinstance(number, (int, np.integer)) or isinstance(number, bool) or not 0 < number < PARTITION_LIMIT:
        raise IvsidError(f"partitions = {number!r} is not usable; give a whole number of at least 1 and below 2^53")
    return int(number)


def check_method(method: str, methods: tuple[str, ...]) -> None:
    """Refuses a name that is not among the methods."""
    if method not in methods:
        raise IvsidError(f"method '{method}' is not available; {choice(method, methods)}")


def _check(method: str, partitions: int | None, sweep: str) -> int:
    """The number of partitions or cells, once the names of the method and of the sweep are known."""
    number = COUNTS.get(method) if isinstance(method, str) else None
    if number is None:
        check_method(method, INVERSE_METHODS)
    if sweep not in SWEEPS:
        raise IvsidError(f"sweep '{sweep}' is unknown; {meant(sweep, SWEEPS)}use {' or '.join(SWEEPS)}")
    return partition_count(partitions, method) if partitions is not None or number is None else number


def _points(value: Operand) -> FloatArray:
    if isinstance(value, Interval):
        raise IvsidError("one interval was given where an array is needed; use IntervalArray")
    return np.asarray(value, dtype=np.float64)


def _intervals(value: Operand) -> IntervalArray:
    return value if isinstance(value, IntervalArray) else IntervalArray(_points(value))


def _matrix(value: Operand, *, square: bool = True) -> IntervalArray:
    matrix = _intervals(value)
    usable = matrix.ndim in ((2, 3) if square else (2,)) and (not square or matrix.shape[-1] == matrix.shape[-2])
    if not usable or matrix.size == 0:
        needed = "(n, n) or (k, n, n)" if square else "(m, n)"
        raise IvsidError(f"an array of shape {matrix.shape} was given; a matrix of shape {needed} is needed")
    return matrix


def _bounds(matrix: IntervalArray, dimensions: int) -> Bounds:
    if matrix.ndim != dimensions:
        needed = "one matrix of shape (n, n)" if dimensions == 2 else "a batch of shape (k, n, n)"
        raise IvsidError(f"an array of shape {matrix.shape} was given; {needed} is needed")
    return np.ascontiguousarray(matrix.lower), np.ascontiguousarray(matrix.upper)


def _right(matrix: IntervalArray, b: Operand) -> Bounds:
    """Right-hand sides for every row of the matrix or of the batch."""
    right = b if isinstance(b, IntervalArray) else IntervalArray(_points(b))
    needed = matrix.shape[:-1]
    if right.shape not in (matrix.shape[-1:], needed):
        raise IvsidError(f"the right-hand side has shape {right.shape}; for this matrix it must be {needed}")
    lower, upper = (np.ascontiguousarray(np.broadcast_to(end, needed)) for end in (right.lower, right.upper))
    return lower, upper


def make_result(method: str, found: _core._Outcome, matrix: Bounds, shape: tuple[int, ...]) -> Result:
    """The core's answer as a ``Result``."""
    ends = found["value"]
    if ends is not None and ends[0].shape != shape:
        ends = (ends[0].reshape(shape), ends[1].reshape(shape))
    value = bounds_of(ends, found["proved"])
    certificate = None if found["certificate"] is None else Certificate(found["certificate"], *matrix)
    return Result(method, Status(found["status"]), value, certificate, found["reason"], found["gap"])
