"""Columns of inertia as quadratic forms of u, v and r, in exact ranges: what they have in common cancels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations_with_replacement, product
from typing import Final, TypeAlias

from ivsid.verification.rational import Range

# Columns at rest of accelerations, by term and channel.
Columns: TypeAlias = Callable[[Sequence[Range]], list[list[Range]]]
# Coefficients of a column, one for each of ``PAIRS``.
Form: TypeAlias = list[Range]
PAIRS: Final = tuple(combinations_with_replacement(range(3), 2))
# Velocities at which a column of inertia is compared with its form: a polynomial of degree 2 in each of three unknowns that is 0 at all of
# them is 0.
# Source: theorem: a polynomial whose degree in each unknown is below the number of values vanishes with its values on their grid
POINTS: Final = tuple(product((0, 1, 2), repeat=3))
# Largest difference of two numbers that are equal but for roundings of known ones, which are 2^-1200 each.
# Source: definition: below the smallest double, 2^-1074, times those numbers
ROUNDED: Final = Fraction(1, 1 << 1080)


def evaluated(form: Form, nu: Sequence[Range]) -> Range:
    """A form at a point or over a box."""
    total = Range(0)
    for x, pair in zip(form, products(nu), strict=True):
        total = total + x * pair
    return total


def products(nu: Sequence[Range]) -> list[Range]:
    """The products of ``PAIRS``."""
    return [nu[a].square() if a == b else nu[a] * nu[b] for a, b in PAIRS]


def forms_of(columns: Columns, inertial: Sequence[bool]) -> list[list[Form] | None]:
    """The columns of each term with inertia as forms by channel; None for other terms, and for columns that are no such form.

    A term with inertia has columns of degree 2 by its definition (the rigid body and added mass in a turning frame); the points show which.
    """
    at = {p: columns([Range(x) for x in p]) for p in POINTS}
    unit = [tuple(int(k == a) for k in range(3)) for a in range(3)]
    found: list[list[Form] | None] = []
    for j, wanted in enumerate(inertial):
        forms = []
        for i in range(3):
            form = []
            for a, b in PAIRS:
                if a == b:
                    form.append(at[unit[a]][j][i])
                else:
                    both = tuple(x + y for x, y in zip(unit[a], unit[b], strict=True))
                    form.append(at[both][j][i] - at[unit[a]][j][i] - at[unit[b]][j][i])
            forms.append(form)
        same = wanted and all(
            (evaluated(forms[i], [Range(x) for x in p]) - at[p][j][i]).magnitude <= ROUNDED
            for p in POINTS
            for i in range(3)
        )
        found.append(forms if same else None)
    return found
