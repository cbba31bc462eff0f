"""Thrusts of a log's demands at its samples and over its steps, under the effects and declared errors of a hypothesis.

Everything works on whole arrays. The catalogue's formulas are shared with the simulator; its integration and its code are not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.plant.declared_curve import DeclaredCurve, ThrustAt
from ivsid.diagnosis.plant.thrust_errors import ThrustErrors, thrust_errors
from ivsid.effects import Drive, Given, Response, Thrust, acting, for_thruster, with_stated
from ivsid.linear.filters import decaying
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster, Vehicle

Array = NDArray[np.float64]
# Shortest lag that is followed [s]; a shorter one is none.
# Source: geometry: 4e-5 of the shortest step, 1/25 s, over which a lag of this length is over
SHORTEST_LAG: Final = 1e-6
# Difference of an error of a thrust curve from which a slope is taken, in units of the error.
# Source: geometry: thrust is linear in the error up to a limit or a dead band, and rounding costs 1e-13 of such a difference
ERROR_STEP: Final = 1e-3
# Points and weights of Gauss and Legendre on [0, 1].
# Source: theorem: exact for polynomials up to the fifth degree, Abramowitz and Stegun, *Handbook of Mathematical Functions*, 1972, table 25.4
NODES: Final = (0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5)
# Weights of these points.
# Source: theorem: as NODES
WEIGHTS: Final = (5 / 18, 8 / 18, 5 / 18)
# Rounding of a number of steps that is rounded to a whole one.
# Source: geometry: far above the rounding of a quotient of times, far below a step
WHOLE: Final = 1e-9


@dataclass(frozen=True)
class Thrusts:
    """Thrusts at no speed [N].

    Attributes:
        now: just after each sample, shape (thrusters, n).
        mean: over the step to the next, shape (thrusters, n).
        parts: means over equal parts of the steps where demands come faster than the clock, shape (thrusters, n, parts), or None.
    """

    now: Array
    mean: Array
    parts: Array | None = None


class Propulsion:
    """The thrusters of a vehicle under the demands of a log.

    Args:
        vehicle: with its thrusters.
        log: with their demands.
        errors: declared errors by thruster as another log of the same thrusters has them; by default they stand over the demands of this one.

    Attributes:
        curves: thrust curves, without dead bands, limits and losses, which are effects.
        demands: of each thruster from its neutral, shape (n,) each.
        errors: declared errors by thruster, as functions of such a demand.
    """

    def __init__(self, vehicle: Vehicle, log: Channels, errors: Sequence[ThrustErrors] | None = None) -> None:
        self.vehicle, self.log = vehicle, log
        bare = {"dead_band": None, "limit": None, "reverse_factor": None}
        self.curves = [ThrustCurve(t.model_copy(update={**bare, "outside": "hold"})) for t in vehicle.thrusters]
        self.demands = [log.demands[k] - t.neutral for k, t in enumerate(vehicle.thrusters)]
        self.errors = (
            [thrust_errors(t, c, d) for t, c, d in zip(vehicle.thrusters, self.curves, self.demands, strict=True)]
            if errors is None
            else list(errors)
        )
        self._curves = [
            DeclaredCurve(t, c, e) for t, c, e in zip(vehicle.thrusters, self.curves, self.errors, strict=True)
        ]
        self._samples = [self._at(k, d, kept=True) for k, d in enumerate(self.demands)]
        # Every hypothesis asks for the thrusts of the same demands between samples: they are worked out once.
        self._between: dict[int, ThrustAt] = {}
        self._clocks: dict[int, tuple[Array, Array | None]] = {}
        # The last thrusts of the log's own demands, with what they were worked out under: lags and delays are tried on the same ones.
        self._static: dict[int, tuple[object, Array]] = {}

    def thrusts(self, given: Sequence[Given] = (), sizes: Sequence[Sequence[float]] | None = None) -> Thrusts:
        """The thrusts before any loss by inflow.

        Args:
            given: effects of a hypothesis.
            sizes: of the declared errors by thruster, in units of their bounds; none by default.
        """
        each = [self._worked(k, given, () if sizes is None else sizes[k]) for k in range(len(self.vehicle.thrusters))]
        if not each:
            empty = np.zeros((0, self.log.n))
            return Thrusts(empty, empty)
        now, mean, parts = zip(*each, strict=True)
        fine = [p for p in parts if p is not None]
        return Thrusts(np.stack(now), np.stack(mean), np.stack(fine) if fine else None)

    def slopes(
        self,
        k: int,
        given: Sequence[Given],
        sizes: Sequence[float],
        beside: Callable[[Array], Array] | None = None,
    ) -> Array:
        """Slopes of one thruster's thrust [N] with errors of its curve, at samples and then over the steps after them, shape (errors, 2 n).

        Args:
            k: index of the thruster.
            given: effects of a hypothesis.
            sizes: of its declared errors, in units of their bounds.
            beside: the errors [N], shape (errors, m), of m demands from neutral in the order of time; the declared ones by default.
        """
        errors = _declared if beside is None else lambda at: beside(at.demand)
        return np.concatenate(self._worked(k, given, sizes, errors)[:2], axis=1)

    def _worked(
        self,
        k: int,
        given: Sequence[Given],
        sizes: Sequence[float],
        errors: Callable[[ThrustAt], Array] | None = None,
    ) -> tuple[Array, Array, Array | None]:
        """Thrusts of one thruster at samples, means over steps, and means over the parts of steps, shape (n, parts), or None.

        With errors of its curve the slopes with each of them, with the errors as a further axis in front.
        """
        h, thruster = self.log.h, self.vehicle.thrusters[k]
        changes = acting(with_stated(given, Thrust, thruster), Thrust)
        late = _responses(thruster, given)
        lag, of_shaft = _lag(thruster, late)
        delay = max(late.get("delay", 0.0), 0.0)

        def changed(thrust: Array, d: Array) -> Array:
            if not changes:
                return thrust
            time, voltage = self._clock(d.size // self.log.n)
            drive = Drive(d, time, k, thruster.position[1], self.curves[k].largest, voltage)
            for change, numbers in changes:
                thrust = change.function(thrust, drive, numbers)
            thrust = np.asarray(thrust, dtype=np.float64)
            return thrust if thrust.shape == d.shape else np.full(d.size, thrust)

        def static(at: ThrustAt) -> Array:
            if errors is not None or at is not self._between.get(k):
                return worked(at)
            key = (tuple(sizes), tuple(changes))
            if self._static.get(k, (None,))[0] != key:
                self._static[k] = key, worked(at)
            return self._static[k][1]

        def worked(at: ThrustAt) -> Array:
            # The error of the curve comes before any limit or dead band.
            thrust = at.pushed(sizes)
            if errors is None:
                return changed(thrust, at.demand)
            each = errors(at)
            if not changes:
                return each
            base = changed(thrust, at.demand)
            moved = [changed(thrust + ERROR_STEP * error, at.demand) - base for error in each]
            return np.stack(moved) / ERROR_STEP if moved else np.zeros((0, at.demand.size))

        d = self.demands[k]
        if self.log.between is not None:
            return self._finely(k, static, lag, delay, of_shaft=of_shaft)
        if lag > SHORTEST_LAG and of_shaft:
            sent = d, _midway(d, held=self.log.held)
            return *self._of_shaft(k, static, *_late(*sent, delay, h), lag, h, own=delay <= 0), None
        now = static(self._samples[k])
        mean = now
        if not self.log.held:
            # Simpson's rule over a demand that runs straight to the next.
            middle = static(self._known(k, lambda: _midway(d, held=False)))
            mean = (now + 4 * middle + np.concatenate([now[..., 1:], now[..., -1:]], axis=-1)) / 6
        now, mean = _late(now, mean, delay, h)
        if lag > SHORTEST_LAG:
            now, mean, _ = _behind(now, mean, lag, h)
        return now, mean, None

    def lag(self, k: int, given: Sequence[Given]) -> tuple[float, bool]:
        """The time constant of a thruster under a hypothesis [s], 0 for one too short to count, and whether it is that of the demand."""
        thruster = self.vehicle.thrusters[k]
        time, of_shaft = _lag(thruster, _responses(thruster, given))
        return (time if time > SHORTEST_LAG else 0.0), of_shaft

    def rise(self, k: int, given: Sequence[Given]) -> float:
        """What the thrust of a thruster rises by over a step on a straight line, in what it rises by to the next sample.

        It runs all the way where its demands do, or where it lags. A late demand jumps inside the step, a share q of it after the sample: the line of
        the same mean and the same first moment rises by 6 q (1 - q) of the jump.
        """
        if not self.log.held or self.lag(k, given)[0] > 0.0:
            return 1.0
        late = max(_responses(self.vehicle.thrusters[k], given).get("delay", 0.0), 0.0) / self.log.h
        share = late - np.floor(late + WHOLE)
        return float(6.0 * share * (1.0 - share)) if share > WHOLE else 0.0

    def _clock(self, parts: int) -> tuple[Array, Array | None]:
        """Times [s] and voltages at equal parts of the steps, shape (n parts,)."""
        log = self.log
        if parts == 1:
            return log.t, log.voltage
        if parts not in self._clocks:
            voltage = None if log.voltage is None else np.repeat(log.voltage, parts)
            self._clocks[parts] = (log.t[:, None] + np.arange(parts) * (log.h / parts)).ravel(), voltage
        return self._clocks[parts]

    def static(self, k: int, demand: Array, error: Array | None = None, given: Sequence[Given] = ()) -> Array:
        """Thrusts of one thruster [N] without lag or delay, at the time zero, shape of the demand.

        Args:
            k: index of the thruster.
            demand: as it is logged.
            error: of its curve [N], of the same shape.
            given: effects of a hypothesis.
        """
        thruster = self.vehicle.thrusters[k]
        d = demand - thruster.neutral
        thrust = np.asarray(self.curves[k].value(demand))
        if error is not None:
            thrust = thrust + error
        drive = Drive(d, 0.0, k, thruster.position[1], self.curves[k].largest, None)
        for change, numbers in acting(with_stated(given, Thrust, thruster), Thrust):
            thrust = change.function(thrust, drive, numbers)
        return np.asarray(thrust, dtype=np.float64)

    def _at(self, k: int, demand: Array, *, kept: bool = False) -> ThrustAt:
        """One thruster at demands from its neutral."""
        return ThrustAt(self._curves[k], demand, kept=kept)

    def _known(self, k: int, demand: Callable[[], Array]) -> ThrustAt:
        """One thruster at the log's own demands between samples."""
        if k not in self._between:
            self._between[k] = self._at(k, demand(), kept=True)
        return self._between[k]

    def _of_shaft(
        self, k: int, static: Callable[[ThrustAt], Array], now: Array, held: Array, lag: float, h: float, *, own: bool
    ) -> tuple[Array, Array]:
        """Thrusts of one thruster whose demand lags, at samples, and means over the steps after them.

        Over a step the demand is d(s) = held + (start - held) y with y = exp(-s / lag), so that the mean of a thrust T is
        T(held) + lag / h times the integral over y, from exp(-h / lag) to 1, of (T(d) - T(held)) / y. The integrand is linear in y where the thrust is
        quadratic in the demand. ``own`` says that ``held`` is the log's own, without a delay.

        Source: Gauss and Legendre's rule, Abramowitz and Stegun, *Handbook of Mathematical Functions*, 1972, 25.4.30.
        """
        start, _, _ = _behind(now, held, lag, h)
        over = 1.0 - float(np.exp(-h / lag))
        goal = static(self._known(k, lambda: held) if own else self._at(k, held))
        mean = goal
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            y = 1.0 - over * (1.0 - node)
            mean = mean + (lag / h * over * weight / y) * (static(self._at(k, held + (start - held) * y)) - goal)
        return static(self._at(k, start)), mean

    def _finely(
        self, k: int, static: Callable[[ThrustAt], Array], lag: float, delay: float, *, of_shaft: bool
    ) -> tuple[Array, Array, Array]:
        """Thrusts of one thruster whose demands come faster than the clock, worked out at equal parts of the steps."""
        assert self.log.between is not None
        thruster, parts = self.vehicle.thrusters[k], self.log.between.demands.shape[2]
        sent = self.log.between.demands[k].ravel() - thruster.neutral
        h = self.log.h / parts
        if lag > SHORTEST_LAG and of_shaft:
            now, mean = self._of_shaft(k, static, *_late(sent, sent, delay, h), lag, h, own=delay <= 0)
        else:
            now = static(self._known(k, lambda: sent))
            now, mean = _late(now, now, delay, h)
            if lag > SHORTEST_LAG:
                now, mean, _ = _behind(now, mean, lag, h)
        fine = mean.reshape(*mean.shape[:-1], mean.shape[-1] // parts, parts)
        return self.log.between.sampled(now), self.log.between.mean(fine), fine


def _responses(thruster: Thruster, given: Sequence[Given]) -> dict[str, float]:
    """Times [s] of the responses of a thruster, by kind."""
    return {r.kind: numbers[0] for r, numbers in acting(for_thruster(given, Response, thruster.name), Response)}


def _lag(thruster: Thruster, late: Mapping[str, float]) -> tuple[float, bool]:
    """The time constant of a thruster [s], and whether it is that of the demand, by its responses and the vehicle file."""
    if "shaft" in late:
        return late["shaft"], True
    return late.get("lag", thruster.time_constant or 0.0), thruster.lag == "demand"


def _midway(x: Array, *, held: bool) -> Array:
    """Demands in the middle of each step."""
    return x if held else 0.5 * (x + np.r_[x[1:], x[-1:]])


def _late(now: Array, mean: Array, delay: float, h: float) -> tuple[Array, Array]:
    """A quantity at samples and its means over the steps after them, a delay later; before the delay has passed it keeps its first value."""
    if delay <= 0:
        return now, mean
    whole = int(np.floor(delay / h + WHOLE))
    part = delay / h - whole
    newer = _earlier(mean, whole)
    older = _earlier(newer, 1)
    over = part * older + (1 - part) * newer
    if mean is not now:
        # A quantity on straight lines stands between two samples.
        late = _earlier(now, whole)
        return (1 - part) * late + part * _earlier(late, 1), over
    return (newer if part < WHOLE else older), over


def _earlier(x: Array, steps: int) -> Array:
    """A quantity as it was some steps before; before its first sample it keeps its first value."""
    steps = min(steps, x.shape[-1])
    return np.concatenate([np.repeat(x[..., :1], steps, axis=-1), x[..., : x.shape[-1] - steps]], axis=-1)


def _behind(now: Array, held: Array, lag: float, h: float) -> tuple[Array, Array, Array]:
    """A quantity that holds over each step, behind a first-order lag: at samples, means over the steps after them, and at their ends."""
    decay = float(np.exp(-h / lag))
    # x at the end of step k is decay x at its start + (1 - decay) goal.
    first = now[..., :1]
    end = first + decaying((1 - decay) * (held - first), decay)
    start = np.concatenate([first, end[..., :-1]], axis=-1)
    share = (1 - decay) * lag / h
    return start, held + (start - held) * share, end


def _declared(at: ThrustAt) -> Array:
    return at.errors
