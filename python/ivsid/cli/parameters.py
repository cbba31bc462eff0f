"""Commands about parameter intervals: identify, verify, validate, and the model for other simulators: export."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ivsid import workflow
from ivsid.cli import completion
from ivsid.cli.arguments import FitFile, Json, LogFile, Out, VehicleFile, window_lengths
from ivsid.cli.run import run


def identify(
    vehicle: VehicleFile,
    log: LogFile,
    method: Annotated[
        str,
        typer.Option(
            "--method",
            help=f"{', '.join(completion.METHODS[:-1])} or {completion.METHODS[-1]}.",
            autocompletion=completion.methods,
        ),
    ] = "feasible",
    partitions: Annotated[
        int | None, typer.Option("--partitions", min=1, help="N of the published methods, or cells of partitioned.")
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
    bias: Annotated[
        str,
        typer.Option(
            "--bias",
            help="The accelerometer's bias: sample (a bound at every sample), log (one unknown a log) or auto (log where clearly tighter).",
        ),
    ] = "auto",
    outliers: Annotated[
        int, typer.Option("--outliers", min=0, help="Number of rows of each set of parameters that may be wrong.")
    ] = 0,
    physical: Annotated[
        bool,
        typer.Option(
            "--physical",
            help="Assume what every vessel keeps: masses of 0.5 to 10 times the hull's, a bounded yaw inertia, drags that never drive.",
        ),
    ] = False,
    out: Out = None,
    json: Json = False,
) -> None:
    """Parameter intervals.

    Example: ivsid identify boat.toml run1.csv --out fit
    """
    windows = window_lengths(window)
    run(
        "identify",
        out,
        json,
        lambda progress: workflow.identify(
            vehicle,
            log,
            method,
            partitions=partitions,
            form=form,
            rows=rows,
            window=windows,
            bias=bias,
            outliers=outliers,
            physical=physical,
            progress=progress,
        ),
    )


def verify(
    result: Annotated[
        Path, typer.Argument(metavar="RESULT", help="Folder or result.json of ivsid identify or ivsid fleet.")
    ],
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="The log that was identified; of a fleet the folder of its logs.")
    ],
    out: Out = None,
    json: Json = False,
) -> None:
    """Check the certificates of an identification or a fleet in exact arithmetic, without the core.

    Example: ivsid verify fit run1.csv
    """
    run("verify", out, json, lambda progress: workflow.verify(result, log, progress=progress))


def validate(
    fit: FitFile,
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Another log, as for identify.")],
    tubes: Annotated[
        bool | None,
        typer.Option(
            "--tubes/--no-tubes",
            help="Compare readings with the tubes of every consistent vehicle; by default for logs of moderate length.",
            show_default=False,
        ),
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Predicted against measured force and moment, simulated motion and tubes against measured motion.

    Example: ivsid validate fit run2.csv
    """
    run("validate", out, json, lambda progress: workflow.validate(fit, log, tubes=tubes, progress=progress))


def export(
    result: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL", help="Folder of ivsid identify or diagnose, or a vehicle file with numbers in its model."
        ),
    ],
    to: Annotated[str, typer.Option("--to", help="gz, vrx, mss, pvs, stonefish or yaml.")],
    out: Out = None,
    json: Json = False,
) -> None:
    """The model in the names and signs of another simulator, with its intervals.

    Example: ivsid export fit --to gz --out model
    """
    run("export", out, json, lambda progress: workflow.export(result, to, progress=progress))
