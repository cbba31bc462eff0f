"""Threads for work on several hypotheses, while the core and NumPy release the interpreter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

from ivsid.memory.pieces import processors

_P = ParamSpec("_P")
_T = TypeVar("_T")


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


def one_blas_thread(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """The function with one thread of BLAS.

    Its matrices are small, and its own threads and processes use the cores: threads of BLAS beside them wait for each other most of the time.
    """

    @wraps(function)
    def alone(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return alone
