"""The commands about trajectories: tube, plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ivsid import workflow
from ivsid.cli.arguments import FitFile, Json, Out, Seed, window_lengths
from ivsid.cli.run import run
from ivsid.errors import IvsidError


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
        str | None,
        typer.Option(
            "--channels",
            help="all, surge (v and r as measured) or straight (v = r = 0, which is then an assumption); by default all, or surge where the "
            "fit leaves parameters of the others open.",
        ),
    ] = None,
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
    yaw_cells: Annotated[
        int,
        typer.Option(
            "--yaw-cells",
            min=1,
            help="Cells of the yaw rate, at most, that a tube of all channels follows by themselves; more are narrower and slower.",
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
            yaw_cells=yaw_cells,
            inner=inner,
            check=check,
            progress=progress,
        ),
    )


def plan(
    fit: FitFile,
    narrow: Annotated[
        bool, typer.Option("--narrow", help="Narrow the widest relative interval; the default without --separate.")
    ] = False,
    separate: Annotated[
        tuple[str, str] | None,
        typer.Option("--separate", metavar="CAUSE CAUSE", help="Tell two causes of the catalogue apart."),
    ] = None,
    seconds: Annotated[
        float | None, typer.Option("--seconds", help="Length of the trial [s]; 60 for intervals, 90 for causes.")
    ] = None,
    fence: Annotated[
        float | None, typer.Option("--fence", help="Radius of the water about the start [m] that the vehicle may use.")
    ] = None,
    feedback: Annotated[
        bool,
        typer.Option(
            "--feedback/--demands",
            help="Damp the yaw rate by feedback, or give demands alone, which a tube can follow.",
        ),
    ] = False,
    window: Annotated[
        str | None,
        typer.Option("--window", help="As for identify: windows [s] by which the next log will be identified."),
    ] = None,
    rate: Annotated[float, typer.Option("--rate", help="Samples of the next log in a second [Hz].")] = 20.0,
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
) -> None:
    """The demands of a next trial that tell the most, as a scenario, with what they are predicted to reach.

    Example: ivsid plan fit --seconds 60 --fence 50 --out next
    """
    if narrow and separate:
        raise IvsidError("--narrow and --separate were both given; a trial is planned for one of them")
    run(
        "plan",
        out,
        json,
        lambda progress: workflow.plan(
            fit,
            seconds=seconds,
            separate=separate,
            fence=fence,
            feedback=feedback,
            window=None if window is None else window_lengths(window),
            rate=rate,
            seed=seed,
            progress=progress,
        ),
    )
