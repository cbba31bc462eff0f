"""Processes for work that holds the interpreter, which end with the one that started them."""

from __future__ import annotations

import gc
import multiprocessing
import os
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from threading import Thread
from typing import Final, Generic, TypeVar

from ivsid.memory.pieces import processors

_T = TypeVar("_T")
_X = TypeVar("_X")
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
        if not _forks():
            return
        context = multiprocessing.get_context("fork")
        self._reader, writer = context.Pipe(duplex=False)
        self._worker = context.Process(target=_sent, args=(task, writer, late), daemon=True)
        self._worker.start()
        writer.close()

    @property
    def done(self) -> bool:
        """Whether a process has a result or a fault that was not asked for yet."""
        return self._reader is not None and self._reader.poll()

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


class Prepared(Generic[_X, _T]):
    """A process that is forked before its task is known, while this one is small, and gets ready for it: it is a copy that costs little.

    Where no process can be forked, the task is done when its result is asked for.

    Args:
        task: what is done with what is given later.
        ready: what the process does before.
    """

    def __init__(self, task: Callable[[_X], _T], ready: Callable[[], object]) -> None:
        self._task = task
        self._given: tuple[()] | tuple[_X] = ()
        self._pipe: Connection | None = None
        self._giving: Thread | None = None
        if not _forks():
            return
        context = multiprocessing.get_context("fork")
        self._pipe, other = context.Pipe()
        self._worker = context.Process(target=_answered, args=(task, ready, other), daemon=True)
        self._worker.start()
        other.close()

    def begin(self, given: _X) -> None:
        """Gives the process what it works on, once."""
        self._given = (given,)
        if self._pipe is not None:
            # What is long waits for a process that is not ready yet, and this one does not.
            self._giving = Thread(target=_given_to, args=(self._pipe, given), daemon=True)
            self._giving.start()

    def result(self) -> _T:
        """The result; a task that failed is done again here, and raises what it raises."""
        if self._pipe is not None:
            try:
                found: _T = self._pipe.recv()
            except (EOFError, OSError):
                pass
            else:
                return found
            finally:
                self.end()
        return self._task(*self._given)

    def end(self) -> None:
        """Ends the process, whether or not its task is done."""
        if self._pipe is not None:
            self._worker.terminate()
            # What is still being given breaks off with the process.
            if self._giving is not None:
                self._giving.join()
            self._pipe.close()
            self._pipe = None


def _given_to(pipe: Connection, given: object) -> None:
    # A process that has ended is noticed where its result is asked for.
    with suppress(OSError):
        pipe.send(given)


def _answered(task: Callable[[_X], _T], ready: Callable[[], object], pipe: Connection) -> None:
    gc.freeze()
    end_with_parent()
    os.nice(GIVES_WAY)
    try:
        ready()
        pipe.send(task(pipe.recv()))
    except Exception:
        pipe.close()


def _forks() -> bool:
    """Whether a process can be forked here and has a processor of its own."""
    return (
        processors() > 1
        and "fork" in multiprocessing.get_all_start_methods()
        and not multiprocessing.current_process().daemon
    )


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
