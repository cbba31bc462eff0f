"""Processes that do the work: this one alone, a local cluster that the command starts, or a cluster at an address."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import count, islice
from threading import Event, Thread
from typing import Final, Protocol, TypeVar, cast

from ivsid.errors import IvsidError
from ivsid.fleets import extra
from ivsid.linear.spread import Client, Future
from ivsid.memory.pieces import processors

# Times that a task may lose its worker before it is taken for the cause.
# Source: resource: a log that ends each worker it meets costs ten restarts
LIVES: Final = 10
# Tasks that wait at the scheduler, for each worker.
# Source: resource: a scheduler holds about 1 kB a task; a million at once would need a gigabyte
WAITING: Final = 50
# Time between two looks at the workers of a local cluster [s].
# Source: resource: a call that does nothing as a rule
WATCHED: Final = 2.0
# Time in which a cluster has to answer [s].
# Source: definition: the default of distributed
PATIENCE: Final = 30


T = TypeVar("T")


class LocalCluster(Protocol):
    """As much of a local cluster of Dask as is used."""

    def scale(self, n: int) -> None:
        """Starts or ends workers, so that there are so many."""


class LostError(Exception):
    """A task whose workers died."""


class Crew(Protocol):
    """Processes that do tasks."""

    def each(self, task: Callable[..., T], inputs: Sequence[tuple[object, ...]]) -> Iterator[tuple[int, T | LostError]]:
        """Results as they come, with the place of their inputs; a ``LostError`` in place of one whose workers died."""

    def hold(self, task: Callable[..., object], inputs: Sequence[tuple[object, ...]]) -> list[object]:
        """Results that stay where they are made, as handles."""

    def on(self, task: Callable[..., T], held: Sequence[object], inputs: Sequence[object]) -> list[T]:
        """Results of a task on what is held, in order.

        Raises:
            IvsidError: workers died again and again.
        """


class Here:
    """This process alone."""

    def each(self, task: Callable[..., T], inputs: Sequence[tuple[object, ...]]) -> Iterator[tuple[int, T | LostError]]:
        """Results in order."""
        for k, given in enumerate(inputs):
            yield k, task(*given)

    def hold(self, task: Callable[..., object], inputs: Sequence[tuple[object, ...]]) -> list[object]:
        """The results themselves."""
        return [task(*given) for given in inputs]

    def on(self, task: Callable[..., T], held: Sequence[object], inputs: Sequence[object]) -> list[T]:
        """Results in order."""
        return [task(h, i) for h, i in zip(held, inputs, strict=True)]


class Cluster:
    """The workers of a cluster of Dask.

    A worker that dies is replaced by its nanny, and its tasks are done again by whoever is left; results that were held by it are made again.

    Args:
        client: of the cluster.
    """

    def __init__(self, client: Client) -> None:
        self._client = client
        self._number = count()

    def _submit(self, task: Callable[..., object], given: tuple[object, ...]) -> Future:
        # Names of their own: a result of an earlier run is never taken for one of this.
        name = f"ivsid-{task.__name__}-{id(self):x}-{next(self._number)}"
        return self._client.submit(task, *given, key=name, pure=False)

    def each(self, task: Callable[..., T], inputs: Sequence[tuple[object, ...]]) -> Iterator[tuple[int, T | LostError]]:
        """Results as they come; only some tasks wait at the scheduler at a time."""
        package = extra.distributed()
        waiting = iter(enumerate(inputs))
        places: dict[str, int] = {}
        most = WAITING * max(1, len(self._client.nthreads()))
        queue = package.as_completed(loop=self._client.loop)

        def more(number: int) -> None:
            for k, given in islice(waiting, number):
                future = self._submit(task, given)
                places[future.key] = k
                queue.add(future)

        more(most)
        for future in queue:
            place = places.pop(future.key)
            yield place, cast(T | LostError, _result(future))
            future.release()
            more(1)

    def hold(self, task: Callable[..., object], inputs: Sequence[tuple[object, ...]]) -> list[object]:
        """Futures: the cluster keeps the results, and makes them again where a worker is lost."""
        return [self._submit(task, given) for given in inputs]

    def on(self, task: Callable[..., T], held: Sequence[object], inputs: Sequence[object]) -> list[T]:
        """Results in order, made where the data lie."""
        futures = [self._submit(task, (h, i)) for h, i in zip(held, inputs, strict=True)]
        found: list[T] = []
        for future in futures:
            each = _result(future)
            if isinstance(each, LostError):
                raise IvsidError(
                    f"{each}; give the workers more memory, or start more of them, and run the command again"
                )
            found.append(cast(T, each))
        return found


def _result(future: Future) -> object:
    package = extra.distributed()
    try:
        return future.result()
    except package.scheduler.KilledWorker:
        return LostError(f"the workers died that had this log, {LIVES} or more of them")


@contextmanager
def _kept(cluster: LocalCluster, number: int) -> Iterator[None]:
    """Keeps the number of workers of a local cluster.

    A nanny starts its worker again. On a busy machine that takes longer than the cluster waits, and it gives the nanny up: without this a run
    whose workers all died would wait for ever.
    """
    ended = Event()

    def look() -> None:
        while not ended.wait(WATCHED):
            cluster.scale(number)

    watch = Thread(target=look, daemon=True)
    watch.start()
    try:
        yield
    finally:
        ended.set()
        watch.join()


@contextmanager
def _answering(place: str) -> Iterator[None]:
    """Says so where the scheduler is lost: its futures are cancelled then, and nothing more is done.

    Raises:
        IvsidError: the scheduler does not answer any more.
    """
    package = extra.distributed()
    try:
        yield
    except (package.client.FutureCancelledError, package.comm.CommClosedError):
        raise IvsidError(
            f"the scheduler {place} was lost in the middle of the work; start it and its workers again, and run the command again: "
            "finished logs are not done again"
        ) from None


@contextmanager
def crew_of(scheduler: str | Client | None, workers: int | None) -> Iterator[Crew]:
    """The processes of a run, which end with the block if it started them.

    Args:
        scheduler: address of a cluster, a client of one, or None for a local cluster of its own.
        workers: number of local processes, 0 for this process alone; by default one for each processor.

    Raises:
        IvsidError: a missing package, or a cluster that does not answer, at the beginning or later.
    """
    if scheduler is None and workers == 0:
        yield Here()
        return
    package = extra.distributed()
    if scheduler is not None and not isinstance(scheduler, str):
        with _answering("of the client"):
            yield Cluster(scheduler)
        return
    with ExitStack() as stack:
        # Restarts of workers are no news to a user: the results do not change.
        # Parts of the package have levels of their own.
        parts = [n for n in logging.root.manager.loggerDict if n.startswith("distributed.")]
        for name in ("distributed", "tornado", *parts):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        if scheduler is not None:
            try:
                client = stack.enter_context(package.Client(scheduler, timeout=PATIENCE, set_as_default=False))
            except (OSError, ValueError, TimeoutError) as error:
                words = (str(error).splitlines() or [""])[0]
                raise IvsidError(
                    f"no cluster answers at {scheduler} ({words}); start one (dask scheduler, dask worker), or leave --scheduler out"
                ) from None
            if not client.scheduler_info(n_workers=-1)["workers"]:
                raise IvsidError(f"the cluster at {scheduler} has no workers; start some with dask worker {scheduler}")
        else:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-fleet-", ignore_cleanup_errors=True))
            stack.enter_context(extra.dask().config.set({"distributed.scheduler.allowed-failures": LIVES}))
            try:
                cluster = package.LocalCluster(
                    n_workers=workers or processors(),
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=":0",
                    silence_logs=logging.CRITICAL,
                    local_directory=folder,
                )
            except (RuntimeError, OSError) as error:
                words = (str(error).splitlines() or [""])[0]
                raise IvsidError(
                    f"the local processes did not start ({words}); a program of your own needs if __name__ == '__main__', and --workers 0 "
                    "works in one process"
                ) from None
            stack.enter_context(cluster)
            stack.enter_context(_kept(cluster, workers or processors()))
            client = stack.enter_context(package.Client(cluster, set_as_default=False))
        with _answering("here" if scheduler is None else f"at {scheduler}"):
            yield Cluster(client)
