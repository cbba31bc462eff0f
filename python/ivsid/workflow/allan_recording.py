"""A static recording for an Allan analysis: its longest stretch without gaps, with the quantity and unit of each channel."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError, meant
from ivsid.files import units
from ivsid.log import open_source
from ivsid.log.headers import label

TIMES = ("t", "t_s", "time", "time_s", "timestamp", "stamp")
# The quantity of a column by its name: (quantity, unit, pattern).
QUANTITIES = (
    ("acceleration", "m/s^2", re.compile(r"^(ax|ay|az|udot|vdot|acc.*)$", re.IGNORECASE)),
    ("yaw_rate", "rad/s", re.compile(r"^(r|p|q|gyr.*|yaw_?rate.*)$", re.IGNORECASE)),
)
UNITS = {"acceleration": units.ACCELERATION, "yaw_rate": units.RATE}


@dataclass(frozen=True)
class Channel:
    """A channel of a static recording.

    Attributes:
        values: readings in ``unit``, shape (n,).
        quantity: acceleration, yaw_rate or other.
        unit: of the readings.
        factor: SI value of one unit.
    """

    values: NDArray[np.float64]
    quantity: str
    unit: str
    factor: float


@dataclass(frozen=True)
class Recording:
    """A gap-free stretch of a static recording at a steady rate."""

    channels: Mapping[str, Channel]
    period: float
    notes: tuple[str, ...]
    sha256: str


def _quantity(name: str) -> tuple[str, str]:
    bare = label("", name)
    found = bare.name if bare else name
    return next(((q, u) for q, u, pattern in QUANTITIES if pattern.match(found)), ("other", "unit of the column"))


def _given(stated: Sequence[str]) -> dict[str, str]:
    """The unit of each quantity that ``--unit`` names."""
    given: dict[str, str] = {}
    for unit in stated:
        quantity = next((q for q, table in UNITS.items() if unit in table), None)
        if quantity is None:
            known = ", ".join(u for table in UNITS.values() for u in table)
            raise IvsidError(f"unit '{unit}' is none of a rate or an acceleration; use one of {known}")
        if given.setdefault(quantity, unit) != unit:
            raise IvsidError(
                f"--unit gives both {given[quantity]} and {unit} for the {quantity.replace('_', ' ')}; analyse the columns one by one "
                "with --columns"
            )
    return given


def _channel(name: str, values: NDArray[np.float64], given: Mapping[str, str]) -> Channel:
    """A channel in the unit of its header, else in the one that is given, else in SI."""
    quantity, unit = _quantity(name)
    if quantity == "other" and len(given) == 1:
        # One unit tells the quantity of a column whose name does not.
        quantity = next(iter(given))
    if quantity == "other":
        return Channel(values, quantity, unit, 1.0)
    header = label("", name)
    stated = header.known(UNITS[quantity], name) if header else given.get(quantity, unit)
    if header and given.get(quantity, stated) != stated:
        raise IvsidError(f"--unit gives {given[quantity]}, but the header {name} states {stated}; give one of them")
    unit = stated if stated in UNITS[quantity] else next(iter(UNITS[quantity]))
    return Channel(values, quantity, unit, UNITS[quantity][unit])


def read_recording(path: str | Path, columns: Sequence[str], time: str | None, stated: Sequence[str]) -> Recording:
    """Reads a static recording.

    Args:
        path: of the recording.
        columns: channels; every inertial one if empty.
        time: name of the time column [s]; found by its name if None.
        stated: units of its rates and accelerations; SI where none is stated.

    Raises:
        IvsidError: an unusable recording or unit, in one sentence.
    """
    given = _given(stated)
    with open_source(path) as source:
        names = source.columns
        name = time or next((c for c in TIMES if c in names), None)
        if name is None or name not in names:
            raise IvsidError(
                f"{path} has no time column {name or 'among ' + ', '.join(TIMES)}; name it with --time (it has {', '.join(names[:12])})"
            )
        t = source.numeric([name])[name]
        if t.size < 2 or not np.isfinite(t).all() or (np.diff(t) <= 0).any():
            raise IvsidError(f"{path}: column {name} must increase strictly without missing cells; sort the recording")
        chosen = list(columns) or [c for c in names if c != name and _quantity(c)[0] != "other"]
        chosen = chosen or [c for c in names if c != name]
        missing = [c for c in chosen if c not in names]
        if missing or not chosen:
            raise IvsidError(
                f"{path} has no column {', '.join(missing) or 'to analyse'}; {meant(missing[0], names) if missing else ''}it has {', '.join(names)}"
            )
        values = source.numeric(chosen)
        digest = source.sha256
    if any(v.size != t.size for v in values.values()):
        raise IvsidError(
            f"{path}: the chosen columns stand on several clocks; choose those of one with --columns and --time"
        )
    steps = np.diff(t)
    usual = float(np.median(steps))
    complete = np.all([np.isfinite(v) for v in values.values()], axis=0)
    broken = np.flatnonzero(np.r_[True, (steps > 2.5 * usual) | ~complete[1:] | ~complete[:-1], True])
    lengths = np.diff(broken)
    longest = int(np.argmax(lengths))
    part = slice(int(broken[longest]), int(broken[longest + 1]))
    notes = []
    if lengths[longest] < t.size:
        notes.append(f"only the longest stretch without gaps is used: {lengths[longest]} of {t.size} samples")
    span = t[part]
    if span.size < 2:
        raise IvsidError(f"{path} has no stretch without gaps; an Allan deviation needs a steady rate")
    period = float((span[-1] - span[0]) / (span.size - 1))
    jitter = float(np.diff(span).std() / period)
    if jitter > 0.01:
        notes.append(
            f"the sampling is uneven (standard deviation of the step {100 * jitter:.0f} % of its mean); its mean is taken as the period"
        )
    channels = {c: _channel(c, v[part], given) for c, v in values.items()}
    unused = [u for q, u in given.items() if all(c.quantity != q for c in channels.values())]
    if unused:
        raise IvsidError(
            f"{path}: --unit {unused[0]} fits none of the channels {', '.join(channels)}; name them with --columns"
        )
    return Recording(channels, period, tuple(notes), digest)
