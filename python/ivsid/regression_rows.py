"""Equations of motion to interval rows A theta = y that hold at the true parameter (paper eq. 3-6; METHODS 5.2).

Pointwise rows state the equations at a sample; they need measured accelerations. Integral rows state their mean over a
window: the mean of an acceleration is an exact difference of velocities, the mean thrust of held demands an exact sum, and
what is left is a quadrature whose error the stated limits of the vessel bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.actuation import GAP, Flow, pushed
from ivsid.effects import CHANNELS, Columns, State, Term, rigid_body
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, Interval, IntervalArray
from ivsid.motion import Motion
from ivsid.needs import lacking
from ivsid.sensors import BoundedLog
from ivsid.vehicle import Vehicle

WINDOW: Final = 1.0
# Decimals of the mass and the centre of gravity are rounded, and their products too: this factor holds what that can lose.
PRODUCT: Final = Interval(1 - 2.0**-50, 1 + 2.0**-50)
KINDS: Final = ("auto", "pointwise", "integral", "both")


@dataclass(frozen=True)
class RegressionRows:
    """Interval rows of a model.

    Attributes:
        terms: one for each column.
        matrix: shape (m, n).
        right: known forces, shape (m,) [N or N m].
        channel: index into ("surge", "sway", "yaw"), shape (m,).
        time: start of each row [s], shape (m,).
        duration: length of its window [s], 0 for a pointwise row, shape (m,).
        assumes: sentences that the rows rely on, beyond the sensor bounds.
    """

    terms: tuple[Term, ...]
    matrix: IntervalArray
    right: IntervalArray
    channel: NDArray[np.int64]
    time: FloatArray
    duration: FloatArray
    assumes: tuple[str, ...]

    def take(self, rows: NDArray[Any], columns: Sequence[int]) -> RegressionRows:
        """Some of the rows, with some of the columns."""
        terms = tuple(self.terms[j] for j in columns)
        matrix = self.matrix[rows][:, list(columns)]
        return RegressionRows(
            terms, matrix, self.right[rows], self.channel[rows], self.time[rows], self.duration[rows], self.assumes
        )


@dataclass(frozen=True)
class _Forces:
    """Known forces by channel: at each row, and over each step to the next one; and where they are known."""

    values: tuple[IntervalArray, IntervalArray, IntervalArray]
    steps: tuple[IntervalArray, IntervalArray, IntervalArray]
    present: NDArray[np.bool_]
    assumes: tuple[str, ...] = ()
    whole: NDArray[np.bool_] | None = None


def build_rows(
    bounded: BoundedLog,
    vehicle: Vehicle,
    terms: Sequence[Term],
    *,
    added_mass: bool = False,
    kind: str = "auto",
    window: float = WINDOW,
) -> RegressionRows:
    """All rows that the log supports.

    Args:
        bounded: the log in intervals.
        vehicle: thrusters, rigid body and limits.
        terms: the model.
        added_mass: the parameters leave out the rigid-body mass, which is then known (second form of eq. 6).
        kind: ``pointwise``, ``integral``, ``both``, or ``auto`` (pointwise where accelerations are measured).
        window: length of integral rows [s].

    Raises:
        IvsidError: naming the channel, sensor section or limit that is missing.
    """
    if kind not in KINDS:
        raise IvsidError(f"rows '{kind}' are unknown; use {', '.join(KINDS)}")
    if not 0 < window < np.inf:
        raise IvsidError(f"a window of {window} s is not usable; give a positive length, such as 1.0")
    if kind != "pointwise" and window > bounded.log.t[-1] - bounded.log.t[0]:
        length = bounded.log.t[-1] - bounded.log.t[0]
        raise IvsidError(
            f"a window of {window:g} s is longer than {bounded.log.name}, {length:.4g} s; give a shorter --window"
        )
    builder = _Builder(bounded, vehicle, tuple(terms), vehicle.hull.mass if added_mass else 0.0)
    parts = []
    for index, channel in enumerate(CHANNELS):
        if not builder.acts(channel):
            continue
        measured = builder.measured(channel)
        if kind in ("pointwise", "both") or (kind == "auto" and measured):
            if not measured and kind == "pointwise":
                continue
            if measured:
                parts.append(builder.pointwise(index, channel))
        if kind in ("integral", "both") or (kind == "auto" and not measured):
            parts.append(builder.integral(index, channel, window))
    parts = [p for p in parts if p.time.size]
    if not parts:
        raise IvsidError(
            f"{bounded.log.name} has no row with every channel that the model needs; look at the missing samples and the gaps"
        )
    return RegressionRows(
        tuple(terms),
        IntervalArray.concatenate([p.matrix for p in parts]),
        IntervalArray.concatenate([p.right for p in parts]),
        np.concatenate([p.channel for p in parts]),
        np.concatenate([p.time for p in parts]),
        np.concatenate([p.duration for p in parts]),
        tuple(dict.fromkeys((*builder.forces.assumes, *(s for p in parts for s in p.assumes)))),
    )


class _Builder:
    """The log, the model and the forces, while rows are made of them."""

    def __init__(self, bounded: BoundedLog, vehicle: Vehicle, terms: tuple[Term, ...], known_mass: float) -> None:
        self.bounded, self.vehicle, self.terms = bounded, vehicle, terms
        x_g, y_g = vehicle.hull.centre_of_gravity
        self.mx, self.my, self.mass = vehicle.hull.mass * x_g, vehicle.hull.mass * y_g, known_mass
        self.t = bounded.log.t
        if (words := lacking(bounded.log, terms, vehicle)) is not None:
            raise IvsidError(words)
        # The decimals of a time may round, and a difference of doubles too: steps are enclosed like everything else.
        self.clock = IntervalArray.around(self.t, bounded.log.time_error)
        self.forces = _forces(bounded, vehicle)
        for name in ("u", "v", "r"):
            self._channel(name)

    def acts(self, channel: str) -> bool:
        """Whether a parameter stands in the channel's equation."""
        probe = State(1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
        return any(channel in term.columns(probe) for term in self.terms)

    def measured(self, channel: str) -> bool:
        """Whether the channel's own acceleration is logged and bounded."""
        names = {"surge": ("udot", "ax"), "sway": ("vdot", "ay"), "yaw": ("rdot",)}[channel]
        return any(n in self.bounded.channels for n in names)

    def _channel(self, name: str) -> IntervalArray:
        self.bounded.log.column(name, "by the equations of motion")
        if name not in self.bounded.channels:
            section = {"u": "velocity", "v": "velocity", "r": "yaw_rate"}[name]
            raise IvsidError(
                f"vehicle file {self.vehicle.source or self.vehicle.name} has no [sensors.{section}]; it is needed to bound column {name}"
            )
        return self.bounded.channels[name]

    def _known(self, state: State) -> Columns:
        return rigid_body(state, self.mx, self.my, self.mass)

    def pointwise(self, index: int, channel: str) -> RegressionRows:
        """The channel's equation at every complete sample."""
        channels = self.bounded.channels
        u, v, r = (self._channel(n) for n in ("u", "v", "r"))
        assumes: list[str] = []
        entire = IntervalArray(np.full(self.t.shape, -np.inf), np.full(self.t.shape, np.inf))
        ax, ay = channels.get("ax"), channels.get("ay")
        udot = channels["udot"] if "udot" in channels else ax + v * r if ax is not None else entire
        vdot = channels["vdot"] if "vdot" in channels else ay - u * r if ay is not None else entire
        rdot = channels.get("rdot", entire)
        limits = self.vehicle.sensors.limits
        if "rdot" not in channels and limits.yaw_acceleration is not None and self._needs_rdot(channel):
            rdot = IntervalArray(
                np.full(self.t.shape, -limits.yaw_acceleration), np.full(self.t.shape, limits.yaw_acceleration)
            )
            assumes.append(f"|rdot| never exceeds {limits.yaw_acceleration!r} rad/s^2")
        state = State(u, v, r, udot, vdot, rdot, ax, ay)
        zero = IntervalArray(np.zeros(self.t.shape))
        columns = [_array(term.columns(state).get(channel), zero) for term in self.terms]
        right = self.forces.values[index] - _array(self._known(state).get(channel), zero) * PRODUCT
        right = right + self._ambient(channel)
        matrix = IntervalArray.stack(columns, axis=1)
        usable = self.forces.present & _finite(matrix) & _finite(right.reshape(-1, 1))
        if not usable.any():
            self._explain(channel)
        return self._rows(index, matrix[usable], right[usable], self.t[usable], np.zeros(usable.sum()), assumes)

    def _needs_rdot(self, channel: str) -> bool:
        """Whether the derivative of the yaw rate stands in the channel's equation."""
        probe = State(0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
        return any(c.get(channel, 0.0) != 0 for c in (*(t.columns(probe) for t in self.terms), self._known(probe)))

    def _explain(self, channel: str) -> None:
        if self._needs_rdot(channel) and "rdot" not in self.bounded.channels:
            raise IvsidError(
                f"the {channel} equation needs the yaw acceleration (the centre of gravity is off the origin, or a term has it): "
                "log rdot with [sensors.yaw_acceleration], or state [sensors.limits] yaw_acceleration"
            )

    def integral(self, index: int, channel: str, window: float) -> RegressionRows:
        """The mean of the channel's equation over sliding windows."""
        count = max(1, round(window / self.bounded.log.period))
        steps = np.diff(self.t)
        names = ("u", "v", "r")
        there = self.forces.present.copy()
        for n in names:
            there &= self.bounded.present[n]
        whole = there[1:] & there[:-1] & (steps <= GAP * np.median(steps))
        if self.forces.whole is not None:
            whole &= self.forces.whole
        starts = _complete(whole, count)
        spans = self.clock[starts + count] - self.clock[starts]
        quadrature = _Quadrature(self, steps, starts, count, spans)
        columns = [quadrature.mean(term.columns, channel) for term in self.terms]
        right = (
            quadrature.window_mean(self.forces.steps[index])
            - quadrature.mean(self._known, channel) * PRODUCT
            + self._ambient(channel)
        )
        matrix = IntervalArray.stack(columns, axis=1)
        durations = self.t[starts + count] - self.t[starts]
        return self._rows(index, matrix, right, self.t[starts], durations, quadrature.assumes)

    def _ambient(self, channel: str) -> IntervalArray:
        force, moment = self.bounded.ambient
        reach = moment if channel == "yaw" else force
        return IntervalArray(-reach, reach)

    def _rows(
        self,
        index: int,
        matrix: IntervalArray,
        right: IntervalArray,
        time: FloatArray,
        duration: FloatArray,
        assumes: Sequence[str],
    ) -> RegressionRows:
        channel = np.full(time.shape, index, dtype=np.int64)
        return RegressionRows(self.terms, matrix, right, channel, time, duration, tuple(assumes))


class _Quadrature:
    """Means over windows of ``count`` steps."""

    def __init__(
        self, builder: _Builder, steps: FloatArray, starts: NDArray[np.int64], count: int, spans: IntervalArray
    ) -> None:
        self.builder, self.starts, self.count, self.spans = builder, starts, count, spans
        self.steps = builder.clock[1:] - builder.clock[:-1]
        self.assumes: list[str] = []

    def window_mean(self, per_step: IntervalArray) -> IntervalArray:
        """The mean over each window of a quantity given by its mean over each step."""
        weighted = per_step * self.steps
        total = IntervalArray(np.zeros(self.starts.shape))
        for offset in range(self.count):
            total = total + weighted[self.starts + offset]
        return total / self.spans

    def mean(self, columns: Any, channel: str) -> IntervalArray:
        """The mean of a column: exact differences for its accelerations, a bounded quadrature for the rest."""
        total = IntervalArray(np.zeros(self.starts.shape))
        for name, derivative in (("u", "udot"), ("v", "vdot"), ("r", "rdot")):
            coefficient = columns(_unit(derivative)).get(channel, 0.0)
            if coefficient:
                x = self.builder.bounded.channels[name]
                difference = x[self.starts + self.count] - x[self.starts]
                total = total + difference * coefficient / self.spans
        if self._has_velocity_part(columns, channel):
            total = total + self.window_mean(self._step_mean(columns, channel))
        return total

    def _has_velocity_part(self, columns: Any, channel: str) -> bool:
        probes = [State(0.3, 0.7, 1.1, 0.0, 0.0, 0.0), State(-0.9, 0.4, -0.2, 0.0, 0.0, 0.0)]
        return any(columns(p).get(channel, 0.0) != 0.0 for p in probes)

    def _step_mean(self, columns: Any, channel: str) -> IntervalArray:
        """Trapezoid with its error: a Lipschitz constant L over a step h leaves at most L h / 4 on the mean."""
        limits = self.builder.vehicle.sensors.limits
        if limits.acceleration is None or limits.yaw_acceleration is None:
            raise IvsidError(
                f"the mean of the {channel} equation over a window needs [sensors.limits] acceleration and yaw_acceleration "
                "in the vehicle file (they bound the quadrature); state them, or log accelerations"
            )
        self.assumes.append(
            f"|udot| and |vdot| never exceed {limits.acceleration!r} m/s^2, |rdot| {limits.yaw_acceleration!r} rad/s^2"
        )
        reach = {"u": limits.acceleration, "v": limits.acceleration, "r": limits.yaw_acceleration}
        nodes, ranges = {}, {}
        for name, limit in reach.items():
            x = self.builder.bounded.channels[name]
            there = self.builder.bounded.present[name]
            x = IntervalArray(np.where(there, x.lower, 0.0), np.where(there, x.upper, 0.0))
            rate = IntervalArray(np.array(-limit), np.array(limit))
            nodes[name] = Motion(x, rate)
            ranges[name] = Motion(x[:-1].hull(x[1:]) + self.steps * 0.5 * rate, rate)
        at_nodes: Motion = columns(State(nodes["u"], nodes["v"], nodes["r"], 0.0, 0.0, 0.0))[channel]
        over_steps: Motion = columns(State(ranges["u"], ranges["v"], ranges["r"], 0.0, 0.0, 0.0))[channel]
        lipschitz = np.broadcast_to(over_steps.rate.magnitude, self.steps.shape)
        error = IntervalArray(-lipschitz, lipschitz) * self.steps * 0.25
        trapezoid: IntervalArray = (at_nodes.value[:-1] + at_nodes.value[1:]) * 0.5 + error
        return trapezoid


def _unit(derivative: str) -> State:
    """At rest, with one unit acceleration."""
    udot, vdot, rdot = (1.0 if derivative == name else 0.0 for name in ("udot", "vdot", "rdot"))
    return State(0.0, 0.0, 0.0, udot, vdot, rdot)


def _complete(whole: NDArray[np.bool_], count: int) -> NDArray[np.int64]:
    """Where ``count`` whole steps follow each other."""
    if whole.size < count:
        return np.zeros(0, dtype=np.int64)
    total = np.r_[0, np.cumsum(whole)]
    return np.flatnonzero(total[count:] - total[:-count] == count)


def _array(column: Any, zero: IntervalArray) -> IntervalArray:
    result: IntervalArray = zero if column is None else column + zero
    return result


def _finite(a: IntervalArray) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(a.lower).all(axis=1) & np.isfinite(a.upper).all(axis=1))


def _forces(bounded: BoundedLog, vehicle: Vehicle) -> _Forces:
    log, held = bounded.log, vehicle.log.demand == "hold"
    present = np.ones(log.t.shape, dtype=bool)
    whole = np.ones(log.t.size - 1, dtype=bool)
    if vehicle.thrusters:
        zero = IntervalArray(np.zeros(log.t.shape))
        totals, ramps = [zero] * 3, [zero[1:]] * 3
        assumes: tuple[str, ...] = (
            "demands hold from each row to the next" if held else "demands change on straight lines from row to row",
        )
        flow = _flow(bounded, vehicle) if any(t.advance_loss for t in vehicle.thrusters) else None
        for thruster in vehicle.thrusters:
            push = pushed(thruster, log, held=held, flow=flow)
            present &= push.present
            whole &= True if push.whole is None else push.whole
            assumes += push.assumes
            totals = [a + b for a, b in zip(totals, push.at_rows, strict=True)]
            ramps = [a + b for a, b in zip(ramps, push.over_steps, strict=True)]
        return _Forces((totals[0], totals[1], totals[2]), (ramps[0], ramps[1], ramps[2]), present, assumes, whole)
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
    return _Forces(
        (values[0], values[1], values[2]), (between[0], between[1], between[2]), present, tuple(sentences), whole
    )


def _flow(bounded: BoundedLog, vehicle: Vehicle) -> Flow:
    """u, v, r at rows, and all that the stated limits allow over each step."""
    limits = vehicle.sensors.limits
    if limits.acceleration is None or limits.yaw_acceleration is None:
        raise IvsidError(
            "a thruster claims advance_loss, whose mean over a step needs [sensors.limits] acceleration and yaw_acceleration in the "
            "vehicle file; state them, or leave the claim out"
        )
    steps = np.diff(bounded.log.t) * (1 + 2.0**-40) + 2 * np.max(bounded.log.time_error)
    rows, ranges = [], []
    for name, limit in (("u", limits.acceleration), ("v", limits.acceleration), ("r", limits.yaw_acceleration)):
        bounded.log.column(name, "by the thrusters' advance loss")
        x = bounded.channels[name]
        reach = IntervalArray(-limit, limit) * (0.5 * steps)
        rows.append(x)
        ranges.append(x[:-1].hull(x[1:]) + reach)
    return Flow((rows[0], rows[1], rows[2]), (ranges[0], ranges[1], ranges[2]))
