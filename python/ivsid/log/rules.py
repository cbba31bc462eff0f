"""Where each channel comes from: a column by its name, by its name without the unit of its header, or a formula of columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError, meant
from ivsid.files import units
from ivsid.files.log_map import Column, LogMap, TimeColumn
from ivsid.log.arithmetic import Formula, formula
from ivsid.log.channels import BY_THRUSTER, COLUMNS, DEMAND, Clocked
from ivsid.log.headers import Label, label, labels
from ivsid.log.runs import one_run
from ivsid.log.source import Source

Array = NDArray[np.float64]
# The end of the note on a column whose header states its unit.
BY_HEADER: Final = ", as its header says"


@dataclass(frozen=True)
class Rule:
    """The origin of a channel: its table, its column, and the stamps of its samples.

    Attributes:
        column: as the map gives it, with the unit that its header states.
        table: that holds it.
        name: of the column, or the text of a formula.
        clock: table and column of the stamps.
        stamps: how they are read.
        formula: of columns of the table, or None.
        note: a sentence for the user, or nothing.
    """

    column: Column
    table: str
    name: str
    clock: Clocked
    stamps: TimeColumn
    formula: Formula | None = None
    note: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """The columns that are read, without the name of their table."""
        if self.formula is None:
            return (self.name,)
        return tuple(n.removeprefix(f"{self.table}/") if self.table else n for n in self.formula.names)

    def values(self, cells: Mapping[str, Array]) -> tuple[Array, Array | None]:
        """Cells of the column, or values of the formula with bounds on their errors, from the cells of ``names``."""
        if self.formula is None:
            return cells[self.name], None
        given = {full: cells[bare] for full, bare in zip(self.formula.names, self.names, strict=True)}
        if (marker := self.column.missing) is not None:
            given = {n: np.where(x == marker, np.nan, x) for n, x in given.items()}
        return self.formula.value(given)


def rules_of(source: Source, mapping: LogMap) -> tuple[dict[str, Rule], tuple[str, ...]]:
    """The rule of every channel that the source has, and the names of the columns that no rule uses.

    Raises:
        IvsidError: the map names a column or a channel that does not exist, or the source holds several runs.
    """
    _check_targets(mapping)
    one_run(source, mapping)
    several = len(source.tables) > 1
    labelled = labels(source)
    # A header with a unit is no name of a thruster: demand_port [rpm] is demand_port.
    foreign = [*(c for n, t in source.tables.items() for c in t.columns if label(n, c) is None), *labelled]
    known = [c for c in COLUMNS if c in foreign or c in mapping.columns]
    demands = [c for c in (*foreign, *mapping.columns) if c.startswith(DEMAND)]
    # An angle belongs to a thruster that the log knows; another column may be called rudder_mode and hold words.
    names = [c.removeprefix(DEMAND) for c in demands]
    angles = [p + n for p in BY_THRUSTER[1:] for n in names if p + n in foreign]
    thrusters = [*demands, *angles, *(c for c in mapping.columns if c.startswith(BY_THRUSTER[1:]))]
    rules: dict[str, Rule] = {}
    used: set[tuple[str, str]] = set()
    for wanted in dict.fromkeys((*known, *thrusters)):
        given = mapping.columns.get(wanted, wanted)
        column = given if isinstance(given, Column) else Column.model_validate({"from": given})
        rule = _rule(source, mapping, labelled, column)
        if rule is None:
            if wanted in mapping.columns:
                raise IvsidError(
                    f"{source.name} has no column {column.from_}, which [log] maps to {wanted}; {meant(column.from_, source.columns)}it has {_some(source)}"
                )
            continue
        rules[wanted] = rule
        used |= {*((rule.table, n) for n in rule.names), rule.clock}
    if not rules and not several:
        table = next(iter(source.tables))
        used.add(_clock(source, mapping, table, None)[1])
    ignored = tuple(
        f"{t}/{c}" if t else c for t, table in source.tables.items() for c in table.columns if (t, c) not in used
    )
    return rules, ignored


def _rule(source: Source, mapping: LogMap, labelled: Mapping[str, Label], column: Column) -> Rule | None:
    """The rule of a column by its name, by its name without the unit of its header, or by a formula; None where there is none."""
    found = source.find(column.from_)
    stated = labelled.get(column.from_) if found is None else label(*found)
    if found is None and stated is None:
        made = formula(column.from_)
        return None if made is None else _of_formula(source, mapping, column, made)
    table, name = found or (stated.table, stated.column)  # type: ignore[union-attr]
    note = ""
    if stated is not None and not {"unit", "scale"} & column.model_fields_set:
        unit = stated.known(units.COLUMN, source.name)
        column = column.model_copy(update={"unit": unit})
        note = f"{source.shown(table, name)} is read in {unit}{BY_HEADER}"
    stamps, clock = _clock(source, mapping, table, column)
    return Rule(column, table, name, clock, stamps, note=note)


def _of_formula(source: Source, mapping: LogMap, column: Column, made: Formula) -> Rule:
    """The rule of a formula.

    Raises:
        IvsidError: a column of it is not there, or its columns have several tables.
    """
    places = {n: source.find(n) for n in made.names}
    lacking = next((n for n, place in places.items() if place is None), None)
    if lacking is not None:
        raise IvsidError(
            f"{source.name} has no column {lacking}, which [log] columns has in '{made.text}'; it has {_some(source)} (names that are no plain words "
            "stand in backquotes)"
        )
    tables = {place[0] for place in places.values() if place is not None}
    if len(tables) > 1:
        raise IvsidError(f"{source.name}: '{made.text}' has columns of several tables; a formula takes those of one")
    (table,) = tables
    stamps, clock = _clock(source, mapping, table, column)
    return Rule(column, table, made.text, clock, stamps, made)


def _some(source: Source, most: int = 16) -> str:
    names = source.columns
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def _check_targets(mapping: LogMap) -> None:
    for name in mapping.columns:
        if name not in COLUMNS and name != "t" and not name.startswith(BY_THRUSTER):
            raise IvsidError(f"[log] columns maps '{name}', which is no column of a log; see the table of columns")
    for name in mapping.rates:
        if name not in COLUMNS and not name.startswith(BY_THRUSTER[1:]):
            raise IvsidError(f"[log] rates has '{name}', which is no channel that is interpolated; name one such as u")
    if isinstance(mapping.columns.get("t"), Column):
        raise IvsidError(
            '[log] columns maps t with a table; write time = { from = "...", unit = "..." } under [log] instead'
        )


def row_clock(source: Source, mapping: LogMap, table: str) -> tuple[TimeColumn, Clocked]:
    """The column of the stamps of a table's rows, and the clock that it makes.

    Raises:
        IvsidError: the table has no such column.
    """
    return _clock(source, mapping, table, None)


def _clock(source: Source, mapping: LogMap, table: str, column: Column | None) -> tuple[TimeColumn, Clocked]:
    if column is not None and column.time is not None:
        # Stamps of one name in many tables, as topics of a bag have them, are those of the column's own table.
        own = column.time.from_
        found = (table, own) if table and own in source.tables[table].columns else source.find(own)
        if found is None or found[0] != table:
            raise IvsidError(
                f"{source.name} has no column {column.time.from_} beside {column.from_}, whose stamps it should be; "
                f"it has {_some(source)}"
            )
        return column.time, found
    content = source.tables[table]
    renamed = mapping.columns.get("t")
    stamps = mapping.time or (TimeColumn.model_validate({"from": renamed}) if isinstance(renamed, str) else None)
    stamps = stamps or content.clock or TimeColumn()
    name = stamps.from_.removeprefix(f"{table}/") if table else stamps.from_
    if name not in content.columns:
        stated = labels(source).get(source.shown(table, name))
        if stated is not None:
            unit = stamps.unit or stated.known(units.TIME, source.name)
            return stamps.model_copy(update={"unit": unit}), (table, stated.column)
        where = f"{source.name}, table {table}," if table else source.name
        raise IvsidError(
            f"{where} has no column {name} for the time; {meant(name, content.columns)}it has {', '.join(list(content.columns)[:12])}"
        )
    return stamps, (table, name)
