"""A mid-value with its interval."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ivsid.intervals import Interval
from ivsid.intervals.shown import shown


@dataclass(frozen=True)
class Number:
    """A number of a model.

    Attributes:
        value: in ``unit``.
        unit: SI.
        symbol: in SNAME notation, where there is one.
        ends: its interval, rounded outward through all sums; None where nothing is known.
    """

    value: float
    unit: str
    symbol: str = ""
    ends: Interval | None = None

    def __add__(self, other: Number) -> Number:
        ends = None if self.ends is None or other.ends is None else self.ends + other.ends
        return Number(self.value + other.value, self.unit, self.symbol, ends)

    def __neg__(self) -> Number:
        return self * -1.0

    def __sub__(self, other: Number) -> Number:
        return self + -other

    def __mul__(self, factor: float) -> Number:
        ends = None if self.ends is None else self.ends * Interval(factor, factor)
        return Number(self.value * factor, self.unit, self.symbol, ends)

    def called(self, symbol: str) -> Number:
        """The number under another symbol."""
        return Number(self.value, self.unit, symbol, self.ends)

    @property
    def words(self) -> str:
        """Symbol, interval and unit, for a comment; the interval is rounded outward to six digits."""
        known = self.ends is not None and math.isfinite(self.ends.lower) and math.isfinite(self.ends.upper)
        if known and self.ends is not None and self.ends.lower == self.ends.upper:
            return ", ".join(w for w in (self.symbol, f"given, {self.unit}") if w)
        inside = "no interval"
        if known and self.ends is not None:
            inside = " to ".join(shown(self.ends.lower, self.ends.upper).strip("[]").split(", "))
        return ", ".join(w for w in (self.symbol, f"{inside} {self.unit}") if w)


def one_line(text: str) -> str:
    """Words on one line: a break ends a comment of code, and no XML or YAML takes a control character."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def exact(value: float, unit: str, symbol: str = "") -> Number:
    """A number that is known: its interval is a point."""
    return Number(value, unit, symbol, Interval(value, value))
