"""The section ``[log]`` that follows from the columns of a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from ivsid.files import units
from ivsid.files.log_map import LogMap
from ivsid.log import Source
from ivsid.log.headers import label, spelled
from ivsid.proposal.columns import ATTITUDE, Columns, ambiguous
from ivsid.proposal.found import Found, Stamps

# Stated rates of change, as a multiple of the largest change from sample to sample: the next log may be livelier.
# Source: definition: a guess that the proposed file calls one
MARGIN: Final = 1.5


@dataclass(frozen=True)
class Mapped:
    """A section ``[log]`` in the making.

    Attributes:
        frame: of the axes.
        time: keys of ``time``, or empty.
        columns: keys of each column, by channel; a plain name is a string.
        rates: largest rates of change by channel [SI units per second].
        dropped: sentences about channels that are known and not taken.
    """

    frame: str
    time: Mapping[str, str]
    columns: Mapping[str, str | Mapping[str, object]]
    rates: Mapping[str, float]
    dropped: tuple[str, ...] = field(default=())

    @property
    def checked(self) -> LogMap:
        """The section as the readers of logs take it."""
        return LogMap.model_validate(
            {
                "frame": self.frame,
                "columns": {n: c if isinstance(c, str) else dict(c) for n, c in self.columns.items()},
                "rates": dict(self.rates),
                **({"time": dict(self.time)} if self.time else {}),
            }
        )


def usable(channels: Mapping[str, Found]) -> tuple[dict[str, Found], tuple[str, ...]]:
    """The channels that the equations of motion can take, and sentences about the others."""
    made, words = dict(channels), []
    level = {"roll", "pitch"} <= made.keys() or set(ATTITUDE) <= made.keys()
    felt = [n for n in ("ax", "ay") if n in made and made[n].meaning.gravity]
    if felt and not level:
        words.append(
            f"{made[felt[0]].match.column} holds gravity, and no column holds roll and pitch to take it out: accelerations are left out"
        )
        for n in felt:
            del made[n]
    pair = [n for n in ("ax", "ay") if n in made]
    if len(pair) == 1:
        words.append(
            f"{made.pop(pair[0]).match.column} stands alone, and accelerations are taken in pairs: it is left out"
        )
    if "roll" in made and "ax" not in made:
        for angle in ("roll", "pitch"):
            made.pop(angle, None)
    return made, tuple(words)


def mapping_of(
    source: Source, columns: Columns, channels: Mapping[str, Found], angles: Mapping[str, Found], frame: str
) -> Mapped:
    """The map of the channels, the demands, the angles of thrusters and the stamps."""
    common = _common(columns.stamps)
    entries: dict[str, str | Mapping[str, object]] = {}
    taken = {**channels, **{f"demand_{n}": f for n, f in columns.demands.items()}, **angles}
    for name, f in taken.items():
        entry = _entry(name, f, source, columns.stamps.get(f.table), common)
        if entry is not None:
            entries[name] = entry
    entries.update(ambiguous(source, {**taken, **entries}))
    clocks = {f.table for f in taken.values()}
    rates = _rates({**channels, **angles}) if len(clocks) > 1 else {}
    return Mapped(frame, _time(common), entries, rates)


def _common(stamps: Mapping[str, Stamps]) -> Stamps | None:
    """The stamps that most tables share by name."""
    several = list(stamps.values())
    names = [s.column for s in several]
    return max(several, key=lambda s: names.count(s.column)) if several else None


def _time(common: Stamps | None) -> dict[str, str]:
    if common is None or (common.column == "t" and common.unit is None and common.nanoseconds is None):
        return {}
    keys = {"from": common.column}
    if common.nanoseconds is not None:
        return {**keys, "nanoseconds": common.nanoseconds}
    return {**keys, "unit": common.unit} if common.unit is not None else keys


def _entry(
    name: str, found: Found, source: Source, stamps: Stamps | None, common: Stamps | None
) -> str | dict[str, object] | None:
    """The keys of a column; None where its name is the channel's and it needs none."""
    keys: dict[str, object] = {}
    stated = label(
        found.table, found.match.column.removeprefix(f"{found.table}/") if found.table else found.match.column
    )
    meaning = found.meaning
    if meaning.channel == "demand":
        if stated is not None:
            keys["unit"] = "1"
    else:
        if meaning.unit is not None and (stated is None or meaning.scale != 1.0):
            keys["unit"] = meaning.unit
        if meaning.scale != 1.0 or (stated is not None and spelled(stated.unit) not in units.COLUMN):
            keys["scale"] = meaning.scale
        if meaning.offset != 0.0:
            keys["offset"] = meaning.offset
    if stamps is not None and common is not None and stamps.column != common.column:
        keys["time"] = _time(stamps) or {"from": "t"}
    if keys:
        return {"from": found.match.column, **keys}
    alone = sum(name in t.columns for t in source.tables.values()) == 1
    return None if found.match.column == name and alone else found.match.column


def _rates(channels: Mapping[str, Found]) -> dict[str, float]:
    """Largest changes from sample to sample over the time between them, with a margin."""
    rates = {}
    for name, f in channels.items():
        ok = np.isfinite(f.values)
        step, dt = np.diff(f.values[ok]) * f.factor, np.diff(f.t[ok])
        if name in ("psi", "roll", "pitch"):
            step = step - 2 * np.pi * np.round(step / (2 * np.pi))
        if step.size and (rate := float(np.max(np.abs(step) / dt))) > 0:
            rates[name] = float(f"{MARGIN * rate:.2g}")
    return rates
