"""Vehicle and scenario files that come with the package, by the name of their vehicle."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path


def shipped(path: str | Path, suffix: str = "") -> Path:
    """The path, or that of the shipped file of this name if there is no file at the path.

    Args:
        path: of a file, or the name of a shipped vehicle.
        suffix: of the file's name behind the vehicle's: ``_programme`` for a scenario.
    """
    given = Path(path)
    if given.exists() or given.suffix or len(given.parts) != 1:
        return given
    found = Path(str(files("ivsid") / "data" / f"{given.name}{suffix}.toml"))
    return found if found.exists() else given
