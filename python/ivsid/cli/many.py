"""The command about many logs: fleet."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ivsid import workflow
from ivsid.cli import completion
from ivsid.cli.arguments import SHIPPED, Json, Seed, window_lengths
from ivsid.cli.progress import shown
from ivsid.cli.run import run
from ivsid.cli.terminal import say

if TYPE_CHECKING:
    from ivsid.report.page import Report
    from ivsid.workflow.progress import Progress


def fleet(
    logs: Annotated[
        list[str],
        typer.Argument(
            metavar="LOG...",
            help="Logs of one vehicle: files, folders of logs, patterns, or URLs (s3://bucket/season).",
        ),
    ],
    vehicle: Annotated[
        Path,
        typer.Option(
            "--vehicle",
            help=f"Vehicle file (TOML), or the name of a shipped vehicle: {', '.join(SHIPPED)}.",
            autocompletion=completion.vehicles,
        ),
    ],
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", help="Address of a cluster of Dask, tcp://host:8786; by default one is started here."
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            min=0,
            help="Number of local processes; 0 for this one alone.",
            show_default="one for each processor",
        ),
    ] = None,
    no_diagnose: Annotated[bool, typer.Option("--no-diagnose", help="Identify alone.")] = False,
    form: Annotated[str, typer.Option("--form", help="As for identify: total or added.")] = "total",
    rows: Annotated[
        str, typer.Option("--rows", help="As for identify: auto, pointwise, integral, weak or both.")
    ] = "auto",
    window: Annotated[
        str, typer.Option("--window", help="As for identify: length of integral rows [s], or several.")
    ] = "1.0",
    null_logs: Annotated[
        int,
        typer.Option(
            "--null-logs", min=0, help="As for diagnose, for each log; 0: theory alone, which names more than is there."
        ),
    ] = 400,
    out: Annotated[
        str | None,
        typer.Option("--out", help="Folder or URL for the results and the finished logs.", show_default="ivsid-fleet"),
    ] = None,
    json: Json = False,
    seed: Seed = None,
) -> None:
    """What many logs of a vehicle say, one by one and together, and what changed between them. A second run does finished logs no more.

    Example: ivsid fleet season/ --vehicle boat.toml --out fleet
    """
    folder = "ivsid-fleet" if out is None else out
    windows = window_lengths(window)

    def work(progress: Progress) -> Report:
        return workflow.fleet(
            logs,
            vehicle,
            folder,
            scheduler=scheduler,
            workers=workers,
            diagnose=not no_diagnose,
            form=form,
            rows=rows,
            window=windows,
            seed=seed,
            null_logs=null_logs,
            progress=progress,
        )

    if "://" not in folder:
        run("fleet", Path(folder), json, work)
        return
    from ivsid.files import records  # noqa: PLC0415 - the help needs none of these
    from ivsid.fleets import places  # noqa: PLC0415
    from ivsid.report import page  # noqa: PLC0415

    with shown("fleet", quiet=json) as progress:
        report = work(progress)
        files: Mapping[str, str | bytes] = page.content(report)
        # The result comes last: where it stands, all others do.
        for name in sorted(files, key=lambda n: n == "result.json"):
            data = files[name]
            places.write_bytes(places.below(folder, name), data.encode() if isinstance(data, str) else data)
    if json:
        say(records.to_json(report.record))
        return
    for line in (report.summary, *report.lines):
        say(line)
    say(f"written to {folder}/ (report.html, result.json, {len(report.files)} tables)")
