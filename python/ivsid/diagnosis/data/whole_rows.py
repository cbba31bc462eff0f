"""Readings of those rows alone that have every reading: what stands beside a lost one lies on no straight line, and counts at another time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.clock import RARE, usual_step
from ivsid.diagnosis.data.resampling import ACCELERATIONS, STRAY, VELOCITIES, read_in
from ivsid.log import Log

# Share of the rows of the rarest channel in which another one has readings if it is read in the same rows.
# Source: geometry: halfway between a channel of other rows and one of the same
BESIDE: Final = 0.5


def whole_rows(log: Log, *, averaged: bool) -> Log:
    """The log without readings in rows that lack one of them, if more than ``STRAY`` of its rows are such; of motions and of accelerations for themselves.

    A velocity that is lost is interpolated between its neighbours, at whose times it was read. A heading in its own row beside it would count as
    one of these times as well.

    Args:
        log: without outliers and channels that come too rarely.
        averaged: whether accelerations are means over the step before their row, which hold what happened between the rows.
    """
    groups: list[Sequence[str]] = [(*VELOCITIES, "psi")]
    columns = dict(log.columns)
    for group in groups if averaged else (*groups, ACCELERATIONS):
        if names := read_in(log, group):
            columns |= _whole(log, names)
    return replace(log, columns=columns)


def _whole(log: Log, names: Sequence[str]) -> dict[str, NDArray[np.float64]]:
    """Columns that are read in the same rows as the rarest one of some, without readings in rows that lack one of them."""
    there = {name: np.isfinite(log.columns[name]) for name in names}
    rows = there[max(names, key=lambda name: usual_step(log, name))]
    beside = [name for name in names if np.mean(there[name][rows]) > BESIDE]
    whole = np.all([there[name] for name in beside], axis=0)
    steps = np.diff(log.t[whole])
    if steps.size < 2 or np.mean(steps > RARE * np.median(steps)) <= STRAY:
        return {}
    return {name: np.where(whole, log.columns[name], np.nan) for name in beside}
