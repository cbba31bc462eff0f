"""Files that are written whole or not at all, alone or together; a run that was killed is cleared up by the next one.

Each folder gets a hidden staging folder beside its files, on the same file system. Its name tells how far the work is:

- ``.ivsid-stage-*``: new files are being written. Nothing of the results has changed; whoever finds it abandoned removes it.
- ``.ivsid-commit-*``: all new files are complete and every target was checked. The renaming of the staging folder is the moment at which the
  results change. An abandoned one is carried out to its end.
- ``.ivsid-undo-*``: a rename failed. The old files are on their way back; an abandoned one is carried out to its end.

The guarantee: a file is the old one or the new one, whole. A run that ends by itself (done, refused, disk full, Ctrl-C) leaves all files old or all
new; a Ctrl-C waits until the files are written. After a SIGKILL or a power cut between the first rename and the last one, some thousandths of a
second, a folder can hold both kinds until the next run writes into it. A folder that was made for the results is seen only empty, or with whole files.

An owner holds a lock on its staging folder that the system drops when the owner dies, however that happened: nothing of a living run is touched.
"""

from __future__ import annotations

import os
import shutil
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Final

from ivsid.errors import IvsidError
from ivsid.files.owned import exclusive, owned
from ivsid.files.places import check_name, check_writable, unwritable

STAGE: Final = ".ivsid-stage-"
COMMIT: Final = ".ivsid-commit-"
UNDO: Final = ".ivsid-undo-"
# Parts of a staging folder: new files, old ones, and the names of those that did not exist.
NEW, OLD, NONE = "new", "old", "none"
LOCK: Final = "owner"


def write_whole(path: str | Path, data: str | bytes) -> None:
    """Writes a file by renaming a finished one over it, so that no reader sees half of it.

    Raises:
        IvsidError: the path cannot be written.
    """
    path = Path(path)
    write_together({path.parent: {path.name: data}})


def write_folder(folder: str | Path, files: Mapping[str, str | bytes]) -> None:
    """Writes all files of a result or, where one cannot be written, none.

    Args:
        folder: made where it does not exist.
        files: content by path below the folder.

    Raises:
        IvsidError: the folder or one of its files cannot be written.
    """
    write_together({Path(folder): files})


def write_together(folders: Mapping[Path, Mapping[str, str | bytes]]) -> None:
    """Writes the files of several folders or, where one cannot be written, none; the folders change in their order.

    Args:
        folders: content by path below each folder; folders are made where they do not exist.

    Raises:
        IvsidError: a folder or a file cannot be written, or a path that leaves its folder.
    """
    for folder in folders:
        check_writable(folder)
    made: list[Path] = []
    with interrupt_after(), ExitStack() as staged:
        try:
            staging = []
            for folder, files in folders.items():
                made += [p for p in reversed((folder, *folder.absolute().parents)) if not p.exists()]
                _make(folder)
                staging.append(staged.enter_context(_staged(folder, files)))
            _change(staging)
        except BaseException:
            # Folders that were made for these files go again, unless another run has put something into them.
            staged.close()
            for each in reversed(made):
                with suppress(OSError):
                    each.rmdir()
            raise


class _Staging:
    """The staging folder of one output folder."""

    def __init__(self, folder: Path, place: Path, names: tuple[str, ...]) -> None:
        self.folder, self.place, self.names = folder, place, names

    def become(self, prefix: str) -> None:
        """Renames the staging folder to the next state."""
        to = self.place.with_name(prefix + self.place.name.split("-", 2)[2])
        self.place.rename(to)
        self.place = to


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None


@contextmanager
def _staged(folder: Path, files: Mapping[str, str | bytes]) -> Iterator[_Staging]:
    """The files, complete in a staging folder whose owner this process is; whatever is left of it is removed."""
    for name in files:
        check_name(folder, name)
    clear_up(folder)
    staging = None
    try:
        with owned(folder, STAGE, LOCK) as place:
            staging = _Staging(folder, place, tuple(files))
            try:
                for name, data in files.items():
                    target = place / NEW / name
                    target.parent.mkdir(parents=True, exist_ok=True)
                    with target.open("wb") as file:
                        file.write(data.encode() if isinstance(data, str) else data)
                        file.flush()
                        # A renamed file whose content is not on the disk is empty after a power cut.
                        os.fsync(file.fileno())
                yield staging
            finally:
                shutil.rmtree(staging.place, ignore_errors=True)
    except OSError as error:
        raise unwritable(folder, error) from None
    finally:
        if staging is not None:
            # Windows keeps the lock's file until it is closed.
            shutil.rmtree(staging.place, ignore_errors=True)


def _change(staging: list[_Staging]) -> None:
    """Renames the staged files into their places, all or none."""
    with ExitStack() as held:
        # Two runs into the same folders take them in the same order, and neither waits for the other for ever.
        # A folder that is reached by two paths is one.
        folders = {(at.st_dev, at.st_ino): s.folder for s in staging for at in (s.folder.stat(),)}
        for key in sorted(folders):
            held.enter_context(exclusive(folders[key]))
        for each in staging:
            _check_places(each)
        for each in staging:
            _keep_old(each)
        done: list[_Staging] = []
        try:
            for each in staging:
                done.append(each)
                each.become(COMMIT)
            for each in staging:
                _forward(each.folder, each.place)
        except OSError as error:
            for each in reversed(done):
                if each.place.name.startswith(COMMIT):
                    each.become(UNDO)
                _back(each.folder, each.place)
            raise unwritable(done[-1].folder, error) from None


def _check_places(staging: _Staging) -> None:
    """Finds a folder in the place of a file, or a file in that of a folder, before anything is changed."""
    for name in staging.names:
        target = staging.folder / name
        if target.is_dir() and not target.is_symlink():
            raise IvsidError(
                f"{target} cannot be written (a folder stands in its place); remove it, or choose another folder with --out"
            )
        _make(target.parent)


def _keep_old(staging: _Staging) -> None:
    """Gives each old file a second name in the staging folder, for the way back."""
    for name in staging.names:
        target = staging.folder / name
        kept = staging.place / (OLD if os.path.lexists(target) else NONE) / name
        kept.parent.mkdir(parents=True, exist_ok=True)
        if kept.is_relative_to(staging.place / NONE):
            kept.touch()
            continue
        try:
            os.link(target, kept, follow_symlinks=False)
        except (OSError, NotImplementedError):
            # File systems without hard links.
            shutil.copy2(target, kept, follow_symlinks=False)


def _forward(folder: Path, place: Path) -> None:
    """Renames all new files into their places."""
    for name in _names(place / NEW):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        (place / NEW / name).replace(target)


def _back(folder: Path, place: Path) -> None:
    """Renames all old files into their places, and removes the new ones that had none."""
    for name in _names(place / OLD):
        (place / OLD / name).replace(folder / name)
    for name in _names(place / NONE):
        if not (place / NEW / name).exists():
            (folder / name).unlink(missing_ok=True)
        (place / NONE / name).unlink()


def _names(part: Path) -> list[Path]:
    """Files below a part of a staging folder, in order; links to folders are not followed."""
    found = [Path(at) / f for at, _, files in os.walk(part) for f in files]
    return sorted(f.relative_to(part) for f in found)


def clear_up(folder: Path) -> None:
    """Ends the work of runs that died while they wrote into a folder: removed before the change of the results, carried out after it.

    A folder whose owner lives is left alone, and so is whatever cannot be removed.
    """
    for place in sorted(folder.glob(".ivsid-*-*")):
        state = next((s for s in (STAGE, COMMIT, UNDO) if place.name.startswith(s)), None)
        if state is None or place.is_symlink() or not place.is_dir():
            continue
        with suppress(OSError), owned(folder, "", LOCK, place):
            # A path through a link could lead out of the folder.
            if state != STAGE and not any(_through_link(folder, place, part) for part in (NEW, OLD, NONE)):
                (_forward if state == COMMIT else _back)(folder, place)
            shutil.rmtree(place, ignore_errors=True)


def _through_link(folder: Path, place: Path, part: str) -> bool:
    return any((folder / p).is_symlink() for name in _names(place / part) for p in name.parents)


@contextmanager
def interrupt_after() -> Iterator[None]:
    """Holds back a Ctrl-C until the block is done; signals reach the main thread alone, so other threads need nothing."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    waiting: list[int] = []

    def wait(number: int, _: FrameType | None) -> None:
        waiting.append(number)

    before = {int(s): signal.getsignal(s) for s in (signal.SIGINT, signal.SIGTERM)}
    for number, handler in before.items():
        # A handler that Python did not set cannot be put back.
        if handler is not None:
            signal.signal(number, wait)
    try:
        yield
    finally:
        for number, handler in before.items():
            if handler is not None:
                signal.signal(number, handler)
    for number in waiting[:1]:
        signal.raise_signal(number)
