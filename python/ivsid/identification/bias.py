"""The slow bias of an accelerometer as one unknown of the log, where that is tighter than a bound at every sample.

A reading is the truth plus a bias b(t) plus white noise. Let the bias be a first-order Gauss-Markov process of standard deviation B and
time T, and let t_m be the middle of the log. Then |b(t) - b(t_m)| is at most k B sqrt(2 (1 - exp(-|t - t_m| / T))) at each sample,
with one more term in the union bound. That is far less than k B where T is long. The accelerations therefore enter with this narrow
bound, and b = b(t_m) is an unknown of its own. Let C be the sum of the parameters that multiply the acceleration in a channel. Each
pointwise row gets the column -1 of the unknown beta = b C, and one more row states |b| <= k B:

    beta - [-k B, k B] C = 0.

That row is linear in beta and the parameters. The assumptions are those of a bound at every sample.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, Columns, State, Term, rigid_body
from ivsid.identification.result import Identification
from ivsid.intervals import IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.log import Log
from ivsid.memory.order import median
from ivsid.memory.pieces import array_pieces, kept
from ivsid.rows import ROW_KINDS, RegressionRows
from ivsid.sensors.bounds import BoundedLog
from ivsid.sensors.noise import rule_for
from ivsid.vehicle import AccelerationSensor, Vehicle
from ivsid.vehicle.carried import with_keys

CHOICES: Final = ("auto", "sample", "log")
# The bias is one unknown by default where that narrows the median reading to at most this share.
# Source: measured: make constants
WORTHWHILE: Final = 0.75
# Relative slack that holds the roundings of bounds, their square roots and exponentials: about ten of 2^-53 each.
# Source: theorem: standard model of floating-point arithmetic, Higham 2002, section 2.2
ROUNDING: Final = 1e-9
# Coefficient of the unknown bias in rows of each kind: -1 where the row takes an acceleration at its sample. A kind that is missing
# here is an error: with narrow accelerations and no unknown its bounds would be too narrow.
# Source: definition: the row's acceleration is the reading less the bias
COEFFICIENT: Final = {"pointwise": -1.0, "integral": 0.0, "weak": 0.0, "bias.x": 0.0, "bias.y": 0.0} | {
    kind: 0.0 for kind in ROW_KINDS if kind.startswith("physical.")
}
AXES: Final = ("x", "y")
_NAMES: Final = (("ax", "udot"), ("ay", "vdot"))


def separate_bias(bounded: BoundedLog, vehicle: Vehicle, choice: str) -> tuple[BoundedLog, dict[str, float]] | None:
    """The log with narrow accelerations, and the bound k B [m/s^2] of each axis; None where the bound at every sample stays.

    Args:
        bounded: with the bound of the bias in the interval of every sample.
        vehicle: with the accelerometer.
        choice: ``sample`` keeps that bound, ``log`` takes the bias as one unknown wherever it can, ``auto`` where it pays.
    """
    vehicle, _ = with_keys(vehicle)
    sensor = vehicle.sensors.acceleration
    if choice == "sample" or sensor is None or bounded.rule.confidence is None:
        return None
    # Readings that were moved to the origin by the yaw rate carry its errors, too; they keep the rule that they were made with.
    velocity = vehicle.sensors.velocity
    moved = (
        (velocity is not None and velocity.off_origin)
        or sensor.off_origin
        or sensor.turned
        or sensor.gravity
        or sensor.sampling == "averaged"
        or bounded.corrected & {"ax", "ay", "udot", "vdot", "r"}
        or bounded.stream
    )
    found = {
        a: n for k, a in enumerate(AXES) for n in _NAMES[k] if n in bounded.channels and n not in bounded.log.derived
    }
    both = sum(n in bounded.channels for pair in _NAMES for n in pair) > len(found)
    # The growth below does not cover readings of another clock, or yaw accelerations made from windows of yaw rates.
    elsewhere = {*found.values()} & {*bounded.log.clocks, *bounded.log.by_rate} or "rdot" in bounded.log.derived
    if moved or both or elsewhere or not found or not all(sensor.axis(AXES.index(a))[0] for a in found):
        return None
    # The bias in the middle is one more error of each axis; at each sample its change from there takes the place of itself.
    rule = rule_for(vehicle.sensors, bounded.rule.errors + len(found))
    channels = dict(bounded.channels)
    share = []
    for axis, name in found.items():
        narrow = _narrowed(bounded, name, sensor, AXES.index(axis), rule.sigmas)
        known = bounded.present[name]
        share.append(_share_left(narrow, channels[name], known))
        channels[name] = narrow
    if choice == "auto" and max(share) > WORTHWHILE:
        return None
    # All other bounds were made for a few errors less, so they grow by the ratio of the two rules.
    growth = rule.sigmas / bounded.rule.sigmas
    for name, x in channels.items():
        if name not in found.values() and name in ("r", "rdot"):
            channels[name] = _grown(x, growth)
    reach = {a: rule.sigmas * sensor.axis(AXES.index(a))[0] * (1 + ROUNDING) for a in found}
    force, moment = (q * growth * (1 + ROUNDING) for q in bounded.ambient)
    return replace(bounded, channels=channels, rule=rule, ambient=(force, moment)), reach


def _share_left(narrow: IntervalArray, wide: IntervalArray, known: NDArray[np.bool_]) -> float:
    """The median share of the width that is left."""

    def share(rows: slice) -> NDArray[np.float64]:
        left = np.zeros(known[rows].size)
        np.divide(narrow[rows].width, wide[rows].width, out=left, where=known[rows])
        return left

    shares = array_pieces(known.size, share)
    shares = shares if known.all() else kept(shares, known)
    return median(shares.size, lambda rows: shares[rows])


def _grown(x: IntervalArray, growth: float) -> IntervalArray:
    def grown(rows: slice) -> IntervalArray:
        width = x[rows].width
        extra = np.where(np.isfinite(width), 0.5 * width * (growth - 1) * (1 + ROUNDING), 0.0)
        made: IntervalArray = x[rows] + IntervalArray(-extra, extra)
        return made

    return interval_pieces(x.shape[0], grown)


def _narrowed(bounded: BoundedLog, name: str, sensor: AccelerationSensor, axis: int, sigmas: float) -> IntervalArray:
    """The reading with its noise and the change of its bias: never wider than the old interval under the new rule."""
    deviation, time = sensor.axis(axis)
    t = bounded.log.t
    middle_of_log, lost = 0.5 * (t[0] + t[-1]), 2 * bounded.log.time_error
    growth = sigmas / bounded.rule.sigmas

    def narrowed(rows: slice) -> IntervalArray:
        away = np.abs(t[rows] - middle_of_log) + lost
        moved = sigmas * deviation * np.sqrt(-2 * np.expm1(-away / time))
        own = bounded.channels[name][rows]
        # The old interval has k B of bias on either side; the change of the bias takes its place.
        change = moved * (1 + ROUNDING) - sigmas * deviation * (1 - ROUNDING)
        there = bounded.present[name][rows]
        middle = np.where(there, own.midpoint, 0.0)
        radius = np.where(there, 0.5 * _grown(own, growth).width + change, 0.0)
        radius = np.nextafter(np.maximum(radius, 0.0) * (1 + ROUNDING), np.inf)
        around = IntervalArray.around(middle, radius + 4 * np.spacing(np.abs(middle)))
        return IntervalArray(np.where(there, around.lower, -np.inf), np.where(there, around.upper, np.inf))

    return interval_pieces(t.size, narrowed)


def with_unknowns(
    rows: RegressionRows, reach: dict[str, float], log: Log, vehicle: Vehicle, mass: float
) -> RegressionRows:
    """The rows with a column for each unknown bias in each channel, and with the rows that bound the biases.

    Args:
        rows: of the model.
        reach: bound of the bias of each axis [m/s^2].
        log: from which the rows were made.
        vehicle: with the rigid body.
        mass: known rigid-body mass, where the parameters leave it out [kg].
    """
    n = rows.matrix.shape[1]
    taken = np.array([COEFFICIENT[kind] for kind in ROW_KINDS])[rows.kind]
    x_g, y_g = vehicle.hull.centre_of_gravity
    unknown: list[tuple[Term, NDArray[np.float64], list[float], IntervalArray, int]] = []
    for axis, bound in reach.items():
        for index, channel in enumerate(CHANNELS):
            coefficient = np.where(rows.channel == index, taken, 0.0)
            shares = [_share(t.columns, axis, channel) for t in rows.terms]
            known = _share(
                lambda s: rigid_body(s, vehicle.hull.mass * x_g, vehicle.hull.mass * y_g, mass), axis, channel
            )
            if not coefficient.any() or not (any(shares) or known):
                continue
            term = Term(f"bias.{axis}.{channel}", "", "N" if index < 2 else "N m", lambda _s: {})
            around = IntervalArray(-bound, bound)
            unknown.append((term, coefficient, shares, around * (known * (1 + 1e-12)), index))
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


def _share(columns: Callable[[State], Columns], axis: str, channel: str) -> float:
    """The coefficient of the acceleration along an axis in a column."""
    rest = State(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    moved = State(0.0, 0.0, 0.0, float(axis == "x"), float(axis == "y"), 0.0)
    return float(columns(moved).get(channel, 0.0) - columns(rest).get(channel, 0.0))


def without_unknowns(fit: Identification, terms: Sequence[Term]) -> Identification:
    """The identification with the parameters of the model alone; its certificates keep the unknown biases."""
    ids = [t.id for t in terms]
    return replace(
        fit,
        parameters={k: p for k, p in fit.parameters.items() if k in ids},
        estimate={k: x for k, x in fit.estimate.items() if k in ids},
        directions=tuple({k: x for k, x in d.items() if k in ids} for d in fit.directions),
    )
