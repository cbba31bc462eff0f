"""Commands of the program: their help as plain text, and their files in the order that they need.

The rule of files: each argument that names a file is recognised by its content. If the order does not fit the command and exactly one other
order does, that one is taken, and a line on stderr says so. If no order fits and every file was recognised, one sentence says what was given
and what is needed. A file that is not recognised is left to its reader, which knows what is wrong with it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import typer
from typer.core import TyperArgument, TyperCommand, TyperGroup, TyperOption

from ivsid.cli import recognition
from ivsid.cli.terminal import say
from ivsid.errors import IvsidError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typer._click.core import Context

# Kinds that an argument takes, by the name under which the help shows it, and how a sentence calls it.
NEEDED: Final = {
    "VEHICLE": (frozenset({recognition.VEHICLE}), "a vehicle file"),
    "SCENARIO": (frozenset({recognition.SCENARIO}), "a scenario"),
    "LOG": (frozenset({recognition.LOG}), "a log"),
    "TRAIN": (frozenset({recognition.LOG}), "a log to look for causes in"),
    "TEST": (frozenset({recognition.LOG}), "another log"),
    "LOG_OR_SCENARIO": (frozenset({recognition.LOG, recognition.SCENARIO}), "a log or a scenario"),
    "RECORDING": (frozenset({recognition.LOG}), "a static recording"),
    "TABLE": (frozenset({recognition.LOG}), "a bollard-pull table"),
    "FIT": (frozenset({recognition.FIT}), "the result of ivsid identify"),
    "MODEL": (
        frozenset({recognition.FIT, recognition.RESULT, recognition.VEHICLE}),
        "the result of ivsid identify or diagnose, or a vehicle file with numbers in its model",
    ),
    "RESULT": (frozenset({recognition.FIT, recognition.FLEET}), "the result of ivsid identify or ivsid fleet"),
}


class Command(TyperCommand):
    """A command whose files are recognised by their content."""

    def parse_args(self, ctx: Context, args: list[str]) -> list[str]:
        """Parses the words behind the command, and puts its files in order.

        Raises:
            IvsidError: a missing argument, or files that do not fit the command.
        """
        wanted = [p for p in self.params if isinstance(p, TyperArgument) and p.required]
        try:
            rest: list[str] = super().parse_args(ctx, args)
        except typer.BadParameter as error:
            given = [ctx.params[p.name] for p in wanted if p.name in ctx.params]
            if error.param not in wanted or error.param.name in ctx.params:
                raise
            raise IvsidError(_missing(self.name or "", [_name(p) for p in wanted], given)) from None
        names = [_name(p) for p in wanted]
        if wanted and not ctx.resilient_parsing and all(n in NEEDED for n in names):
            files = _ordered(self.name or "", names, [ctx.params[p.name] for p in wanted])
            ctx.params.update(zip((p.name for p in wanted), files, strict=True))
        return rest


def plain(program: TyperGroup) -> None:
    """Marks the brackets in all help of the program as text: Rich takes ``[model]`` for a style, and prints nothing of it."""
    from rich.markup import escape  # noqa: PLC0415 - quicker to import than the rest of Rich, and still slow

    for command in (program, *program.commands.values()):
        command.help = escape(command.help or "")
        for parameter in command.params:
            if isinstance(parameter, TyperArgument | TyperOption) and parameter.help:
                parameter.help = escape(parameter.help)


def _name(argument: TyperArgument) -> str:
    return argument.metavar or (argument.name or "").upper()


def _ordered(command: str, names: Sequence[str], given: Sequence[Path]) -> list[Path]:
    """The files in the order that the command needs."""
    needed = tuple(NEEDED[n][0] for n in names)
    kinds = tuple(recognition.kinds(g) for g in given)
    if recognition.fits(kinds, needed) or not all(kinds):
        return list(given)
    order = recognition.in_order(kinds, needed)
    if order is None:
        said = "; ".join(_is(g, k, names) for g, k in zip(given, kinds, strict=True))
        raise IvsidError(f"{command} needs {_all(names)}; {said}")
    files = [given[k] for k in order]
    say(f"ivsid: taken as ivsid {command} {' '.join(map(str, files))}, by the content of the files", err=True)
    return files


def _missing(command: str, names: Sequence[str], given: Sequence[Path]) -> str:
    """The sentence on an argument that is left out: the one that no given file can be."""
    left, said = list(names), []
    for path in given:
        kinds = recognition.kinds(path) if set(names) <= NEEDED.keys() else frozenset()
        left.remove(next((n for n in left if n in NEEDED and NEEDED[n][0] & kinds), left[0]))
        said.append(_is(path, kinds, names) if kinds else f"{path} was given")
    hint = "".join(
        f"; ivsid {command} {p} {p} takes the scenario that comes with it"
        for p in given
        if left[0] == "SCENARIO" and recognition.SCENARIO in recognition.kinds(p) and not p.exists()
    )
    return (
        f"Missing argument {left[0]}: {command} needs {_all(names)}, and {'; '.join(said) or 'nothing was given'}{hint}"
    )


def _all(names: Sequence[str]) -> str:
    words = [NEEDED[n][1] if n in NEEDED else n for n in names]
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _is(path: Path, kinds: frozenset[str], names: Sequence[str]) -> str:
    """What a file is: of several kinds, those that the command takes."""
    taken = frozenset[str]().union(*(NEEDED[n][0] for n in names))
    kinds = kinds & taken or kinds
    return f"{path} is {' or '.join(sorted(kinds))}"
