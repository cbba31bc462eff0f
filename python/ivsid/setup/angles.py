"""Angles of rudders that are not in radians: no rudder stands beyond a quarter turn."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.log import Log
from ivsid.setup.finding import Checked, SetupFinding
from ivsid.setup.suspects import DEGREE, in_unit
from ivsid.setup.windows import LEAST
from ivsid.vehicle import Vehicle

# Largest angle of a rudder [rad], and the same in degrees: a blade across the flow steers no more.
# Source: geometry: a quarter turn
QUARTER: Final = (0.5 * math.pi, 90.0)


def angles(vehicle: Vehicle, log: Log) -> Checked:
    """Rudder angles most of which lie beyond a quarter turn, so that they are in no radians: by their size in degrees, or in another unit.

    Those of an azimuth thruster may stand anywhere: ``histories`` asks the motion about them.
    """
    findings, columns = [], dict(log.columns)
    for thruster in vehicle.thrusters:
        name = f"rudder_{thruster.name}"
        if thruster.rudder is None or name not in columns:
            continue
        size = np.abs(columns[name])
        turned = size[np.isfinite(size) & (size > 0.0)]
        beyond = int((turned > QUARTER[0]).sum())
        if beyond < LEAST or 2 * beyond < turned.size:
            continue
        most = float(turned.max())
        degrees = most <= QUARTER[1]
        words = (
            f"{log.name}: {name} is not in radians{', and of the size of degrees' if degrees else ''}: {beyond} of {turned.size} readings that are not 0 "
            f"lie beyond a quarter turn, up to {most:.3g} rad"
        )
        unit = in_unit(vehicle, name, "deg", DEGREE) if degrees else f"the unit or the scale of {name}"
        evidence = {"largest": most, "beyond": float(beyond), "turned": float(turned.size)}
        findings.append(
            SetupFinding("setup.angle.unit", words, evidence, f"state {unit} under [log.columns]", certain=True)
        )
        # The checks that follow need an angle that a rudder can have, in any measure.
        columns[name] = columns[name] * (DEGREE if degrees else QUARTER[0] / most)
    return Checked(tuple(findings), replace(log, columns=columns))
