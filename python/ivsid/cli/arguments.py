"""Options that commands share, and the values that they parse."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Final, TypeAlias

import typer

from ivsid.cli import completion
from ivsid.errors import IvsidError

# Vehicles that come with the package, in the words of the help; a test compares them with the files.
SHIPPED: Final = ("cse1", "kvlcc2", "otter", "rov30k", "swan", "vectored_rov")

# Arguments that several commands take; the name in capitals decides which kind of file is looked for (``command``).
VehicleFile: TypeAlias = Annotated[
    Path,
    typer.Argument(
        metavar="VEHICLE",
        help=f"Vehicle file (TOML), or the name of a shipped vehicle: {', '.join(SHIPPED)}.",
        autocompletion=completion.vehicles,
    ),
]
LogFile: TypeAlias = Annotated[
    Path,
    typer.Argument(metavar="LOG", help="Log: CSV, Parquet, .mat, ROS bag, DataFlash .bin, or a folder of tables."),
]
FitFile: TypeAlias = Annotated[Path, typer.Argument(metavar="FIT", help="Folder or result.json of ivsid identify.")]

Out: TypeAlias = Annotated[
    Path | None,
    typer.Option("--out", help="Folder for result.json, figures and report.html.", show_default="ivsid-COMMAND"),
]
Json: TypeAlias = Annotated[
    bool, typer.Option("--json", help="Print only the JSON of result.json on stdout: neither words nor progress.")
]
Seed: TypeAlias = Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the random numbers.")]


def window_lengths(text: str) -> float | list[float]:
    """The value of ``--window``: a length [s], or several separated by commas.

    Raises:
        IvsidError: text that is no number.
    """
    try:
        lengths = [float(part) for part in text.split(",")]
    except ValueError:
        raise IvsidError(
            f"--window {text} is not understood; write a length in seconds, 1.0, or several, 0.5,2,10"
        ) from None
    return lengths[0] if len(lengths) == 1 else lengths


def effect_numbers(text: str) -> tuple[str, list[float]]:
    """The value of ``--effect``: an id of the catalogue and its numbers, from ID=VALUE or ID=A,B.

    Raises:
        IvsidError: no number, or one that is not finite.
    """
    id_, _, values = text.partition("=")
    try:
        numbers = [float(v) for v in values.split(",")]
    except ValueError:
        numbers = []
    if not numbers or not all(map(math.isfinite, numbers)):
        raise IvsidError(
            f"--effect {text} is not understood; write ID=VALUE, for example drag.surge.linear=4, or ID=A,B for an effect of "
            "several numbers, for example current.steady=0.08,0.05"
        )
    return id_.strip(), numbers
