"""Words that the shell completes behind a command: shipped vehicles, effects and methods, as the package knows them. A list that would take a second to load stands here.

The shell asks by running the program once for each press of the key. It is installed by ``ivsid --install-completion``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

# Methods of identification, in the words of the help; a test compares them with the package's.
METHODS: Final = (
    "feasible",
    "qr",
    "augmented",
    "exact",
    "partitioned",
    "hansen-bliek-rohn",
    "krawczyk",
    "cramer",
    "kuttler",
    "neumaier",
    "published",
    "published-hull",
)


def vehicles(incomplete: str) -> list[str]:
    """Shipped vehicles and vehicle files that begin like the word."""
    from ivsid.files.shipped import shipped_names  # noqa: PLC0415 - only a shell that asks needs it

    return [*_begins(shipped_names(), incomplete), *_files(incomplete)]


def scenarios(incomplete: str) -> list[str]:
    """Vehicles with a shipped scenario, and scenario files, that begin like the word."""
    from ivsid.files.shipped import shipped_names  # noqa: PLC0415 - likewise

    return [*_begins(shipped_names("_programme"), incomplete), *_files(incomplete)]


def effects(incomplete: str) -> list[str]:
    """Ids of the catalogue that begin like the word, with the sign behind which their numbers stand."""
    from ivsid.effects import EFFECTS  # noqa: PLC0415 - loads NumPy

    return _begins([f"{id_}=" for id_ in EFFECTS], incomplete)


def methods(incomplete: str) -> list[str]:
    """Methods of identification that begin like the word."""
    return _begins(METHODS, incomplete)


def _begins(names: list[str] | tuple[str, ...], incomplete: str) -> list[str]:
    return [n for n in names if n.startswith(incomplete)]


def _files(incomplete: str) -> list[str]:
    """TOML files and folders that the word may lead to."""
    given = Path(incomplete)
    folder = given if incomplete.endswith("/") else given.parent
    found = sorted(p for p in folder.glob("*") if p.is_dir() or p.suffix == ".toml") if folder.is_dir() else []
    return _begins([f"{p}/" if p.is_dir() else str(p) for p in found], incomplete)
