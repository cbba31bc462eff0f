"""Processes for work that holds the interpreter, which end with the one that started them."""

from __future__ import annotations

import gc
import multiprocessing
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from multiprocessing.reduction import ForkingPickler
from threading import Thread
from typing import Final, Generic, Self, TypeVar

from ivsid.memory.pieces import processors

_T = TypeVar("_T")
_T_co = TypeVar("_T_co", covariant=True)
_X = TypeVar("_X")
# Steps by which a task whose result is asked for late gives way to others (POSIX ``nice``).
# Source: resource: it takes what time of the processors the others leave, a tenth of theirs where they leave none
GIVES_WAY: Final = 10
# Seconds between two looks at the parent.
# Source: resource: time that a process without a use goes on
LOOK: Final = 0.5


class Apart(Generic[_T_co]):
    """A task in a forked process: many operations on short arrays, which hold the interpreter.

    Where no process can be forked, the task is done when its result is asked for.

    Args:
        task: what is done.
        late: whether its result is asked for late, so that the task gives way to others, and all that its process does after it.
        begun: whether its process starts at once; ``in_turn`` starts it otherwise.
    """

    def __init__(self, task: Callable[[], _T_co], *, late: bool = False, begun: bool = True) -> None:
        self._task, self._late = task, late
        self._reader: Connection | None = None
        self._found: tuple[()] | tuple[_T_co] = ()
        if begun:
            in_turn(self)

    @property
    def done(self) -> bool:
        """Whether a process has a result or a fault that was not asked for yet."""
        return self._reader is not None and self._reader.poll()

    def result(self) -> _T_co:
        """The result, the same one however often it is asked for; a task that failed is done again here, and raises what it raises."""
        if not self._found:
            self._found = (self._received(),)
        return self._found[0]

    def _received(self) -> _T_co:
        if self._reader is None:
            return self._task()
        try:
            found: _T_co = self._reader.recv()
        except (EOFError, OSError):
            # A process that is ended while it sends leaves a part of its result.
            self._close()
            return self._task()
        except BaseException:
            self.end()
            raise
        # The process may have other tasks, or nothing left to do but to give its memory back, which takes as long as many a task: nobody waits for that.
        # The next process that is started, or the end of the program, takes its exit code.
        self._close()
        return found

    def end(self) -> None:
        """Ends the process, whether or not its task is done; tasks that it had beside are done where their results are asked for."""
        if self._reader is not None:
            self._worker.terminate()
            self._worker.join()
            self._close()

    def drop(self) -> None:
        """Says that nobody will ask for the result; the process goes on with the tasks that it has beside."""
        self._close()

    def _begin(self, worker: BaseProcess, reader: Connection) -> None:
        self._worker, self._reader = worker, reader

    def _close(self) -> None:
        if self._reader is not None:
            self._reader.close()
            self._reader = None


def in_turn(*tasks: Apart[object]) -> None:
    """Starts one process for several tasks, in the order in which their results are asked for.

    A process is a copy: what either side changes later is copied page by page, which costs as much as a short task.
    """
    if not forks():
        return
    context = multiprocessing.get_context("fork")
    pipes = [context.Pipe(duplex=False) for _ in tasks]
    jobs = [(t._task, *pipe, t._late) for t, pipe in zip(tasks, pipes, strict=True)]
    worker = context.Process(target=_sent, args=(jobs,), daemon=True)
    worker.start()
    for task, (reader, writer) in zip(tasks, pipes, strict=True):
        writer.close()
        task._begin(worker, reader)


class Prepared(Generic[_X, _T]):
    """A process that is forked before its tasks are known, while this one is small, and gets ready for them: it is a copy that costs little.

    Where no process can be forked, a task is done when its result is asked for.

    Args:
        task: what is done with each of what is given later.
        pipe: to a process that does it, or None.
        worker: the process that this one has forked for it, if any.
    """

    def __init__(self, task: Callable[[_X], _T], pipe: Connection | None, worker: BaseProcess | None) -> None:
        self._task, self._pipe, self._worker = task, pipe, worker
        self._given = 0
        self._found: list[_T] = []
        self._giving: Thread | None = None

    @classmethod
    def some(cls, count: int, task: Callable[[_X], _T], ready: Callable[[], object]) -> list[Self]:
        """Several processes: one gets ready, and the others are copies of it.

        Args:
            count: how many.
            task: what each does with each of what is given later.
            ready: what is done before.
        """
        if not forks():
            return [cls(task, None, None) for _ in range(count)]
        context = multiprocessing.get_context("fork")
        pipes = [context.Pipe() for _ in range(count)]
        worker = context.Process(target=_answered, args=(task, ready, pipes), daemon=True)
        worker.start()
        for _, other in pipes:
            other.close()
        return [cls(task, own, None if k else worker) for k, (own, _) in enumerate(pipes)]

    def begin(self, given: _X) -> Callable[[], _T]:
        """Gives the process what it works on next.

        Returns:
            What asks for the result, once; a task that failed, or that cannot be sent, is done here, and raises what it raises.
        """
        if self._pipe is None:
            return partial(self._task, given)
        try:
            sent = ForkingPickler.dumps(given)
        except Exception:
            return partial(self._task, given)
        # What is long waits for a process that is not ready yet, and this one does not.
        self._giving = Thread(target=_given_to, args=(self._pipe, sent, self._giving), daemon=True)
        self._giving.start()
        self._given += 1
        return partial(self._result, self._given, given)

    def _result(self, number: int, given: _X) -> _T:
        while self._pipe is not None and len(self._found) < number:
            try:
                self._found.append(self._pipe.recv())
            except (EOFError, OSError):
                self.end()
        return self._found[number - 1] if number <= len(self._found) else self._task(given)

    def end(self) -> None:
        """Ends the process, whether or not its tasks are done; its copies end soon after it."""
        if self._pipe is not None:
            if self._worker is not None:
                self._worker.terminate()
            # What is still being given breaks off with the process.
            if self._giving is not None:
                self._giving.join()
            self._pipe.close()
            self._pipe = None


def _given_to(pipe: Connection, given: memoryview, before: Thread | None) -> None:
    if before is not None:
        before.join()
    # A process that has ended is noticed where its result is asked for.
    with suppress(OSError):
        pipe.send_bytes(given)


def _answered(
    task: Callable[[_X], _T], ready: Callable[[], object], pipes: Sequence[tuple[Connection, Connection]]
) -> None:
    gc.freeze()
    os.nice(GIVES_WAY)
    for other, _ in pipes:
        # The end of the parent alone says whether somebody gives tasks.
        other.close()
    own, *others = (pipe for _, pipe in pipes)
    first, parent = os.getpid(), None
    with suppress(Exception):
        ready()
        for pipe in others:
            # The process has no thread yet: a copy would lack it.
            if os.fork() == 0:
                own, parent = pipe, first
                break
    end_with_parent(parent)
    for _, pipe in pipes:
        if pipe is not own:
            pipe.close()
    # Nothing more is given, or a task failed.
    with suppress(Exception), own:
        while True:
            own.send(task(own.recv()))


def forks() -> bool:
    """Whether a process can be forked here and has a processor of its own."""
    return (
        processors() > 1
        and "fork" in multiprocessing.get_all_start_methods()
        and not multiprocessing.current_process().daemon
    )


def _sent(jobs: Sequence[tuple[Callable[[], object], Connection, Connection, bool]]) -> None:
    """Work of the process; nothing is sent of a task that fails."""
    # A collection would write to every object of the parent, and so copy all of its memory.
    gc.freeze()
    end_with_parent()
    for _, reader, _, _ in jobs:
        # The end of the parent alone says whether somebody asks for a result.
        reader.close()
    given_way = False
    for task, _, writer, late in jobs:
        if late and not given_way:
            os.nice(GIVES_WAY)
            given_way = True
        try:
            found = ForkingPickler.dumps(task())
        except Exception:
            # An end that closes without a result says that the task failed.
            writer.close()
        else:
            # What is long waits in its pipe until it is asked for, and the next task does not wait for that.
            Thread(target=_delivered, args=(writer, found)).start()


def _delivered(writer: Connection, found: memoryview) -> None:
    # Nobody may ask for it.
    with suppress(OSError), writer:
        writer.send_bytes(found)


def end_with_parent(started: int | None = None) -> None:
    """Makes this process end when the one that started it is gone, however it ended: nobody waits for its results.

    Its own code need not help, as long as it lets other threads run. Linux could send a signal (``PR_SET_PDEATHSIG``), but that follows the thread
    that started the process, and a thread of a pool may end before its process does.

    Args:
        started: number of the process that started this one, where multiprocessing did not.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        Thread(target=_watch, args=(parent.sentinel, started or parent.pid), daemon=True).start()


def _watch(sentinel: int, parent: int | None) -> None:
    # Processes that were forked later hold the sentinel open as well; the parent's number changes with its death in any case (POSIX).
    while not wait([sentinel], LOOK) and os.getppid() == parent:
        pass
    os._exit(1)
