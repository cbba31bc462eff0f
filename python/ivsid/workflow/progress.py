"""Progress of a command: a function that is told each step.

A step is a few words. If they have the form ``WORDS K of N`` or ``WORDS K of N: NAME``, so much of the step is done, and whoever shows it
can say how long the rest takes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final, TypeAlias

Progress: TypeAlias = Callable[[str], None]

COUNTED: Final = re.compile(r"(.*?) (\d+) of (\d+)(: .*)?")


def silent(_: str) -> None:
    """Progress that is shown to nobody."""


def count(step: str) -> tuple[str, int, int]:
    """The step without its count, the share that is done and the whole; both 0 where nothing is counted."""
    found = COUNTED.fullmatch(step)
    return (step, 0, 0) if found is None else (found[1], int(found[2]), int(found[3]))
