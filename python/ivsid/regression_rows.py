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
from ivsid.effects import CHANNELS, Columns, Place, State, Term, rigid_body
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, Interval, IntervalArray
from ivsid.log import Log
from ivsid.motion import Motion
from ivsid.needs import lacking, needed_by
from ivsid.sensors import BoundedLog
from ivsid.vehicle import Vehicle
from ivsid.weak_form import ROUNDING, pose_means

WINDOW: Final = 1.0
# Decimals of the mass and the centre of gravity are rounded, and their products too: this factor holds what that can lose.
PRODUCT: Final = Interval(1 - 2.0**-50, 1 + 2.0**-50)
# Stands for an acceleration [m/s^2] that nobody knows, where an infinity would spoil the sum over a window.
MOST: Final = 1e6
# A step this much longer than the usual one is more than one sample.
WHOLE_STEP: Final = 1.5
# A place for questions of which quantities stand in a term.
_SOMEWHERE: Final = Place(0.3, 0.0, 0.0, 0.0)
KINDS: Final = ("auto", "pointwise", "integral", "both", "weak")


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
    window: float | Sequence[float] = WINDOW,
) -> RegressionRows:
    """All rows that the log supports.

    Args:
        bounded: the log in intervals.
        vehicle: thrusters, rigid body and limits.
        terms: the model.
        added_mass: the parameters leave out the rigid-body mass, which is then known (second form of eq. 6).
        kind: ``pointwise``, ``integral``, ``weak`` (hat-weighted over two windows, for velocities that come from a pose), ``both``
            (every kind that there is), or ``auto`` (pointwise where accelerations are measured, else integral).
        window: length of integral rows [s], or several: each row holds by itself, so what is consistent with all is an intersection.

    Raises:
        IvsidError: naming the channel, sensor section or limit that is missing.
    """
    if kind not in KINDS:
        raise IvsidError(f"rows '{kind}' are unknown; use {', '.join(KINDS)}")
    counts = _counts(bounded.log, (window,) if isinstance(window, float | int) else tuple(window), kind)
    builder = _Builder(bounded, vehicle, tuple(terms), vehicle.hull.mass if added_mass else 0.0)
    parts = []
    for index, channel in enumerate(CHANNELS):
        if not builder.acts(channel):
            continue
        measured = builder.measured(channel)
        # An acceleration that only follows from velocities adds its rows to those over windows.
        if kind not in ("integral", "weak") and builder.known(channel):
            parts.append(builder.pointwise(index, channel))
        if kind in ("integral", "both") or (kind == "auto" and not measured):
            parts += [builder.integral(index, channel, count) for count in counts]
        if kind in ("weak", "both"):
            parts += [w for count in counts if (w := builder.weak(index, channel, count)) is not None]
    if kind == "weak" and not parts:
        raise IvsidError(
            f"rows 'weak' need velocities that are enclosed from the pose, and {bounded.log.name} measures them or its vehicle file has "
            "[ambient]; use rows 'auto'"
        )
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


def _counts(log: Log, windows: Sequence[float], kind: str) -> list[int]:
    """Steps of each window; windows of as many steps count once."""
    if not windows:
        raise IvsidError("no window is given; give a length, such as 1.0, or several")
    length = log.t[-1] - log.t[0]
    for window in windows:
        if not 0 < window < np.inf:
            raise IvsidError(f"a window of {window} s is not usable; give a positive length, such as 1.0")
        if kind != "pointwise" and window > length:
            raise IvsidError(
                f"a window of {window:g} s is longer than {log.name}, {length:.4g} s; give a shorter --window"
            )
    return list(dict.fromkeys(max(1, round(window / log.period)) for window in windows))


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
        # Some terms turn with the vehicle; the heading is one more quantity that moves.
        self.turning = "psi" in needed_by(terms, vehicle)
        if self.turning:
            self._channel("psi")

    def acts(self, channel: str) -> bool:
        """Whether a parameter stands in the channel's equation."""
        probe = State(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, place=_SOMEWHERE)
        return any(channel in term.columns(probe) for term in self.terms)

    def measured(self, channel: str) -> bool:
        """Whether the channel's own acceleration is logged and bounded."""
        names = {"surge": ("udot", "ax"), "sway": ("vdot", "ay"), "yaw": ("rdot",)}[channel]
        derived = self.bounded.log.derived
        return any(n in self.bounded.channels and n not in derived for n in names)

    def known(self, channel: str) -> bool:
        """Whether the channel's own acceleration is bounded at samples, measured or not."""
        own = {"surge": "udot", "sway": "vdot", "yaw": "rdot"}[channel]
        return self.measured(channel) or own in self.bounded.channels

    def _channel(self, name: str) -> IntervalArray:
        self.bounded.log.column(name, "by the equations of motion")
        if name not in self.bounded.channels:
            section = {"u": "velocity", "v": "velocity", "r": "yaw_rate", "psi": "heading"}[name]
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
            most = _above(limits.yaw_acceleration)
            rdot = IntervalArray(np.full(self.t.shape, -most), np.full(self.t.shape, most))
            assumes.append(f"|rdot| never exceeds {limits.yaw_acceleration!r} rad/s^2")
        place = Place(self._channel("psi"), entire, entire, self.clock) if self.turning else None
        state = State(u, v, r, udot, vdot, rdot, ax, ay, place=place)
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
        still, probe = (State(0.0, 0.0, 0.0, 0.0, 0.0, rdot, place=_SOMEWHERE) for rdot in (0.0, 1.0))
        return any(
            f(probe).get(channel, 0.0) != f(still).get(channel, 0.0)
            for f in (*(t.columns for t in self.terms), self._known)
        )

    def _explain(self, channel: str) -> None:
        if self._needs_rdot(channel) and "rdot" not in self.bounded.channels:
            raise IvsidError(
                f"the {channel} equation needs the yaw acceleration (the centre of gravity is off the origin, or a term has it): "
                "log rdot with [sensors.yaw_acceleration], or state [sensors.limits] yaw_acceleration"
            )

    def integral(self, index: int, channel: str, count: int) -> RegressionRows:
        """The mean of the channel's equation over sliding windows of ``count`` steps."""
        steps = np.diff(self.t)
        names = ("u", "v", "r", "psi") if self.turning else ("u", "v", "r")
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

    def weak(self, index: int, channel: str, half: int) -> RegressionRows | None:
        """The channel's equation weighted by a hat of ``half`` steps on either side, with means of velocities from the pose itself; None without it."""
        steps = self.clock[1:] - self.clock[:-1]
        means = pose_means(self.bounded.log, self.vehicle.sensors, dict(self.bounded.channels), steps)
        mixed = any(t.time_constant and (t.advance_loss or t.rudder is not None) for t in self.vehicle.thrusters)
        if means is None or mixed or self.bounded.ambient != (0.0, 0.0):
            return None
        there = self.forces.present & means.there
        whole = there[1:] & there[:-1] & (np.diff(self.t) <= GAP * self.bounded.log.period)
        if self.forces.whole is not None:
            whole &= self.forces.whole
        starts = _complete(whole, 2 * half)
        hat = _Hat(self, starts, half, means.rising(starts, half))
        columns = [hat.mean(term.columns, channel) for term in self.terms]
        values, over = self.forces.values[index], self.forces.steps[index]
        right = hat.weighted(over, over.hull(values[:-1].hull(values[1:]))) - hat.mean(self._known, channel) * PRODUCT
        durations = self.t[starts + 2 * half] - self.t[starts]
        return self._rows(
            index, IntervalArray.stack(columns, axis=1), right, self.t[starts], durations, hat.quadrature.assumes
        )

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
            coefficient = columns(_unit(derivative)).get(channel, 0.0) - columns(_unit("")).get(channel, 0.0)
            if coefficient:
                x = self.builder.bounded.channels[name]
                difference = self._narrowed(x[self.starts + self.count] - x[self.starts], name)
                total = total + difference * coefficient / self.spans
        if self.has_velocity_part(columns, channel):
            total = total + self.window_mean(self._step_mean(columns, channel))
        return total

    def _narrowed(self, difference: IntervalArray, name: str) -> IntervalArray:
        """A difference of u or v, by what an averaging accelerometer says of it, too: its mean, and that of v r or u r."""
        own = {"u": "mean_ax", "v": "mean_ay"}.get(name)
        channels = self.builder.bounded.channels
        if own is None or own not in channels:
            return difference

        def turning(s: State) -> Columns:
            return {"surge": s.v * s.r if name == "u" else -(s.u * s.r)}

        reading = channels[own][1:]
        # Where a row was lost the reading averages the last sample alone, not the step.
        usual = np.diff(self.builder.t) <= WHOLE_STEP * self.builder.bounded.log.period
        there = np.isfinite(reading.lower) & usual
        known = IntervalArray(np.where(there, reading.lower, -MOST), np.where(there, reading.upper, MOST))
        other = self.window_mean(known + self._step_mean(turning, "surge")) * self.spans
        lower, upper = np.maximum(difference.lower, other.lower), np.minimum(difference.upper, other.upper)
        if (lower > upper).any():
            k = int(self.starts[np.argmax(lower > upper)])
            raise IvsidError(
                f"{self.builder.bounded.log.name}: around t = {self.builder.t[k]:.6g} s {name} and its averaged acceleration contradict "
                "each other within their bounds; look at the bounds, the axes and the sampling of [sensors.acceleration]"
            )
        return IntervalArray(lower, upper)

    def has_velocity_part(self, columns: Any, channel: str) -> bool:
        probes = [State(*nu, 0.0, 0.0, 0.0, place=_SOMEWHERE) for nu in ((0.3, 0.7, 1.1), (-0.9, 0.4, -0.2))]
        return any(columns(p).get(channel, 0.0) != 0.0 for p in probes)

    def _step_mean(self, columns: Any, channel: str) -> IntervalArray:
        return self.step_parts(columns, channel)[0]

    def step_parts(self, columns: Any, channel: str) -> tuple[IntervalArray, IntervalArray]:
        """A column's mean over each step, and all that it can be within.

        Trapezoid with its error: a Lipschitz constant L over a step h leaves at most L h / 4 on the mean.
        """
        limits = self.builder.vehicle.sensors.limits
        if limits.acceleration is None or limits.yaw_acceleration is None:
            raise IvsidError(
                f"the mean of the {channel} equation over a window needs [sensors.limits] acceleration and yaw_acceleration "
                "in the vehicle file (they bound the quadrature); state them, or log accelerations"
            )
        self.assumes.append(
            f"|udot| and |vdot| never exceed {limits.acceleration!r} m/s^2, |rdot| {limits.yaw_acceleration!r} rad/s^2"
        )
        acceleration, yaw_acceleration = _above(limits.acceleration), _above(limits.yaw_acceleration)
        reach = {"u": acceleration, "v": acceleration, "r": yaw_acceleration}
        nodes, ranges = {}, {}
        for name, limit in reach.items():
            x = self.builder.bounded.channels[name]
            there = self.builder.bounded.present[name]
            x = IntervalArray(np.where(there, x.lower, 0.0), np.where(there, x.upper, 0.0))
            rate = IntervalArray(np.array(-limit), np.array(limit))
            nodes[name] = Motion(x, rate)
            ranges[name] = Motion(x[:-1].hull(x[1:]) + self.steps * 0.5 * rate, rate)
        here, along = self._places(nodes["r"].value, ranges["r"].value)
        at_nodes: Motion = columns(State(nodes["u"], nodes["v"], nodes["r"], 0.0, 0.0, 0.0, place=here))[channel]
        over_steps: Motion = columns(State(ranges["u"], ranges["v"], ranges["r"], 0.0, 0.0, 0.0, place=along))[channel]
        lipschitz = np.broadcast_to(over_steps.rate.magnitude, self.steps.shape)
        error = IntervalArray(-lipschitz, lipschitz) * self.steps * 0.25
        trapezoid: IntervalArray = (at_nodes.value[:-1] + at_nodes.value[1:]) * 0.5 + error
        return trapezoid, over_steps.value

    def _places(self, r: IntervalArray, swept: IntervalArray) -> tuple[Place | None, Place | None]:
        """The heading at rows and over steps, with the yaw rate as its rate, where a term turns with it."""
        if not self.builder.turning:
            return None, None
        psi, there = self.builder.bounded.channels["psi"], self.builder.bounded.present["psi"]
        psi = IntervalArray(np.where(there, psi.lower, 0.0), np.where(there, psi.upper, 0.0))
        over = psi[:-1].hull(psi[1:]) + self.steps * 0.5 * swept
        nowhere = 0.0
        return (
            Place(Motion(psi, r), nowhere, nowhere, nowhere),
            Place(Motion(over, swept), nowhere, nowhere, nowhere),
        )


class _Hat:
    """Means weighted by a hat over two halves of ``half`` steps each."""

    def __init__(
        self, builder: _Builder, starts: NDArray[np.int64], half: int, rising: dict[str, IntervalArray]
    ) -> None:
        clock = builder.clock
        self.starts, self.half, self.rising = starts, half, rising
        middle, end = starts + half, starts + 2 * half
        self.first, self.second = clock[middle] - clock[starts], clock[end] - clock[middle]
        self.area = (clock[end] - clock[starts]) * 0.5
        self.quadrature = _Quadrature(builder, np.diff(builder.t), starts, 2 * half, clock[end] - clock[starts])
        self.clock = clock

    def weighted(self, per_step: IntervalArray, within: IntervalArray) -> IntervalArray:
        """The weighted mean of a quantity given by its mean over each step and by all that it can be within.

        Within a step the weight is off its mean by a line: what that can catch is at most a quarter of its rise times the radius.
        """
        steps = self.quadrature.steps
        radius = within.radius * (1 + ROUNDING)
        total = IntervalArray(np.zeros(self.starts.shape))
        for offset in range(2 * self.half):
            k = self.starts + offset
            if offset < self.half:
                span, out = self.first, self.clock[self.starts]
                twice = (self.clock[k] - out) + (self.clock[k + 1] - out)
            else:
                span, out = self.second, self.clock[self.starts + 2 * self.half]
                twice = (out - self.clock[k]) + (out - self.clock[k + 1])
            caught = IntervalArray(-radius[k], radius[k]) * (steps[k] / span) * 0.25
            total = total + (per_step[k] * (twice / span) * 0.5 + caught) * steps[k]
        mean: IntervalArray = total / self.area
        return mean

    def mean(self, columns: Any, channel: str) -> IntervalArray:
        """The weighted mean of a column: its accelerations through the means of both halves, the rest by a bounded quadrature."""
        total = IntervalArray(np.zeros(self.starts.shape))
        for name, derivative in (("u", "udot"), ("v", "vdot"), ("r", "rdot")):
            coefficient = columns(_unit(derivative)).get(channel, 0.0) - columns(_unit("")).get(channel, 0.0)
            if coefficient:
                total = total + self.rising[name] * coefficient / self.area
        if self.quadrature.has_velocity_part(columns, channel):
            total = total + self.weighted(*self.quadrature.step_parts(columns, channel))
        return total


def _above(limit: float) -> float:
    """The decimals of a limit are rounded to a double, too: the next one up holds them."""
    return float(np.nextafter(limit, np.inf))


def _unit(derivative: str) -> State:
    """At rest, with one unit acceleration."""
    udot, vdot, rdot = (1.0 if derivative == name else 0.0 for name in ("udot", "vdot", "rdot"))
    return State(0.0, 0.0, 0.0, udot, vdot, rdot, place=_SOMEWHERE)


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
            "a thruster claims advance_loss or has a rudder, whose mean over a step needs [sensors.limits] acceleration and yaw_acceleration in the "
            "vehicle file; state them, or leave the claim out"
        )
    steps = np.diff(bounded.log.t) * (1 + 2.0**-40) + 2 * np.max(bounded.log.time_error)
    rows, ranges = [], []
    for name, limit in (("u", limits.acceleration), ("v", limits.acceleration), ("r", limits.yaw_acceleration)):
        bounded.log.column(name, "by the thrusters' advance loss or rudder")
        x = bounded.channels[name]
        reach = IntervalArray(-_above(limit), _above(limit)) * (0.5 * steps)
        rows.append(x)
        ranges.append(x[:-1].hull(x[1:]) + reach)
    return Flow((rows[0], rows[1], rows[2]), (ranges[0], ranges[1], ranges[2]))
