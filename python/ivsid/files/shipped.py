"""Vehicle and scenario files that come with the package, by the name of their vehicle."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from pathlib import Path

from ivsid.errors import meant


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


def shipped_names(suffix: str = "") -> list[str]:
    """Names of the shipped vehicles, or of those that a shipped file with the suffix is for."""
    folder = Path(str(files("ivsid") / "data"))
    vehicles = sorted(p.stem for p in folder.glob("*.toml") if "hull" in tomllib.loads(p.read_text()))
    return [name for name in vehicles if (folder / f"{name}{suffix}.toml").exists()]


def near_shipped(path: str | Path, suffix: str = "") -> str:
    """The question of a sentence on a path that leads nowhere and may be a misspelt name of a shipped vehicle, or nothing."""
    given = Path(path)
    return "" if given.suffix or len(given.parts) != 1 else meant(given.name, shipped_names(suffix))
