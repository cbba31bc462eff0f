"""The command about trajectories: tube."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ivsid import workflow
from ivsid.cli.arguments import FitFile, Json, Out, window_lengths
from ivsid.cli.run import run


def tube(
    fit: FitFile,
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG_OR_SCENARIO",
            help="A log, or a scenario whose demands the fit's own estimate finds. Named LOG_OR_SCENARIO in messages.",
        ),
    ],
    channels: Annotated[
        str,
        typer.Option(
            "--channels", help="all, surge (v and r as measured) or straight (v = r = 0, which is then an assumption)."
        ),
    ] = "all",
    windows: Annotated[
        str,
        typer.Option(
            "--windows", help="Lengths [s] after which a tube restarts from the measured state, beside the whole log."
        ),
    ] = "10,30",
    parts: Annotated[
        int, typer.Option("--parts", min=1, help="Equal parts of each step; more are narrower and slower.")
    ] = 1,
    cells: Annotated[
        int,
        typer.Option(
            "--cells", min=1, help="Equal parts of the interval of each parameter; more are narrower and slower."
        ),
    ] = 1,
    inner: Annotated[bool, typer.Option("--inner/--no-inner", help="Simulate extreme members beside the tube.")] = True,
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Prove each step of the whole tube once more in exact arithmetic, without the core."
        ),
    ] = False,
    out: Out = None,
    json: Json = False,
) -> None:
    """Bounds of every trajectory that the data allow, and the readings that contradict them.

    Example: ivsid tube fit run2.csv --out tube
    """
    lengths = window_lengths(windows)
    listed = [lengths] if isinstance(lengths, float) else lengths
    run(
        "tube",
        out,
        json,
        lambda progress: workflow.tube(
            fit,
            log,
            channels=channels,
            windows=listed,
            parts=parts,
            cells=cells,
            inner=inner,
            check=check,
            progress=progress,
        ),
    )
