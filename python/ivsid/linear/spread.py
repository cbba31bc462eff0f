"""Partitions of one inverse, spread over the workers of a cluster: the bits of one machine.

The extremes of a sweep do not depend on how its partitions are divided, and a cell of the rigorous partition depends on nothing but itself. Who does the
work therefore changes no bit of the result.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, Final, Protocol

import numpy as np

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


class Client(Protocol):
    """A client of a cluster, as that of ``distributed``."""

    def submit(self, task: Callable[..., Any], *given: Any, **options: Any) -> Any:
        """A future of the task."""

    def gather(self, futures: Any) -> Any:
        """The results of futures."""


def workers_of(client: Client) -> int:
    """The number of threads that work.

    Raises:
        IvsidError: no client, or one without workers.
    """
    threads: object = getattr(client, "nthreads", None)
    found = threads() if callable(threads) else None
    if not isinstance(found, dict) or not hasattr(client, "submit"):
        raise IvsidError(
            f"client is given as {type(client).__name__}; give a distributed.Client (pip install 'ivsid[fleet]')"
        )
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
    found: list[FloatArray | None] = list(client.gather(futures))
    return found


def asker(
    client: Client, answers: Callable[[FloatArray, FloatArray], tuple[Any, FloatArray]]
) -> Callable[[FloatArray, FloatArray], tuple[Any, FloatArray]]:
    """A function that has the cells of a level answered by the workers.

    Args:
        client: of a cluster.
        answers: codes and numbers of some cells from their bounds, shape (k, n, n).
    """
    workers = workers_of(client)

    def ask(lower: FloatArray, upper: FloatArray) -> tuple[Any, FloatArray]:
        size = max(CELLS, -(-len(lower) // (2 * workers)))
        ranges = [slice(k, k + size) for k in range(0, len(lower), size)]
        futures = [client.submit(answers, lower[r], upper[r], pure=False) for r in ranges]
        found: Sequence[tuple[Any, FloatArray]] = client.gather(futures)
        return np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])

    return ask
