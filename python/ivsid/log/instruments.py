"""Headers of instruments' text files: Campbell's TOA5 and LabVIEW's measurement files (.lvm)."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from ivsid.errors import IvsidError

TOA5: Final = "TOA5"
# Tables of the same loggers in other forms.
OTHER_TABLES: Final = ("TOB1", "TOB2", "TOB3", "TOACI1", "CSIXML")
LABVIEW: Final = "LabVIEW Measurement"
END: Final = "***End_of_Header***"
# The channels' column of stamps in a file of LabVIEW.
X: Final = "X_Value"


@dataclass(frozen=True)
class Header:
    """What an instrument writes before its samples.

    Attributes:
        names: of the columns, with their units in brackets.
        separator: of the cells.
        lines: before the first sample.
        step: between two samples [s], where they have no stamps.
    """

    names: tuple[str, ...]
    separator: str
    lines: int
    step: str = ""


def header_of(lines: Sequence[str], name: str) -> Header | None:
    """The header of an instrument that is known, or None.

    Raises:
        IvsidError: a header of such an instrument that is not whole, or in a form that is not read.
    """
    kind = lines[0].partition(",")[0].strip().strip('"')
    if kind == TOA5:
        return _toa5(lines, name)
    if kind in OTHER_TABLES:
        raise IvsidError(
            f"{name} is a table of a Campbell logger in the form {kind}; convert it to TOA5 (CardConvert or LoggerNet), and give that"
        )
    if lines[0].startswith(LABVIEW):
        return _labview(lines, name)
    return None


def _toa5(lines: Sequence[str], name: str) -> Header:
    """Four rows: the logger, names, units, and how a value was made of its samples."""
    rows = [next(csv.reader([line])) for line in lines[1:4] if line.strip()]
    if len(rows) < 3 or len({len(r) for r in rows}) > 1:
        raise IvsidError(
            f"{name} begins as a TOA5 table, whose rows 2 to 4 hold names, units and processing, a cell for each column; export the table again"
        )
    units = [u.strip() if u.strip() not in ("TS", "RN") else "" for u in rows[1]]
    names = tuple(f"{n.strip()} [{u}]" if u else n.strip() for n, u in zip(rows[0], units, strict=True))
    return Header(names, ",", 4)


def _labview(lines: Sequence[str], name: str) -> Header:
    """Keys with their values, twice, each up to a mark of its end; then the names of the columns."""
    ends = [k for k, line in enumerate(lines) if line.strip("\t, ").startswith(END)]
    begins = [k for k, line in enumerate(lines) if line.startswith(X)]
    if len(ends) < 2 or not begins or begins[0] < ends[1]:
        raise IvsidError(
            f"{name} begins as a measurement file of LabVIEW, and lacks {END} or the row {X} below it; save it with one header"
        )
    told = next((line for line in lines if line.startswith("Separator")), "Separator\tTab")
    separator = "," if told.rpartition("Separator")[2].strip("\t, ").startswith("Comma") else "\t"
    keys = {line.split(separator)[0]: [c.strip() for c in line.split(separator)[1:]] for line in lines[: begins[0]]}
    columns = [c.strip() for c in lines[begins[0]].split(separator)]
    kind = (keys.get("X_Columns") or ["One"])[0]
    if kind == "Multi":
        raise IvsidError(
            f"{name} has a column of stamps for each channel (X_Columns Multi); save it with one time column for all channels"
        )
    units = dict(zip(columns[1:], keys.get("Y_Unit_Label", []), strict=False))
    names = [f"{X} [s]", *(f"{c} [{units[c]}]" if units.get(c) else c for c in columns[1:])]
    steps = {float(s) for s in keys.get("Delta_X", []) if s}
    if kind == "No" and (len(steps) != 1 or min(steps) <= 0):
        raise IvsidError(
            f"{name} has no time column (X_Columns No), and its Delta_X states no common step; save it with one time column"
        )
    step = repr(steps.pop()) if kind == "No" else ""
    return Header(tuple(names), separator, begins[0] + 1, step)
