"""Stage 3: rows whose intervals no value of the fitted parameters can meet; they need no noise model."""

from __future__ import annotations

from typing import Final

import numpy as np

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import Vehicle

WINDOW: Final = 2.0
CHANNELS: Final = ("surge", "sway", "yaw")


def falsified(vehicle: Vehicle, log: Log, h: Hypothesis) -> dict[str, int] | None:
    """How many rows of each channel contradict a hypothesis at its fitted parameters.

    Rows are means over two seconds, or samples where accelerations are measured, with the bounds of sensors, thrust and ambient force.
    None where the hypothesis is more than terms, or the vehicle file does not bound what the rows need.
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
