"""Froude scaling: the power of a vehicle's length with which a number grows, from its unit."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

from ivsid.errors import IvsidError

# Powers of the length L: at equal Froude number and density masses and forces grow as L^3, times as L^0.5; angles, shares and
# demands do not grow.
# Source: theorem: Froude's law of similarity.
_BASE: Final = {"kg": 3.0, "N": 3.0, "m": 1.0, "s": 0.5, "rad": 0.0, "1": 0.0, "demand": 0.0}
_TOKEN: Final = re.compile(r"\s*(per\b|[A-Za-z]+|1|\^-?\d+|[/()])")


@cache
def froude_power(unit: str) -> float:
    """The power of length that a unit scales with.

    Args:
        unit: products with a space, powers with ``^``, quotients with ``/`` (of the next factor or bracket) or ``per`` (of all that
            follows): ``kg/m``, ``N/(m/s)^2``, ``m/s^2 per N``.

    Raises:
        IvsidError: a unit that is not made of kg, N, m, s, rad, 1 and demand.
    """
    tokens = _TOKEN.findall(unit)
    if not tokens or "".join(tokens) != "".join(unit.split()):
        raise _unknown(unit)
    if "per" in tokens:
        at = tokens.index("per")
        return _sum(tokens[:at], unit) - _sum(tokens[at + 1 :], unit)
    return _sum(tokens, unit)


def _sum(tokens: list[str], unit: str) -> float:
    """The power of a product of factors."""
    total, sign, at = 0.0, 1.0, 0
    if not tokens:
        raise _unknown(unit)
    while at < len(tokens):
        token = tokens[at]
        if token == "/" and at and sign > 0:
            sign, at = -1.0, at + 1
            continue
        if token == "(":
            end = _closing(tokens, at, unit)
            power, at = _sum(tokens[at + 1 : end], unit), end + 1
        elif token in _BASE:
            power, at = _BASE[token], at + 1
        else:
            raise _unknown(unit)
        if at < len(tokens) and tokens[at].startswith("^"):
            power, at = power * int(tokens[at][1:]), at + 1
        total, sign = total + sign * power, 1.0
    if sign < 0:
        raise _unknown(unit)
    return total


def _closing(tokens: list[str], at: int, unit: str) -> int:
    depth = 0
    for k in range(at, len(tokens)):
        depth += (tokens[k] == "(") - (tokens[k] == ")")
        if depth == 0:
            return k
    raise _unknown(unit)


def _unknown(unit: str) -> IvsidError:
    return IvsidError(
        f"unit '{unit}' is not understood; write it with kg, N, m, s, rad, 1 and demand, as kg/m, N m s^2 or N/(m/s)^3"
    )
