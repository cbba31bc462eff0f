"""A text log that is still being written: its whole lines, in a copy that the reader takes for a log."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from ivsid.errors import IvsidError

# Marks of texts whose characters take two bytes, in which a line cannot be told to be whole by its last byte.
WIDE: Final = (b"\xff\xfe", b"\xfe\xff")
# Bytes that are read of a log at a time.
# Source: resource: memory; a log of an hour at 50 Hz has some ten times as many
PIECE: Final = 2**22


class Growing:
    """A text log that another program writes.

    Attributes:
        copy: its whole lines so far; the name is that of the log.
    """

    def __init__(self, path: Path, folder: Path) -> None:
        self._path = path
        self._done = 0
        self.copy = folder / path.name

    def grown(self) -> bool:
        """Takes the whole lines that were written since the last call, and says whether there were any.

        Raises:
            IvsidError: a log that became shorter, or that is no text of single bytes.
        """
        found = False
        with self._path.open("rb") as source, self.copy.open("ab") as target:
            size = source.seek(0, 2)
            if size < self._done:
                raise IvsidError(
                    f"{self._path} became shorter while it was followed; a log that is followed is only written at its end"
                )
            source.seek(self._done)
            while piece := source.read(PIECE):
                if b"\x00" in piece or (self._done == 0 and piece.startswith(WIDE)):
                    raise IvsidError(
                        f"{self._path} is no CSV in UTF-8; only lines of such a log can be followed while they are written"
                    )
                whole = piece[: piece.rfind(b"\n") + 1]
                if not whole:
                    break
                target.write(whole)
                self._done += len(whole)
                source.seek(self._done)
                found = True
        return found


@contextmanager
def growing(path: str | Path) -> Iterator[Growing]:
    """The log while it is followed.

    Args:
        path: of a text log.

    Raises:
        IvsidError: no such file.
    """
    if not Path(path).is_file():
        raise IvsidError(f"{path} is no file; with --wait give a CSV log whose header is written")
    with TemporaryDirectory(prefix="ivsid-") as folder:
        yield Growing(Path(path), Path(folder))
