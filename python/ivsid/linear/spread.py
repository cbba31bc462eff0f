"""Partitions of one inverse, spread over the workers of a cluster: the bits of one machine.

The extremes of a sweep do not depend on how its partitions are divided, and a cell of the rigorous partition depends on nothing but itself. Who does the
work therefore changes no bit of the result.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Final, Protocol, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray

# Parts for each worker: the last ones to finish keep the others waiting for one part.
# Source: resource: a tenth of the time is lost at most
PARTS: Final = 8
# Partitions of a part at least; a smaller one takes less time than its way to a worker.
# Source: resource: a millisecond of a sweep of order 3
LEAST: Final = 100_000
# Cells of a task at least.
# Source: resource: some milliseconds of cells of order 3
CELLS: Final = 64


# Codes and numbers of cells.
Answers: TypeAlias = tuple[NDArray[np.uint8], FloatArray]


class Future(Protocol):
    """A result that a cluster makes and keeps."""

    key: str

    def result(self) -> object:
        """The result, once it is there."""

    def release(self) -> None:
        """Lets the cluster forget it."""


class Client(Protocol):
    """A client of a cluster, as that of ``distributed``."""

    loop: object

    def submit(self, task: Callable[..., object], *given: object, **options: object) -> Future:
        """A future of the task."""

    def gather(self, futures: Sequence[Future]) -> Sequence[object]:
        """The results of futures."""

    def nthreads(self) -> dict[str, int]:
        """The number of threads of each worker."""


def workers_of(client: Client) -> int:
    """The number of threads that work.

    Raises:
        IvsidError: no client, or one without workers.
    """
    if not hasattr(client, "nthreads") or not hasattr(client, "submit"):
        raise IvsidError(
            f"client is given as {type(client).__name__}; give a distributed.Client (pip install 'ivsid[fleet]')"
        )
    found = client.nthreads()
    if not found:
        raise IvsidError("the cluster of client has no workers; start some with dask worker ADDRESS")
    return sum(int(n) for n in found.values())


def parts_of(partitions: int, workers: int) -> list[tuple[int, int]]:
    """Ranges of partitions, which cover all of them."""
    number = max(1, min(PARTS * workers, partitions // LEAST))
    edges = [partitions * k // number for k in range(number + 1)]
    return list(pairwise(edges))


def swept(
    client: Client, part: Callable[..., FloatArray | None], given: tuple[object, ...], partitions: int
) -> list[FloatArray | None]:
    """The parts of a sweep, in order.

    Args:
        client: of a cluster.
        part: makes one part of the arguments ``given`` and a range.
        given: bounds of the matrix, method and number of partitions.
        partitions: their number.
    """
    futures = [client.submit(part, *given, r, pure=False) for r in parts_of(partitions, workers_of(client))]
    found = cast(Sequence[FloatArray | None], client.gather(futures))
    return [None if part is None else np.array(part) for part in found]


def asker(
    client: Client, answers: Callable[[FloatArray, FloatArray], Answers]
) -> Callable[[FloatArray, FloatArray], Answers]:
    """A function that has the cells of a level answered by the workers.

    Args:
        client: of a cluster.
        answers: codes and numbers of some cells from their bounds, shape (k, n, n).
    """
    workers = workers_of(client)

    def ask(lower: FloatArray, upper: FloatArray) -> Answers:
        size = max(CELLS, -(-len(lower) // (2 * workers)))
        ranges = [slice(k, k + size) for k in range(0, len(lower), size)]
        futures = [client.submit(answers, lower[r], upper[r], pure=False) for r in ranges]
        found = cast(Sequence[Answers], client.gather(futures))
        return np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])

    return ask
