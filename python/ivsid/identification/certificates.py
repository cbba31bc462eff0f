"""Certificates of a feasible set as records: the rows and multipliers that prove each bound."""

from __future__ import annotations

from typing import Any, TypedDict

from ivsid.effects import CHANNELS
from ivsid.linear import regression
from ivsid.rows import ROW_KINDS, RegressionRows


class RowName(TypedDict):
    """A row by its kind, channel, start [s] and length [s]."""

    kind: str
    channel: str
    time: float
    duration: float


class WrongRows(TypedDict):
    """The least number of rows that must be wrong, and every choice of that many; no choice where the number is 0 or None."""

    fewest: int | None
    sets: list[list[RowName]]


def _row_name(rows: RegressionRows, index: int) -> RowName:
    return {
        "kind": ROW_KINDS[rows.kind[index]],
        "channel": CHANNELS[rows.channel[index]],
        "time": float(rows.time[index]),
        "duration": float(rows.duration[index]),
    }


def wrong_rows(rows: RegressionRows, found: regression.FeasibleSet) -> WrongRows:
    """The rows that must be wrong, of a feasible set that allows wrong rows."""
    return {
        "fewest": found.fewest_outliers,
        "sets": [[_row_name(rows, k) for k in sorted(chosen)] for chosen in found.outliers]
        if found.fewest_outliers
        else [],
    }


def feasible_certificates(rows: RegressionRows, found: regression.FeasibleSet) -> tuple[dict[str, Any], ...]:
    """The certificates of a feasible set, one for each bound in each orthant, and for each proof of signs or of emptiness.

    A row of a certificate has its name, its interval entries as hexadecimal floats, the side that is used, and its multiplier.
    """
    ids = [t.id for t in rows.terms]

    def row(entry: tuple[int, bool, float]) -> dict[str, Any]:
        index, lower_side, multiplier = entry
        matrix, right = rows.matrix[index], rows.right[index]
        return {
            "row": int(index),
            **_row_name(rows, index),
            "side": "lower" if lower_side else "upper",
            "multiplier": multiplier,
            "lower": [x.hex() for x in matrix.lower.tolist()],
            "upper": [x.hex() for x in matrix.upper.tolist()],
            "right": [float(right.lower).hex(), float(right.upper).hex()],
        }

    certificates: list[dict[str, object]] = []
    for proof in found.sign_proofs:
        home = dict(zip(ids, proof["home"], strict=True))
        reach = zip((c[0] for c in proof["columns"]), proof["reach"], strict=True)
        certificates.append(
            {
                "proves": "signs",
                "orthant": dict(zip(ids, proof["decided"], strict=True)),
                "home": home,
                "proved": [ids[j] for j, r in reach if r == 0],
                "branch": None if proof["branch"] is None else ids[proof["branch"]],
                "columns": [
                    {
                        "parameter": ids[j],
                        "rows": [row(e) for e in rows_],
                        "signs": [{"parameter": ids[k], "multiplier": m} for k, m in signs_],
                    }
                    for j, rows_, signs_ in proof["columns"]
                ],
                "vector": [float(v).hex() for v in proof["vector"]],
            }
        )
    for orthant in found.certificate:
        signs = dict(zip(ids, orthant["signs"], strict=True))
        left_out = {"dropped": [_row_name(rows, k) for k in orthant["dropped"]]} if orthant["dropped"] else {}
        if orthant["empty"]:
            contradiction = [row(e) for e in orthant["rows"]]
            certificates.append({"proves": "empty", "orthant": signs, "rows": contradiction, **left_out})
            continue
        for bound in orthant["bounds"]:
            certificates.append(
                {
                    "proves": "bound",
                    "orthant": signs,
                    "parameter": ids[bound["column"]],
                    "end": bound["end"],
                    "bound": bound["bound"].hex(),
                    "rows": [row(e) for e in bound["rows"]],
                    "signs": [{"parameter": ids[j], "multiplier": m} for j, m in bound["signs"]],
                    **left_out,
                }
            )
    return tuple(certificates)
