"""Integral rows: the mean of the equations over a window, by exact differences and a quadrature with its error."""

from __future__ import annotations

from functools import partial
from typing import Final, cast

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Columns, Place, State
from ivsid.errors import IvsidError
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.rows.equations import SOMEWHERE, ColumnsOf, Equations, complete, unit
from ivsid.rows.forces import above, turning_stream
from ivsid.rows.motion import Motion
from ivsid.rows.record import RegressionRows

# Bound on an acceleration [m/s^2] that is not known; an infinity would make the sum over a window undefined.
# Source: physics: 1e5 times the acceleration of gravity
MOST: Final = 1e6
# Largest deviation of a step from the usual one, as a share of it, at which an averaging sensor still averages over the step. A lost row
# makes a deviation of 1.
# Source: definition: a tenth of a lost row
WHOLE_STEP: Final = 0.1


def integral(equations: Equations, index: int, channel: str, count: int) -> RegressionRows:
    """The mean of a channel's equation over sliding windows.

    Args:
        equations: of the log, or of a part of it that owns the first sample of each window.
        index: of the channel.
        channel: its name.
        count: steps of a window.

    Raises:
        IvsidError: the vehicle file lacks a limit, or an averaged acceleration contradicts the velocities.
    """
    starts, spans = equations.once(("windows", count), lambda: _windows(equations, count))
    quadrature = Quadrature(equations, np.diff(equations.t), starts, count, spans)
    columns = [quadrature.mean(term.columns, channel) for term in equations.terms]
    right = (
        quadrature.window_mean(equations.forces.steps[index])
        - equations.known_force(lambda columns: quadrature.mean(columns, channel))
        + equations.ambient(channel)
    )
    matrix = IntervalArray.stack(columns, axis=1)
    durations = equations.t[starts + count] - equations.t[starts]
    return equations.rows("integral", index, matrix, right, equations.t[starts], durations, quadrature.assumes)


def _windows(equations: Equations, count: int) -> tuple[NDArray[np.int64], IntervalArray]:
    """The starts of whole windows, and their lengths [s]."""
    there = equations.forces.present.copy()
    for n in ("u", "v", "r", "psi") if equations.turning else ("u", "v", "r"):
        there &= equations.present[n]
    starts = complete(equations.whole_steps(there, equations.period, heading=equations.turning), count)
    starts = starts[starts < equations.owned]
    return starts, _taken(equations.clock, starts, count) - _taken(equations.clock, starts, 0)


def _taken(x: IntervalArray, starts: NDArray[np.int64], offset: int) -> IntervalArray:
    """The entries at ``starts + offset``; a view where they follow each other, as they do in a log without gaps."""
    if starts.size and starts[-1] - starts[0] + 1 == starts.size:
        return cast(IntervalArray, x[starts[0] + offset : starts[-1] + offset + 1])
    return cast(IntervalArray, x[starts + offset])


def window_sum(x: IntervalArray, starts: NDArray[np.int64], count: int) -> IntervalArray:
    """The sum of ``count`` neighbours from each start, by sums of 1, 2, 4 ... neighbours: few additions and few roundings."""
    total, done = None, 0
    doubled, length = x, 1
    while True:
        if count & length:
            part = _taken(doubled, starts, done)
            total, done = part if total is None else total + part, done + length
        if 2 * length > count:
            return IntervalArray(np.zeros(starts.shape)) if total is None else total
        doubled, length = doubled[:-length] + doubled[length:], 2 * length


class Quadrature:
    """Means over windows.

    Args:
        equations: of the log or a part of it, with n samples.
        steps: lengths of the steps [s], shape (n - 1,).
        starts: first sample of each window, shape (k,).
        count: steps of a window.
        spans: lengths of the windows [s], shape (k,).
    """

    def __init__(
        self, equations: Equations, steps: FloatArray, starts: NDArray[np.int64], count: int, spans: IntervalArray
    ) -> None:
        self.equations, self.starts, self.count, self.spans = equations, starts, count, spans
        self.steps: IntervalArray = equations.once("steps", lambda: equations.clock[1:] - equations.clock[:-1])
        self.assumes: list[str] = ["psi turns by less than half a turn from row to row"] if equations.turning else []

    def window_mean(self, per_step: IntervalArray) -> IntervalArray:
        """The mean over each window, shape (k,), of a quantity given by its mean over each step, shape (n - 1,)."""
        return window_sum(per_step * self.steps, self.starts, self.count) / self.spans

    def mean(self, columns: ColumnsOf, channel: str) -> IntervalArray:
        """The mean of a column over each window: exact differences for its accelerations, a bounded quadrature for the rest."""
        total = IntervalArray(np.zeros(self.starts.shape))
        for name, coefficient in self._accelerations(columns, channel):
            difference = self.equations.once(("difference", name, self.count), partial(self._difference, name))
            total = total + self._narrowed(difference, name) * coefficient / self.spans
        if self.has_velocity_part(columns, channel):
            total = total + self.window_mean(self._step_mean(columns, channel))
        return total

    def _accelerations(self, columns: ColumnsOf, channel: str) -> list[tuple[str, float]]:
        """The velocities whose rates of change a column has, each with its coefficient."""

        def found() -> list[tuple[str, float]]:
            rest = columns(unit("")).get(channel, 0.0)
            pairs = (
                (name, columns(unit(rate)).get(channel, 0.0) - rest)
                for name, rate in (("u", "udot"), ("v", "vdot"), ("r", "rdot"))
            )
            return [(name, coefficient) for name, coefficient in pairs if coefficient]

        return self.equations.ask(("accelerations", columns, channel), found)

    def _difference(self, name: str) -> IntervalArray:
        x = self.equations.channels[name]
        return _taken(x, self.starts, self.count) - _taken(x, self.starts, 0)

    def _narrowed(self, difference: IntervalArray, name: str) -> IntervalArray:
        """A difference of u or v, narrowed by the readings of an averaging accelerometer and the mean of v r or u r."""
        own = {"u": "mean_ax", "v": "mean_ay"}.get(name)
        channels = self.equations.channels
        log = self.equations.bounded.log
        if own is None or own not in channels or own.removeprefix("mean_") in {*log.clocks, *log.by_rate}:
            # A reading on another clock than the rows' does not average over the step before its row.
            return difference
        self.assumes.append(f"each reading of {own.removeprefix('mean_')} is the mean since the row before it")

        def turning(s: State) -> Columns:
            return {"surge": s.v * s.r if name == "u" else -(s.u * s.r)}

        reading = channels[own][1:]
        # After a lost row the reading averages over its last sample, a part of the step.
        usual = np.abs(np.diff(self.equations.t) - log.period) <= WHOLE_STEP * log.period
        there = np.isfinite(reading.lower) & usual
        known = IntervalArray(np.where(there, reading.lower, -MOST), np.where(there, reading.upper, MOST))
        other = self.window_mean(known + self._step_mean(turning, "surge")) * self.spans
        lower, upper = np.maximum(difference.lower, other.lower), np.minimum(difference.upper, other.upper)
        if (lower > upper).any():
            k = int(self.starts[np.argmax(lower > upper)])
            raise IvsidError(
                f"{self.equations.bounded.log.name}: around t = {self.equations.t[k]:.6g} s {name} and its averaged acceleration contradict "
                "each other within their bounds; look at the bounds, the axes and the sampling of [sensors.acceleration]"
            )
        return IntervalArray(lower, upper)

    def has_velocity_part(self, columns: ColumnsOf, channel: str) -> bool:
        """Whether a column has more than accelerations."""
        probes = [State(*nu, 0.0, 0.0, 0.0, place=SOMEWHERE) for nu in ((0.3, 0.7, 1.1), (-0.9, 0.4, -0.2))]
        return self.equations.ask(
            ("velocity", columns, channel), lambda: any(bool(columns(p).get(channel, 0.0) != 0.0) for p in probes)
        )

    def _step_mean(self, columns: ColumnsOf, channel: str) -> IntervalArray:
        return self.step_parts(columns, channel)[0]

    def step_parts(self, columns: ColumnsOf, channel: str) -> tuple[IntervalArray, IntervalArray]:
        """The mean of a column over each step, and its range over the step, shape (n - 1,) each.

        The mean is the trapezoidal rule with its error: for a Lipschitz constant L and a step h it is at most L h / 4.

        Raises:
            IvsidError: the vehicle file lacks a limit that bounds the error.
        """
        limits = self.equations.vehicle.sensors.limits
        if limits.acceleration is None or limits.yaw_acceleration is None:
            raise IvsidError(
                f"the mean of the {channel} equation over a window needs [sensors.limits] acceleration and yaw_acceleration "
                "in the vehicle file (they bound the quadrature); state them, or log all of the accelerations ax, ay and rdot"
            )
        self.assumes.append(
            f"|udot| and |vdot| never exceed {limits.acceleration!r} m/s^2, |rdot| {limits.yaw_acceleration!r} rad/s^2"
        )
        at_nodes = self.equations.once(("nodes", columns), lambda: columns(self._states()[0]))[channel]
        over_steps: Motion = self.equations.once(("ranges", columns), lambda: columns(self._states()[1]))[channel]
        lipschitz = np.broadcast_to(over_steps.rate.magnitude, self.steps.shape)
        error = IntervalArray(-lipschitz, lipschitz) * self.steps * 0.25
        trapezoid: IntervalArray = (at_nodes[:-1] + at_nodes[1:]) * 0.5 + error
        return trapezoid, over_steps.value

    def _states(self) -> tuple[State, State]:
        """Velocities at the rows, and over each step with their rates of change."""
        return self.equations.once("states", self._made_states)

    def _made_states(self) -> tuple[State, State]:
        limits = self.equations.vehicle.sensors.limits
        acceleration, yaw_acceleration = above(limits.acceleration or 0.0), above(limits.yaw_acceleration or 0.0)
        nodes: dict[str, IntervalArray] = {}
        ranges: dict[str, Motion] = {}
        stream = self.equations.bounded.stream
        for name, limit in (("r", yaw_acceleration), ("u", acceleration), ("v", acceleration)):
            x = self.equations.channels[name]
            there = self.equations.present[name]
            x = IntervalArray(np.where(there, x.lower, 0.0), np.where(there, x.upper, 0.0))
            rate = IntervalArray(np.array(-limit), np.array(limit))
            if stream and name != "r":
                rate = rate + turning_stream(stream, ranges["r"].value)
            nodes[name] = x
            ranges[name] = Motion(x[:-1].hull(x[1:]) + self.steps * 0.5 * rate, rate)
        here, along = self._places(nodes["r"], ranges["r"].value)
        return (
            State(nodes["u"], nodes["v"], nodes["r"], 0.0, 0.0, 0.0, place=here),
            State(ranges["u"], ranges["v"], ranges["r"], 0.0, 0.0, 0.0, place=along),
        )

    def _places(self, r: IntervalArray, swept: IntervalArray) -> tuple[Place | None, Place | None]:
        """The heading at rows, and over steps with the yaw rate as its rate; None where no term turns with it."""
        if not self.equations.turning:
            return None, None
        psi, there = self.equations.channels["psi"], self.equations.present["psi"]
        psi = IntervalArray(np.where(there, psi.lower, 0.0), np.where(there, psi.upper, 0.0))
        # In the first half of a step the heading differs from the row before by a turn over at most half a step, in the second half from
        # the row after.
        turned = IntervalArray(np.zeros(self.steps.shape), self.steps.upper) * 0.5 * swept
        over = (psi[:-1] + turned).hull(psi[1:] - turned)
        nowhere = 0.0
        return (
            Place(psi, nowhere, nowhere, nowhere),
            Place(Motion(over, swept), nowhere, nowhere, nowhere),
        )
