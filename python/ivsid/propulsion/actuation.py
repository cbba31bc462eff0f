"""Forces of a vehicle in time, from logged demands: in intervals and in numbers.

``thrust`` holds the static curve with its accuracy. This module adds lag, azimuth angles, advance loss and rudders. Every key of a
thruster in the vehicle file takes part, or the file is refused.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.log.turning import Turned, angle_of
from ivsid.memory.pieces import array_pieces, over_pieces, pieces
from ivsid.memory.room import DOUBLE, room
from ivsid.propulsion.carried import Fitted, Late, late
from ivsid.propulsion.configuration import directions
from ivsid.propulsion.foil import rudder_force
from ivsid.propulsion.lag import lagged
from ivsid.propulsion.rudder import rudder_over
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster, Vehicle

# A thruster of which the file states no cause.
NOTHING: Final = Fitted()


@dataclass(frozen=True)
class Flow:
    """The vehicle's motion through the water, u, v [m/s] and r [rad/s].

    Attributes:
        at_rows: at each row, each of shape (n,).
        over_steps: ranges over each step to the next row, each of shape (n - 1,).
    """

    at_rows: tuple[IntervalArray, IntervalArray, IntervalArray]
    over_steps: tuple[IntervalArray, IntervalArray, IntervalArray]

    def part(self, rows: slice, steps: slice) -> Flow:
        """The motion at some rows and over the steps between them."""
        (u, v, r), (du, dv, dr) = self.at_rows, self.over_steps
        return Flow((u[rows], v[rows], r[rows]), (du[steps], dv[steps], dr[steps]))


@dataclass(frozen=True)
class Pushed:
    """Forces of one thruster at the rows, shape (n,), and over the steps between them, shape (n - 1,).

    Attributes:
        at_rows: X, Y [N], N [N m] at each row.
        over_steps: their means over each step to the next row.
        present: whether demand and angle are known at a row, shape (n,).
        assumes: assumptions of the intervals, as sentences.
        whole: whether the angle is known over a step, shape (n - 1,); None if it is known wherever it is at both rows.
    """

    at_rows: tuple[IntervalArray, IntervalArray, IntervalArray]
    over_steps: tuple[IntervalArray, IntervalArray, IntervalArray]
    present: NDArray[np.bool_]
    assumes: tuple[str, ...] = ()
    whole: NDArray[np.bool_] | None = None


def pushed(thruster: Thruster, log: Log, *, held: bool, flow: Flow | None = None) -> Pushed:
    """The forces of a thruster at all rows of a log; arguments and errors are those of ``Push``."""
    return Push(thruster, log, held=held, flow=flow).forces(0, log.t.size)


class Push:
    """A thruster under the demands of a log. Preparations are done once, forces are computed for some rows at a time.

    Args:
        thruster: with its curve, lag, steering and rudder.
        log: with its demand, and its angle where it turns.
        held: whether demands hold from row to row (zero-order hold); else they change linearly.
        flow: needed for a thruster with an advance loss or a rudder.
        fitted: factor and delay of the thrust that ``[model.fitted]`` states.

    Raises:
        IvsidError: a missing column, a demand outside the curve, or a lag under linear demands.
    """

    def __init__(
        self, thruster: Thruster, log: Log, *, held: bool, flow: Flow | None = None, fitted: Fitted = NOTHING
    ) -> None:
        _followed(thruster, held=held)
        self.thruster, self.held, self.flow = thruster, held, flow
        name = f"demand_{thruster.name}"
        demand = log.column(name, f"for thruster {thruster.name}")
        self.error = partial(log.error, name)
        self.there: NDArray[np.bool_] = array_pieces(demand.size, lambda rows: ~np.isnan(demand[rows]))
        # Missing demands are filled by an allowed one, which is never used.
        allowed = demand[int(np.argmax(self.there))]
        there = self.there
        self.demand = (
            demand
            if there.all()
            else array_pieces(demand.size, lambda rows: np.where(there[rows], demand[rows], allowed))
        )
        self.curve = ThrustCurve(thruster)
        self.whole: NDArray[np.bool_] | None = None
        assumes: tuple[str, ...] = ()
        self.lagged: tuple[IntervalArray, IntervalArray] | None = None
        if thruster.time_constant:
            self.lagged = lagged(self.curve, self.demand, self.error(), log, self.there, thruster.time_constant)
            assumes = (
                f"thruster {thruster.name} follows its demand with a time constant of {thruster.time_constant!r} s; before the log it "
                "was at rest or pushed anything that its curve allows",
            )
        self.factor = fitted.factor
        self.late: Late | None = None
        if fitted.delay is not None:
            self.late = late(self.curve.interval(self.demand, error=self.error()), log, self.there, fitted.delay)
            self.there, self.whole = self.there & self.late.present, self.late.whole
        self.turned: Turned | None = None
        if thruster.steering == "azimuth":
            self.turned = angle_of(
                log, f"azimuth_{thruster.name}", f"for the direction of thruster {thruster.name}", held=held
            )
            self.there = self.there & self.turned.present
            self.whole = self.turned.whole if self.whole is None else self.whole & self.turned.whole
            assumes = (*assumes, self.turned.assumes)
        if flow is None and (thruster.advance_loss or thruster.rudder is not None):
            raise IvsidError(
                f"thruster {thruster.name} claims advance_loss or has a rudder, which needs the motion; give u, v and r"
            )
        # The mean of T cos a over a step is the mean of T times cos a only for a constant angle.
        self.swept = f"azimuth_{thruster.name}" in log.over
        self.delta: Turned | None = None
        if thruster.rudder is not None and flow is not None:
            self.delta = angle_of(
                log, f"rudder_{thruster.name}", f"for the rudder of thruster {thruster.name}", held=held
            )
            self.there = self.there & self.delta.present
            self.whole = self.delta.whole if self.whole is None else self.whole & self.delta.whole
            within = f", each within {thruster.rudder.accuracy:g} of itself" if thruster.rudder.accuracy else ""
            foil = f"the rudder behind {thruster.name} has the lift and drag of the stated foil{within}"
            assumes = (*assumes, self.delta.assumes, foil)
        self.assumes = assumes

    def forces(self, first: int, last: int) -> Pushed:
        """The forces at the rows from ``first`` up to ``last``, exclusive, and over the steps between them."""
        thruster, flow = self.thruster, self.flow
        here, between = slice(first, last), slice(first, last - 1)
        at, over = self._thrust(here, between)
        if self.turned is not None:
            rows, steps = (_shares(thruster, a) for a in (self.turned.at_rows[here], self.turned.over_steps[between]))
        else:
            rows = steps = directions(thruster)
        # A lagged thrust moves between its values at both rows, so that its mean alone is no bound.
        swept_thrust = at[:-1].hull(at[1:]) if thruster.time_constant and thruster.lag == "thrust" else over
        if self.late is not None:
            swept_thrust = self.late.swept[between]
        if self.factor is not None:
            at, over, swept_thrust = at * self.factor, over * self.factor, swept_thrust * self.factor
        if self.swept:
            over = swept_thrust
        motion = None if flow is None else flow.part(here, between)
        if thruster.advance_loss and motion is not None:
            at = at - _advance_loss(thruster, at, rows, motion.at_rows)
            lost = _advance_loss(thruster, swept_thrust, steps, motion.over_steps)
            over, swept_thrust = over - lost, swept_thrust - lost
        at_rows = [_share(at, s) for s in rows]
        # Under a held demand the force over a step is that at its first row.
        same = self.held and self.lagged is None and self.late is None and self.turned is None and motion is None
        over_steps = [force[:-1] for force in at_rows] if same else [_share(over, s) for s in steps]
        if self.delta is not None and thruster.rudder is not None and motion is not None:
            blades = (
                rudder_over(thruster.rudder, self.delta.at_rows[here], at, motion.at_rows),
                rudder_over(thruster.rudder, self.delta.over_steps[between], swept_thrust, motion.over_steps),
            )
            at_rows = [a + b for a, b in zip(at_rows, blades[0], strict=True)]
            over_steps = [a + b for a, b in zip(over_steps, blades[1], strict=True)]
        whole = None if self.whole is None else self.whole[between]
        return Pushed(
            (at_rows[0], at_rows[1], at_rows[2]),
            (over_steps[0], over_steps[1], over_steps[2]),
            self.there[here],
            self.assumes,
            whole,
        )

    def ranges(self) -> tuple[IntervalArray, tuple[IntervalArray, IntervalArray, IntervalArray]]:
        """The thrust [N] at all moments of each step, shape (n - 1,), and its shares in X, Y [1] and N [m] there.

        A held demand gives any thrust within its accuracy at any moment. A lagged thrust never leaves the hull of its ranges at both rows,
        whose ends approach those of the goal one-sidedly.

        Raises:
            IvsidError: a thruster whose force depends on the motion.
        """
        thruster = self.thruster
        if thruster.advance_loss or thruster.rudder is not None:
            raise IvsidError(
                f"thruster {thruster.name} claims advance_loss or has a rudder, whose force depends on the motion, and a tube takes forces "
                "that demands alone determine; leave the claim out and widen the thruster's accuracy by it"
            )
        at, over = self._thrust(slice(None), slice(self.demand.size - 1))
        if thruster.time_constant and thruster.lag == "thrust":
            over = at[:-1].hull(at[1:])
        if self.turned is None:
            return over, directions(thruster)
        return over, _shares(thruster, self.turned.over_steps)

    def _thrust(self, here: slice, between: slice) -> tuple[IntervalArray, IntervalArray]:
        """The thrust [N] at rows and over the steps between them, without advance loss."""
        if self.lagged is not None:
            return self.lagged[0][here], self.lagged[1][between]
        if self.late is not None:
            return self.late.at_rows[here], self.late.over_steps[between]
        demand, error = self.demand[here], self.error(here)
        at = self.curve.interval(demand, error=error)
        if self.held:
            return at, at[:-1]
        return at, self.curve.interval(demand[:-1], demand[1:], np.maximum(error[:-1], error[1:]))


def _followed(thruster: Thruster, *, held: bool) -> None:
    if thruster.time_constant and not held:
        raise IvsidError(
            f"thruster {thruster.name} claims a time_constant and the log's demands are linear; a lag is followed for held demands "
            'only: set [log] demand = "hold", or leave time_constant out'
        )


def _share(force: IntervalArray, share: IntervalArray) -> IntervalArray:
    """``force * share``, with shortcuts for a share of 0 or 1."""
    if not share.ndim and share.lower == share.upper and share.lower in (0.0, 1.0):
        return force if share.lower else IntervalArray(np.zeros(force.shape))
    return force * share


def _shares(thruster: Thruster, angle: IntervalArray) -> tuple[IntervalArray, IntervalArray, IntervalArray]:
    x, y = (IntervalArray.around(p, np.spacing(abs(p))) for p in thruster.position)
    cosine, sine = np.cos(angle), np.sin(angle)
    return cosine, sine, sine * x - cosine * y


def _advance_loss(
    thruster: Thruster,
    thrust: IntervalArray,
    shares: tuple[IntervalArray, IntervalArray, IntervalArray],
    motion: tuple[IntervalArray, IntervalArray, IntervalArray],
) -> IntervalArray:
    """Loss of thrust by inflow, k |T| w [N] with w along the thruster's axis: the catalogue's thruster.advance_loss."""
    loss = thruster.advance_loss or 0.0
    x, y = (IntervalArray.around(p, np.spacing(abs(p))) for p in thruster.position)
    u, v, r = motion
    inflow = (u - r * y) * shares[0] + (v + r * x) * shares[1]
    return abs(thrust) * inflow * IntervalArray.around(loss, np.spacing(loss))


def nominal_force(vehicle: Vehicle, log: Log) -> NDArray[np.float64]:
    """X, Y [N], N [N m] from the demands without errors, as means over the step after each row, shape (n, 3).

    Advance losses and rudders use the logged motion. The result is NaN where a demand or an angle is missing, and behind a lag for
    the first five time constants, because the thrust before the log is unknown.

    Raises:
        IvsidError: a missing column, a demand outside the curve, or a lag under linear demands.
    """
    if not vehicle.thrusters:
        return np.stack([log.columns[n] for n in ("force_X", "force_Y", "moment_N")], axis=1)
    n = log.t.size
    # A lag goes from row to row, so that its forces are made in one piece.
    parts = [slice(0, n)] if any(t.time_constant for t in vehicle.thrusters) else pieces(n)
    for thruster in vehicle.thrusters:
        _followed(thruster, held=vehicle.log.demand == "hold")
        for name in [f"azimuth_{thruster.name}"] if thruster.steering == "azimuth" else []:
            log.column(name, f"for the direction of thruster {thruster.name}")
        for name in [f"rudder_{thruster.name}"] if thruster.rudder is not None else []:
            log.column(name, f"for the rudder of thruster {thruster.name}")
    demands = {t.name: log.columns[f"demand_{t.name}"] for t in vehicle.thrusters}
    allowed = {
        name: float(x[next(int(np.argmax(~np.isnan(x[p]))) + p.start for p in pieces(n) if not np.isnan(x[p]).all())])
        for name, x in demands.items()
    }
    made = room((n, 3), DOUBLE)

    def fill(part: slice) -> None:
        columns = {name: x[part] for name, x in log.columns.items()}
        made[part] = _nominal(vehicle, log.t[part], columns, allowed)

    over_pieces(parts, fill)
    return made


def _nominal(
    vehicle: Vehicle, t: NDArray[np.float64], columns: Mapping[str, NDArray[np.float64]], allowed: Mapping[str, float]
) -> NDArray[np.float64]:
    """Forces of ``nominal_force`` at some rows; an allowed demand stands for each missing one."""
    total = np.zeros((t.size, 3))
    for thruster in vehicle.thrusters:
        demand = columns[f"demand_{thruster.name}"]
        there = ~np.isnan(demand)
        filled = np.where(there, demand, allowed[thruster.name])
        thrust = ThrustCurve(thruster).value(filled)
        if thruster.time_constant:
            thrust = _nominal_lag(thruster, filled, thrust, t)
            thrust[t - t[0] < 5 * thruster.time_constant] = np.nan
        thrust = np.where(there, thrust, np.nan)
        x, y = thruster.position
        if thruster.steering == "azimuth":
            angle = columns[f"azimuth_{thruster.name}"]
            shares: list[float | NDArray[np.float64]] = [
                np.cos(angle),
                np.sin(angle),
                x * np.sin(angle) - y * np.cos(angle),
            ]
        else:
            shares = [float(s.midpoint) for s in directions(thruster)]
        if thruster.advance_loss:
            u, v, r = (columns[n] for n in ("u", "v", "r"))
            thrust = thrust - thruster.advance_loss * np.abs(thrust) * (
                (u - y * r) * shares[0] + (v + x * r) * shares[1]
            )
        for j, share in enumerate(shares):
            total[:, j] += thrust * share
        if thruster.rudder is not None:
            delta = columns[f"rudder_{thruster.name}"]
            u, v, r = (columns[n] for n in ("u", "v", "r"))
            total += np.stack(rudder_force(thruster.rudder, delta, thrust, u, v, r), axis=1)
    return total


def _nominal_lag(
    thruster: Thruster, demand: NDArray[np.float64], thrust: NDArray[np.float64], t: NDArray[np.float64]
) -> NDArray[np.float64]:
    tau = thruster.time_constant or 0.0
    goal = demand if thruster.lag == "demand" else thrust
    now, means = float(goal[0]), []
    for g, h in zip(goal.tolist(), [*np.diff(t).tolist(), math.inf], strict=True):
        decay = math.exp(-h / tau)
        share = (1 - decay) * tau / h if math.isfinite(h) else 0.0
        means.append(g + (now - g) * share)
        now = g + (now - g) * decay
    mean = np.array(means)
    return ThrustCurve(thruster).value(mean) if thruster.lag == "demand" else mean
