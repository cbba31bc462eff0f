"""Logs and results by path, pattern or URL of an object store."""

from __future__ import annotations

import glob
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final, Protocol

from ivsid.errors import IvsidError
from ivsid.files.places import check_writable
from ivsid.files.whole import write_whole
from ivsid.fleets import extra
from ivsid.log import TABLES, WHOLE, Parts

ENDINGS: Final = (*TABLES, *WHOLE)


class FileSystem(Protocol):
    """As much of a file system of fsspec as is used."""

    def glob(self, path: str) -> list[str]:
        """Paths that a pattern names."""

    def isdir(self, path: str) -> bool:
        """Whether it is a folder."""

    def ls(self, path: str, *, detail: bool) -> list[str]:
        """Paths in a folder."""

    def exists(self, path: str) -> bool:
        """Whether it is there."""

    def unstrip_protocol(self, path: str) -> str:
        """The URL of a path."""

    def cat_file(self, path: str, *, start: int | None = None, end: int | None = None) -> bytes:
        """The content of a file, or its bytes from one place up to another."""

    def size(self, path: str) -> int | None:
        """Bytes of a file."""

    def invalidate_cache(self) -> None:
        """Forgets what lay in the store."""

    def pipe_file(self, path: str, value: bytes) -> None:
        """Writes a file."""

    def makedirs(self, path: str, *, exist_ok: bool) -> None:
        """Makes folders."""

    def rm_file(self, path: str) -> None:
        """Removes a file."""


@dataclass(frozen=True)
class Place:
    """A log of a fleet.

    Attributes:
        address: path or URL.
        name: the shortest end of the address that tells the logs apart.
    """

    address: str
    name: str


def is_url(address: str) -> bool:
    """Whether an address is a URL of an object store or of another file system."""
    return "://" in address


def logs_of(given: Sequence[str]) -> list[Place]:
    """The logs that paths, folders, patterns and URLs name, each once, by name.

    Raises:
        IvsidError: one that names no log.
    """
    found: dict[str, None] = {}
    for each in given:
        addresses = _below(each) if is_url(each) else _on_disk(each)
        if not addresses:
            raise IvsidError(
                f"{each} names no log; give a log, a folder of logs, or a pattern such as 'season/*.csv' ({', '.join(ENDINGS)})"
            )
        found |= dict.fromkeys(addresses)
    return sorted((Place(a, n) for a, n in zip(found, _names(list(found)), strict=True)), key=lambda p: p.name)


def _on_disk(given: str) -> list[str]:
    path = Path(given)
    if path.is_file() or _is_bag(path):
        return [str(path.resolve())]
    if path.is_dir():
        inside = sorted(path.iterdir())
        return [str(p.resolve()) for p in inside if not p.name.startswith(".") and (_is_log(p.name) or _is_bag(p))]
    # A pattern may be absolute, which Path.glob refuses.
    named = map(Path, sorted(glob.glob(given, recursive=True)))  # noqa: PTH207
    return [str(p.resolve()) for p in named if _is_log(p.name) or _is_bag(p)]


def _is_bag(path: Path) -> bool:
    return (path / "metadata.yaml").is_file()


def _is_log(name: str) -> bool:
    return name.lower().endswith(ENDINGS)


def _below(url: str) -> list[str]:
    """The logs at a URL: itself, those in a folder, or those that a pattern names."""
    system, path = _system(url)
    try:
        if any(c in path for c in "*?["):
            paths = system.glob(path)
        elif system.isdir(path):
            paths = [p for p in system.ls(path, detail=False) if _is_log(str(p))]
        else:
            paths = [path] if system.exists(path) else []
    except Exception as error:
        raise _unusable(url, error) from None
    return sorted(system.unstrip_protocol(p) for p in paths)


def _system(url: str) -> tuple[FileSystem, str]:
    """The file system of a URL, and the path in it."""
    try:
        system, path = extra.fsspec().core.url_to_fs(url)
    except IvsidError:
        raise
    except Exception as error:
        raise _unusable(url, error) from None
    return system, path


def _unusable(url: str, error: Exception) -> IvsidError:
    words = (str(error).splitlines() or [""])[0] or type(error).__name__
    return IvsidError(f"{url} cannot be read or written ({words}); check the address, and the access to it")


def _names(addresses: Sequence[str]) -> list[str]:
    """The last parts of each address, as many as tell them apart."""
    parts = [PurePosixPath(a.replace(os.sep, "/")).parts for a in addresses]
    longest = max(map(len, parts), default=1)
    count = next((k for k in range(1, longest + 1) if len({p[-k:] for p in parts}) == len(parts)), longest)
    return ["/".join(p[-count:]).replace("//", "/") for p in parts]


@contextmanager
def opened(address: str) -> Iterator[Path | Parts]:
    """The log as ``read_log`` takes it: a path of this machine, or a file elsewhere, of which the bytes that are needed are fetched.

    They lie in a file of this machine as long as the block lasts.

    Raises:
        IvsidError: a URL that cannot be read.
    """
    if not is_url(address):
        yield Path(address)
        return
    system, path = _system(address)

    def fetch(begin: int, end: int) -> bytes:
        try:
            return system.cat_file(path, start=begin, end=end)
        except Exception as error:
            raise _unusable(address, error) from None

    try:
        # A store may remember what lay there before.
        system.invalidate_cache()
        size = system.size(path)
    except Exception as error:
        raise _unusable(address, error) from None
    if size is None:
        raise IvsidError(f"{address} has no size that its store tells; copy it to a disk")
    with tempfile.TemporaryDirectory(prefix="ivsid-") as folder:
        yield Parts(Path(folder) / PurePosixPath(path).name, address, fetch, size)


def read_bytes(address: str) -> bytes | None:
    """The content of a file of the results; None where there is none."""
    if not is_url(address):
        try:
            return Path(address).read_bytes()
        except OSError:
            return None
    system, path = _system(address)
    try:
        content = system.cat_file(path)
    except FileNotFoundError:
        return None
    except Exception as error:
        raise _unusable(address, error) from None
    return content


def write_bytes(address: str, content: bytes) -> None:
    """Writes a file of the results, whole or not at all: by renaming on disk, and as one object in a store.

    Raises:
        IvsidError: the place cannot be written.
    """
    if not is_url(address):
        write_whole(address, content)
        return
    system, path = _system(address)
    try:
        system.makedirs(path.rpartition("/")[0], exist_ok=True)
        system.pipe_file(path, content)
    except Exception as error:
        raise _unusable(address, error) from None


def check(folder: str) -> None:
    """Checks, before any work is done, that a folder of results can be written; leaves nothing behind.

    Raises:
        IvsidError: it cannot.
    """
    if not is_url(folder):
        check_writable(folder)
        return
    probe = below(folder, ".ivsid")
    write_bytes(probe, b"")
    system, path = _system(probe)
    try:
        system.rm_file(path)
    except Exception as error:
        raise _unusable(folder, error) from None


def below(folder: str, *parts: str) -> str:
    """The address of a file below a folder."""
    return "/".join((folder.rstrip("/"), *parts)) if is_url(folder) else str(Path(folder, *parts))
