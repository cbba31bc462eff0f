"""Known forces at rows and over the steps between them, for the right-hand side of every kind of row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ivsid.actuation import Flow, pushed
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.sensors import BoundedLog
from ivsid.vehicle import Vehicle


def above(limit: float) -> float:
    """The decimals of a limit are rounded to a double, too: the next one up holds them."""
    return float(np.nextafter(limit, np.inf))


@dataclass(frozen=True)
class Forces:
    """Known forces by channel: at each row, and over each step to the next one; and where they are known."""

    values: tuple[IntervalArray, IntervalArray, IntervalArray]
    steps: tuple[IntervalArray, IntervalArray, IntervalArray]
    present: NDArray[np.bool_]
    assumes: tuple[str, ...] = ()
    whole: NDArray[np.bool_] | None = None


def known_forces(bounded: BoundedLog, vehicle: Vehicle) -> Forces:
    """The forces of all thrusters, or the logged ones where the vehicle file has none."""
    log, held = bounded.log, vehicle.log.demand == "hold"
    present = np.ones(log.t.shape, dtype=bool)
    whole = np.ones(log.t.size - 1, dtype=bool)
    if vehicle.thrusters:
        zero = IntervalArray(np.zeros(log.t.shape))
        totals, ramps = [zero] * 3, [zero[1:]] * 3
        assumes: tuple[str, ...] = (
            "demands hold from each row to the next" if held else "demands change on straight lines from row to row",
        )
        flow = (
            _flow(bounded, vehicle) if any(t.advance_loss or t.rudder is not None for t in vehicle.thrusters) else None
        )
        for thruster in vehicle.thrusters:
            push = pushed(thruster, log, held=held, flow=flow)
            present &= push.present
            whole &= True if push.whole is None else push.whole
            assumes += push.assumes
            totals = [a + b for a, b in zip(totals, push.at_rows, strict=True)]
            ramps = [a + b for a, b in zip(ramps, push.over_steps, strict=True)]
        return Forces((totals[0], totals[1], totals[2]), (ramps[0], ramps[1], ramps[2]), present, assumes, whole)
    values, between, sentences = [], [], []
    for name, section in (("force_X", "force"), ("force_Y", "force"), ("moment_N", "moment")):
        log.column(name, "because the vehicle file has no thrusters")
        if name not in bounded.channels:
            raise IvsidError(
                f"the vehicle file has no [sensors.{section}] accuracy; it is needed to bound column {name}"
            )
        x, sweep = bounded.channels[name], log.over.get(name)
        values.append(x)
        present &= bounded.present[name]
        if sweep is None:
            # Unlike a demand, a logged force need not be held to the next row: between two rows it lies between their values.
            between.append(x[:-1].hull(x[1:]))
            sentences.append(f"{name} lies between the values of neighbouring samples")
            continue
        known = np.isfinite(sweep.lower) & np.isfinite(sweep.upper)
        whole &= known
        accuracy = np.nextafter(getattr(vehicle.sensors, section).accuracy, np.inf)
        readings = IntervalArray(np.where(known, sweep.lower, 0.0), np.where(known, sweep.upper, 0.0))
        between.append(readings + IntervalArray(-accuracy, accuracy))
        sentences.append(sweep.assumes)
    return Forces(
        (values[0], values[1], values[2]), (between[0], between[1], between[2]), present, tuple(sentences), whole
    )


def _flow(bounded: BoundedLog, vehicle: Vehicle) -> Flow:
    """u, v, r at rows, and all that the stated limits allow over each step."""
    limits = vehicle.sensors.limits
    if limits.acceleration is None or limits.yaw_acceleration is None:
        raise IvsidError(
            "a thruster claims advance_loss or has a rudder, whose mean over a step needs [sensors.limits] acceleration and yaw_acceleration in the "
            "vehicle file; state them, or leave the claim out"
        )
    steps = np.diff(bounded.log.t) * (1 + 2.0**-40) + 2 * np.max(bounded.log.time_error)
    rows, ranges = [], []
    for name, limit in (("u", limits.acceleration), ("v", limits.acceleration), ("r", limits.yaw_acceleration)):
        bounded.log.column(name, "by the thrusters' advance loss or rudder")
        x = bounded.channels[name]
        reach = IntervalArray(-above(limit), above(limit)) * (0.5 * steps)
        rows.append(x)
        ranges.append(x[:-1].hull(x[1:]) + reach)
    return Flow((rows[0], rows[1], rows[2]), (ranges[0], ranges[1], ranges[2]))
