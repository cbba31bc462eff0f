"""Tables with a row for each reading: a column names the series, another holds its value, as plots of Foxglove and data bases export them.

Series with the same stamps become the columns of one table, as if each message had a row of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.files.log_map import TimeColumn
from ivsid.log.source import Table

# Columns that name a series, a field of it, its unit and its value, in small letters.
SERIES: Final = ("topic", "series", "signal", "channel", "variable", "path", "name", "_measurement")
FIELDS: Final = ("field", "key", "_field")
UNITS: Final = ("unit", "units")
VALUES: Final = ("value", "_value")
# Series of one file; a column with more different words names no series.
# Source: definition: a log has tens of channels, a column of text may have as many words as rows
MOST_SERIES: Final = 2000

Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Whole:
    """The table as it stands in the file; its columns are read once."""

    table: Table
    value: str
    _kept: dict[tuple[str, bool], pl.Series] = field(default_factory=dict, repr=False)

    def column(self, name: str, *, exact: bool) -> pl.Series:
        """A whole column."""
        if (name, exact) not in self._kept:
            self._kept[name, exact] = self.table.exact(name) if exact else self.table.read([name])[name]
        return self._kept[name, exact]


@dataclass(frozen=True)
class Group:
    """Series with the same stamps.

    Attributes:
        whole: the table of the file.
        stamps: its columns that change within a series.
        series: rows of the file by the name of a column, shape (n,) each.
    """

    whole: Whole
    stamps: tuple[str, ...]
    series: Mapping[str, Rows]
    clock: TimeColumn | None = None
    first_row: int = 1

    @cached_property
    def columns(self) -> list[str]:
        """The stamps, and the series."""
        return [*self.stamps, *self.series]

    def read(self, names: Sequence[str]) -> dict[str, pl.Series]:
        """The columns as they are in the file."""
        return {n: self._cells(n, exact=False) for n in names}

    def exact(self, name: str) -> pl.Series:
        """One column with every digit."""
        return self._cells(name, exact=True)

    def _cells(self, name: str, *, exact: bool) -> pl.Series:
        rows = self.series.get(name)
        source = name if rows is None else self.whole.value
        chosen = next(iter(self.series.values())) if rows is None else rows
        return self.whole.column(source, exact=exact)[chosen].alias(name)


def split(table: Table) -> Mapping[str, Table] | None:
    """The tables of a file with a row for each reading, by name; None where each row holds all channels."""
    small = {c.strip().lower(): c for c in reversed(table.columns)}
    name, part, unit, value = (_first(small, words) for words in (SERIES, FIELDS, UNITS, VALUES))
    if value is None or (name is None and part is None):
        return None
    words = [c for c in (name, part) if c is not None]
    labels = _labels([table.exact(c) for c in words])
    kinds = None if labels is None else labels.unique(maintain_order=True).drop_nulls()
    if labels is None or kinds is None or not 1 < kinds.len() <= min(MOST_SERIES, labels.len() // 2):
        return None
    rows = {str(k): np.flatnonzero((labels == k).fill_null(value=False).to_numpy()) for k in kinds}
    whole = Whole(table, value)
    others = [c for c in table.columns if c not in (*words, value, unit)]
    stamps = [c for c in others if _changes(whole.column(c, exact=True), rows.values())]
    if unit is not None:
        rows = {_with_unit(k, whole.column(unit, exact=True)[r]): r for k, r in rows.items()}
    return _named(whole, _groups(whole, stamps, rows))


def _first(small: Mapping[str, str], words: Iterable[str]) -> str | None:
    return next((small[w] for w in words if w in small), None)


def _labels(columns: Sequence[pl.Series]) -> pl.Series | None:
    """The name of the series of each row; None where the columns hold numbers."""
    if any(c.dtype not in (pl.String, pl.Categorical, pl.Enum) for c in columns):
        return None
    texts = [c.cast(pl.String).str.strip_chars() for c in columns]
    if texts[0].cast(pl.Float64, strict=False).is_not_null().any():
        return None
    return texts[0] if len(texts) == 1 else texts[0] + "." + texts[1]


def _changes(column: pl.Series, series: Iterable[Rows]) -> bool:
    """Whether a column changes within a series, as stamps do and frames or units do not."""
    return any(column[r].n_unique() > 1 for r in series)


def _with_unit(name: str, units: pl.Series) -> str:
    """The name of a series with its unit, as a header states it."""
    stated = units.cast(pl.String).drop_nulls().unique()
    return f"{name} [{stated[0].strip()}]" if stated.len() == 1 and stated[0].strip() else name


def _groups(whole: Whole, stamps: Sequence[str], rows: Mapping[str, Rows]) -> list[Group]:
    """Series whose stamps agree in every cell, together; columns of stamps that a group leaves empty are no columns of it."""
    found: list[tuple[pl.DataFrame, dict[str, Rows]]] = []
    by_hash: dict[bytes, list[int]] = {}
    for name, chosen in rows.items():
        cells = pl.DataFrame([whole.column(c, exact=True)[chosen] for c in stamps])
        key = cells.hash_rows().to_numpy().tobytes() if stamps else b""
        same = next((k for k in by_hash.get(key, ()) if found[k][0].equals(cells)), None)
        if same is None:
            by_hash.setdefault(key, []).append(len(found))
            found.append((cells, {}))
        found[len(found) - 1 if same is None else same][1][name] = chosen
    return [
        Group(whole, tuple(c for c in stamps if cells[c].null_count() < cells.height), series)
        for cells, series in found
    ]


def _named(whole: Whole, groups: Sequence[Group]) -> dict[str, Table]:
    """Tables by the words that the names of their series begin with; a single one holds whole names."""
    if len(groups) == 1:
        return {"": groups[0]}
    tables: dict[str, Table] = {}
    for g in groups:
        head = _common([n.partition(" [")[0] for n in g.series])
        series = {n[len(head) :].lstrip("./"): r for n, r in g.series.items()} if head else g.series
        name = head or "readings"
        tables[name if name not in tables else f"{name}[{len(tables)}]"] = Group(whole, g.stamps, series)
    return tables


def _common(names: Sequence[str]) -> str:
    """The words before the last one that all names begin with; the topic of a message path, where they have one."""
    heads = [[m.end() for m in re.finditer(r"[^./]+(?=[./])", n)] for n in names]
    topics = {n.partition(".")[0] for n in names if "." in n[1:]}
    if len(topics) == 1 and all("." in n[1:] for n in names):
        return next(iter(topics))
    least = min((len(h) for h in heads), default=0)
    for k in range(least, 0, -1):
        starts = {n[: h[k - 1]] for n, h in zip(names, heads, strict=True)}
        if len(starts) == 1:
            return starts.pop()
    return ""
