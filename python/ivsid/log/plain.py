"""Files of samples as the readers take them: unpacked, and text in UTF-8. Copies lie on disk, since they need not fit in memory."""

from __future__ import annotations

import gzip
import tempfile
import zlib
from contextlib import ExitStack
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.log.source import head
from ivsid.log.unpacked import most_unpacked, too_large

# Bytes that are unpacked at a time.
# Source: resource: bounds the memory of a step
PIECE: Final = 1 << 20
GZIP: Final = b"\x1f\x8b"
# Marks at the beginning of text in UTF-16, as Excel and instruments under Windows write it.
UTF_16: Final = (b"\xff\xfe", b"\xfe\xff")
# Formats that are recorded by others and not read, with what their user does.
EXPORTED: Final = {
    b"ULog\x01\x12\x35": "is a ULog of PX4; turn it into tables with `ulog2csv`, and give the folder of those",
    b"PK\x03\x04": "is a workbook or another packed archive; save the sheet as CSV, or unpack it",
}


def plain(path: Path, name: str, stack: ExitStack) -> Path:
    """The file itself, or a copy that is unpacked and in UTF-8.

    Raises:
        IvsidError: a damaged or too large packed file, or a format that is not read.
    """
    path = unzipped(path, name, stack)
    first = head(path)
    for mark, words in EXPORTED.items():
        if first.startswith(mark):
            raise IvsidError(f"{name} {words}")
    return _in_utf_8(path, name, _copy(stack)) if first.startswith(UTF_16) else path


def unzipped(path: Path, name: str, stack: ExitStack) -> Path:
    """The file itself, or an unpacked copy whose name has its ending.

    Raises:
        IvsidError: a damaged or too large packed file.
    """
    if not head(path).startswith(GZIP):
        return path
    copy = _copy(stack)
    return _unpacked(path, name, copy.with_suffix(Path(path.stem).suffix if path.suffix.lower() == ".gz" else ""))


def _copy(stack: ExitStack) -> Path:
    return Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ivsid-"))) / "log"


def _unpacked(path: Path, name: str, target: Path) -> Path:
    most = most_unpacked(path.stat().st_size)
    try:
        with gzip.open(path) as packed, target.open("wb") as file:
            while piece := packed.read(PIECE):
                file.write(piece)
                if file.tell() > most:
                    raise too_large(name, most)
    except (gzip.BadGzipFile, EOFError, zlib.error):
        raise IvsidError(f"{name} is a damaged gzip file; copy it again") from None
    except OSError as error:
        raise _no_room(name, error) from None
    return target


def _in_utf_8(path: Path, name: str, target: Path) -> Path:
    try:
        with path.open(encoding="utf-16", newline="") as source, target.open("w", encoding="utf-8", newline="") as file:
            while piece := source.read(PIECE):
                file.write(piece)
    except UnicodeError:
        raise IvsidError(
            f"{name} begins as text in UTF-16 and is damaged; copy it again, or save it in UTF-8"
        ) from None
    except OSError as error:
        raise _no_room(name, error) from None
    return target


def _no_room(name: str, error: OSError) -> IvsidError:
    return IvsidError(f"{name} cannot be unpacked ({error.strerror}); make room, or unpack it yourself")
