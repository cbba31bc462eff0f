"""What a fit knows already, as interval rows: those of its certificates, and its intervals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ivsid.identification import Identification
from ivsid.intervals import IntervalArray


def known_rows(fit: Identification, ids: Sequence[str]) -> tuple[IntervalArray, IntervalArray]:
    """Rows that every parameter of the fit keeps, and that bound it as its log does: matrix of shape (m, n), right-hand sides of shape (m,).

    The rows of the certificates are rows of the fit's log, and those that its bounds rest on. Where unknowns that belong to the log alone
    stand in them, as a bias of its accelerometer does, the intervals say what is left.

    Args:
        fit: by ``identify``.
        ids: of the n parameters, in the order of the columns.
    """
    lower: list[list[float]] = []
    upper: list[list[float]] = []
    right: list[tuple[float, float]] = []
    for id_ in ids:
        p = fit.parameters.get(id_)
        if p is not None and (np.isfinite(p.lower) or np.isfinite(p.upper)):
            row = [1.0 if other == id_ else 0.0 for other in ids]
            lower.append(row)
            upper.append(row)
            right.append((p.lower, p.upper))
    seen: set[tuple[object, ...]] = set()
    for c in fit.certificates:
        names = list(c["orthant"])
        if fit.method != "feasible" or fit.options.get("outliers") or not set(names) <= set(ids):
            continue
        places = [ids.index(name) for name in names]
        for made in c.get("rows", ()):
            key = (*names, *made["lower"], *made["upper"], *made["right"])
            if key in seen or len(made["lower"]) != len(names):
                continue
            seen.add(key)
            ends = []
            for end in ("lower", "upper"):
                row = [0.0] * len(ids)
                for place, x in zip(places, made[end], strict=True):
                    row[place] = float.fromhex(x)
                ends.append(row)
            lower.append(ends[0])
            upper.append(ends[1])
            right.append((float.fromhex(made["right"][0]), float.fromhex(made["right"][1])))
    n = len(ids)
    ends_of = np.array(right).reshape(-1, 2)
    return (
        IntervalArray(np.array(lower).reshape(-1, n), np.array(upper).reshape(-1, n)),
        IntervalArray(ends_of[:, 0].copy(), ends_of[:, 1].copy()),
    )
