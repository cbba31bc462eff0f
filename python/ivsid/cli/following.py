"""The command about a log as it comes: follow."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic, sleep
from typing import TYPE_CHECKING, Annotated

import typer

from ivsid import workflow
from ivsid.cli.arguments import Json, LogFile, Out, VehicleFile, window_lengths
from ivsid.cli.run import run
from ivsid.cli.terminal import say
from ivsid.errors import IvsidError

if TYPE_CHECKING:
    from rich.table import Table

    from ivsid.identification import Moment
    from ivsid.report.page import Report
    from ivsid.workflow.progress import Progress


def follow(
    vehicle: VehicleFile,
    log: LogFile,
    live: Annotated[
        bool,
        typer.Option(
            "--live", help="Show the intervals as they narrow: a table on a terminal, elsewhere a line each time."
        ),
    ] = False,
    every: Annotated[
        float | None,
        typer.Option("--every", help="Time of the log between two moments that are shown [s]; by default a twentieth."),
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option("--speed", help="Seconds of the log in a second, with --live; by default as fast as possible."),
    ] = None,
    wait: Annotated[
        float | None,
        typer.Option(
            "--wait",
            help="Follow a CSV log that is still being written, with --live: it ends after this time without a new row [s], or by Ctrl-C.",
        ),
    ] = None,
    drift: Annotated[
        list[str] | None,
        typer.Option(
            "--drift",
            metavar="ID=RATE",
            help="Most change of a parameter in its unit a second; the others are constant. May repeat.",
        ),
    ] = None,
    changes: Annotated[
        float | None,
        typer.Option(
            "--changes", help="Compare windows of this length [s], and prove where parameters changed between them."
        ),
    ] = None,
    form: Annotated[
        str, typer.Option("--form", help="total, or added: the rigid-body mass is known and left out.")
    ] = "total",
    rows: Annotated[
        str, typer.Option("--rows", help="auto, pointwise, integral, weak (from a pose) or both: every kind.")
    ] = "auto",
    window: Annotated[
        str, typer.Option("--window", help="Length of integral rows [s], or several at once: 0.5,2,10.")
    ] = "1.0",
    physical: Annotated[
        bool, typer.Option("--physical", help="Assume what every vessel keeps, as for identify.")
    ] = False,
    start: Annotated[
        float | None,
        typer.Option("--start", help="Most size of any parameter in its unit, an assumption; 1e12 by default."),
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Parameter intervals row by row, as a vehicle's computer has them, in bounded memory.

    Example: ivsid follow boat.toml run1.csv --live
    """
    if speed is not None and not (live and speed > 0):
        raise IvsidError(
            f"--speed {speed:g} is not possible; give seconds of the log in a second, above 0, with --live"
        )
    if wait is not None and not (live and speed is None and 0 < wait < float("inf")):
        raise IvsidError(
            f"--wait {wait:g} is not possible; give the seconds without a new row after which the log has ended, above 0, with --live and without --speed"
        )
    rates = dict(_rate(text) for text in drift or ())
    windows = window_lengths(window)

    def work(progress: Progress) -> Report:
        # The table on the terminal ends before the lines of the report are printed.
        with _watching(live and not json, speed) as watch:
            return workflow.follow(
                vehicle,
                log,
                form=form,
                rows=rows,
                window=windows,
                physical=physical,
                start=start,
                drift=rates,
                changes=changes,
                every=every,
                wait=wait,
                watch=watch,
                say=lambda text: say(text, err=True),
                progress=progress,
            )

    run("follow", out, json, work, quiet=live)


def _rate(text: str) -> tuple[str, float]:
    """A parameter and its rate, from ID=RATE."""
    id_, _, value = text.partition("=")
    try:
        return id_.strip(), float(value)
    except ValueError:
        raise IvsidError(
            f"--drift {text} is not understood; write ID=RATE, for example drag.surge.linear=0.01"
        ) from None


@contextmanager
def _watching(live: bool, speed: float | None) -> Iterator[Callable[[Moment], None]]:
    """Shows each moment, at the speed that is asked for."""
    if not live:
        yield lambda _: None
        return
    began: list[tuple[float, float]] = []

    def wait(moment: Moment) -> None:
        if speed is not None:
            began.append((monotonic(), moment.time))
            sleep(max((moment.time - began[0][1]) / speed - (monotonic() - began[0][0]), 0.0))

    if not sys.stdout.isatty():

        def told(moment: Moment) -> None:
            wait(moment)
            say(_line(moment))

        yield told
        return
    from rich.console import Console  # noqa: PLC0415 - the help needs none of it
    from rich.live import Live  # noqa: PLC0415

    with Live(console=Console(), auto_refresh=False) as screen:

        def drawn(moment: Moment) -> None:
            wait(moment)
            screen.update(_table(moment), refresh=True)

        yield drawn


def _line(moment: Moment) -> str:
    """A moment on one line."""
    from ivsid.intervals import shown  # noqa: PLC0415 - likewise

    if not moment.parameters:
        return f"{moment.time:.6g} s: no parameters explain the {moment.rows} rows so far"
    each = (f"{id_} {shown(p.lower, p.upper, 4)}" for id_, p in moment.parameters.items())
    return f"{moment.time:.6g} s, {moment.rows} rows: {'; '.join(each)}"


def _table(moment: Moment) -> Table:
    """A moment as a table."""
    from rich.table import Table  # noqa: PLC0415 - likewise
    from rich.text import Text  # noqa: PLC0415 - likewise

    from ivsid.intervals import shown  # noqa: PLC0415 - likewise

    table = Table(title=f"{moment.time:.6g} s, {moment.rows} rows")
    for name in ("parameter", "interval", "unit"):
        table.add_column(name)
    for id_, p in moment.parameters.items():
        # Brackets would be taken for a style.
        table.add_row(*map(Text, (id_, shown(p.lower, p.upper), p.unit)))
    return table
