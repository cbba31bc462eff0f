"""The program ``ivsid``: its commands, in the order of the help, and the options that stand before a command."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ivsid.cli.causes import diagnose, isolability
from ivsid.cli.parameters import export, identify, validate, verify
from ivsid.cli.preparation import allan, demo, import_, simulate, thrust

app = typer.Typer(
    name="ivsid",
    help="Guaranteed system identification for unmanned marine vehicles.",
    no_args_is_help=True,
    add_completion=False,
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


app.command()(demo)
app.command()(simulate)
app.command()(allan)
app.command()(thrust)
app.command()(identify)
app.command()(verify)
app.command()(validate)
app.command()(diagnose)
app.command()(isolability)
app.command()(export)
app.command("import")(import_)
