"""The row of yaw integrated over all parts of a tube, in exact ranges (docs/theory.md, "Guaranteed simulation", "Integrated row")."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Final, TypeAlias

from ivsid.verification.rational import Range
from ivsid.verification.turning import PAIRS, Form, products

Vertex: TypeAlias = tuple[Range, ...]
Factors: TypeAlias = Sequence[Sequence[Range]]
ZERO: Final = Range(0)
# Number of the yaw rate among the velocities.
# Source: definition: u, v, r
YAW: Final = 2


class Integrals:
    """Integrals since the start of a tube, of the columns, of the products of velocities and of the forces.

    Args:
        start: velocities there.
        inertia: factors of the accelerations, by term (the known body last), acceleration and channel.
        vertices: of the parameters by channel.
        forms: of the columns of terms with inertia, by term and channel; None for other terms.
    """

    def __init__(
        self,
        start: Sequence[Range],
        inertia: Sequence[Factors],
        vertices: Sequence[Sequence[Vertex]],
        forms: Sequence[list[Form] | None],
    ) -> None:
        self._start = start
        self._inertia = inertia
        self._vertices = vertices
        self._forms = forms
        self._columns = [[ZERO] * 3 for _ in inertia]
        self._products = [ZERO] * len(PAIRS)
        self._force = [ZERO] * 3

    def joined(self, others: Sequence[Integrals]) -> Integrals:
        """What is true of every solution of this and of the others, which have run as long."""
        made = Integrals(self._start, self._inertia, self._vertices, self._forms)
        alike = [self, *others]
        made._start = _hull([tuple(x._start) for x in alike])
        made._columns = [
            list(_hull([tuple(row) for row in rows])) for rows in zip(*(x._columns for x in alike), strict=True)
        ]
        made._products = list(_hull([tuple(x._products) for x in alike]))
        made._force = list(_hull([tuple(x._force) for x in alike]))
        return made

    def add(self, h: Range, over: Sequence[Range], columns: Sequence[Sequence[Range]], force: Sequence[Range]) -> None:
        """Adds a part: its length, and velocities, columns and forces over it."""
        self._columns = [
            [total + h * x for total, x in zip(old, new, strict=True)]
            for old, new in zip(self._columns, columns, strict=True)
        ]
        self._products = [total + h * x for total, x in zip(self._products, products(over), strict=True)]
        self._force = [total + h * x for total, x in zip(self._force, force, strict=True)]

    def yaw(self, end: Sequence[Range]) -> Range:
        """The yaw rate now, where u and v are known.

        Raises:
            ZeroDivisionError: an inertia that is not proved positive.
        """
        moved = [now - start for now, start in zip(end, self._start, strict=True)]
        hulls = [_hull(points) for points in self._vertices]
        # Any multiples of the other rows may be taken from it; these move it to the centre of gravity, where little is left of the turn.
        about = [
            Range(_middle(self._total(hulls[YAW], k, YAW)) / _middle(self._total(hulls[k], k, k))) for k in range(YAW)
        ]
        plain, moved_row = (self._bounded(hulls, m, moved) for m in ([ZERO] * YAW, about))
        return self._start[YAW] + Range.raw(max(plain.low, moved_row.low), min(plain.high, moved_row.high))

    def _bounded(self, hulls: Sequence[Vertex], multiples: Sequence[Range], moved: Sequence[Range]) -> Range:
        """What the row of yaw, less multiples of those of surge and sway by their hulls, says of its change.

        Equal products of velocities are collected before they are multiplied, so that what turns with the vehicle cancels.
        """
        found: Range | None = None
        for vertex in self._vertices[YAW]:
            rows = [(vertex, YAW, Range(1)), *((hulls[k], k, -multiples[k]) for k in range(YAW))]
            rest, inertia, pairs = ZERO, [ZERO] * 3, [ZERO] * len(PAIRS)
            for theta, i, factor in rows:
                if not (factor.low or factor.high):
                    continue
                rest = rest + factor * self._force[i]
                inertia = [total + factor * self._total(theta, k, i) for k, total in enumerate(inertia)]
                for j, form in enumerate(self._forms):
                    value = factor * theta[j] if j < len(theta) else factor
                    if form is None:
                        rest = rest - value * self._columns[j][i]
                    else:
                        pairs = [total + value * x for total, x in zip(pairs, form[i], strict=True)]
            for x, integral in zip([*pairs, *inertia[:YAW]], [*self._products, *moved[:YAW]], strict=True):
                rest = rest - x * integral
            if inertia[YAW].low <= 0:
                raise ZeroDivisionError("an inertia is not proved positive")
            quotient = rest / inertia[YAW]
            found = quotient if found is None else found.hull(quotient)
        assert found is not None
        return found

    def _total(self, theta: Vertex, k: int, i: int) -> Range:
        """The factor of acceleration k in row i, the known body counting once."""
        total = self._inertia[-1][k][i]
        for value, inertia in zip(theta, self._inertia, strict=False):
            total = total + value * inertia[k][i]
        return total


def _hull(points: Sequence[Vertex]) -> Vertex:
    hull = points[0]
    for point in points[1:]:
        hull = tuple(a.hull(b) for a, b in zip(hull, point, strict=True))
    return hull


def _middle(x: Range) -> Fraction:
    return (x.lower + x.upper) / 2
