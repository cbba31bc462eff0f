"""Signs that hold for every consistent parameter, proved from a few rows each, in fractions.

With z a sign for each unknown, |x_k| = z_k x_k + 2 d_k, where d_k >= 0 is the distance of x_k beyond 0 on the other side. A row's
half-space, made with the signs z, then holds up to sum_k (b_k - a_k) d_k, and multipliers that prove z_j x_j >= b_j from such rows prove
``z_j x_j >= b_j - (M d)_j``, that is d <= (M d - b)+. With v > 0 and M v < v this bounds d, and each repetition sharpens the bound. The
sign of x_j is proved if the bound of d_j is 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from ivsid.verification.multipliers import ZERO, HalfSpace, Vector, multipliers_of

# Repetitions that sharpen the bound; each of them is valid, and later ones change little.
# Source: resource: time of exact matrix products
REPEATED: Final = 12


@dataclass(frozen=True)
class Line:
    """The bound of one unknown: its place, half-spaces with the widths of their coefficients, and the signs in the basis."""

    column: int
    rows: Sequence[HalfSpace]
    widths: Sequence[Vector]
    slack: set[int]


def proved_signs(
    decided: Sequence[int], home: Sequence[int], lines: Sequence[Line], vector: Sequence[Fraction]
) -> dict[int, int] | None:
    """The signs that follow from those ``decided``, by place; None if the multipliers prove nothing.

    Args:
        decided: signs that hold in the region; 0 for none.
        home: the signs z.
        lines: for each unknown whose sign is open.
        vector: v, for each of ``lines``; a proposal.
    """
    places = [line.column for line in lines]
    others = [k for k, d in enumerate(decided) if not d and k not in places]
    if any(w[k] for line in lines for w in line.widths for k in others):
        return None
    growth, least = [], []
    for line in lines:
        if not line.rows or not home[line.column]:
            return None
        objective = [Fraction(home[line.column] * (k == line.column)) for k in range(len(home))]
        found = multipliers_of(objective, line.rows, decided, home, line.slack)
        if found is None:
            return None
        least.append(-sum((m * row.height for m, row in zip(found, line.rows, strict=True)), ZERO))
        growth.append([sum((m * w[k] for m, w in zip(found, line.widths, strict=True)), ZERO) for k in places])
    if len(vector) != len(lines) or any(v <= 0 for v in vector):
        return None
    rest = [v - g for v, g in zip(vector, _times(growth, vector), strict=True)]
    if any(r <= 0 for r in rest):
        return None
    factor = max((max(-b, ZERO) / r for b, r in zip(least, rest, strict=True)), default=ZERO)
    reach = [factor * v for v in vector]
    for _ in range(REPEATED):
        grown = _times(growth, reach)
        reach = [min(d, max(g - b, ZERO)) for d, g, b in zip(reach, grown, least, strict=True)]
    return {k: home[k] for k, d in zip(places, reach, strict=True) if d == 0}


def _times(matrix: Sequence[Vector], vector: Sequence[Fraction]) -> Vector:
    return [sum((a * v for a, v in zip(row, vector, strict=True)), ZERO) for row in matrix]
