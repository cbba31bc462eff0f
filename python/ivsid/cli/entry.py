"""The entry point: exit codes, and one sentence in place of a traceback."""

from __future__ import annotations

import sys
import warnings

import typer

from ivsid.cli.application import program
from ivsid.cli.terminal import say
from ivsid.errors import IvsidError


def main() -> None:
    """Runs the command that the arguments name, and exits: 0 done, 1 internal fault, 2 unusable input, 130 interrupted."""
    # Overflow on the way to a refusal is reported by the refusal; NumPy's warning would be a second sentence.
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    try:
        code = program().main(standalone_mode=False)
    except typer.Abort:
        code = 130
    except typer.TyperException as error:
        if words := _usage(error):
            say(f"ivsid: {words} (ivsid --help shows what is possible)", err=True)
        code = 2
    except IvsidError as error:
        say(f"ivsid: {error}", err=True)
        code = 2
    except BrokenPipeError:
        code = 0
    except (KeyboardInterrupt, EOFError):
        code = 130
    except MemoryError:
        say("ivsid: not enough memory for this input; give a shorter log", err=True)
        code = 2
    except Exception as error:
        say(
            f"ivsid: an internal fault, {type(error).__name__}: {error}; please report it with the command and its files",
            err=True,
        )
        code = 1
    sys.exit(code if isinstance(code, int) else 0)


def _usage(error: typer.TyperException) -> str:
    """Typer's words on wrong usage, on one line."""
    words = error.format_message() if hasattr(error, "format_message") else str(error)
    return " ".join(words.split())
