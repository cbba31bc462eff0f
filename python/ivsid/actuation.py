"""From logged demands to thrusts in intervals and in numbers: lag, and thrusters that turn.

The static curve with its accuracy is ``thrust``; here stands what happens between a demand and the water in time. Nothing that the
vehicle file claims is left out in silence.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.foil import rudder_force
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.log.turning import angle_of
from ivsid.rudder import rudder_over
from ivsid.thrust import ThrustCurve, directions
from ivsid.vehicle import Thruster, Vehicle

# One step of the lag, e a + (1 - e) b with 0 <= e <= 1, is rounded four times, each by at most 2^-53 of |a| + |b|.
STEP_ROUNDING: Final = 1e-15
# exp and the quotient before it are good to a few units in the last place.
DECAY_ROUNDING: Final = 1e-14
# A step this much longer than the usual one is a gap: demands in it are unknown.
GAP: Final = 2.5

_cos: Any = np.cos  # NumPy's types know no intervals, its functions do.
_sin: Any = np.sin


@dataclass(frozen=True)
class Flow:
    """The vehicle's motion through the water, for what depends on it: u, v [m/s], r [rad/s] at rows and over all of each step."""

    at_rows: tuple[IntervalArray, IntervalArray, IntervalArray]
    over_steps: tuple[IntervalArray, IntervalArray, IntervalArray]


@dataclass(frozen=True)
class Pushed:
    """Forces of one thruster at the rows, shape (n,), and over the steps between them, shape (n - 1,).

    Attributes:
        at_rows: X, Y [N], N [N m] at each row.
        over_steps: their means over each step to the next row.
        present: where demand and angle are known, shape (n,).
        assumes: sentences that the intervals rely on.
        whole: steps over which the angle is known, shape (n - 1,); None: wherever it is at both rows.
    """

    at_rows: tuple[IntervalArray, IntervalArray, IntervalArray]
    over_steps: tuple[IntervalArray, IntervalArray, IntervalArray]
    present: NDArray[np.bool_]
    assumes: tuple[str, ...] = ()
    whole: NDArray[np.bool_] | None = None


def pushed(thruster: Thruster, log: Log, *, held: bool, flow: Flow | None = None) -> Pushed:
    """The forces of a thruster.

    Args:
        thruster: with its claims.
        log: with its demand, and its angle where it turns.
        held: demands hold from row to row; else they change on straight lines.
        flow: needed where the thruster claims an advance loss.

    Raises:
        IvsidError: a column that is missing, a demand outside the curve, or a claim that the rows cannot follow.
    """
    _followed(thruster, held=held)
    name = f"demand_{thruster.name}"
    demand, error = log.column(name, f"for thruster {thruster.name}"), log.error(name)
    there = ~np.isnan(demand)
    # A missing demand is not used; any demand that is allowed stands in for it.
    demand = np.where(there, demand, demand[there][0])
    curve = ThrustCurve(thruster)
    assumes: tuple[str, ...] = ()
    if thruster.time_constant:
        at, over = _lagged(curve, demand, np.broadcast_to(error, demand.shape), log, there, thruster.time_constant)
        assumes = (
            f"thruster {thruster.name} follows its demand with a time constant of {thruster.time_constant!r} s; before the log it was "
            "at rest or pushed anything that its curve allows",
        )
    else:
        at = curve.interval(demand, error=error)
        over = at[:-1] if held else curve.interval(demand[:-1], demand[1:], np.maximum(error[:-1], error[1:]))
    if thruster.steering == "azimuth":
        turned = angle_of(log, f"azimuth_{thruster.name}", f"for the direction of thruster {thruster.name}", held=held)
        there, whole = there & turned.present, turned.whole
        assumes = (*assumes, turned.assumes)
        rows, steps = (_shares(thruster, a) for a in (turned.at_rows, turned.over_steps))
    else:
        whole = None
        rows = steps = directions(thruster)
    if flow is None and (thruster.advance_loss or thruster.rudder is not None):
        raise IvsidError(
            f"thruster {thruster.name} claims advance_loss or has a rudder, which needs the motion; give u, v and r"
        )
    # Behind a lag the thrust moves between its values at both rows, and its mean alone is no bound.
    swept_thrust = at[:-1].hull(at[1:]) if thruster.time_constant and thruster.lag == "thrust" else over
    if f"azimuth_{thruster.name}" in log.over:
        # The mean of T cos a is the mean of T times cos a only where the angle holds still.
        over = swept_thrust
    if thruster.advance_loss and flow is not None:
        at = at - _advance_loss(thruster, at, rows, flow.at_rows)
        lost = _advance_loss(thruster, swept_thrust, steps, flow.over_steps)
        over, swept_thrust = over - lost, swept_thrust - lost
    at_rows, over_steps = ([force * s for s in shares] for force, shares in ((at, rows), (over, steps)))
    if thruster.rudder is not None and flow is not None:
        delta = angle_of(log, f"rudder_{thruster.name}", f"for the rudder of thruster {thruster.name}", held=held)
        there, whole = there & delta.present, delta.whole if whole is None else whole & delta.whole
        blades = (
            rudder_over(thruster.rudder, delta.at_rows, at, flow.at_rows),
            rudder_over(thruster.rudder, delta.over_steps, swept_thrust, flow.over_steps),
        )
        at_rows = [a + b for a, b in zip(at_rows, blades[0], strict=True)]
        over_steps = [a + b for a, b in zip(over_steps, blades[1], strict=True)]
        within = f", each within {thruster.rudder.accuracy:g} of itself" if thruster.rudder.accuracy else ""
        foil = f"the rudder behind {thruster.name} has the lift and drag of the stated foil{within}"
        assumes = (*assumes, delta.assumes, foil)
    return Pushed(
        (at_rows[0], at_rows[1], at_rows[2]), (over_steps[0], over_steps[1], over_steps[2]), there, assumes, whole
    )


def _followed(thruster: Thruster, *, held: bool) -> None:
    if thruster.time_constant and not held:
        raise IvsidError(
            f"thruster {thruster.name} claims a time_constant and the log's demands are linear; a lag is followed for held demands "
            'only: set [log] demand = "hold", or leave time_constant out'
        )


def _shares(thruster: Thruster, angle: IntervalArray) -> tuple[IntervalArray, IntervalArray, IntervalArray]:
    x, y = (IntervalArray.around(p, np.spacing(abs(p))) for p in thruster.position)
    cosine, sine = _cos(angle), _sin(angle)
    return cosine, sine, sine * x - cosine * y


def _advance_loss(
    thruster: Thruster,
    thrust: IntervalArray,
    shares: tuple[IntervalArray, IntervalArray, IntervalArray],
    motion: tuple[IntervalArray, IntervalArray, IntervalArray],
) -> IntervalArray:
    """What inflow takes of a thrust, k |T| w with w along the thruster's axis (EFFECTS.md, thruster.advance_loss)."""
    loss = thruster.advance_loss or 0.0
    x, y = (IntervalArray.around(p, np.spacing(abs(p))) for p in thruster.position)
    u, v, r = motion
    inflow = (u - r * y) * shares[0] + (v + r * x) * shares[1]
    return abs(thrust) * inflow * IntervalArray.around(loss, np.spacing(loss))


def _lagged(
    curve: ThrustCurve,
    demand: NDArray[np.float64],
    error: NDArray[np.float64],
    log: Log,
    there: NDArray[np.bool_],
    tau: float,
) -> tuple[IntervalArray, IntervalArray]:
    """The thrust behind a first-order lag of held demands, at rows and as mean over steps.

    Under a held demand with thrust G the lag is exact, T(t) = G + (T_0 - G) exp(-t / tau); T_0 is nothing or whatever the curve allows
    before the first row, and again after a gap or a missing demand. On its way from rest to a curve that does not begin there a shaft
    gives anything between no thrust and that of the curve's nearer end.
    """
    shaft = curve.thruster.lag == "demand"
    low, high = curve.range
    if not np.isfinite(low) or not np.isfinite(high):
        raise IvsidError(
            f"thruster {curve.thruster.name} claims a time_constant, and what it did before the log is anything its curve allows; "
            "end the curve with demand_range = [lowest, highest]"
        )
    everything = curve.interval(np.array([low]), np.array([high]))
    rest = curve.thruster.neutral
    if shaft:
        # A demand outside the curve is held at its end before the shaft follows it.
        goal = IntervalArray(*curve.inside(demand - error, demand + error))
        start = min(low, rest), max(high, rest)
    else:
        goal = curve.interval(demand, error=error)
        start = min(float(everything.lower[0]), 0.0), max(float(everything.upper[0]), 0.0)
    steps = np.diff(log.t)
    whole = (steps <= GAP * log.period) & there[:-1] & there[1:]
    ratio = steps / tau
    slack = DECAY_ROUNDING * (1 + ratio) + 2 * np.max(log.time_error) / tau
    at = _follow(goal, start, np.exp(-ratio), slack, whole)
    if shaft:
        reach = at[:-1].hull(at[1:])
        return _of_shaft(curve, at), _of_shaft(curve, reach)
    share = np.where(ratio > 1e-8, -np.expm1(-ratio) / np.maximum(ratio, 1e-300), 1.0)
    over = _between(at[:-1], goal[:-1], share, slack + np.where(ratio > 1e-8, 0.0, 1e-8))
    return at, over


def _of_shaft(curve: ThrustCurve, speed: IntervalArray) -> IntervalArray:
    """The thrust at a shaft's speed, from rest on."""
    low, high = curve.range
    thrust = curve.interval(np.clip(speed.lower, low, high), np.clip(speed.upper, low, high))
    rest = curve.thruster.neutral
    if low <= rest <= high:
        return thrust
    starting = speed.lower < low if rest < low else speed.upper > high
    return IntervalArray(
        np.where(starting, np.minimum(thrust.lower, 0.0), thrust.lower),
        np.where(starting, np.maximum(thrust.upper, 0.0), thrust.upper),
    )


def _follow(
    goal: IntervalArray,
    start: tuple[float, float],
    decay: NDArray[np.float64],
    slack: NDArray[np.float64],
    whole: NDArray[np.bool_],
) -> IntervalArray:
    """T_0 = start; T_k+1 = e T_k + (1 - e) G_k for a decay e within its slack; start again after what is not whole."""
    lower, upper = [start[0]], [start[1]]
    for g_low, g_high, e, s, known in zip(
        goal.lower[:-1].tolist(), goal.upper[:-1].tolist(), decay.tolist(), slack.tolist(), whole.tolist(), strict=True
    ):
        if not known:
            lower.append(start[0])
            upper.append(start[1])
            continue
        least, most = max(e - s, 0.0), min(e + s, 1.0)
        a, b = lower[-1], upper[-1]
        # Linear in e: its extremes stand at the ends.
        low = min(least * a + (1 - least) * g_low, most * a + (1 - most) * g_low)
        high = max(least * b + (1 - least) * g_high, most * b + (1 - most) * g_high)
        lower.append(low - STEP_ROUNDING * (abs(a) + abs(g_low)))
        upper.append(high + STEP_ROUNDING * (abs(b) + abs(g_high)))
    return IntervalArray(np.array(lower), np.array(upper))


def _between(
    a: IntervalArray, b: IntervalArray, share: NDArray[np.float64], slack: NDArray[np.float64]
) -> IntervalArray:
    """P a + (1 - p) b for a share p within its slack."""
    least, most = np.clip(share - slack, 0.0, 1.0), np.clip(share + slack, 0.0, 1.0)
    ends = [(p * a.lower + (1 - p) * b.lower, p * a.upper + (1 - p) * b.upper) for p in (least, most)]
    low = np.minimum(ends[0][0], ends[1][0]) - STEP_ROUNDING * (np.abs(a.lower) + np.abs(b.lower))
    high = np.maximum(ends[0][1], ends[1][1]) + STEP_ROUNDING * (np.abs(a.upper) + np.abs(b.upper))
    return IntervalArray(low, high)


def nominal_force(vehicle: Vehicle, log: Log) -> NDArray[np.float64]:
    """X, Y [N], N [N m] from the demands without their error, as means over the step after each row, shape (n, 3).

    An advance loss and a rudder take the logged motion. NaN where a demand or an angle is missing, and behind a lag for the first five time constants: what it did before the log is
    not known.
    """
    if not vehicle.thrusters:
        return np.stack([log.columns[n] for n in ("force_X", "force_Y", "moment_N")], axis=1)
    total = np.zeros((log.t.size, 3))
    for thruster in vehicle.thrusters:
        _followed(thruster, held=vehicle.log.demand == "hold")
        demand = log.columns[f"demand_{thruster.name}"]
        there = ~np.isnan(demand)
        filled = np.where(there, demand, demand[there][0])
        thrust = ThrustCurve(thruster).value(filled)
        if thruster.time_constant:
            thrust = _nominal_lag(thruster, filled, thrust, log.t)
            thrust[log.t - log.t[0] < 5 * thruster.time_constant] = np.nan
        thrust = np.where(there, thrust, np.nan)
        x, y = thruster.position
        if thruster.steering == "azimuth":
            angle = log.column(f"azimuth_{thruster.name}", f"for the direction of thruster {thruster.name}")
            shares: list[Any] = [np.cos(angle), np.sin(angle), x * np.sin(angle) - y * np.cos(angle)]
        else:
            shares = [float(s.midpoint) for s in directions(thruster)]
        if thruster.advance_loss:
            u, v, r = (log.columns[n] for n in ("u", "v", "r"))
            thrust = thrust - thruster.advance_loss * np.abs(thrust) * (
                (u - y * r) * shares[0] + (v + x * r) * shares[1]
            )
        for j, share in enumerate(shares):
            total[:, j] += thrust * share
        if thruster.rudder is not None:
            delta = log.column(f"rudder_{thruster.name}", f"for the rudder of thruster {thruster.name}")
            u, v, r = (log.columns[n] for n in ("u", "v", "r"))
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
