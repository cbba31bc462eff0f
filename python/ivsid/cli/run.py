"""One command: its folder is checked, its work done, its results written whole and printed."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ivsid.cli.progress import shown
from ivsid.cli.terminal import say
from ivsid.errors import IvsidError

if TYPE_CHECKING:
    from ivsid.report.page import Report
    from ivsid.workflow.progress import Progress


def run(
    command: str,
    out: Path | None,
    json: bool,
    work: Callable[[Progress], Report],
    apart: Mapping[str, Path] | None = None,
    *,
    quiet: bool = False,
) -> None:
    """Runs a command.

    Args:
        command: its name, which also names the folder where none is given.
        out: the folder of the results; it is checked before any work.
        json: print the JSON of result.json and nothing else.
        work: makes the report, telling each step to its argument.
        apart: files of the report that are written elsewhere, by name.
        quiet: no progress, since the work shows itself.

    Raises:
        IvsidError: a folder that cannot be written, or unusable input.
    """
    with _loading():
        # Imports of a second or two wait until a command runs; the help needs none of them.
        from ivsid import effects, workflow  # noqa: PLC0415
        from ivsid.files import places, records  # noqa: PLC0415
        from ivsid.report import page  # noqa: PLC0415

        # A command is loaded when it is first asked for.
        getattr(workflow, command, None)
    apart = apart or {}
    folder = out if out is not None else Path(f"ivsid-{command}")
    places.check_writable(folder)
    own = (folder / "result.json", folder / "report.html")
    for place in (*own, *apart.values()):
        places.check_target(place)
    for name, place in apart.items():
        if place.resolve() in {p.resolve() for p in own}:
            raise IvsidError(f"{place} is a file of the results themselves; name another one for {name}")
    with shown(command, quiet=json or quiet) as progress:
        report = work(progress)
        report = replace(report, record=records.with_own_effects(report.record, effects.own_files()))
        page.write(report, folder, apart)
    if json:
        say(records.to_json(report.record))
        return
    for line in (report.summary, *report.lines):
        say(line)
    for name, place in apart.items():
        say(f"  {name} stands apart: {place}")
    count = len(report.drawings)
    figures = f", {count} figure{'s' * (count > 1)}" if count else ""
    say(f"written to {folder}/ (report.html, result.json{figures})")


@contextmanager
def _loading() -> Iterator[None]:
    """Modules that are loaded here stay as long as the program: the collector of garbage looks at none of them, neither later nor at the end."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
