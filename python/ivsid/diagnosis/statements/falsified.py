"""Falsified rows: interval rows that a hypothesis contradicts at its fitted parameters, by the declared bounds and without a noise model."""

from __future__ import annotations

from typing import Final

import numpy as np

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import CHANNELS
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import Vehicle

# Length of the windows of integral rows [s].
# Source: measured: make constants
WINDOW: Final = 2.0


def falsified(vehicle: Vehicle, log: Log, h: Hypothesis) -> dict[str, int] | None:
    """Number of rows in each channel that contradict a hypothesis at its fitted parameters.

    Rows are means over two seconds, or samples if accelerations are measured, within the bounds of sensors, thrust and ambient force.

    Args:
        vehicle: with the declared bounds.
        log: of the rows.
        h: the hypothesis.

    Returns:
        The number by channel; None if the hypothesis has effects that are no terms, or if the vehicle file lacks a bound.
    """
    if h.given:
        return None
    try:
        rows = build_rows(bound_log(log, vehicle), vehicle, h.terms, window=WINDOW)
    except IvsidError:
        return None
    values = IntervalArray(np.array([h.values[t.id] for t in rows.terms]))
    predicted = (rows.matrix * values).sum(axis=1)
    apart = (predicted.lower > rows.right.upper) | (predicted.upper < rows.right.lower)
    return {name: int(apart[rows.channel == k].sum()) for k, name in enumerate(CHANNELS)}
