"""Places of results, checked before any work is done."""

from __future__ import annotations

import tempfile
from pathlib import Path

from ivsid.errors import IvsidError


def check_writable(folder: str | Path) -> None:
    """Checks, before any work is done, that an output folder can be written; leaves nothing behind.

    Raises:
        IvsidError: the folder cannot be written.
    """
    folder = Path(folder)
    try:
        existing = next(p for p in (folder, *folder.absolute().parents) if p.exists())
        if not existing.is_dir():
            raise IvsidError(
                f"output folder {folder} cannot be written ({existing} is a file); choose another with --out"
            )
        with tempfile.TemporaryFile(dir=existing):
            pass
    except OSError as error:
        raise unwritable(folder, error) from None


def check_target(path: str | Path) -> None:
    """Checks, before any work is done, that a file can be written; leaves nothing behind.

    Raises:
        IvsidError: its folder cannot be written, or a folder stands in its place.
    """
    path = Path(path)
    check_writable(path.parent)
    if path.is_dir():
        raise IvsidError(f"{path} cannot be written (a folder stands in its place); name a file, or remove the folder")


def check_name(folder: Path, name: str) -> None:
    """Refuses a path that leaves its folder: names of files can come from a vehicle file or a log.

    Raises:
        IvsidError: a path that leads out of the folder.
    """
    path = Path(name)
    if path.is_absolute() or path.drive or ".." in path.parts or not path.parts or "\0" in name:
        raise IvsidError(f"a result is not written as '{name}', which lies outside {folder}; give it a plain name")


def unwritable(path: Path, error: OSError) -> IvsidError:
    """The sentence on a place that cannot be written."""
    return IvsidError(f"{path} cannot be written ({error.strerror or error}); choose another folder with --out")
