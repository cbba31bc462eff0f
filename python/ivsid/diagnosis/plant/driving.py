"""Thrusts and angles of a log under a hypothesis, at samples and over steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.between import Between
from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.diagnosis.plant.thrust_errors import ThrustErrors
from ivsid.diagnosis.plant.thruster_forces import bollard_force
from ivsid.effects import Response, Thrust, of_kind
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Hypotheses whose thrusts are kept: those that a fit compares, so that most of its steps work none out.
# Source: resource: memory of thrusts, of shape (thrusters, 2 n) each
KEPT: Final = 4


@dataclass
class _Pushes:
    """Thrusts and their sum at no speed, the thrusts over the parts of steps, and the moments that are made of them when they are asked for."""

    thrusts: Array
    force: Array
    parts: Array | None
    early: Array | None = None
    around: Array | None = None


@dataclass(frozen=True)
class Inside:
    """Thrusts and angles over the parts of steps: all of the first part of each step, then all of the next.

    Attributes:
        thrusts: at no speed [N], shape (thrusters, parts n).
        angles: of azimuth thrusters [rad], shape (thrusters, parts n).
        rudders: angles of rudders [rad], shape (thrusters, parts n).
        bollard: X, Y [N], N [N m] of the thrusts, shape (3, parts n).
        swing: cosines and sines of the angles.
    """

    thrusts: Array
    angles: Array
    rudders: Array
    bollard: Array
    swing: tuple[Array, Array]


class Driving:
    """Thrusts and angles of a log; each array has the samples first, then the steps after them.

    Args:
        vehicle: with its thrusters.
        log: with their demands.
        errors: declared errors of the thrusters as another log has them; those of this log by default.

    Attributes:
        propulsion: the thrusters.
        turned: angles of azimuth thrusters [rad], shape (thrusters, 2 n).
        swing: cosines and sines of ``turned``.
        steered: angles of rudders [rad], shape (thrusters, 2 n).
    """

    def __init__(self, vehicle: Vehicle, log: Channels, errors: Sequence[ThrustErrors] | None = None) -> None:
        self.vehicle, self.log = vehicle, log
        self.propulsion = Propulsion(vehicle, log, errors)
        held = log.held and not log.running
        # An angle that runs takes the shorter way.
        angles = np.unwrap(log.angles, axis=1) if log.running else log.angles
        self.turned, self.steered = (_over(x, held=held) for x in (angles, log.rudders))
        if log.between is not None:
            self.turned, self.steered = (_between(log.between, x) for x in (log.between.angles, log.between.rudders))
        self.swing = np.cos(self.turned), np.sin(self.turned)
        self._turns = any(t.steering == "azimuth" for t in vehicle.thrusters)
        self._at_samples = self.swing[0][:, : log.n], self.swing[1][:, : log.n]
        self._known: dict[object, _Pushes] = {}

    def thrusts(self, h: Hypothesis) -> Array:
        """Thrusts of a hypothesis at samples and over steps [N], shape (thrusters, 2 n)."""
        return self._worked(h).thrusts

    def force(self, h: Hypothesis) -> tuple[Array, Array]:
        """The thrusts, and their sum at no speed: X, Y [N], N [N m], shape (3, 2 n)."""
        pushes = self._worked(h)
        return pushes.thrusts, pushes.force

    def whole(self, h: Hypothesis) -> tuple[Array, Array, Array | None]:
        """The thrusts, their sum at no speed, and its first moment over each step, shape (3, n), or None.

        The moment is positive for a force that comes early in its step; it exists if demands come faster than the clock.
        """
        pushes = self._moments(h)
        return pushes.thrusts, pushes.force, pushes.early

    def around(self, h: Hypothesis) -> Array | None:
        """Impulse of the thrusts from each sample to its readings, the mean over them, beyond ``bend`` of a force that changes evenly [N s, N m s].

        It has shape (3, n), and exists if readings are averaged.
        """
        return self._moments(h).around

    def bend(self, rate: Array) -> Array:
        """The mean of averaged readings less the value at their sample, of a quantity whose rate changes evenly from one step to the next.

        Half of the second derivative times the mean square of the readings' times, by Taylor's series.

        Args:
            rate: over each step, shape (..., n).
        """
        between = self.log.between
        size = 0.0 if between is None else 0.5 * between.spread * self.log.h
        return size * np.diff(rate, axis=-1, prepend=rate[..., :1])

    def _moments(self, h: Hypothesis) -> _Pushes:
        pushes = self._worked(h)
        if pushes.parts is not None and pushes.early is None:
            pushes.early, pushes.around = self._early(pushes.parts), self._around(pushes.parts, pushes.force)
        return pushes

    def inside(self, h: Hypothesis, at: Sequence[float]) -> Inside | None:
        """The thrusts over the parts of steps, if demands come faster than the clock, or else at places where thrusts or angles run; None if all hold.

        Args:
            h: the hypothesis.
            at: the places, in steps.
        """
        between, parts = self.log.between, self._worked(h).parts
        if between is None or parts is None:
            return self._running(h, at)
        thrusts, angles, rudders = (_by_part(x) for x in (parts, between.angles, between.rudders))
        swing = np.cos(angles), np.sin(angles)
        return Inside(thrusts, angles, rudders, bollard_force(self.vehicle, thrusts, swing), swing)

    def _running(self, h: Hypothesis, at: Sequence[float]) -> Inside | None:
        """Thrusts and angles at places in the steps, on straight lines from one sample to the next where they run."""
        log, n = self.log, self.log.n
        rises = np.array(
            [self.propulsion.rise(k, h.given) for k in range(len(self.vehicle.thrusters))], dtype=np.float64
        )
        turning = log.running or not log.held
        if not (turning or rises.any()):
            return None
        thrusts = self._worked(h).thrusts
        pushes = _on_lines(thrusts[:, n:], rises[:, None] * _rise(thrusts[:, :n]), at)
        angles, rudders = (_on_lines(x[:, n:], turning * _rise(x[:, :n]), at) for x in (self.turned, self.steered))
        swing = np.cos(angles), np.sin(angles)
        return Inside(pushes, angles, rudders, bollard_force(self.vehicle, pushes, swing), swing)

    def _worked(self, h: Hypothesis) -> _Pushes:
        """The thrusts of a hypothesis, those of a call before if they are the same."""
        sizes = [self._sizes(h, k) for k in range(len(self.vehicle.thrusters))]
        acting = of_kind(h.given, Thrust, Response)
        key = (tuple((g.effect.id, g.values, g.thruster) for g in acting), tuple(map(tuple, sizes)))
        found = self._known.get(key)
        if found is None:
            made = self.propulsion.thrusts(h.given, sizes)
            thrusts = np.concatenate([made.now, made.mean], axis=1)
            force = bollard_force(self.vehicle, thrusts, self.swing)
            found = _Pushes(thrusts, force, None if self.log.between is None else made.parts)
            for old in list(self._known)[: 1 - KEPT]:
                self._known.pop(old, None)
        # A dictionary keeps the order of its keys: those that were asked for least lately go, and every candidate asks for the model without it.
        self._known.pop(key, None)
        self._known[key] = found
        return found

    def _early(self, parts: Array) -> Array:
        """First moment of the force of thrusts that change inside the steps, shape (3, n)."""
        between = self.log.between
        assert between is not None
        if not self._turns:
            # A force that keeps its direction has its moment where its thrust has it.
            return bollard_force(self.vehicle, parts @ between.lean, self._at_samples)
        pushes = (parts * between.lean).reshape(len(parts), -1)
        angles = between.angles.reshape(pushes.shape)
        total = bollard_force(self.vehicle, pushes, (np.cos(angles), np.sin(angles)))
        return np.asarray(total.reshape(3, self.log.n, -1).sum(axis=2))

    def _around(self, parts: Array, force: Array) -> Array | None:
        """Impulse of thrusts from each sample to its readings beyond that of an even change, shape (3, n), or None."""
        between = self.log.between
        assert between is not None
        if not between.apart:
            return None
        # Before the first sample the first demand was in force.
        impulse = between.moved(parts, parts[:, 0, 0])
        whole = bollard_force(self.vehicle, impulse, self._at_samples)
        return self.log.h * whole - self.bend(force[:, self.log.n :])

    def _sizes(self, h: Hypothesis, k: int) -> list[float]:
        names = self.propulsion.errors[k].names(self.vehicle.thrusters[k].name)
        return [h.declared_errors.get(name, 0.0) for name in names]

    def slopes(self, h: Hypothesis, k: int, beside: Callable[[Array], Array] | None = None) -> Array:
        """Slopes of a thruster's thrust [N] with errors of its curve, shape (errors, 2 n).

        Args:
            h: the hypothesis, with the sizes of declared errors at which the slopes are taken.
            k: index of the thruster.
            beside: the errors [N], shape (errors, m), of m demands from neutral in the order of time; the declared ones by default.
        """
        return self.propulsion.slopes(k, h.given, self._sizes(h, k), beside)


def _rise(x: Array) -> Array:
    """From each sample to the next, of the same shape."""
    return np.diff(x, axis=1, append=x[:, -1:])


def _on_lines(mean: Array, rise: Array, at: Sequence[float]) -> Array:
    """Numbers at places in the steps, by their means over these and what they rise by: all of the first place, then all of the next."""
    return np.concatenate([mean + (c - 0.5) * rise for c in at], axis=1)


def _by_part(x: Array) -> Array:
    """Numbers of parts of steps, shape (rows, n, parts), with all of one part side by side, shape (rows, parts n)."""
    return np.ascontiguousarray(np.moveaxis(x, 2, 1)).reshape(len(x), -1)


def _between(between: Between, x: Array) -> Array:
    """Angles at the readings of samples, then over the steps, from those at the parts of the steps."""
    return np.concatenate([between.sampled(x.reshape(len(x), -1)), between.mean(x)], axis=1)


def _over(x: Array, *, held: bool) -> Array:
    """Angles at samples, then in the middle of steps."""
    return (
        np.concatenate([x, x], axis=-1)
        if held
        else np.concatenate([x, 0.5 * (x + np.c_[x[..., 1:], x[..., -1:]])], axis=-1)
    )
