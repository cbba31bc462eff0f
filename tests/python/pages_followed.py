"""Pages of the docs followed in this process, in the working directory."""

import contextlib
import io
from collections.abc import Callable
from pathlib import Path

from tests.page_steps import Step, follow, steps

from command_line import run


def ivsid(words: list[str]) -> str:
    """What a command prints: stdout, or the sentence of a refusal."""
    done = run(*words)
    return done.stdout or done.stderr


def follow_page(page: Path, wanted: Callable[[Step], bool] = lambda _: True) -> int:
    """Does the steps of a page that are wanted, and returns their number; programs share their names, as in one session."""
    names: dict[str, object] = {}

    def python(text: str) -> str:
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            exec(compile(text, page.name, "exec"), names)
        return said.getvalue()

    chosen = [step for step in steps(page.read_text()) if wanted(step)]
    for step in chosen:
        follow(step, ivsid, python)
    return len(chosen)
