"""Units in the headers of columns: ``r [deg/s]`` and ``u (m/s)`` are r and u with their units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from ivsid.errors import IvsidError
from ivsid.log.source import Source

_LABELLED: Final = re.compile(r"(?P<name>.*?\S)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))")
# Other spellings of known units.
_SPELLED: Final = {
    **{"degrees": "deg", "degree": "deg", "°": "deg", "radians": "rad", "radian": "rad"},
    **{"°/s": "deg/s", "deg/sec": "deg/s", "rad/sec": "rad/s", "dps": "deg/s"},
    **{"°/min": "deg/min", "deg/minute": "deg/min"},
    **{"m/s2": "m/s^2", "m/s²": "m/s^2", "m/s/s": "m/s^2", "rad/s2": "rad/s^2", "rad/s²": "rad/s^2"},
    **{"deg/s2": "deg/s^2", "deg/s²": "deg/s^2", "°/s²": "deg/s^2", "m/sec": "m/s", "mps": "m/s"},
    **{"knots": "kn", "knot": "kn", "kts": "kn", "kt": "kn", "sec": "s", "seconds": "s", "µs": "us", "μs": "us"},
    **{
        "cm/sec": "cm/s",
        "ft/sec": "ft/s",
        "fps": "ft/s",
        "mi/h": "mph",
        "kph": "km/h",
        "kmh": "km/h",
        "grad": "gon",
        "mG": "mg",
    },
    **{"cm/s2": "cm/s^2", "cm/s²": "cm/s^2", "mm/s2": "mm/s^2", "mm/s²": "mm/s^2", "feet": "ft", "kNm": "kN m"},
    **{"Nm": "N m", "N·m": "N m", "N*m": "N m", "metres": "m", "meters": "m", "-": "1", "": "1"},
}


@dataclass(frozen=True)
class Label:
    """A column whose header states a unit.

    Attributes:
        table: that holds it.
        column: its whole header.
        name: without the unit.
        unit: as the header spells it.
    """

    table: str
    column: str
    name: str
    unit: str

    def known(self, table: dict[str, float], source: str) -> str:
        """The unit in the package's spelling.

        Args:
            table: of the units that are meant, one of ``ivsid.files.units``.
            source: name of the file, for messages.

        Raises:
            IvsidError: the unit is not in the table.
        """
        unit = spelled(self.unit)
        if unit not in table:
            raise IvsidError(
                f"{source}: the header {self.column} states the unit '{self.unit}', which is none of {', '.join(table)}; map the column under [log] "
                "columns with its unit or scale"
            )
        return unit


def spelled(unit: str) -> str:
    """A unit in the package's spelling, or as it stands where none is known."""
    return _SPELLED.get(unit, unit)


def label(table: str, column: str) -> Label | None:
    """The label of a column, or None where its header states no unit."""
    match = _LABELLED.fullmatch(column)
    # Columns of a matrix and elements of an array have numbers in brackets.
    if match is None or (match["round"] or "").isdigit() or re.fullmatch(r".*\S\[\d+\]", column):
        return None
    unit = match["square"] if match["square"] is not None else match["round"]
    return Label(table, column, match["name"], unit.strip())


def labels(source: Source) -> Mapping[str, Label]:
    """Columns with a unit in their header, by name without it, with and without the table's name; a name that stands plainly is left out."""
    found: dict[str, list[Label]] = {}
    for table, content in source.tables.items():
        for one in filter(None, (label(table, c) for c in content.columns)):
            for name in {one.name, source.shown(table, one.name)}:
                found.setdefault(name, []).append(one)
    plain = set(source.columns)
    return {name: several[0] for name, several in found.items() if len(several) == 1 and name not in plain}
