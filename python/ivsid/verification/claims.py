"""Claims of a tube as exact ranges: one a part of a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from ivsid.verification.rational import Range

Three: TypeAlias = tuple[Range, Range, Range]


@dataclass(frozen=True)
class Part:
    """A claim: ``start`` and ``end`` hold velocities, ``rates`` accelerations, ``force`` X, Y, N, and ``h`` the length [s]."""

    start: Three
    rates: Three
    end: Three
    force: Three
    h: Range


def range_of(low: float, high: float) -> Range:
    """A range from doubles."""
    return Range(Fraction(low), Fraction(high))


def holds(outer: Range, inner: Range) -> bool:
    """Whether a range lies in another."""
    return outer.low <= inner.low and inner.high <= outer.high


def inside(outer: Sequence[Range], inner: Sequence[Range]) -> bool:
    """Whether a box lies in another."""
    return all(holds(a, b) for a, b in zip(outer, inner, strict=True))


def part_of(
    row: Sequence[tuple[float, float]], force: Sequence[tuple[float, float]], h: tuple[float, float], parts: int
) -> Part:
    """A part from the ends of its nine ranges (start, rates, end), the forces of its step, the step's length and its number of parts."""
    ranges = [range_of(low, high) for low, high in row]
    push = [range_of(low, high) for low, high in force]
    length = Range(Fraction(h[0]) / parts, Fraction(h[1]) / parts)
    return Part(
        (ranges[0], ranges[1], ranges[2]),
        (ranges[3], ranges[4], ranges[5]),
        (ranges[6], ranges[7], ranges[8]),
        (push[0], push[1], push[2]),
        length,
    )


def start_box(lower: Sequence[float], upper: Sequence[float]) -> Three:
    """Velocities in which a tube starts, from their ends."""
    u, v, r = (range_of(a, b) for a, b in zip(lower, upper, strict=True))
    return u, v, r
