"""Text of TOML and JSON files as tables, inside stated limits: whoever wrote a file may want a fault, or a terminal that obeys it."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from typing import Final

from ivsid.errors import CONTROL, visible
from ivsid.files.processor import check_rounding

# Levels of tables and lists in each other, at most.
# Source: definition: no file of this package has ten
DEEPEST: Final = 100
TOO_DEEP: Final = f"tables or lists stand in each other more than {DEEPEST} deep"


def toml_table(text: str) -> dict[str, object]:
    """The table of a TOML text.

    Raises:
        tomllib.TOMLDecodeError: no TOML, nested too deeply, or a control character in a key or a text.
    """
    check_rounding()
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise tomllib.TOMLDecodeError(TOO_DEEP) from None
    for word in _words(table, tomllib.TOMLDecodeError):
        if found := CONTROL.search(word):
            shown = visible(word[:40])
            raise tomllib.TOMLDecodeError(f"the text '{shown}' has the control character U+{ord(found[0]):04X}")
    return table


def json_value(text: str | bytes) -> object:
    """The value of a JSON text.

    Raises:
        ValueError: no JSON, or nested too deeply.
    """
    check_rounding()
    try:
        value: object = json.loads(text)
    except RecursionError:
        raise ValueError(TOO_DEEP) from None
    for _ in _words(value, ValueError):
        pass
    return value


def _words(value: object, refusal: type[ValueError]) -> Iterator[str]:
    """All keys and texts of a value; ``refusal`` is raised where it is nested too deeply."""
    level = [value]
    for _ in range(DEEPEST):
        below: list[object] = []
        for each in level:
            if isinstance(each, dict):
                yield from each
                below += each.values()
            elif isinstance(each, list):
                below += each
            elif isinstance(each, str):
                yield each
        level = [x for x in below if isinstance(x, dict | list | str)]
        if not level:
            return
    raise refusal(TOO_DEEP)
