"""Threads for work on several hypotheses, while the core and NumPy release the interpreter, and a process for work that holds it."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from functools import wraps
from multiprocessing.connection import Connection
from typing import Generic, ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

from ivsid.intervals.pieces import processors

_P = ParamSpec("_P")
_T = TypeVar("_T")
_A = TypeVar("_A")
_B = TypeVar("_B")


def side_by_side(tasks: Sequence[Callable[[], _T]]) -> list[_T]:
    """Results of the tasks, in their order.

    The tasks share no state, so results do not depend on the number of threads. The floating-point settings of NumPy hold in every thread.

    Raises:
        Exception: that of the first task that fails.
    """
    threads = min(len(tasks), processors())
    if threads < 2:
        return [task() for task in tasks]
    with ThreadPoolExecutor(threads) as pool:
        waiting = [pool.submit(copy_context().run, task) for task in tasks]
        return [w.result() for w in waiting]


def at_once(one: Callable[[], _A], other: Callable[[], _B]) -> tuple[_A, _B]:
    """Results of two tasks that do not depend on each other."""
    if processors() < 2:
        return one(), other()
    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(copy_context().run, other)
        first = one()
        return first, waiting.result()


class Apart(Generic[_T]):
    """A task in a forked process: many operations on short arrays, which hold the interpreter.

    Where no process can be forked, the task is done when its result is asked for.
    """

    def __init__(self, task: Callable[[], _T]) -> None:
        self._task = task
        self._reader: Connection | None = None
        if (
            processors() < 2
            or "fork" not in multiprocessing.get_all_start_methods()
            or multiprocessing.current_process().daemon
        ):
            return
        context = multiprocessing.get_context("fork")
        self._reader, writer = context.Pipe(duplex=False)
        self._worker = context.Process(target=_sent, args=(task, writer), daemon=True)
        self._worker.start()
        writer.close()

    def result(self) -> _T:
        """The result; a task that failed is done again here, and raises what it raises."""
        if self._reader is None:
            return self._task()
        try:
            found: _T = self._reader.recv()
        except EOFError:
            found = self._task()
        finally:
            self.end()
        return found

    def end(self) -> None:
        """Ends the process, whether or not its task is done."""
        if self._reader is not None:
            self._worker.terminate()
            self._worker.join()
            self._reader.close()
            self._reader = None


def _sent(task: Callable[[], _T], writer: Connection) -> None:
    """Work of the process; nothing is sent of a task that fails."""
    try:
        writer.send(task())
    except Exception:
        writer.close()


def one_blas_thread(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """The function with one thread of BLAS.

    Its matrices are small, and its own threads and processes use the cores: threads of BLAS beside them wait for each other most of the time.
    """

    @wraps(function)
    def alone(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return alone
