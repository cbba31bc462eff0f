"""Commands about what the simulation gets wrong: diagnose, isolability."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ivsid import workflow
from ivsid.cli import completion
from ivsid.cli.arguments import SHIPPED, Json, Out, Seed, VehicleFile
from ivsid.cli.run import run


def diagnose(
    vehicle: Annotated[
        Path,
        typer.Argument(
            metavar="VEHICLE",
            help=f"Vehicle file (TOML) with the simulation's [model], or the name of a shipped vehicle: {', '.join(SHIPPED)}.",
            autocompletion=completion.vehicles,
        ),
    ],
    train: Annotated[Path, typer.Argument(metavar="TRAIN", help="Log in which causes are looked for.")],
    test: Annotated[
        Path,
        typer.Argument(
            metavar="TEST", help="Log of another run, which may refuse a cause, and on which the better model is tried."
        ),
    ],
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
    null_logs: Annotated[
        int,
        typer.Option(
            "--null-logs",
            min=0,
            help="Simulated null logs that a finding or structure close to its threshold has to pass, at most; 0: theory alone.",
        ),
    ] = 400,
    no_cache: Annotated[bool, typer.Option("--no-cache", help="Neither read nor keep what null logs gave.")] = False,
) -> None:
    """Causes of the simulation's errors, the extended model, and its gain on the other log.

    Example: ivsid diagnose boat.toml run1.csv run2.csv --out causes
    """
    run(
        "diagnose",
        out,
        json,
        lambda progress: workflow.diagnose(
            vehicle, train, test, seed=seed, null_logs=null_logs, cache=not no_cache, progress=progress
        ),
    )


def isolability(
    vehicle: VehicleFile,
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG_OR_SCENARIO",
            help="A log, or a scenario (TOML) that is simulated; otter or vectored_rov for a shipped one.",
        ),
    ],
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
) -> None:
    """Causes that a programme can detect and tell apart, and the manoeuvre that would help.

    Example: ivsid isolability boat.toml run1.csv
    """
    run("isolability", out, json, lambda progress: workflow.isolability(vehicle, log, seed=seed, progress=progress))
