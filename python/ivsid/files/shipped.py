"""Vehicle and scenario files that come with the package, by the name of their vehicle."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path

from ivsid.errors import meant


def shipped(path: str | Path, suffix: str = "") -> Path:
    """The path, or that of the shipped file of this name if there is no file at the path.

    Args:
        path: of a file, or the name of a shipped vehicle or scenario.
        suffix: of the file's name behind the vehicle's: ``_programme`` for a scenario.
    """
    given = Path(path)
    if given.exists() or given.suffix or len(given.parts) != 1:
        return given
    named = _files(suffix)
    # A scenario that is called after its vehicle may be given by its own name, too.
    own = given.name.removesuffix(suffix) if suffix else given.name
    return named.get(given.name) or named.get(own, given)


def shipped_names(suffix: str = "") -> list[str]:
    """Names of the shipped vehicles, or of the shipped scenarios, which are those of their vehicles or their own."""
    return sorted(_files(suffix))


@cache
def _files(suffix: str) -> dict[str, Path]:
    """The shipped files by name: vehicle files without a suffix, scenarios with theirs. A scenario may have a name of its own."""
    folder = Path(str(files("ivsid") / "data"))
    found: dict[str, Path] = {}
    for path in folder.glob("*.toml"):
        table = tomllib.loads(path.read_text())
        if suffix and "segments" in table:
            found[path.stem.removesuffix(suffix)] = path
        elif not suffix and "hull" in table:
            found[path.stem] = path
    return found


def near_shipped(path: str | Path, suffix: str = "") -> str:
    """The question of a sentence on a path that leads nowhere and may be a misspelt name of a shipped vehicle, or nothing."""
    given = Path(path)
    return "" if given.suffix or len(given.parts) != 1 else meant(given.name, shipped_names(suffix))
