"""A process for work that holds the interpreter, which ends with the one that started it."""

from __future__ import annotations

import gc
import multiprocessing
import os
from collections.abc import Callable
from multiprocessing.connection import Connection, wait
from threading import Thread
from typing import Final, Generic, TypeVar

from ivsid.memory.pieces import processors

_T = TypeVar("_T")
# Steps by which a task whose result is asked for late gives way to others (POSIX ``nice``).
# Source: resource: it takes what time of the processors the others leave, a tenth of theirs where they leave none
GIVES_WAY: Final = 10
# Seconds between two looks at the parent.
# Source: resource: time that a process without a use goes on
LOOK: Final = 0.5


class Apart(Generic[_T]):
    """A task in a forked process: many operations on short arrays, which hold the interpreter.

    Where no process can be forked, the task is done when its result is asked for.

    Args:
        task: what is done.
        late: whether its result is asked for late, so that the task gives way to others.
    """

    def __init__(self, task: Callable[[], _T], *, late: bool = False) -> None:
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
        self._worker = context.Process(target=_sent, args=(task, writer, late), daemon=True)
        self._worker.start()
        writer.close()

    def result(self) -> _T:
        """The result; a task that failed is done again here, and raises what it raises."""
        if self._reader is None:
            return self._task()
        try:
            found: _T = self._reader.recv()
        except EOFError:
            self.end()
            return self._task()
        except BaseException:
            self.end()
            raise
        # The process has nothing left to do but to give its memory back, which takes as long as many a task: nobody waits for that. The next process
        # that is started, or the end of the program, takes its exit code.
        self._reader.close()
        self._reader = None
        return found

    def end(self) -> None:
        """Ends the process, whether or not its task is done."""
        if self._reader is not None:
            self._worker.terminate()
            self._worker.join()
            self._reader.close()
            self._reader = None


def _sent(task: Callable[[], _T], writer: Connection, late: bool) -> None:
    """Work of the process; nothing is sent of a task that fails."""
    if late:
        os.nice(GIVES_WAY)
    # A collection would write to every object of the parent, and so copy all of its memory.
    gc.freeze()
    end_with_parent()
    try:
        writer.send(task())
    except Exception:
        writer.close()


def end_with_parent() -> None:
    """Makes this process end when the one that started it is gone, however it ended: nobody waits for its results.

    Its own code need not help, as long as it lets other threads run. Linux could send a signal (``PR_SET_PDEATHSIG``), but that follows the thread
    that started the process, and a thread of a pool may end before its process does.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        Thread(target=_watch, args=(parent.sentinel, parent.pid), daemon=True).start()


def _watch(sentinel: int, parent: int | None) -> None:
    # Processes that were forked later hold the sentinel open as well; the parent's number changes with its death in any case (POSIX).
    while not wait([sentinel], LOOK) and os.getppid() == parent:
        pass
    os._exit(1)
