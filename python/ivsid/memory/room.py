"""Memory for arrays, in a file where they are large: a log of any length is worked on in bounded memory.

A large array is a mapped file without a name, which ends with the array. The system keeps as much of it in memory as there is room for, and
writes the rest to the disk. Its numbers are those of an array in memory, so no result depends on where an array lies.
"""

from __future__ import annotations

import math
import mmap
import os
import tempfile
from pathlib import Path
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError

# Bytes from which an array lies in a file: a column of four million doubles. A log of fewer rows needs less than 2.5 GB in memory.
# Source: resource: bounds the memory of a process
LARGE: int = 1 << 25
# The folder that POSIX systems have on a disk; the usual one for files without a name is often memory itself.
# Source: definition: the Filesystem Hierarchy Standard 3.0, section 5.15
ON_DISK: Final = Path("/var/tmp")
DOUBLE: Final = np.dtype(np.float64)
_N = TypeVar("_N", bound=np.generic)


def disk() -> Path | None:
    """The folder of large files that end with their user; None for the one that the system chooses."""
    return ON_DISK if "TMPDIR" not in os.environ and os.access(ON_DISK, os.W_OK) else None


def is_large(size: int) -> bool:
    """Whether an array of this many bytes lies in a file."""
    return size >= LARGE


def room(shape: int | tuple[int, ...], kind: np.dtype[_N]) -> NDArray[_N]:
    """An array without values yet, in a file if it is large.

    The folder of the file is ``TMPDIR`` where that is set, else one on a disk.

    Raises:
        IvsidError: the disk has no room for it.
    """
    size = math.prod((shape,) if isinstance(shape, int) else shape) * kind.itemsize
    if not is_large(size):
        return np.empty(shape, dtype=kind)
    folder = disk()
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            if hasattr(os, "posix_fallocate"):
                # Without room on the disk a later write would end the process.
                os.posix_fallocate(file.fileno(), 0, size)
            else:
                file.truncate(size)
            mapped = mmap.mmap(file.fileno(), size)
    except OSError as error:
        where = folder or tempfile.gettempdir()
        raise IvsidError(
            f"{size / 1e9:.3g} GB for a long log cannot be had in {where} ({error.strerror}); make room there, or set TMPDIR to a folder with more"
        ) from None
    return np.frombuffer(mapped, dtype=kind).reshape(shape)
