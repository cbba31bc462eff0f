"""Work over many rows in pieces that stay in the processor's cache, shared between threads.

An operation on a million intervals waits for memory: its operands and its result are 48 MB. On a piece of some thousand rows a whole chain
of operations runs in the cache. The core and NumPy release the interpreter while they work, so pieces run on all processors. The result
for a row does not depend on its piece, so results depend neither on the pieces nor on the threads.
"""

from __future__ import annotations

import os
from _thread import start_new_thread
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from itertools import pairwise
from queue import SimpleQueue
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from ivsid.memory.room import room

# Rows of a piece: two operands and a result of this many intervals are 0.8 MB.
# Source: resource: bounds the memory of an operation by a processor's cache
PIECE: Final = 1 << 14
_T = TypeVar("_T")
_N = TypeVar("_N", bound=np.generic)


def pieces(rows: int, size: int = 0) -> list[slice]:
    """Slices of about equal length that cover the rows from 0 up to ``rows``, none longer than ``size`` (``PIECE`` by default)."""
    count = max(1, -(-rows // (size or PIECE)))
    edges = [rows * k // count for k in range(count + 1)]
    return [slice(a, b) for a, b in pairwise(edges)]


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def over_pieces(parts: list[slice], work: Callable[[slice], _T]) -> list[_T]:
    """The result of ``work`` for each piece, in their order; an error in a piece is raised, the first in order.

    This thread takes the pieces in turn with the others, and waits for none of them to begin: where another process has the other processors, it
    does the work alone.
    """
    helpers = min(len(parts), processors()) - 1
    if helpers < 1:
        return [work(part) for part in parts]
    found: dict[int, _T] = {}
    failed: dict[int, BaseException] = {}
    left = deque(range(len(parts)))

    def share() -> None:
        while True:
            try:
                k = left.popleft()
            except IndexError:
                return
            try:
                found[k] = work(parts[k])
            except BaseException as error:
                # An interrupt is raised as well, when no thread works on the pieces any more.
                failed[k] = error

    waiting, ended = deque([share] * helpers), SimpleQueue[None]()
    for _ in range(helpers):
        # A thread of the module threading is waited for until it runs. Where none can be had, this one does all the work.
        with suppress(RuntimeError):
            start_new_thread(_helped, (waiting, ended))
    share()
    begun = helpers
    with suppress(IndexError):
        # One that begins later finds nothing to do, and holds none of the work's memory.
        while True:
            waiting.popleft()
            begun -= 1
    for _ in range(begun):
        ended.get()
    if failed:
        raise failed[min(failed)]
    return [found[k] for k in range(len(parts))]


def _helped(waiting: deque[Callable[[], None]], ended: SimpleQueue[None]) -> None:
    with suppress(IndexError):
        waiting.popleft()()
        ended.put(None)


def array_pieces(rows: int, work: Callable[[slice], NDArray[_N]]) -> NDArray[_N]:
    """The numbers of all rows, shape (rows,); ``work`` gives those of a piece."""
    first, *others = pieces(rows)
    begin = work(first)
    if not others:
        return begin
    made = room(rows, begin.dtype)
    made[first] = begin

    def fill(part: slice) -> None:
        made[part] = work(part)

    over_pieces(others, fill)
    return made


def kept(values: NDArray[_N], flags: NDArray[np.bool_]) -> NDArray[_N]:
    """The entries with a flag, ``values[flags]`` along the first axis."""
    parts = pieces(flags.size)
    if len(parts) == 1:
        return values[flags]
    ends = np.cumsum([np.count_nonzero(flags[p]) for p in parts])
    made = room((int(ends[-1]), *values.shape[1:]), values.dtype)
    for p, a, b in zip(parts, np.r_[0, ends[:-1]], ends, strict=True):
        if b > a:
            made[a:b] = values[p][flags[p]]
    return made


def any_piece(rows: int, test: Callable[[slice], bool]) -> bool:
    """Whether a test holds for some piece of the rows."""
    return any(test(part) for part in pieces(rows))
