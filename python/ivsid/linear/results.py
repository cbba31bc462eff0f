"""Results of inverses, square systems and regularity, one by one and in batches.

Results are values: nothing here computes, and the core is not imported.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Final, Protocol, TypeAlias, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import EndpointPair, FloatArray, IntervalArray
from ivsid.linear.certificate_kinds import Content
from ivsid.linear.certificates import Certificate

Bounds: TypeAlias = tuple[FloatArray, FloatArray]


class Status(StrEnum):
    """The status of an inverse or of the solution of a square system: ``STATUSES`` of the core, by name."""

    ENCLOSED = "enclosed"
    SINGULAR = "singular"
    NOT_PROVED = "not_proved"
    NOT_APPLICABLE = "not_applicable"


class Verdict(StrEnum):
    """The verdict on the regularity of a matrix: ``VERDICTS`` of the core, by name."""

    REGULAR = "regular"
    SINGULAR = "singular"
    NOT_PROVED = "not_proved"


PROVED: Final = (Status.ENCLOSED, Status.SINGULAR)
"""Statuses that are proved."""


def bounds_of(ends: Bounds | None, proved: bool) -> IntervalArray | EndpointPair | None:
    """The core's bounds; only proved ones become an ``IntervalArray``."""
    if ends is None:
        return None
    # The core made the bounds, for this array: they are intervals without another look at them.
    return IntervalArray._raw(ends, ends[0].shape) if proved else EndpointPair(*ends)


class _Answered(Protocol):
    """The core's answer for one matrix, whose parts are made when they are asked for."""

    @property
    def status(self) -> str: ...
    @property
    def value(self) -> Bounds | None: ...
    @property
    def proved(self) -> bool: ...
    @property
    def gap(self) -> float | None: ...
    @property
    def certificate(self) -> Content | None: ...
    @property
    def reason(self) -> str | None: ...


def _certificate_of(found: _Answered, matrix: Bounds) -> Certificate | None:
    content = found.certificate
    return None if content is None else Certificate(content, *matrix)


# Parts of a result that are made when they are first asked for, from the core's answer and the matrix.
PARTS: Final[dict[str, Callable[[_Answered, Bounds], object]]] = {
    "status": lambda found, _: Status(found.status),
    "value": lambda found, _: bounds_of(found.value, found.proved),
    "certificate": _certificate_of,
    "reason": lambda found, _: found.reason,
}


@dataclass(frozen=True)
class Result:
    """Answer of a method, with its proof.

    Attributes:
        method: its name.
        status: ``enclosed``, ``singular``, ``not_proved`` or ``not_applicable``.
        value: the enclosure; an ``EndpointPair`` for the published methods, which prove nothing; None without bounds.
        certificate: proof of the status; its ``verify()`` checks it in exact arithmetic.
        reason: the missing proof and its cause, in one sentence.
        gap: for ``partitioned``, the largest distance that a bound can have from the hull.
    """

    method: str
    status: Status
    value: IntervalArray | EndpointPair | None
    certificate: Certificate | None
    reason: str | None
    gap: float | None = None

    @property
    def guaranteed(self) -> bool:
        """Whether every step was proved."""
        return self.status in PROVED

    @classmethod
    def of(cls, method: str, found: _Answered, matrix: Bounds) -> Result:
        """A result whose ``PARTS`` are made when they are first asked for: one inverse takes less time than they do."""
        new = object.__new__(cls)
        object.__setattr__(new, "__dict__", {"method": method, "gap": found.gap, "_found": found, "_matrix": matrix})
        return new

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> object:
            # Called where the instance has no such attribute yet.
            own = self.__dict__
            if name not in PARTS or "_found" not in own:
                raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'")
            return own.setdefault(name, PARTS[name](own["_found"], own["_matrix"]))

    def __reduce__(self) -> tuple[type[Result], tuple[object, ...]]:
        return type(self), (self.method, self.status, self.value, self.certificate, self.reason, self.gap)


@dataclass(frozen=True)
class Regularity:
    """Whether every member is nonsingular: ``status`` is ``regular``, ``singular`` or ``not_proved``."""

    status: Verdict
    certificate: Certificate | None


Answer = TypeVar("Answer")


class Batch(Sequence[Answer]):
    """Answers to a batch: one answer after the other, or the names of all statuses as an array.

    An answer with its certificate is made when it is asked for.

    Attributes:
        status: names of the statuses, shape (k,).
    """

    def __init__(self, status: NDArray[np.str_], single: Callable[[int], Answer]) -> None:
        self.status = status
        self._single = single

    def __len__(self) -> int:
        return len(self.status)

    @overload
    def __getitem__(self, index: int) -> Answer: ...
    @overload
    def __getitem__(self, index: slice) -> list[Answer]: ...
    def __getitem__(self, index: int | slice) -> Answer | list[Answer]:
        positions = range(len(self))[index]
        return self._single(positions) if isinstance(positions, int) else [self._single(k) for k in positions]


class RegularityBatch(Batch[Regularity]):
    """Verdicts on a batch."""

    @property
    def statuses(self) -> tuple[Verdict, ...]:
        """The verdicts of ``status`` as members of their enumeration."""
        return tuple(map(Verdict, self.status.tolist()))


class ResultBatch(Batch[Result]):
    """Results of a batch, with all bounds as arrays.

    Attributes:
        method: its name.
        lower: bounds, shape (k, n, n), of systems (k, n); NaN where a result has no value.
        upper: the same from above.
    """

    def __init__(self, method: str, status: NDArray[np.str_], bounds: Bounds, single: Callable[[int], Result]) -> None:
        super().__init__(status, single)
        self.method = method
        self.lower, self.upper = bounds

    @property
    def statuses(self) -> tuple[Status, ...]:
        """The names of ``status`` as members of their enumeration."""
        return tuple(map(Status, self.status.tolist()))

    @property
    def guaranteed(self) -> NDArray[np.bool_]:
        """Mask of the proved results, shape (k,)."""
        return np.isin(self.status, PROVED)
