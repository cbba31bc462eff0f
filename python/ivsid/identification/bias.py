"""An accelerometer's slow bias as one unknown a log, where that is tighter than a box at every sample.

A reading is the truth plus a bias b(t) plus white noise. A first-order Gauss-Markov bias of standard deviation B and time T leaves its
value in the middle of the log by at most k B sqrt(2 (1 - exp(-|t - t_m| / T))) at each sample (one more union bound), which is far
less than k B where T is long. So the accelerations enter narrow, and b = b(t_m) as an unknown of its own: with C the sum of
the parameters that multiply the acceleration in a channel, each pointwise row gets the column -1 of the unknown beta = b C, and one more
row states |b| <= k B:

    beta - [-k B, k B] C = 0.

That row is linear in beta and the parameters; nothing is lost and nothing is assumed beside what the box assumes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, State, Term, rigid_body
from ivsid.identification.fit import Identification
from ivsid.intervals import IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.log import Log
from ivsid.rows import ROW_KINDS, RegressionRows
from ivsid.sensors.bounds import BoundedLog
from ivsid.sensors.noise import rule_for
from ivsid.vehicle import AccelerationSensor, Vehicle

CHOICES: Final = ("auto", "sample", "log")
# By default the bias is taken apart where that narrows the median reading to at most this share.
WORTHWHILE: Final = 0.75
AXES: Final = ("x", "y")
_NAMES: Final = (("ax", "udot"), ("ay", "vdot"))


def apart(bounded: BoundedLog, vehicle: Vehicle, choice: str) -> tuple[BoundedLog, dict[str, float]] | None:
    """The log with narrow accelerations, and the bound k B of each axis; None where the box stays.

    Args:
        bounded: with the box of every sample.
        vehicle: whose accelerometer it is.
        choice: ``sample`` keeps the box, ``log`` takes the bias apart wherever it can be, ``auto`` where it pays.
    """
    sensor = vehicle.sensors.acceleration
    if choice == "sample" or sensor is None or bounded.rule.confidence is None:
        return None
    # Readings that were moved by the yaw rate carry its errors; they keep the rule that they were made with.
    velocity = vehicle.sensors.velocity
    moved = (
        (velocity is not None and velocity.off_origin)
        or sensor.off_origin
        or sensor.turned
        or sensor.gravity
        or sensor.sampling == "averaged"
    )
    found = {
        a: n for k, a in enumerate(AXES) for n in _NAMES[k] if n in bounded.channels and n not in bounded.log.derived
    }
    both = sum(n in bounded.channels for pair in _NAMES for n in pair) > len(found)
    # On another clock, or beside a rate made of windows, the growth below is not all that changes.
    elsewhere = {*found.values()} & {*bounded.log.clocks, *bounded.log.by_rate} or "rdot" in bounded.log.derived
    if moved or both or elsewhere or not found or not all(sensor.axis(AXES.index(a))[0] for a in found):
        return None
    # The bias in the middle is one more error an axis; what it moves from there takes the place of itself at each sample.
    rule = rule_for(vehicle.sensors, bounded.rule.errors + len(found))
    channels = dict(bounded.channels)
    share = []
    for axis, name in found.items():
        narrow = _narrowed(bounded, name, sensor, AXES.index(axis), rule.sigmas)
        known = bounded.present[name]
        share.append(float(np.median(narrow.width[known] / channels[name].width[known])))
        channels[name] = narrow
    if choice == "auto" and max(share) > WORTHWHILE:
        return None
    # All other bounds were made for a few errors less: they are widened as the rule asks.
    growth = rule.sigmas / bounded.rule.sigmas
    for name, x in channels.items():
        if name not in found.values() and name in ("r", "rdot"):
            channels[name] = _grown(x, growth)
    reach = {a: rule.sigmas * sensor.axis(AXES.index(a))[0] * (1 + 1e-9) for a in found}
    force, moment = (q * growth * (1 + 1e-9) for q in bounded.ambient)
    return replace(bounded, channels=channels, rule=rule, ambient=(force, moment)), reach


def _grown(x: IntervalArray, growth: float) -> IntervalArray:
    extra = np.where(np.isfinite(x.width), 0.5 * x.width * (growth - 1) * (1 + 1e-9), 0.0)
    return x + IntervalArray(-extra, extra)


def _narrowed(bounded: BoundedLog, name: str, sensor: AccelerationSensor, axis: int, sigmas: float) -> IntervalArray:
    """The reading with what is left around its own bias: never wider than the box grown to the new rule."""
    deviation, time = sensor.axis(axis)
    t = bounded.log.t
    middle_of_log, lost = 0.5 * (t[0] + t[-1]), 2 * bounded.log.time_error
    growth = sigmas / bounded.rule.sigmas

    def narrowed(rows: slice) -> IntervalArray:
        away = np.abs(t[rows] - middle_of_log) + lost
        moved = sigmas * deviation * np.sqrt(-2 * np.expm1(-away / time))
        own = bounded.channels[name][rows]
        # The box holds k B of bias on either side; in its place comes what the bias moves.
        change = moved * (1 + 1e-9) - sigmas * deviation * (1 - 1e-9)
        there = bounded.present[name][rows]
        middle = np.where(there, own.midpoint, 0.0)
        radius = np.where(there, 0.5 * _grown(own, growth).width + change, 0.0)
        radius = np.nextafter(np.maximum(radius, 0.0) * (1 + 1e-9), np.inf)
        around = IntervalArray.around(middle, radius + 4 * np.spacing(np.abs(middle)))
        return IntervalArray(np.where(there, around.lower, -np.inf), np.where(there, around.upper, np.inf))

    return interval_pieces(t.size, narrowed)


def with_unknowns(
    rows: RegressionRows, reach: dict[str, float], log: Log, vehicle: Vehicle, mass: float
) -> RegressionRows:
    """The rows with a column for each bias in each channel, and the rows that bound them."""
    n = rows.matrix.shape[1]
    x_g, y_g = vehicle.hull.centre_of_gravity
    unknown: list[tuple[Term, NDArray[np.float64], list[float], IntervalArray, int]] = []
    for axis, bound in reach.items():
        for index, channel in enumerate(CHANNELS):
            pointwise = (rows.channel == index) & (rows.kind == ROW_KINDS.index("pointwise"))
            shares = [_share(t.columns, axis, channel) for t in rows.terms]
            known = _share(
                lambda s: rigid_body(s, vehicle.hull.mass * x_g, vehicle.hull.mass * y_g, mass), axis, channel
            )
            if not pointwise.any() or not (any(shares) or known):
                continue
            term = Term(f"bias.{axis}.{channel}", "", "N" if index < 2 else "N m", lambda _s: {})
            around = IntervalArray(-bound, bound)
            unknown.append((term, np.where(pointwise, -1.0, 0.0), shares, around * (known * (1 + 1e-12)), index))
    if not unknown:
        return rows
    columns = [rows.matrix[:, j] for j in range(n)] + [IntervalArray(u[1]) for u in unknown]
    top = IntervalArray.stack(columns, axis=1)
    lower, upper = np.zeros((len(unknown), n + len(unknown))), np.zeros((len(unknown), n + len(unknown)))
    for k, (term, _, shares, _, _) in enumerate(unknown):
        bound = reach[term.id.split(".")[1]]
        for j, share in enumerate(shares):
            wide = float(np.nextafter(abs(share) * bound, np.inf)) if share else 0.0
            lower[k, j], upper[k, j] = -wide, wide
        lower[k, n + k] = upper[k, n + k] = 1.0
    rights = [u[3].reshape(1) for u in unknown]
    middle = 0.5 * float(log.t[0] + log.t[-1])
    more = len(unknown)
    words = f"the accelerometer's bias is one unknown for the log, within {', '.join(f'{b:.3g} ({a})' for a, b in reach.items())} m/s^2"
    return RegressionRows(
        (*rows.terms, *(u[0] for u in unknown)),
        IntervalArray.concatenate([top, IntervalArray(lower, upper)]),
        IntervalArray.concatenate([rows.right, *rights]),
        np.r_[rows.channel, np.array([u[4] for u in unknown], dtype=np.int64)],
        np.r_[rows.time, np.full(more, middle)],
        np.r_[rows.duration, np.zeros(more)],
        np.r_[rows.kind, np.array([ROW_KINDS.index(f"bias.{u[0].id.split('.')[1]}") for u in unknown], dtype=np.int64)],
        (*rows.assumes, words),
    )


def _share(columns: Any, axis: str, channel: str) -> float:
    """What one unit of acceleration adds to a column."""
    still = State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    moved = State(0.0, 0.0, 0.0, float(axis == "x"), float(axis == "y"), 0.0)
    return float(columns(moved).get(channel, 0.0) - columns(still).get(channel, 0.0))


def without_unknowns(fit: Identification, terms: Sequence[Term]) -> Identification:
    """The fit with the model's own parameters alone; the unknown biases stay in its certificates."""
    ids = [t.id for t in terms]
    return replace(
        fit,
        parameters={k: p for k, p in fit.parameters.items() if k in ids},
        estimate={k: x for k, x in fit.estimate.items() if k in ids},
        directions=tuple({k: x for k, x in d.items() if k in ids} for d in fit.directions),
    )
