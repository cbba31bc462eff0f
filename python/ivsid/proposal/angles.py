"""Units and signs of the angles of rudders and azimuth thrusters: guesses from their ranges and from the turning of the vessel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.proposal.blanks import PULSES
from ivsid.proposal.found import Found
from ivsid.proposal.signs import SPAN, TURN

Array = NDArray[np.float64]

# Angles of a rudder beyond this [rad] in a column without a unit are degrees.
# Source: geometry: a rudder goes over by 35 to 45 degrees, and a quarter turn is beyond all of them
RUDDER: Final = np.pi / 2
# Share of the variance of a rudder angle that the turning of the vessel has to explain before its sign is judged.
# Source: definition: half of it is something else's
EXPLAINED: Final = 0.5


def angles_of(
    angles: Mapping[str, Found], channels: Mapping[str, Found]
) -> tuple[dict[str, Found], tuple[str, ...], list[str]]:
    """The angles with the units and signs that their readings suggest, columns that are none, and questions for the user.

    Args:
        angles: by channel, ``rudder_NAME`` or ``azimuth_NAME``.
        channels: of the motion, with their units and signs.
    """
    made: dict[str, Found] = {}
    loose, questions = [], []
    for name, given in angles.items():
        f, column = given, given.match.column
        largest = float(np.nanmax(np.abs(f.values), initial=0.0))
        values = f.values[np.isfinite(f.values)]
        if not f.stated and values.size and values.min() >= PULSES[0] and values.max() <= PULSES[1]:
            loose.append(column)
            continue
        if f.meaning.unit is None:
            limit = RUDDER if name.startswith("rudder") else TURN
            unit = "deg" if largest > limit else "rad"
            f = f.with_meaning(unit=unit if unit == "deg" else None)
            questions.append(f"{column} reaches {largest:.4g} and is read in {unit}: is that right?")
        if name.startswith("rudder") and (gain := _turning(f, channels.get("r"))) is not None and gain < 0:
            f = f.with_meaning(scale=-f.meaning.scale)
            questions.append(
                f"the vessel turns to port where {column} is positive, so it is read with the opposite sign (the trailing edge to starboard is positive): is that right?"
            )
        made[name] = f
    questions = list(dict.fromkeys(questions))
    by_column: dict[str, list[str]] = {}
    for name, f in made.items():
        by_column.setdefault(f.match.column, []).append(name.partition("_")[2])
    shared = {c: names for c, names in by_column.items() if len(names) > 1}
    questions += [
        f"{c} is taken for the direction of {', '.join(names)}: is that right?" for c, names in shared.items()
    ]
    return made, tuple(loose), questions


def _turning(angle: Found, r: Found | None) -> float | None:
    """Sign of the turning that a rudder gives, by Nomoto's equation K delta = T rdot + r with means over a second; None where it does not tell."""
    if r is None:
        return None
    ok, good = np.isfinite(angle.values), np.isfinite(r.values)
    if ok.sum() < 10 or good.sum() < 10:
        return None
    grid = np.arange(max(angle.t[0], r.t[0]), min(angle.t[-1], r.t[-1]), SPAN)
    if grid.size < 20:
        return None
    delta = np.interp(grid, angle.t[ok], angle.values[ok] * angle.factor)
    rate = np.interp(grid, r.t[good], r.values[good] * r.factor)
    columns = np.column_stack([rate, np.gradient(rate, SPAN), np.ones(grid.size)])
    gains = np.linalg.lstsq(columns, delta, rcond=None)[0]
    left = float(np.var(delta - columns @ gains))
    if np.var(delta) <= 0 or left > (1 - EXPLAINED) * np.var(delta) or gains[0] * gains[1] < 0:
        return None
    return float(np.sign(gains[0] + gains[1]))
