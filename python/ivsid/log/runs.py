"""Runs beside each other in one folder: tables with the same columns, which hold how the vessel moves, are no log on several clocks."""

from __future__ import annotations

from typing import Final

from ivsid.errors import IvsidError
from ivsid.files.log_map import Column, LogMap
from ivsid.log.headers import label
from ivsid.log.source import SEPARATOR, Source

# A run states how fast and how the vessel turns: one channel of each.
SPEEDS: Final = frozenset({"u", "velocity_north", "x", "latitude"})
TURNS: Final = frozenset({"r", "psi", "qw", "y", "longitude"})
# Names that a sentence shows.
# Source: resource: a sentence
SHOWN: Final = 4


def one_run(source: Source, mapping: LogMap) -> None:
    """Refuses several runs in place of one log.

    Args:
        source: an opened log.
        mapping: of its columns; a column of one of the runs by its full name makes the choice.

    Raises:
        IvsidError: two tables with the same columns, by which the mapping knows the motion.
    """
    alike: dict[tuple[str, ...], list[str]] = {}
    for table, content in source.tables.items():
        alike.setdefault(tuple(sorted(content.columns)), []).append(table)
    for columns, tables in alike.items():
        if len(tables) == 1:
            continue
        names = {*columns, *(stated.name for c in columns if (stated := label(tables[0], c)) is not None)}
        held = {channel: name for channel in sorted(SPEEDS | TURNS) if (name := _name(mapping, channel)) in names}
        if held.keys() & SPEEDS and held.keys() & TURNS:
            shown = ", ".join(tables[:SHOWN]) + (", ..." if len(tables) > SHOWN else "")
            first = held.get("u", next(iter(held.values())))
            raise IvsidError(
                f"{source.name} holds {len(tables)} runs ({shown}: the same columns in each), and one log is needed; give one of these files "
                f"(ivsid diagnose takes two, ivsid fleet all of them), or map the columns of the one that is meant, as "
                f'"{tables[0]}{SEPARATOR}{first}" under [log] columns'
            )


def _name(mapping: LogMap, channel: str) -> str:
    """The column that a channel is read from."""
    given = mapping.columns.get(channel, channel)
    return given.from_ if isinstance(given, Column) else given
