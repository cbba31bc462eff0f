"""Statements that hold where a few rows may be wrong: for every choice of wrong rows a proof uses none of them.

A proof from the rows S holds whichever other rows are wrong. A statement therefore stands against q wrong rows exactly when no q rows
together touch every proof of it. The proofs alone are examined; the search that found them plays no part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, TypeAlias

from ivsid.verification.errors import UnprovedError
from ivsid.verification.result import Stored

# Kind, channel, time [s], duration [s].
RowName: TypeAlias = tuple[str, str, float, float]
Chosen: TypeAlias = frozenset[RowName]

NOTHING: Final[Chosen] = frozenset()
# Choices of wrong rows that are followed for one statement.
# Source: resource: minutes of time, and memory of the choices seen
MOST: Final = 50_000
# Wrong rows that are followed one within another, each a level of recursion.
# Source: resource: depth of Python's call stack
DEEPEST: Final = 100


@dataclass(frozen=True)
class Proof:
    """A proof on one cell of signs: that it is empty, or a bound of one end.

    Attributes:
        end: parameter, and ``lower`` or ``upper``; None for an empty cell.
        bound: the proved bound; None for an empty cell.
        rows: rows that it uses.
        meant: wrong rows that it was made for, which order the search and prove nothing.
    """

    end: tuple[str, str] | None
    bound: Fraction | None
    rows: Chosen
    meant: Chosen = NOTHING


def named(row: Stored) -> RowName:
    """The name of a row of a result: kind, channel, time and duration."""
    return str(row["kind"]), str(row["channel"]), float(row["time"]), float(row["duration"])


def left_open(
    proofs: Sequence[Proof], wrong: int, allowed: Callable[[Chosen], bool] = lambda _: False
) -> Chosen | None:
    """At most ``wrong`` rows that touch every proof; None without such rows.

    Args:
        proofs: of one statement.
        wrong: number of rows that may be wrong.
        allowed: whether a choice of that many rows needs no proof.

    Raises:
        UnprovedError: more choices than ``MOST``, or more wrong rows than ``DEEPEST``.
    """
    if wrong > DEEPEST:
        raise UnprovedError(f"{wrong} wrong rows are more than the {DEEPEST} that are followed")
    first = {p.meant: p for p in proofs if not p.rows & p.meant}
    seen: set[Chosen] = set()

    def look(gone: Chosen) -> Chosen | None:
        if gone in seen:
            return None
        if len(seen) > MOST:
            raise UnprovedError(f"a claim rests on more than {MOST} choices of wrong rows")
        found = first.get(gone) or next((p for p in proofs if not p.rows & gone), None)
        if found is None:
            return None if len(gone) == wrong and allowed(gone) else gone
        if len(gone) < wrong:
            for row in found.rows:
                if (bad := look(gone | {row})) is not None:
                    return bad
        seen.add(gone)
        return None

    return look(NOTHING)


def check_choices(listed: Stored, cells: Sequence[Sequence[Proof]], wrong: int) -> None:
    """Checks the fewest rows that have to be wrong, and every choice of that many, against the proofs that cells are empty.

    Args:
        listed: ``fewest`` and ``sets`` of a block.
        cells: for each cell of signs the proofs that it is empty.
        wrong: number of rows that may be wrong.

    Raises:
        UnprovedError: fewer rows may do, a choice is left out, or a choice that is named is disproved.
    """
    fewest = listed["fewest"]
    if fewest is not None and (not isinstance(fewest, int) or isinstance(fewest, bool) or not 0 <= fewest <= wrong):
        raise UnprovedError(f"the fewest wrong rows are {fewest!r}, and {wrong} may be")
    sets = [frozenset(named(r) for r in chosen) for chosen in listed["sets"]]
    if bool(sets) != bool(fewest) or len(set(sets)) < len(sets) or any(len(s) != fewest for s in sets):
        raise UnprovedError(f"the choices of wrong rows are not choices of {fewest!r}")
    if fewest is None:
        if any(left_open(proofs, wrong) is not None for proofs in cells):
            raise UnprovedError(f"{wrong} wrong rows may be enough, and it is claimed that they are not")
        return
    for chosen in sets or [NOTHING]:
        if all(any(not p.rows & chosen for p in proofs) for proofs in cells):
            raise UnprovedError(f"without {shown(chosen)} the rest still contradicts itself")
    for proofs in cells:
        missing = left_open(proofs, fewest, lambda gone: not gone or gone in sets)
        if missing is not None:
            raise UnprovedError(f"{shown(missing)} may be all that is wrong, and that is not among the choices")


def shown(rows: Chosen) -> str:
    """Rows in words."""
    return " and ".join(f"the {channel} row at t = {time!r} s" for _, channel, time, _ in sorted(rows)) or "no row"
