"""Demands in another unit than their thrust curve, by their range: pulse widths, fractions and percentages."""

from __future__ import annotations

import numpy as np

from ivsid.log import Log
from ivsid.propulsion.demand_unit import advice
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.setup.finding import Checked, SetupFinding
from ivsid.vehicle import Vehicle


def demands(vehicle: Vehicle, log: Log) -> Checked:
    """Demands that all lie where another unit of the same command has them, and the curve does not.

    A curve that refuses demands beyond its end says so itself, with the same advice. One that holds its end values, or has no end, would
    take them all for full thrust.
    """
    findings = []
    for thruster in vehicle.thrusters:
        values = log.columns.get(f"demand_{thruster.name}")
        if values is None or not np.isfinite(values).any():
            continue
        least, most = float(np.nanmin(values)), float(np.nanmax(values))
        ends = ThrustCurve(thruster).range
        # A gain without ends takes any demand: it may be meant so.
        bounded = bool(np.isfinite(ends).any()) or thruster.neutral != 0.0
        said = advice(thruster, ends, values)
        if said is None:
            continue
        what, remedy = said
        words = f"{log.name}: demand_{thruster.name} runs from {least:g} to {most:g}: {what}"
        evidence = {"lowest": least, "highest": most, "neutral": thruster.neutral}
        findings.append(SetupFinding("setup.demand.unit", words, evidence, remedy, certain=bounded))
    return Checked(tuple(findings), log)
