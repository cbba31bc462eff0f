"""Work on several hypotheses side by side: the core and NumPy release the interpreter while they work."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import TypeVar

from ivsid.intervals.pieces import processors

_T = TypeVar("_T")
_A = TypeVar("_A")
_B = TypeVar("_B")


def side_by_side(tasks: Sequence[Callable[[], _T]]) -> list[_T]:
    """What each task gives, in their order; the first that fails raises.

    No task sees what another does, so results do not depend on the number of threads. What NumPy ignores here it ignores there.
    """
    threads = min(len(tasks), processors())
    if threads < 2:
        return [task() for task in tasks]
    with ThreadPoolExecutor(threads) as pool:
        waiting = [pool.submit(copy_context().run, task) for task in tasks]
        return [w.result() for w in waiting]


def at_once(one: Callable[[], _A], other: Callable[[], _B]) -> tuple[_A, _B]:
    """Both, of which neither needs the other."""
    if processors() < 2:
        return one(), other()
    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(copy_context().run, other)
        first = one()
        return first, waiting.result()
