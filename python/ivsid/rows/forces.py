"""Known forces at rows and over the steps between them, for the right-hand side of every kind of row."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.log.record import steps_in
from ivsid.propulsion.actuation import Flow, Push
from ivsid.propulsion.carried import carried_by
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle
from ivsid.vehicle.carried import with_keys


def above(limit: float) -> float:
    """The next double above a limit, which holds the rounding of its decimals."""
    return float(np.nextafter(limit, np.inf))


def turning_stream(stream: float, r: IntervalArray) -> IntervalArray:
    """The rate at which a current turns in body axes [m/s^2], from its speed [m/s] and the yaw rate."""
    return IntervalArray(-stream, stream) * r


@dataclass(frozen=True)
class Forces:
    """Known forces by channel, X [N], Y [N], N [N m].

    Attributes:
        values: at the rows, shape (n,) each.
        steps: mean over each step to the next row, shape (n - 1,) each.
        present: rows with known forces, shape (n,).
        assumes: sentences that the forces rely on.
        whole: steps with known forces, shape (n - 1,); None where all are known.
    """

    values: tuple[IntervalArray, IntervalArray, IntervalArray]
    steps: tuple[IntervalArray, IntervalArray, IntervalArray]
    present: NDArray[np.bool_]
    assumes: tuple[str, ...] = ()
    whole: NDArray[np.bool_] | None = None


class KnownForces:
    """The forces of all thrusters, or the logged forces of a vehicle file without thrusters.

    Raises:
        IvsidError: a column or a limit that the forces need is missing.
    """

    def __init__(self, bounded: BoundedLog, vehicle: Vehicle) -> None:
        log, held = bounded.log, vehicle.log.demand == "hold"
        vehicle, _ = with_keys(vehicle)
        self._pushes: list[Push] = []
        self._logged: Forces | None = None
        if not vehicle.thrusters:
            self._logged = _logged(bounded, vehicle)
            self.assumes = self._logged.assumes
            return
        moved = any(t.advance_loss or t.rudder is not None for t in vehicle.thrusters)
        flow = _flow(bounded, vehicle) if moved else None
        effect, _ = carried_by(vehicle)
        self._pushes = [
            Push(thruster, log, held=held, flow=flow, fitted=effect[thruster.name]) for thruster in vehicle.thrusters
        ]
        self.assumes = (
            "demands hold from each row to the next" if held else "demands change on straight lines from row to row",
            *(s for push in self._pushes for s in push.assumes),
        )

    def part(self, first: int, last: int) -> Forces:
        """The forces at rows from ``first`` up to ``last``, and over the steps between them."""
        here, between = slice(first, last), slice(first, last - 1)
        if self._logged is not None:
            known = self._logged
            (X, Y, N), (dX, dY, dN) = known.values, known.steps
            whole = None if known.whole is None else known.whole[between]
            values, steps = (X[here], Y[here], N[here]), (dX[between], dY[between], dN[between])
            return Forces(values, steps, known.present[here], self.assumes, whole)
        pushes = [made.forces(first, last) for made in self._pushes]
        present, whole = np.ones(last - first, dtype=bool), np.ones(last - first - 1, dtype=bool)
        totals, ramps = pushes[0].at_rows, pushes[0].over_steps
        for push in pushes:
            present &= push.present
            whole &= True if push.whole is None else push.whole
        for push in pushes[1:]:
            totals = _sum(totals, push.at_rows)
            ramps = _sum(ramps, push.over_steps)
        return Forces(totals, ramps, present, self.assumes, whole)


_Three: TypeAlias = tuple[IntervalArray, IntervalArray, IntervalArray]


def _sum(a: _Three, b: _Three) -> _Three:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _logged(bounded: BoundedLog, vehicle: Vehicle) -> Forces:
    log = bounded.log
    present = np.ones(log.t.shape, dtype=bool)
    whole = np.ones(log.t.size - 1, dtype=bool)
    values, between, sentences = [], [], []
    for name, section in (("force_X", "force"), ("force_Y", "force"), ("moment_N", "moment")):
        log.column(name, "because the vehicle file has no thrusters")
        if name not in bounded.channels:
            raise IvsidError(
                f"the vehicle file has no [sensors.{section}] accuracy; it is needed to bound column {name}"
            )
        x, between_rows = bounded.channels[name], log.over.get(name)
        values.append(x)
        present &= bounded.present[name]
        if between_rows is None:
            # A logged force has no zero-order hold, unlike a demand: between two rows it lies between their values.
            between.append(interval_pieces(log.t.size - 1, partial(_between, x)))
            sentences.append(f"{name} lies between the values of neighbouring samples")
            continue
        known = np.isfinite(between_rows.lower) & np.isfinite(between_rows.upper)
        whole &= known
        accuracy = np.nextafter(getattr(vehicle.sensors, section).accuracy, np.inf)
        readings = IntervalArray(np.where(known, between_rows.lower, 0.0), np.where(known, between_rows.upper, 0.0))
        between.append(readings + IntervalArray(-accuracy, accuracy))
        sentences.append(between_rows.assumes)
    return Forces(
        (values[0], values[1], values[2]), (between[0], between[1], between[2]), present, tuple(sentences), whole
    )


def _between(x: IntervalArray, part: slice) -> IntervalArray:
    ends: IntervalArray = x[part].hull(x[part.start + 1 : part.stop + 1])
    return ends


def _flow(bounded: BoundedLog, vehicle: Vehicle) -> Flow:
    """u, v, r at rows, and their ranges over each step under the stated limits."""
    limits = vehicle.sensors.limits
    if limits.acceleration is None or limits.yaw_acceleration is None:
        raise IvsidError(
            "a thruster claims advance_loss or has a rudder, whose mean over a step needs [sensors.limits] acceleration and yaw_acceleration in the "
            "vehicle file; state them, or leave the claim out"
        )
    t, lost = bounded.log.t, 2 * bounded.log.time_error
    rows: dict[str, IntervalArray] = {}
    ranges: dict[str, IntervalArray] = {}
    for name, limit in (("r", limits.yaw_acceleration), ("u", limits.acceleration), ("v", limits.acceleration)):
        bounded.log.column(name, "by the thrusters' advance loss or rudder")
        x = bounded.channels[name]
        rate = IntervalArray(-above(limit), above(limit))
        stream = bounded.stream if name != "r" else 0.0

        def over(
            part: slice, x: IntervalArray = x, limit: IntervalArray = rate, stream: float = stream
        ) -> IntervalArray:
            rate = limit + turning_stream(stream, ranges["r"][part]) if stream else limit
            steps = steps_in(t, part) * (1 + 2.0**-40) + lost
            ends: IntervalArray = x[part].hull(x[part.start + 1 : part.stop + 1])
            return ends + rate * (0.5 * steps)

        rows[name], ranges[name] = x, interval_pieces(t.size - 1, over)
    return Flow((rows["u"], rows["v"], rows["r"]), (ranges["u"], ranges["v"], ranges["r"]))
