"""Columns that blanks align: several between two cells, or in front of the first. A copy has one tab between two cells."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.log.beginning import COMMENTS, holds_number, units_of
from ivsid.log.instruments import Header

# Rows that tell how many cells a row has.
# Source: definition: a table has the same number in each
SAMPLE: Final = 5
_CELL: Final = re.compile(r'"[^"]*"|\S+')
_BYTES: Final = re.compile(rb'"[^"\n]*"|[^ \t\r\n]+')
_UNIT: Final = re.compile(r"\[[^\[\]]*\]|\([^()]*\)")
_DAY: Final = re.compile(rb"(\d{4}[-/]\d{1,2}[-/]\d{1,2}|\d{1,2}\.\d{1,2}\.\d{4}) +(\d{1,2}:)")
_RULE: Final = re.compile(r"[-=+| ]+")


def aligned(lines: Sequence[str], name: str) -> Header | None:
    """The header of a table whose columns are aligned by blanks; None for other text.

    Raises:
        IvsidError: its header has another number of names than its rows have cells.
    """
    at = 0
    while at + 1 < len(lines) and (not lines[at].strip() or lines[at].lstrip().startswith(COMMENTS)):
        at += 1
    rows = [line for line in lines[at : at + SAMPLE] if line.strip()]
    if len(rows) < 2 or any(c in row for c in "\t;" for row in rows) or "," in rows[0]:
        return None
    if not any("  " in row.rstrip() or row.startswith(" ") for row in rows):
        return None
    if holds_number(_CELL.findall(lines[at])):
        # The names stand behind the mark of a comment.
        cells = _cells(lines[at])
        said = reversed([line.lstrip().lstrip("#%/ ") for line in lines[:at]])
        names = next((n for line in said if line.strip() and (n := _named(line, cells))), None)
        return None if names is None else Header(names, "\t", at)
    below = at + 1
    while below + 1 < len(lines) and (not lines[below].strip() or _RULE.fullmatch(lines[below])):
        below += 1
    stated = units_of(_CELL.findall(lines[below]))
    first = below + 1 if stated is not None and below + 1 < len(lines) else below
    cells = _cells(lines[first])
    if not holds_number(_CELL.findall(lines[first])):
        return None
    names = _named(lines[at], cells)
    if names is None:
        raise IvsidError(
            f"{name} has columns that blanks align, and its header '{lines[at].strip()[:60]}' does not tell the names of its {cells} cells a row; part names by "
            "two blanks or more, or cells by commas"
        )
    if stated is not None and len(stated) == len(names) and first > below:
        names = tuple(f"{n} [{u}]" if u and "[" not in n else n for n, u in zip(names, stated, strict=True))
    return Header(names, "\t", first)


def _cells(line: str) -> int:
    return len(_BYTES.findall(_DAY.sub(rb"\1_\2", line.encode())))


def _named(header: str, cells: int) -> tuple[str, ...] | None:
    """The names of so many cells: words, words with their units, or what several blanks part."""
    words = _CELL.findall(header)
    with_units: list[str] = []
    for word in words:
        if with_units and _UNIT.fullmatch(word):
            with_units[-1] += f" {word}"
        else:
            with_units.append(word)
    for names in (words, with_units, re.split(r" {2,}", header.strip())):
        if len(names) == cells:
            return tuple(n.strip('" ') for n in names)
    return None


def copied(path: Path, target: Path) -> Path:
    """A copy with a tab between two cells, and with day and time of day in one. Lines keep their numbers.

    Raises:
        OSError: there is no room for it.
    """
    with path.open("rb") as source, target.open("wb") as file:
        for line in source:
            end = b"\n" if line.endswith(b"\n") else b""
            file.write(b"\t".join(_BYTES.findall(_DAY.sub(rb"\1_\2", line))) + end)
    return target


def filled(path: Path, target: Path, header: Header) -> Path:
    """A copy of a file of LabVIEW whose rows have all cells: an empty comment is left out there, and stamps where a step stands for them.

    Raises:
        OSError: there is no room for it.
    """
    separator, most = header.separator.encode(), len(header.names)
    with path.open("rb") as source, target.open("wb") as file:
        for k, line in enumerate(source):
            if k < header.lines or not line.strip():
                file.write(line)
                continue
            cells = line.rstrip(b"\r\n").split(separator)
            if not line.endswith(b"\n") and len(cells) < most - 1:
                # The last row breaks off, and its reader says so.
                file.write(line)
                continue
            if header.step:
                point = b"," if b"," in line and separator != b"," else b"."
                cells[0] = repr((k - header.lines) * float(header.step)).encode().replace(b".", point)
            file.write(separator.join([*cells, *[b""] * (most - len(cells))]) + b"\n")
    return target
