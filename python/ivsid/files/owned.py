"""Folders that belong to a living process: the lock on them ends with the process, however it ends.

On POSIX the lock is ``flock``, which the kernel drops with the last descriptor. Elsewhere an open file stands for it, which Windows does not let
anyone remove. A file system without locks has no owner to ask: there, an abandoned folder is left alone, and two runs into one folder are not
kept apart.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]  # no POSIX


@contextmanager
def owned(folder: Path, prefix: str, lock: str, place: Path | None = None) -> Iterator[Path]:
    """A folder that this process owns: a new one, or an abandoned one.

    Args:
        folder: in which a new one is made.
        prefix: of a new one's name.
        lock: name of the file in it that carries the lock.
        place: an existing folder to take over.

    Raises:
        OSError: it cannot be made, or it has a living owner.
    """
    while True:
        at = place or Path(tempfile.mkdtemp(dir=folder, prefix=prefix))
        try:
            descriptor = _taken(at / lock, abandoned=place is not None)
        except (BlockingIOError, FileNotFoundError):
            # Between the making and the locking of a new folder, another run can take it for an abandoned one.
            if place is not None:
                raise
            continue
        try:
            yield at
        finally:
            os.close(descriptor)
        return


def _taken(lock: Path, *, abandoned: bool) -> int:
    """The descriptor of the locked file.

    Raises:
        OSError: the folder has a living owner, or is gone.
    """
    if fcntl is None and abandoned:
        lock.unlink(missing_ok=True)
    descriptor = os.open(lock, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        if fcntl is not None:
            _lock(descriptor, abandoned=abandoned)
        if not os.path.samestat(os.fstat(descriptor), lock.stat()):
            raise FileNotFoundError(lock)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def _lock(descriptor: int, *, abandoned: bool) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise
    except OSError:
        # A file system without locks: a new folder is used all the same.
        if abandoned:
            raise


@contextmanager
def exclusive(folder: Path) -> Iterator[None]:
    """The right to change the files of a folder: another run waits for it. Without locks nobody waits."""
    if fcntl is None:
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        # A network file system may know no locks.
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
