"""The reader of a file: chosen by its first bytes, or by its ending where the bytes do not tell."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.log.dataflash import open_dataflash
from ivsid.log.json_text import is_json, open_json
from ivsid.log.long_tables import split
from ivsid.log.matlab import open_matlab
from ivsid.log.moos import is_moos, open_moos
from ivsid.log.parquet import open_parquet
from ivsid.log.parts import Parts
from ivsid.log.plain import plain, unzipped
from ivsid.log.rosbag import open_bag
from ivsid.log.source import SEPARATOR, Source, Table, head
from ivsid.log.text import open_text

# A MATLAB v5 file begins with words; a v4 file is known by its ending.
MATLAB_5: Final = b"MATLAB 5.0 MAT-file"
MATLAB_73: Final = (b"MATLAB 7.3 MAT-file", b"\x89HDF\r\n\x1a\n")
MCAP: Final = b"\x89MCAP0\r\n"
SQLITE: Final = b"SQLite format 3\x00"
ROS_1: Final = b"#ROSBAG V2.0"
DATAFLASH: Final = b"\xa3\x95\x80"
PARQUET: Final = b"PAR1"
BAGS: Final = (".mcap", ".db3", ".bag")
# Bytes by which formats are told apart.
# Source: definition: the longest mark of a format has fewer
FIRST: Final = 64
TABLES: Final = tuple(e + z for e in (".csv", ".tsv", ".parquet", ".jsonl", ".ndjson") for z in ("", ".gz"))
# Endings of files that are a log each, in a folder that is searched.
WHOLE: Final = (".mat", ".bin", ".mcap", ".db3", ".bag", ".alog", ".lvm")
# Columns of a table that is no run: a stamp and a signal.
# Source: definition: a run needs velocities as well
LEAST_RUN: Final = 2
# Files below a folder that is searched for a log.
# Source: definition: a folder of one log has fewer; a disk has more
MOST_FILES: Final = 10_000


@contextmanager
def open_source(
    path: str | Path | Parts, span: tuple[float, float] | None = None, *, parts: bool = False, mended: bool = False
) -> Iterator[Source]:
    """Opens any log (plain or gzip): CSV, Parquet, JSON, MATLAB, a ROS bag, DataFlash, or a folder of tables.

    A folder that is no log is searched: the one log below it is opened. Of an MCAP or Parquet file that is elsewhere, or of which a span is
    read, only the bytes that are needed are read, and make its identity.

    Args:
        path: of the log, or a file elsewhere.
        span: seconds from and to which messages of a bag are read; None for all.
        parts: whether the identity of an MCAP or Parquet file is that of its parts.
        mended: whether the index of an MCAP file is made anew.

    Raises:
        IvsidError: an unreadable, empty, binary or unknown file, or a missing optional reader.
    """
    with ExitStack() as stack:
        if isinstance(path, Parts):
            name, plain, files = path.name, path.path, [path.path]
            whole: Parts | None = path
            first = path.peek(0, FIRST)
        else:
            name = str(path)
            plain = _found(_regular(Path(path), stack), name)
            files = _files(plain, name)
            whole = Parts(plain, name) if plain.is_file() else None
            first = b"" if plain.is_dir() else head(plain)
        divided = first.startswith((MCAP, PARQUET))
        if whole is not None and (not divided or mended):
            whole.all()
        in_parts = whole if divided and (isinstance(path, Parts) or parts or span is not None) else None
        digest = in_parts or stack.enter_context(ThreadPoolExecutor(1)).submit(_hash, files)
        of_mcap = whole if first.startswith(MCAP) else None
        tables = _tables(plain, name, files, stack, span, of_mcap or in_parts, mended=mended)
        yield Source(name, tables, digest, spanned=is_bag(plain, first), notes=_unread(plain, files))


def digest_of(path: str | Path) -> str:
    """SHA-256 of a log, as ``Log.sha256`` states it, without reading its tables.

    Raises:
        IvsidError: a path that leads to no log.
    """
    return _hash(_files(_found(Path(path), str(path)), str(path)))


def _regular(path: Path, stack: ExitStack) -> Path:
    """The path itself, or a copy of the content of a pipe, which can be read only once."""
    try:
        if path.is_file() or path.is_dir() or not path.exists():
            return path
        copy = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-"))) / path.name
        with path.open("rb") as source, copy.open("wb") as target:
            shutil.copyfileobj(source, target, 1 << 20)
    except OSError as error:
        raise _unreadable(str(path), error) from None
    return copy


def _unreadable(name: str, error: OSError) -> IvsidError:
    return IvsidError(f"log {name} cannot be read ({error.strerror}); give the path of a CSV or Parquet file")


def _hash(files: Sequence[Path]) -> str:
    if len(files) == 1:
        with files[0].open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    whole = hashlib.sha256()
    for each in files:
        whole.update(f"{each.name}:{_hash([each])}\n".encode())
    return whole.hexdigest()


def _found(path: Path, name: str) -> Path:
    """The path itself, or the log that a folder has below it: a bag, a file, or a folder of tables, which may lie in folders themselves."""
    try:
        if not path.is_dir() or _is_bag(path) or any(_is_table(p) for p in path.iterdir()):
            return path
        below = _below(path)
    except OSError as error:
        raise _unreadable(name, error) from None
    bags = {p.parent for p in below if p.name == "metadata.yaml"}
    files = [p for p in below if not bags & {*p.parents}]
    tables = {p.parent for p in files if _is_table(p)}
    whole = {*bags, *(p for p in files if p.suffix.lower() in WHOLE)}
    if whole and len(whole) + len(tables) > 1:
        raise _several(path, name, [*whole, *tables])
    if not whole and not tables:
        raise IvsidError(
            f"folder {name} holds neither a ROS 2 bag (metadata.yaml) nor a CSV, Parquet, MATLAB or DataFlash file; give a log file"
        )
    return path if len(tables) > 1 else next(iter(whole | tables))


def _below(folder: Path) -> list[Path]:
    """The files in a folder and in those below it, without hidden ones.

    Raises:
        IvsidError: more files than a folder of one log has.
    """
    files: list[Path] = []
    for where, folders, names in os.walk(folder):
        folders[:] = [f for f in folders if not f.startswith(".")]
        files += [p for n in names if not n.startswith(".") and (p := Path(where, n)).is_file()]
        if len(files) > MOST_FILES:
            raise IvsidError(
                f"folder {folder} has more than {MOST_FILES:,} files below it; give the folder of one log, or a file"
            )
    return sorted(files)


def _unread(path: Path, files: Sequence[Path]) -> tuple[str, ...]:
    """A sentence on tables below a folder that has tables of its own, which are its log."""
    if not path.is_dir() or _is_bag(path):
        return ()
    try:
        below = [p for p in _below(path) if _is_table(p) and p not in files]
    except (IvsidError, OSError):
        return ()
    if not below:
        return ()
    shown = ", ".join(str(p.relative_to(path)) for p in below[:3])
    return (
        f"{path.name} has tables of its own, which are read, and {len(below)} below it, which are not ({shown}{', ...' if len(below) > 3 else ''}): "
        "give the folder of those, or put all of them in one",
    )


def _several(folder: Path, name: str, logs: Sequence[Path]) -> IvsidError:
    shown = ", ".join(sorted(str(p.relative_to(folder)) for p in logs)[:6])
    return IvsidError(
        f"folder {name} holds {len(logs)} logs ({shown}{', ...' if len(logs) > 6 else ''}); give one of them"
    )


def _files(path: Path, name: str) -> list[Path]:
    """The files of a log: itself, those of the folder, or the tables below it."""
    if not path.is_dir():
        try:
            with path.open("rb"):
                return [path]
        except OSError as error:
            raise _unreadable(name, error) from None
    files = sorted(p for p in path.iterdir() if p.is_file())
    if _is_bag(path):
        return files
    return [p for p in files if _is_table(p)] or [p for p in _below(path) if _is_table(p)]


def _tables(
    path: Path,
    name: str,
    files: Sequence[Path],
    stack: ExitStack,
    span: tuple[float, float] | None,
    parts: Parts | None,
    *,
    mended: bool,
) -> Mapping[str, Table]:
    """The tables of a log; files and readers behind them are released with the stack."""
    if path.is_dir():
        if _is_bag(path):
            return open_bag(path, name, stack, span)
        tables: dict[str, Table] = {}
        for each in files:
            where = each.relative_to(path).as_posix()
            stem = next(where[: -len(e)] for e in TABLES if where.lower().endswith(e))
            if stem in tables:
                raise IvsidError(f"folder {name} holds two tables named {stem}; rename one")
            for part, content in _of_file(each, str(each), stack).items():
                tables[f"{stem}{SEPARATOR}{part.lstrip(SEPARATOR)}" if part else stem] = content
        places = {each.parent for each in files}
        runs = [tuple(t.columns) for t in tables.values() if len(t.columns) > LEAST_RUN]
        if len(places) > 1 and len(set(runs)) < len(runs):
            # Tables of one log have columns of their own; two that are alike are two runs, unless they hold a signal each.
            raise _several(path, name, [*places])
        return tables
    path = unzipped(path, name, stack)
    first, ending = head(path), path.suffix.lower()
    if first.startswith(MATLAB_73):
        raise IvsidError(
            f"{name} is a MATLAB 7.3 file; save it with the option -v7, or export the log as CSV, and read that"
        )
    if first.startswith(MATLAB_5) or ending == ".mat":
        return open_matlab(path, name)
    if is_bag(path, first):
        return open_bag(path, name, stack, span, parts, mended=mended)
    if first.startswith(DATAFLASH) or ending == ".bin":
        return open_dataflash(path, name, stack)
    return _of_file(path, name, stack, parts)


def is_bag(path: Path, first: bytes) -> bool:
    """Whether a path leads to a bag, by the first bytes or the ending of a file."""
    if path.is_dir():
        return _is_bag(path)
    return first.startswith((MCAP, SQLITE, ROS_1)) or path.suffix.lower() in BAGS


def _is_bag(folder: Path) -> bool:
    return (folder / "metadata.yaml").is_file()


def _is_table(path: Path) -> bool:
    return path.name.lower().endswith(TABLES)


def _of_file(path: Path, name: str, stack: ExitStack, parts: Parts | None = None) -> Mapping[str, Table]:
    """The tables of a file that is text or Parquet, plain or gzip."""
    path = plain(path, name, stack)
    if head(path).startswith(PARQUET):
        tables: Mapping[str, Table] = {"": open_parquet(path, name, parts)}
    elif is_moos(path, name):
        tables = open_moos(path, name)
    elif is_json(path, name):
        tables = open_json(path, name)
    else:
        tables = {"": open_text(path, name, stack)}
    return (split(tables[""]) if tables.keys() == {""} else None) or tables
