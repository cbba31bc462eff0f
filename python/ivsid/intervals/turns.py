"""Tasks that this process and a copy of it take in turn, where threads would wait for the interpreter."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from contextvars import ContextVar
from functools import partial
from multiprocessing.reduction import ForkingPickler
from typing import TypeVar

from ivsid.intervals.apart import Apart

_T = TypeVar("_T")
# Objects that results refer to, while those of one call are read.
_common: ContextVar[Sequence[object]] = ContextVar("_common")


def in_turns(tasks: Sequence[Callable[[], _T]], common: Sequence[object] = ()) -> list[_T]:
    """Results of the tasks, in their order: each side takes the next task when it has done one.

    A task that fails, or whose result cannot be sent, is done again here, and raises what it raises; the first in order does.

    Args:
        tasks: at most 256, since a ticket is one byte.
        common: objects of which results refer to one instance, as to effects with functions that cannot be sent.

    Raises:
        ValueError: more tasks.
    """
    tickets = bytes(range(len(tasks)))
    reader, writer = os.pipe()
    try:
        # A read of one byte takes a ticket from both processes at once.
        with os.fdopen(writer, "wb") as into:
            into.write(tickets)
        other = Apart(partial(_sent, tasks, reader, common))
        found: dict[int, _T] = _taken(tasks, reader)
        token = _common.set(common)
        try:
            found |= {k: ForkingPickler.loads(result) for k, result in other.result().items()}
        finally:
            _common.reset(token)
    finally:
        os.close(reader)
    return [found[k] if k in found else task() for k, task in enumerate(tasks)]


def _taken(tasks: Sequence[Callable[[], _T]], reader: int) -> dict[int, _T]:
    """Results of the tasks that were left, by index; failures are none."""
    found = {}
    while ticket := os.read(reader, 1):
        try:
            found[ticket[0]] = tasks[ticket[0]]()
        except Exception:
            # It is done again where it can raise in its turn.
            continue
    return found


def _sent(tasks: Sequence[Callable[[], object]], reader: int, common: Sequence[object]) -> dict[int, bytes]:
    """Results of the tasks that were left, as bytes, by index; the address of a common object is the same on both sides."""
    places = {id(one): k for k, one in enumerate(common)}
    found = {}
    for k, result in _taken(tasks, reader).items():
        into = io.BytesIO()
        # What cannot be sent is done again on the other side, whatever the reason.
        with suppress(Exception):
            _Sending(into, places).dump(result)
            found[k] = into.getvalue()
    return found


def _of_common(place: int) -> object:
    """A common object by its number, where results are read."""
    return _common.get()[place]


class _Sending(ForkingPickler):
    """Writes results with common objects as their numbers."""

    def __init__(self, into: io.BytesIO, places: Mapping[int, int]) -> None:
        super().__init__(into)
        self._places = places

    def reducer_override(self, obj: object) -> tuple[Callable[[int], object], tuple[int]]:
        place = self._places.get(id(obj))
        return NotImplemented if place is None else (_of_common, (place,))
