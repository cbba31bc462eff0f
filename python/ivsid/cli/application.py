"""The program ``ivsid``: its commands, in the order of the help, and the options that stand before a command."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperGroup

from ivsid.cli.causes import diagnose, isolability
from ivsid.cli.command import Command, plain
from ivsid.cli.following import follow
from ivsid.cli.many import fleet
from ivsid.cli.parameters import export, identify, validate, verify
from ivsid.cli.preparation import allan, demo, example, import_, init, simulate, thrust
from ivsid.cli.progress import EVERY
from ivsid.cli.trajectories import plan, tube

# Groups of the help, by task.
FIRST, MEASURED, SIMULATION, INTERVALS, CAUSES, MANY = (
    "First steps",
    "Sensors and thrusters",
    "Simulation",
    "Parameters",
    "Causes of errors",
    "Many logs",
)

# The help of the program, by paragraphs.
HELP = (
    "Guaranteed system identification for unmanned marine vehicles.",
    "First steps: ivsid example DIR, then ivsid diagnose DIR/boat.toml DIR/run1.csv DIR/run2.csv. With a log of your own: ivsid init LOG. "
    "Each command has an example: ivsid COMMAND --help.",
    "Files may stand in another order where their content tells which is which.",
    "On a terminal, progress shows the time so far, and the time left where the work is counted. "
    f"Otherwise stderr gets a line every {EVERY:g} s. There is none with --json.",
    "Exit codes: 0 done, 1 internal fault, 2 wrong usage or unusable input, 130 interrupted.",
)

app = typer.Typer(
    name="ivsid",
    help="\n\n".join(HELP),
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version  # noqa: PLC0415 - slow to import, and only this option needs it

        typer.echo(f"ivsid {version('ivsid')}")
        raise typer.Exit


@app.callback()
def _root(
    _version_wanted: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    own: Annotated[
        list[Path] | None,
        typer.Option(
            "--own-effects",
            metavar="FILE",
            help="Python file with effects of your own, for every command; it is run. Stands before the command; may repeat.",
        ),
    ] = None,
) -> None:
    """Options of every command."""
    if own:
        from ivsid.effects import read_effects  # noqa: PLC0415 - loads NumPy and Pydantic, which the help does not need

        for path in own:
            read_effects(path)


app.command(cls=Command, rich_help_panel=FIRST, no_args_is_help=True)(example)
app.command(cls=Command, rich_help_panel=FIRST, no_args_is_help=True)(init)
app.command(cls=Command, rich_help_panel=FIRST)(demo)
app.command("import", cls=Command, rich_help_panel=FIRST, no_args_is_help=True)(import_)
app.command(cls=Command, rich_help_panel=MEASURED, no_args_is_help=True)(allan)
app.command(cls=Command, rich_help_panel=MEASURED, no_args_is_help=True)(thrust)
app.command(cls=Command, rich_help_panel=SIMULATION, no_args_is_help=True)(simulate)
app.command(cls=Command, rich_help_panel=INTERVALS, no_args_is_help=True)(identify)
app.command(cls=Command, rich_help_panel=INTERVALS, no_args_is_help=True)(follow)
app.command(cls=Command, rich_help_panel=INTERVALS, no_args_is_help=True)(verify)
app.command(cls=Command, rich_help_panel=INTERVALS, no_args_is_help=True)(validate)
app.command(cls=Command, rich_help_panel=INTERVALS, no_args_is_help=True)(tube)
app.command(cls=Command, rich_help_panel=INTERVALS, no_args_is_help=True)(plan)
app.command(cls=Command, rich_help_panel=SIMULATION, no_args_is_help=True)(export)
app.command(cls=Command, rich_help_panel=CAUSES, no_args_is_help=True)(diagnose)
app.command(cls=Command, rich_help_panel=CAUSES, no_args_is_help=True)(isolability)
app.command(cls=Command, rich_help_panel=MANY, no_args_is_help=True)(fleet)


def program() -> TyperGroup:
    """The program with all commands, as Typer runs it."""
    made = typer.main.get_command(app)
    assert isinstance(made, TyperGroup)
    plain(made)
    return made
