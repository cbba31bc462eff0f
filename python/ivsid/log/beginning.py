"""The lines of a text table before its samples: Excel's ``sep=;``, comments, the header, and a row of units below it."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.log.headers import spelled

# Separators in the order in which they count: names hold blanks and commas, and no tabs.
SEPARATORS: Final = ("\t", ";", ",", " ")
# Lines before the header that are looked at.
# Source: definition: a logger writes tens of lines about itself
MOST_LINES: Final = 200
# Units of a row that make it a row of units: one alone may be a word.
# Source: definition: the stamps and a channel have units
LEAST_UNITS: Final = 2
COMMENTS: Final = ("#", "%", "//")
_EXCEL: Final = re.compile(r"sep=(.)")
_NUMBER: Final = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|nan|inf", re.IGNORECASE)


@dataclass(frozen=True)
class Beginning:
    """What stands before the samples.

    Attributes:
        names: of the columns; a unit of the row below stands behind its name, in brackets.
        separator: of the cells.
        lines: before the first sample.
    """

    names: tuple[str, ...]
    separator: str
    lines: int


def beginning(lines: Sequence[str], name: str) -> Beginning:
    """The header among the first lines of a file.

    Args:
        lines: without their ends, at least one of which holds something.
        name: of the file, for messages.

    Raises:
        IvsidError: a header with open quotation marks.
    """
    told = _EXCEL.fullmatch(lines[0].strip())
    at = 0 if told is None else 1
    while at + 1 < len(lines) and (not lines[at].strip() or lines[at].lstrip().startswith(COMMENTS)):
        at += 1
    # A file without comments begins with its header, whatever that holds.
    header, sample = lines[at], lines[at + 1] if at + 1 < len(lines) else ""
    separator = told[1] if told is not None else _separator(header, sample)
    names = _cells(header, separator, name)
    if at and holds_number(names):
        # The header itself stands behind the mark of a comment, as NumPy writes it, or begins with such a mark.
        for said in (lines[at - 1].lstrip().lstrip("#%/ "), lines[at - 1]):
            held = _cells(said, separator, name)
            if len(held) == len(names) and all(held):
                return Beginning(tuple(held), separator, at)
    below, next_row = (line.split(separator) for line in (sample, lines[at + 2] if at + 2 < len(lines) else ""))
    if len(below) == len(names) == len(next_row) and holds_number(next_row) and (found := units_of(below)) is not None:
        pairs = zip(names, found, strict=True)
        return Beginning(tuple(f"{n} [{u}]" if u and "[" not in n else n for n, u in pairs), separator, at + 2)
    return Beginning(tuple(names), separator, at + 1)


def _separator(header: str, second: str) -> str:
    """What separates cells: as often in the header as in the first row of samples, or else most often in the header."""
    counts = {s: header.strip().count(s) for s in SEPARATORS}
    alike = (s for s, n in counts.items() if n and n == second.strip().count(s))
    return next(alike, max(counts, key=lambda s: (counts[s], s == ",")))


def _cells(line: str, separator: str, name: str) -> list[str]:
    try:
        return [c.strip() for c in next(csv.reader([line], delimiter=separator, strict=True))]
    except csv.Error as error:
        raise IvsidError(f"{name} has a header that cannot be read ({error}); mend its quotation marks") from None


def holds_number(cells: Sequence[str]) -> bool:
    """Whether a row holds samples: a header has no numbers."""
    return any(_NUMBER.fullmatch(c.strip(' \r"')) for c in cells)


def units_of(cells: Sequence[str]) -> list[str] | None:
    """The units of a row that holds nothing else, two of them known; None for another row."""
    if holds_number(cells):
        return None
    stated = [spelled(c.strip(" \r\"'").strip("[]()").strip()) for c in cells]
    known = [u for u in stated if u != "1" and (u in units.COLUMN or u in units.TIME)]
    return ["" if u == "1" else u for u in stated] if len(known) >= LEAST_UNITS else None
