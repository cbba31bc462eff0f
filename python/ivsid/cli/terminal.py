"""Words to the terminal: names that came from files are shown, and never obeyed."""

from __future__ import annotations

import typer

from ivsid.errors import visible


def say(text: str, *, err: bool = False) -> None:
    """Prints text, each control character as an escape that shows it.

    Args:
        text: lines of a report, or a sentence.
        err: whether it goes to the standard error.
    """
    typer.echo(visible(text), err=err)
