"""Free-running tests of a manoeuvring basin: a few title lines, and a table of numbers without a header."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError

Array = NDArray[np.float64]
# Lines at the head of a file among which the titles stand.
# Source: definition: the published files have three and four
TITLES: Final = 6
# Share of the scatter of a candidate for the yaw rate that its difference from the slope of the heading may have.
# Source: definition: a rate is its slope but for noise; rates about other axes differ by all of their scatter
ALIKE: Final = 0.5


def table_of(path: Path, columns: int, *, words: tuple[str, ...]) -> Array:
    """The numbers of a file, shape (n, columns).

    Args:
        path: of the file.
        columns: that each row has.
        words: that its titles hold.

    Raises:
        IvsidError: other titles, rows of other lengths, no numbers, or times that do not increase.
    """
    text = path.read_bytes().decode("latin-1")
    lines = text.splitlines()
    head = " ".join(lines[:TITLES])
    if missing := [w for w in words if w not in head]:
        raise IvsidError(f"{path}: its titles do not say {' and '.join(missing)}; it is no file of the set")
    rows: list[list[float]] = []
    for number, line in enumerate(lines, 1):
        cells = line.split()
        values = _numbers(cells)
        if values is None:
            if rows and cells:
                raise IvsidError(f"{path}: line {number} holds no numbers; give the file as it is published")
            continue
        if len(values) != columns:
            raise IvsidError(
                f"{path}: line {number} has {len(values)} of {columns} numbers; give the file as it is published"
            )
        rows.append(values)
    if len(rows) < 2:
        raise IvsidError(f"{path}: {len(rows)} rows of numbers; give the file as it is published")
    table = np.array(rows)
    if not np.isfinite(table).all() or not (np.diff(table[:, 0]) > 0).all():
        raise IvsidError(
            f"{path}: its times do not increase, or a number is not finite; give the file as it is published"
        )
    return table


def _numbers(cells: list[str]) -> list[float] | None:
    try:
        return [float(c) for c in cells] or None
    except ValueError:
        return None


def rate_of(table: Array, heading: int, candidates: tuple[int, ...]) -> int:
    """The column that is the slope of the heading, of those that may be.

    Args:
        table: shape (n, k), time first.
        heading: its column.
        candidates: columns of rates, in the heading's unit a second.

    Raises:
        IvsidError: none of them is.
    """
    slope = np.diff(table[:, heading]) / np.diff(table[:, 0])
    misses = {}
    for c in candidates:
        middle = 0.5 * (table[1:, c] + table[:-1, c])
        # The published digits make steps of the slope: medians over the file say which column it follows.
        misses[c] = float(np.median(np.abs(middle - slope)))
    best = min(misses, key=lambda c: misses[c])
    if misses[best] > ALIKE * float(np.median(np.abs(slope - np.median(slope)))) + 1e-12:
        raise IvsidError("no column of the file is the slope of its heading; give the set as it is published")
    return best


def continuous(degrees: Array) -> Array:
    """A heading [rad] without jumps."""
    return np.asarray(np.unwrap(np.radians(degrees)))
