"""Decimals of files as exact numbers: those of a vehicle file, and readings whose decimals became doubles."""

from __future__ import annotations

import math
import tomllib
from fractions import Fraction
from typing import Any, Final

from ivsid.verification.rational import Range

# Digits of a decimal, and its largest exponent: more would make numbers that take minutes; no double needs them.
# Source: resource: memory and time of one fraction
MOST_DIGITS: Final = 400


def nearby(x: float) -> Range:
    """All decimals that may have been read as this double, and more: one unit in its last place to either side."""
    return Range.around(x, math.ulp(x))


def around(value: float, off: float) -> Range:
    """The decimals that were read as a double, half a unit in its last place to either side, and ``off`` beside that."""
    half = Range.around(0.0, math.ulp(value))
    return Range.around(value, off) + Range.raw(half.low // 2, half.high // 2)


def decimal(text: str) -> Fraction:
    """A decimal exactly.

    Raises:
        ValueError: more than ``MOST_DIGITS`` digits, or an exponent that would need as many.
    """
    mantissa, _, exponent = text.lower().replace("_", "").partition("e")
    if len(mantissa) > MOST_DIGITS or abs(int(exponent or 0)) > MOST_DIGITS:
        raise ValueError(f"{text[:40]} has too many digits to be used")
    return Fraction(text)


def stated(text: str) -> dict[str, Any]:
    """A vehicle file, its decimals as exact fractions."""
    return tomllib.loads(text, parse_float=decimal)


class Decimals:
    """The numbers of a vehicle file's text, by the doubles that they were read as."""

    def __init__(self, text: str) -> None:
        self._known: dict[float, Range] = {}
        self._collect(stated(text))

    def _collect(self, value: object) -> None:
        if isinstance(value, dict):
            for v in value.values():
                self._collect(v)
        elif isinstance(value, list):
            for v in value:
                self._collect(v)
        elif isinstance(value, (Fraction, int)) and not isinstance(value, bool):
            key, exact = float(value), Range(Fraction(value))
            self._known[key] = self._known[key].hull(exact) if key in self._known else exact

    def __call__(self, x: float) -> Range:
        """The decimal in the file; for a default its shortest decimal, for a computed number all decimals nearby."""
        if x in self._known:
            return self._known[x]
        shortest = Range(Fraction(repr(float(x))))
        return shortest if len(repr(float(x))) < 8 else nearby(x)

    def pair(self, xy: tuple[float, float]) -> tuple[Range, Range]:
        """The decimals of two numbers."""
        return self(xy[0]), self(xy[1])
