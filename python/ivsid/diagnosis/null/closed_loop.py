"""Motion of null logs in closed loop: the fitted model under demands that answer to its own motion, all logs at once.

The equations of motion are integrated in true states by the Runge-Kutta method of fourth order. On a thinned clock the thrusts have their means over
each step, which is what predictions take there, so a clock that is slower than the log's adds no error that the log does not have.

Source: Hairer, Norsett and Wanner, *Solving Ordinary Differential Equations I*, 1993, sections II.1 and II.7.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, cast

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.null.feedback import Feedback
from ivsid.diagnosis.plant.physics import Dynamics, Hypothesis
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.diagnosis.plant.thruster_forces import bollard_force
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Longest step of the integration [s]: a slower clock is integrated as finely as the fastest clock of null logs.
# Source: definition: one step at 10 Hz
LONGEST: Final = 0.1
# Entries of a thrust curve over the range of the demands.
# Source: resource: 32 kB for each thruster and null log
TABLE: Final = 4001
# Distance of the largest place in a thrust curve from its number of entries: just below the last entry, so that two entries enclose it.
# Source: geometry: linear interpolation needs an entry above the place
BELOW_END: Final = 1.000001
# Least width of a grid over the range of the demands, and the width that a grid adds beyond it, in the unit of the demands.
# Source: geometry: the grid of a demand that never changes needs increasing places
GRID_MARGIN: Final = 1e-9
# Excess of a ratio of two steps above a whole number that counts as their rounding.
# Source: geometry: doubles round a decimal step by far less, and no ratio of clock rates is so close to a whole number by itself
RATIO_ROUNDING: Final = 1e-6
# A thruster with a shorter lag [s] follows its demand at once.
# Source: definition: far below any step of the clock
NO_LAG: Final = 1e-6


@dataclass(frozen=True)
class Programme:
    """The model, the demands and the disturbances that null logs are simulated from.

    Attributes:
        vehicle: of the file.
        log: on the clock of the null logs.
        h: the fitted model.
        ambient: the estimated ambient acceleration.
        declared_errors: standard deviation of each declared error, by name.
        start: u, v, r at the first sample [m/s, rad/s], shape (3,).
        feedback: regressed from the log.
        reference: u, v, r, psi to which the logged demands answered, shape (4, n).
        thinned: whether this clock is slower than that of the log itself.
    """

    vehicle: Vehicle
    log: Channels
    h: Hypothesis
    ambient: Ambient
    declared_errors: dict[str, float]
    start: Array
    feedback: Feedback
    reference: Array
    thinned: bool = False


def not_followed(h: Hypothesis) -> tuple[str, ...]:
    """Ids of the causes of a model that null logs do not follow: late thrusts, thrusts that change in time, and sensors."""
    return tuple(
        g.effect.id for g in h.given if g.effect.acts.late or (g.effect.acts.at_thruster and g.effect.acts.in_time)
    )


def ends(programme: Programme) -> tuple[Array, Array]:
    """The smallest and the largest demand that each thruster may be sent, shape (thrusters,) each.

    A slow clock has demands between its samples. The feedback may send all that the log was sent, of which the clock of null logs holds means.
    """
    log, back = programme.log, programme.feedback
    sent = log.demands if log.between is None else np.concatenate([log.demands[..., None], log.between.demands], axis=2)
    sent = sent.reshape(len(sent), math.prod(sent.shape[1:]))
    return (
        np.minimum(sent.min(axis=1), back.lowest[: len(sent)]),
        np.maximum(sent.max(axis=1), back.highest[: len(sent)]),
    )


class _Thrusters:
    """Thrusts of all logs at the demands that are sent, step by step, with the lags of the vehicle file."""

    def __init__(self, programme: Programme, errors: list[Array | None], count: int) -> None:
        vehicle, log, given = programme.vehicle, programme.log, programme.h.given
        self.vehicle, self.log, self.count = vehicle, log, count
        self.behind: list[Array | None] = [None for _ in vehicle.thrusters]
        propulsion = Propulsion(vehicle, log)
        self.low, high = ends(programme)
        self.pace = np.maximum(high - self.low, GRID_MARGIN) / (TABLE - 1)
        self.row = np.arange(count)
        self.tables = []
        for k in range(len(vehicle.thrusters)):
            grid = self.low[k] + self.pace[k] * np.arange(TABLE)
            off = errors[k]
            rows = [None] * count if off is None else list(off)
            self.tables.append(np.stack([propulsion.static(k, grid, row, given) for row in rows]))

    def static(self, k: int, demand: Array) -> Array:
        """Thrust of one thruster at its demands without any lag, shape (count,)."""
        place = np.minimum(np.maximum((demand - self.low[k]) / self.pace[k], 0.0), TABLE - BELOW_END)
        # A lost motion asks for no demand, and gets no thrust.
        cell = np.fmax(place, 0.0).astype(np.int64)
        table, share = self.tables[k], place - cell
        return np.asarray((1 - share) * table[self.row, cell] + share * table[self.row, cell + 1])

    def step(self, now: Array, later: Array, share: float) -> Array:
        """Thrusts at the start, in the middle and at the end of a step of ``share`` samples, shape (3, thrusters, count)."""
        out = np.empty((3, len(self.behind), self.count))
        for k, thruster in enumerate(self.vehicle.thrusters):
            middle = 0.5 * (now[k] + later[k]) if later is not now else now[k]
            lag = thruster.time_constant or 0.0
            if lag <= NO_LAG:
                out[:, k] = self.static(k, now[k])
                if later is not now:
                    out[1, k], out[2, k] = self.static(k, middle), self.static(k, later[k])
                continue
            decay = [float(np.exp(-part * share * self.log.h / lag)) for part in (0.5, 1.0)]
            of_demand = thruster.lag == "demand"
            goal = middle if of_demand else self.static(k, middle)
            known = self.behind[k]
            first = goal if known is None else known
            last = [goal + (first - goal) * d for d in decay]
            self.behind[k] = last[1]
            for part, x in enumerate((first, *last)):
                out[part, k] = self.static(k, x) if of_demand else x
        return out


class _Motion:
    """Rates of change of all logs under the fitted model."""

    def __init__(self, programme: Programme, drawn: dict[str, Array], count: int) -> None:
        # Each log has its own size of an error: an array stands for the one number of a hypothesis.
        declared_errors = cast("dict[str, float]", {k: x for k, x in drawn.items() if k.startswith("~rudder.")})
        self.vehicle, self.log = programme.vehicle, programme.log
        self.dynamics = Dynamics(self.vehicle, replace(programme.h, declared_errors=declared_errors))
        self.wide = np.zeros(count)
        self.thrusters = len(self.log.demands)

    def start(self, at: Array) -> Array:
        """u, v, r, psi, x, y of all logs at the first sample, shape (6, count)."""
        log = self.log
        x = np.zeros((6, self.wide.size))
        x[:3] = at[:, None]
        x[3] = 0.0 if log.psi is None else log.psi[0]
        if log.place is not None:
            x[4:] = log.place[:, :1]
        return x

    def bollard(self, push: Array, sent: Array) -> Array:
        """X, Y [N], N [N m] of thrusts at no speed during the step after sample i, shape (3, parts, count).

        Args:
            push: thrusts at several moments of the step, shape (parts, thrusters, count).
            sent: commands, shape (sent, count).
        """
        angles = sent[2 * self.thrusters :]
        return bollard_force(self.vehicle, push.transpose(1, 0, 2), (np.cos(angles), np.sin(angles)))

    def known(self, sent: Array, i: int, time: float) -> tuple[Array, Array, Array | None, Array]:
        """Time, angles of thrusters, wind and angles of rudders during the step after sample i, as ``rates`` takes them."""
        log, m = self.log, self.thrusters
        wind = None if log.wind is None else self.wide + log.wind[:, i, None]
        return self.wide + time, sent[2 * m :], wind, sent[m : 2 * m]

    def rates(self, x: Array, push: Array, bollard: Array, known: tuple[Array, Array, Array | None, Array]) -> Array:
        """Rates of u, v, r, psi, x, y under thrusts and all else that is known of a step, shape (6, count)."""
        time, angles, wind, rudders = known
        p = Points(x[:3], x[3], x[4:], time, push, angles, wind, rudders, bollard)
        nudot = self.dynamics.acceleration(p)
        c, s = np.cos(x[3]), np.sin(x[3])
        out = np.empty_like(x)
        out[:3], out[3] = nudot, x[2]
        out[4], out[5] = x[0] * c - x[1] * s, x[0] * s + x[1] * c
        return out


class _Controller:
    """Commands: those of the log, and the answer of the feedback to the difference from the log's motion."""

    def __init__(self, programme: Programme, noise: dict[str, Array], count: int) -> None:
        log = programme.log
        self.logged = np.concatenate([log.demands, log.rudders, log.angles])
        self.back, self.reference, self.held = programme.feedback, programme.reference, log.held
        self.acting = self.back.at & np.any(self.back.feedback_gains != 0, axis=1, keepdims=True)
        none = np.zeros((count, log.n))
        self.noise = np.stack([noise.get(q, none) for q in ("u", "v", "r", "psi")])
        self.wide = np.zeros(count)
        # Commands inside the steps of a clock that is slower than they are, as differences from those at the samples.
        self.inside = None
        if log.between is not None:
            fine = np.concatenate([log.between.demands, log.between.rudders, log.between.angles])
            self.inside = fine - self.logged[:, :, None]

    def within(self, now: Array, i: int, share: float) -> Array:
        """Commands at a share of the step after sample i, for those at the sample, shape (sent, count)."""
        if self.inside is None:
            return now
        return np.asarray(now + self.inside[:, i, int(share * self.inside.shape[2]), None])

    def sent(self, x: Array, i: int) -> tuple[Array, Array]:
        """Commands at sample i and at the end of its step, each of shape (sent, count); the same array under a zero-order hold."""
        own = self.logged[:, i, None] + self.wide
        now = own
        if self.acting[:, i].any():
            felt = x[:4] - self.reference[:, i, None]
            if self.back.reads:
                felt = felt + self.noise[:, :, i]
            now = own + np.where(self.acting[:, i : i + 1], self.back.feedback_gains @ felt, 0.0)
            now = np.clip(now, self.back.lowest[:, None], self.back.highest[:, None])
        if self.held or i + 1 == self.logged.shape[1]:
            return now, now
        return now, self.logged[:, i + 1, None] + (now - own)


@dataclass(frozen=True)
class _Force:
    """All that drives the logs during a part of a step.

    Attributes:
        motion: the fitted model.
        push: thrusts at the start, in the middle and at the end, shape (3, thrusters, count).
        bollard: their forces at no speed, shape (3, 3, count), the moments second.
        known: all else, as ``_Motion.rates`` takes it.
        ahead: ambient accelerations, with zeros for the rates of the place, shape (6, count).
    """

    motion: _Motion
    push: Array
    bollard: Array
    known: tuple[Array, Array, Array | None, Array]
    ahead: Array

    def at(self, x: Array, moment: int) -> Array:
        """Rates of change at some states under the thrusts of a moment, shape (6, count)."""
        return self.motion.rates(x, self.push[moment], self.bollard[:, moment], self.known) + self.ahead

    def mean(self) -> _Force:
        """With the means of the thrusts over the part, by Simpson's rule, all along it."""
        if np.array_equal(self.push[0], self.push[1]) and np.array_equal(self.push[0], self.push[2]):
            return self
        push = (self.push[0] + 4 * self.push[1] + self.push[2]) / 6
        bollard = (self.bollard[:, :1] + 4 * self.bollard[:, 1:2] + self.bollard[:, 2:]) / 6
        push, bollard = np.broadcast_to(push, self.push.shape), np.broadcast_to(bollard, self.bollard.shape)
        return _Force(self.motion, push, bollard, self.known, self.ahead)


def _runge_kutta(force: _Force, x: Array, step: float, first: Array | None = None) -> tuple[Array, Array]:
    """Rates at the start of a step, worked out if they are not known, and the states at its end, by the method of fourth order."""
    k1 = force.at(x, 0) if first is None else first
    k2 = force.at(x + 0.5 * step * k1, 1)
    k3 = force.at(x + 0.5 * step * k2, 1)
    k4 = force.at(x + step * k3, 2)
    return k1, x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def _with_mean_thrusts(force: _Force, x: Array, step: float) -> tuple[Array, Array]:
    """Rates at the start of a step under its first thrusts, and the states at its end under their means."""
    first, mean = force.at(x, 0), force.mean()
    return first, _runge_kutta(mean, x, step, first if mean is force else None)[1]


def simulated(
    programme: Programme, drawn: dict[str, Array], errors: list[Array | None], pushed: Array, noise: dict[str, Array]
) -> tuple[Array, Array, Array]:
    """Motion of all null logs.

    Args:
        programme: model, log and feedback.
        drawn: sizes of the declared errors by name, each of shape (count,).
        errors: thrust errors by thruster over a table of demands, each of shape (count, TABLE) or None.
        pushed: ambient accelerations, shape (3, n, count).
        noise: of the sensors by quantity, each of shape (count, n).

    Returns:
        States u, v, r, psi, x, y at samples, shape (6, n, count); rates of u, v, r, shape (3, n, count); commands, shape (sent, n, count).
    """
    log, n, count = programme.log, programme.log.n, pushed.shape[-1]
    thrusters, motion = _Thrusters(programme, errors, count), _Motion(programme, drawn, count)
    controller = _Controller(programme, noise, count)
    whole = 1 if log.between is None else log.between.demands.shape[2]
    parts = 1 if programme.thinned else whole * max(1, int(np.ceil(log.h / (whole * LONGEST) - RATIO_ROUNDING)))
    step = log.h / parts
    integrate = _with_mean_thrusts if programme.thinned else _runge_kutta
    x = motion.start(programme.start)
    states, rates = np.empty((6, n, count)), np.empty((3, n, count))
    sent = np.empty((len(controller.logged), n, count))
    ahead = np.zeros((6, count))
    with np.errstate(over="ignore", invalid="ignore"):
        for i in range(n):
            states[:, i] = x
            now, later = controller.sent(x, i)
            sent[:, i] = now
            ahead[:3] = pushed[:, i]
            for part in range(parts):
                first = last = middle = controller.within(now, i, (part + 0.5) / parts)
                if later is not now:
                    first, last = (now + (later - now) * (q / parts) for q in (part, part + 1))
                    middle = 0.5 * (first + last)
                push = thrusters.step(first, last, 1.0 / parts)
                known = motion.known(middle, i, float(log.t[i]) + (part + 0.5) * step)
                force = _Force(motion, push, motion.bollard(push, middle), known, ahead)
                rate, x = integrate(force, x, step)
                if not part:
                    rates[:, i] = rate[:3]
    return states, rates, sent
