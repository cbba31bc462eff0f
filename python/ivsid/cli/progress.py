"""Progress of a command on stderr: a line that changes on a terminal, elsewhere a line now and then."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread
from time import monotonic
from typing import TYPE_CHECKING, Final, TextIO

if TYPE_CHECKING:
    from ivsid.workflow.progress import Progress

# Time between two lines off a terminal [s].
# Source: resource: 120 lines an hour in the log file of a batch system
EVERY: Final = 30.0


class Watch:
    """The step of a command, the time so far, and the time left if the step is counted.

    Args:
        command: its name.
        now: a clock [s].
    """

    def __init__(self, command: str, now: Callable[[], float] = monotonic) -> None:
        self._command, self._now = command, now
        self._start = now()
        self._step = self._shown = ""
        self._first = (self._start, 0)
        self._last = (self._start, 0, 0)

    def __call__(self, step: str) -> None:
        """Takes note of a step."""
        from ivsid.workflow.progress import count  # noqa: PLC0415 - the help needs no workflow

        words, done, whole = count(step)
        moment = self._now()
        if words != self._step or whole != self._last[2] or done < self._last[1]:
            self._step, self._first = words, (moment, done)
        self._shown, self._last = step, (moment, done, whole)

    def words(self) -> str:
        """The line that is shown."""
        parts = [f"{self._command}: {self._shown}", _time(self._now() - self._start)]
        left = self._left()
        return ", ".join(parts if left is None else [*parts, f"about {_time(left)} left in this step"])

    def _left(self) -> float | None:
        """The rest of a counted step at its mean rate so far [s]."""
        (start, first), (moment, done, whole) = self._first, self._last
        if done <= first:
            return None
        rest = (moment - start) / (done - first) * (whole - done)
        return max(rest - (self._now() - moment), 0.0)


def _time(seconds: float) -> str:
    """A time as m:ss, or h:mm:ss."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02d}:{second:02d}" if hours else f"{minute}:{second:02d}"


@contextmanager
def shown(command: str, *, quiet: bool) -> Iterator[Progress]:
    """Shows what it is told on stderr while the command works; nothing if it is to be quiet."""
    watch = Watch(command)
    if quiet:
        yield watch
    elif sys.stderr.isatty():
        with _on_terminal(watch):
            yield watch
    else:
        with lines(watch, sys.stderr, EVERY):
            yield watch


@contextmanager
def _on_terminal(watch: Watch) -> Iterator[None]:
    from rich.console import Console  # noqa: PLC0415 - the help needs none of it
    from rich.live import Live  # noqa: PLC0415
    from rich.spinner import Spinner  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    spinner = Spinner("dots")

    def line() -> Spinner:
        spinner.update(text=Text(watch.words()))
        return spinner

    with Live(console=Console(stderr=True), get_renderable=line, transient=True):
        yield


@contextmanager
def lines(watch: Watch, stream: TextIO, every: float) -> Iterator[None]:
    """Writes a line to a stream each time that so many seconds [s] have passed, until the work ends."""
    ended = Event()

    def write() -> None:
        while not ended.wait(every):
            stream.write(f"ivsid {watch.words()}\n")
            stream.flush()

    writer = Thread(target=write, daemon=True)
    writer.start()
    try:
        yield
    finally:
        ended.set()
        writer.join()
