"""Values of JSON as tables: records, columns, messages of several topics, and what other libraries write."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final, TypeAlias

import polars as pl

from ivsid.errors import IvsidError
from ivsid.log.long_tables import MOST_SERIES, SERIES, VALUES
from ivsid.log.source import Frame, Table

Scalar: TypeAlias = str | int | bool | None
Record: TypeAlias = dict[str, Scalar]

# Items of a list that become columns: a covariance of ROS has 36; a scan of a laser is no channel.
# Source: definition: a list of more items is no list of channels
MOST_ITEMS: Final = 64
# Words that name the topic of a record beside those of long tables, and the words in front of what a message holds.
TOPICS: Final = (*SERIES, "type", "msg_type", "message_type", "mavpackettype")
BODIES: Final = ("msg", "message", "data", "payload", "fields", "values")


def tables_of(value: object, name: str) -> Mapping[str, Table]:
    """The tables of a value of JSON.

    Raises:
        IvsidError: the value holds no samples.
    """
    found = _found(value, name)
    if not found:
        raise IvsidError(
            f'{name} holds JSON without samples; give a list of records ([{{"t": 0.0, "u": 1.2}}, ...]), one record a line, or a list of values a column '
            '({"t": [0.0, ...], "u": [1.2, ...]})'
        )
    return {table: Frame(frame, first_row=1) for table, frame in found.items()}


def _found(value: object, name: str) -> dict[str, pl.DataFrame]:
    """Frames by the name of their table, which is empty for a single one."""
    if isinstance(value, list):
        if value and all(isinstance(v, dict) for v in value):
            return _messages([_flat(v) for v in value])
        return _rows(value, name)
    if not isinstance(value, dict):
        return {}
    names, cells = value.get("columns"), value.get("data")
    if _is_column(names) and isinstance(cells, list) and cells and isinstance(cells[0], list):
        # As pandas splits a table.
        return _rows([names, *cells], name)
    columns = dict(_columns(value))
    if columns:
        return _of_columns(columns, name)
    below = {str(k): made for k, v in value.items() if isinstance(v, dict | list) and (made := _found(v, name))}
    if len(below) == 1:
        return next(iter(below.values()))
    return {f"{k}/{t}" if t else k: frame for k, made in below.items() for t, frame in made.items()}


def _flat(value: Mapping[str, object]) -> Record:
    """A record whose names are paths into the tables and lists of a value."""
    made: Record = {}
    todo: list[tuple[str, object]] = [*value.items()][::-1]
    while todo:
        path, v = todo.pop()
        if isinstance(v, dict):
            todo += reversed([(f"{path}.{k}", x) for k, x in v.items()])
        elif isinstance(v, list):
            todo += reversed([(f"{path}[{k}]", x) for k, x in enumerate(v)] if len(v) <= MOST_ITEMS else [])
        else:
            made[path] = v  # type: ignore[assignment]
    return made


def _frame(records: Sequence[Record]) -> pl.DataFrame:
    """Records as columns, in the order in which their names come up."""
    names = list(dict.fromkeys(n for r in records for n in r))
    return pl.DataFrame({n: _series([r.get(n) for r in records]) for n in names})


def _series(cells: Sequence[Scalar]) -> pl.Series:
    """Integers of 64 bits, or else text with every digit; a missing cell is null."""
    whole = all(c is None or (isinstance(c, int) and -(2**63) <= c < 2**63) for c in cells)
    if whole and any(c is not None for c in cells):
        return pl.Series([None if c is None else int(c) for c in cells], dtype=pl.Int64)
    return pl.Series([None if c is None else str(int(c) if isinstance(c, bool) else c) for c in cells], dtype=pl.String)


def _messages(records: Sequence[Record]) -> dict[str, pl.DataFrame]:
    """A table for each topic where a word of every record names its topic, or else for records that share nothing but their stamps."""
    topic = _topic(records)
    if topic is not None:
        groups: dict[str, list[Record]] = {}
        for r in records:
            groups.setdefault(str(r[topic]).strip(), []).append({k: v for k, v in r.items() if k != topic})
        return {t: _frame(_bared(rs)) for t, rs in groups.items() if len(rs) > 1}
    kinds = list(dict.fromkeys(frozenset(r) for r in records))
    shared = frozenset.intersection(*kinds)
    parts: list[set[str]] = []
    for kind in kinds:
        own = set(kind - shared)
        touched = [p for p in parts if p & own]
        parts = [p for p in parts if not p & own] + ([set.union(own, *touched)] if own else [])
    if len(parts) < 2 or not shared:
        return {"": _frame(records)}
    frames = [_frame([r for r in records if part & r.keys()]) for part in parts]
    heads = [_head(part) for part in parts]
    named = {head or f"records[{k}]": frame for k, (head, frame) in enumerate(zip(heads, frames, strict=True))}
    return {n: frame.rename(lambda c, n=n: c.removeprefix(f"{n}.")) for n, frame in named.items()}  # type: ignore[misc]


def _topic(records: Sequence[Record]) -> str | None:
    """The name whose words say which message a record is."""
    ends = {k: k.rpartition(".")[2].lower() for k in records[0]}
    if any(end in VALUES for end in ends.values()):
        # Readings one by one, which long tables take apart.
        return None
    for key in sorted((k for k, end in ends.items() if end in TOPICS), key=lambda k: TOPICS.index(ends[k])):
        words = {r.get(key) for r in records}
        if all(isinstance(w, str) for w in words) and 1 < len(words) <= min(MOST_SERIES, len(records) // 2):
            return key
    return None


def _bared(records: Sequence[Record]) -> list[Record]:
    """Messages without the word in front of all that they hold."""
    names = {k for r in records for k in r}
    for head in BODIES:
        inside = {k.removeprefix(f"{head}.") for k in names if k.startswith(f"{head}.")}
        if inside and not inside & names:
            names = {k.removeprefix(f"{head}.") for k in names}
            records = [{k.removeprefix(f"{head}."): v for k, v in r.items()} for r in records]
    return list(records)


def _head(names: set[str]) -> str:
    """The word in front of all names, or nothing."""
    heads = {n.partition(".")[0] for n in names if "." in n}
    return heads.pop() if len(heads) == 1 and all("." in n for n in names) else ""


def _is_column(value: object) -> bool:
    return isinstance(value, list) and len(value) > 1 and not any(isinstance(v, dict | list) for v in value)


def _columns(value: Mapping[str, object], head: str = "") -> Iterator[tuple[str, list[Scalar]]]:
    """Lists of cells by their paths, and columns of cells by the number of their row, as pandas writes them."""
    for k, v in value.items():
        path = f"{head}.{k}" if head else str(k)
        if _is_column(v):
            yield path, v  # type: ignore[misc]
        elif isinstance(v, dict):
            if len(v) > 1 and all(n.isdigit() and not isinstance(x, dict | list) for n, x in v.items()):
                yield path, list(v.values())
            else:
                yield from _columns(v, path)


def _of_columns(columns: Mapping[str, list[Scalar]], name: str) -> dict[str, pl.DataFrame]:
    """One table of columns of one length, or a table for each word in front of them.

    Raises:
        IvsidError: columns of a table whose lengths differ.
    """
    if len({len(c) for c in columns.values()}) == 1:
        return {"": pl.DataFrame({n: _series(c) for n, c in columns.items()})}
    tables: dict[str, dict[str, list[Scalar]]] = {}
    for path, cells in columns.items():
        table, _, column = path.rpartition(".")
        tables.setdefault(table, {})[column] = cells
    for held in tables.values():
        lengths = {n: len(c) for n, c in held.items()}
        if len(set(lengths.values())) > 1:
            shown = ", ".join(f"{n} {k}" for n, k in list(lengths.items())[:6])
            raise IvsidError(
                f"{name}: its columns have unequal numbers of cells ({shown}); give each a cell for every stamp, with null where there is none"
            )
    return {t: pl.DataFrame({n: _series(c) for n, c in held.items()}) for t, held in tables.items()}


def _rows(value: Sequence[object], name: str) -> dict[str, pl.DataFrame]:
    """Lists of cells, the first of which holds the names.

    Raises:
        IvsidError: names or cells are missing.
    """
    rows = [v for v in value if isinstance(v, list)]
    if len(rows) < len(value) or len(rows) < 2:
        return {}
    names = [str(n) for n in rows[0]]
    if not all(isinstance(n, str) for n in rows[0]) or len(set(names)) < len(names) or _are_numbers(names):
        raise IvsidError(
            f'{name} begins with the row [{", ".join(names[:6])}], which are no names of columns; let its first row be such as ["t", "u", "v", "r"]'
        )
    bad = next((k for k, r in enumerate(rows) if len(r) != len(names)), None)
    if bad is not None:
        raise IvsidError(f"{name}: row {bad} has {len(rows[bad])} cells where the first has {len(names)} names")
    return {"": pl.DataFrame({n: _series([r[k] for r in rows[1:]]) for k, n in enumerate(names)})}


def _are_numbers(names: Sequence[str]) -> bool:
    return bool(pl.Series(names).cast(pl.Float64, strict=False).is_not_null().any())
