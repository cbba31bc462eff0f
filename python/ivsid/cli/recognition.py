"""The kind of a file by its content, so that arguments in another order are put right, and a wrong one is named.

A vehicle file is TOML with a table ``hull``, a scenario TOML with ``duration`` and ``rate``, a result JSON that names its command. A folder with a
result.json is that result; it holds a log as well unless the command was ``identify``. Any other file or folder may be a log: readers of
logs look at far more. The name of a shipped vehicle stands for its vehicle file and for its scenario.
"""

from __future__ import annotations

from itertools import combinations, permutations
from os import R_OK, access
from pathlib import Path
from typing import Final

from ivsid.files.parsed import json_value, toml_table
from ivsid.files.shipped import shipped

VEHICLE, SCENARIO, LOG, FIT, FLEET, RESULT = (
    "a vehicle file",
    "a scenario",
    "a log",
    "the result of ivsid identify",
    "the result of ivsid fleet",
    "a result",
)
# Largest text file that is tried as TOML [bytes].
# Source: resource: ten times the largest shipped vehicle file, and a log of this size is tried in a millisecond
MOST_TOML: Final = 200_000


def kinds(path: str | Path) -> frozenset[str]:
    """The kinds that a path may be taken for; none where it leads nowhere, or to a pipe or a damaged file."""
    given = Path(path)
    if not given.exists():
        found = {k for k, suffix in ((VEHICLE, ""), (SCENARIO, "_programme")) if shipped(given, suffix) != given}
        return frozenset(found)
    result = given / "result.json" if given.is_dir() else given
    if result.suffix == ".json":
        command = _command(result)
        if command is not None:
            if command in ("identify", "fleet"):
                return frozenset({FIT if command == "identify" else FLEET})
            return frozenset({RESULT, LOG} if given.is_dir() else {RESULT})
        # A folder without a result is a log, or the folder of a result that was not written.
        return frozenset({LOG, FIT} if given.is_dir() else ())
    if not given.is_file() or not access(given, R_OK):
        # A pipe can be read only once, and any kind of file may come through it.
        return frozenset()
    table = _toml(given)
    if table is None:
        return frozenset() if given.suffix == ".toml" else frozenset({LOG})
    if "hull" in table:
        return frozenset({VEHICLE})
    return frozenset({SCENARIO} if {"duration", "rate"} <= table.keys() else ())


def _command(result: Path) -> str | None:
    """The command that a result names, or None."""
    try:
        record = json_value(result.read_bytes())
    except (OSError, ValueError):
        return None
    command = record.get("command") if isinstance(record, dict) else None
    return command if isinstance(command, str) else None


def _toml(path: Path) -> dict[str, object] | None:
    """The tables of a TOML file, or None."""
    try:
        if path.stat().st_size > MOST_TOML:
            return None
        return toml_table(path.read_text())
    except (OSError, ValueError):
        return None


def fits(given: tuple[frozenset[str], ...], needed: tuple[frozenset[str], ...]) -> bool:
    """Whether each argument may be of the kind that stands at its place."""
    return all(g & n for g, n in zip(given, needed, strict=True))


def in_order(given: tuple[frozenset[str], ...], needed: tuple[frozenset[str], ...]) -> tuple[int, ...] | None:
    """The places of the arguments in the order that the command needs, if there is one such order.

    Arguments whose kinds are the same keep their order, as TRAIN and TEST do.
    """
    orders = []
    for order in permutations(range(len(given))):
        kept = all(i < k for i, k in combinations(order, 2) if given[i] == given[k])
        if kept and fits(tuple(given[k] for k in order), needed):
            orders.append(order)
    return orders[0] if len(orders) == 1 else None
