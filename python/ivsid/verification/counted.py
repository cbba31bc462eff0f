"""Rows and parameters that are counted together where a few rows may be wrong.

The assumption covers all rows that the options make, for each set of parameters that share an equation. A row of another kind or
length was not counted, and parameters that share no equation have wrong rows of their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from ivsid.verification.errors import UnprovedError
from ivsid.verification.outliers import RowName
from ivsid.verification.physics import Meaning, State
from ivsid.verification.rational import Range
from ivsid.verification.result import Stored

if TYPE_CHECKING:
    from ivsid.verification.rows import Rows

_OWN: Final = {"surge": ("udot", "ax"), "sway": ("vdot", "ay"), "yaw": ("rdot",)}


def counted(rows: Rows, options: Stored, name: RowName) -> None:
    """Checks that the options of a result make a row.

    Raises:
        UnprovedError: the options make no such row.
    """
    kind, channel, time, duration = name
    chosen, window = options["rows"], options["window"]
    measured = any(rows.readings.logged(n) and n not in rows.log.derived for n in _OWN.get(channel, ()))
    kinds = {
        "pointwise": {"pointwise"},
        "integral": {"integral"},
        "weak": {"weak"},
        "both": {"pointwise", "integral", "weak"},
        "auto": {"pointwise"} if measured else {"pointwise", "integral"},
    }.get(chosen, set())
    if kind not in kinds:
        raise UnprovedError(
            f"rows {chosen!r} make no {kind} rows in {channel}, so none of them is counted among the wrong"
        )
    if kind == "pointwise":
        return
    first, last = rows.span(time, duration)
    lengths = [float(w) for w in (window if isinstance(window, list) else [window])]
    steps = [max(1, round(w / rows.log.period)) * (1 + (kind == "weak")) for w in lengths]
    if last - first not in steps:
        raise UnprovedError(f"windows of {lengths} s make no {kind} row of {duration!r} s")


def linked(terms: Mapping[str, Meaning], ids: Iterable[str]) -> None:
    """Checks that parameters share equations, one with another.

    Raises:
        UnprovedError: some parameters have equations of their own.
    """
    u, v, r, udot, vdot, rdot, psi = (Range(Fraction(k + 2, 7)) for k in range(7))
    probe = State(u, v, r, udot, vdot, rdot, psi=psi)
    groups: list[tuple[set[str], set[str]]] = []
    for id_ in ids:
        own, channels = {id_}, {c for c, x in terms[id_].columns(probe).items() if x.magnitude}
        for group in [g for g in groups if g[1] & channels]:
            own, channels = own | group[0], channels | group[1]
            groups.remove(group)
        groups.append((own, channels))
    if len(groups) > 1:
        alone = ", ".join(sorted(groups[-1][0]))
        raise UnprovedError(f"{alone} shares no equation with the rest of its block, and has wrong rows of its own")
