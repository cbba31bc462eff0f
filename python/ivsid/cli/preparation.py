"""Commands that make or examine data: init, example, demo, simulate, allan, thrust, import."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from ivsid import workflow
from ivsid.cli import completion
from ivsid.cli.arguments import Json, Out, Seed, VehicleFile, effect_numbers
from ivsid.cli.questions import answers
from ivsid.cli.run import run
from ivsid.cli.terminal import say


def init(
    logs: Annotated[
        list[Path],
        typer.Argument(
            metavar="LOG...", help="Logs of one vehicle in one form, or folders of them; one may be static."
        ),
    ],
    out: Annotated[Path, typer.Option("--out", help="Vehicle file to write.")] = Path("boat.toml"),
    yes: Annotated[
        bool, typer.Option("--yes", help="Ask nothing: keys that no log states are marked TODO in the file.")
    ] = False,
    json: Json = False,
) -> None:
    """A commented vehicle file proposed from logs, with the questions that they leave open.

    Example: ivsid init run1.csv deck.csv --out boat.toml
    """
    asked = not (yes or json) and sys.stdin.isatty()
    made = workflow.init(logs, out, ask=answers if asked else None)
    if json:
        from ivsid.files import records  # noqa: PLC0415 - loads libraries that the help does not need

        say(records.to_json(made.record))
        return
    for line in made.lines:
        say(line)


def example(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder for the two logs, their vehicle file and the sealed truth.")
    ],
    json: Json = False,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Draws another hidden cause.")] = None,
) -> None:
    """Two logs with a hidden cause, ready for ivsid diagnose; a file apart names the cause.

    Example: ivsid example first --seed 7
    """
    run(
        "example",
        folder,
        json,
        lambda progress: workflow.example(folder, seed=seed, progress=progress),
        {"truth.json": folder / "truth" / "truth.json"},
    )


def demo(out: Out = None, json: Json = False, seed: Seed = None) -> None:
    """The paper's experiment end to end on a twin of its vehicle.

    Example: ivsid demo --out demo
    """
    run("demo", out, json, lambda progress: workflow.demo(seed=seed, progress=progress))


def simulate(
    vehicle: VehicleFile,
    scenario: Annotated[
        Path,
        typer.Argument(
            metavar="SCENARIO",
            help="Scenario file (TOML), or a shipped one: otter, vectored_rov, swan_train, ...",
            autocompletion=completion.scenarios,
        ),
    ],
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
    effect: Annotated[
        list[str] | None,
        typer.Option(
            "--effect",
            help="An effect of the catalogue with its numbers, ID=VALUE or ID=A,B; may repeat.",
            autocompletion=completion.effects,
        ),
    ] = None,
    hide: Annotated[
        int | None, typer.Option("--hide", min=0, help="Draw a hidden effect from this seed; only truth.json names it.")
    ] = None,
    effects: Annotated[
        int | None, typer.Option("--effects", min=1, max=5, help="Hide exactly so many effects at once, with --hide.")
    ] = None,
    table: Annotated[str, typer.Option("--format", help="Format of the log: csv or parquet.")] = "csv",
    truth: Annotated[
        Path | None,
        typer.Option(
            "--truth", help="File of the truth; by default OUT-truth/truth.json with --hide, else OUT/truth.json."
        ),
    ] = None,
) -> None:
    """A log with sensor noise from a known truth.

    Example: ivsid simulate otter otter --effect drag.surge.linear=4 --out run
    """
    given = dict(effect_numbers(e) for e in effect or [])
    folder = out if out is not None else Path("ivsid-simulate")
    if truth is None and hide is not None:
        # Beside the log it would lie open before whoever is to find the effect.
        truth = folder.with_name(f"{folder.name}-truth") / "truth.json"
    run(
        "simulate",
        folder,
        json,
        lambda progress: workflow.simulate(
            vehicle, scenario, seed=seed, effects=given, hide=hide, hidden=effects, table=table, progress=progress
        ),
        {} if truth is None else {"truth.json": truth},
    )


def allan(
    log: Annotated[Path, typer.Argument(metavar="RECORDING", help="Static recording (CSV or Parquet).")],
    out: Out = None,
    json: Json = False,
    columns: Annotated[
        str, typer.Option("--columns", help="Channels, separated by commas; by default every inertial one.")
    ] = "",
    time: Annotated[str | None, typer.Option("--time", help="Name of the time column [s].")] = None,
    unit: Annotated[
        str,
        typer.Option("--unit", help="Units of rates and accelerations: deg/s, deg/h, rad/s, g, mg, m/s^2; as deg/s,g."),
    ] = "",
) -> None:
    """Allan deviation per channel, noise coefficients, bounds, ready for a vehicle file.

    Example: ivsid allan deck.csv --columns ax,ay,r --unit deg/s,g
    """
    chosen, units = ([c.strip() for c in text.split(",") if c.strip()] for text in (columns, unit))
    run(
        "allan",
        out,
        json,
        lambda progress: workflow.allan(log, columns=chosen, time=time, unit=units, progress=progress),
    )


def thrust(
    table: Annotated[Path, typer.Argument(metavar="TABLE", help="Bollard-pull table (CSV or Parquet).")],
    out: Out = None,
    json: Json = False,
    demand_column: Annotated[str | None, typer.Option("--demand-column", help="Name of the demand column.")] = None,
    thrust_column: Annotated[str | None, typer.Option("--thrust-column", help="Name of the thrust column.")] = None,
    unit: Annotated[str | None, typer.Option("--unit", help="Unit of the thrust: N, kN, kgf, gf, lbf.")] = None,
) -> None:
    """Thrust models of a bollard-pull table: residuals, and which to use.

    Example: ivsid thrust bollard.csv --unit kgf
    """
    run(
        "thrust",
        out,
        json,
        lambda progress: workflow.thrust(
            table, demand_column=demand_column, thrust_column=thrust_column, unit=unit, progress=progress
        ),
    )


def import_(
    name: Annotated[str, typer.Argument(metavar="SET", help="cse1, hsva, marin, rov30k or t200.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that holds the data set.")],
    out: Out = None,
    json: Json = False,
) -> None:
    """A public data set as logs, thrust tables and a vehicle file.

    Example: ivsid import cse1 CS_EnterpriseI_archive --out cse1
    """
    run("import", out, json, lambda progress: workflow.import_set(name, folder, progress=progress))
