"""Innovations of a log under any hypothesis, and how they answer to forces and to readings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.physics import Hypothesis, Mass, acceleration, added_force, changed
from ivsid.diagnosis.prediction.axes import Ambient, motion_axes
from ivsid.diagnosis.prediction.filtered_states import FilteredStates, as_logged, over_ground
from ivsid.diagnosis.prediction.states import StateFilter
from ivsid.effects import Reading, Response, Thrust, of_kind

Array = NDArray[np.float64]


class Predictor(StateFilter):
    """A vehicle's log with its filters: states, prediction errors, and the responses of the errors to causes."""

    def adopt(self, ambient: Ambient) -> Predictor:
        """The same log with filters for another ambient acceleration."""
        # The filters of the position do not depend on the ambient acceleration.
        axes = motion_axes(self.log, ambient) + self.axes[3:]
        return Predictor(self.vehicle, self.log, ambient, driving=self.driving, axes=axes, turning=self.rate is None)

    def answer(
        self,
        process: Array,
        *,
        specific: Array | None = None,
        reading: Mapping[str, Array] | None = None,
        track: Array | None = None,
    ) -> Array:
        """Prediction errors that a cause outside the model leaves, shape (rows, n).

        Args:
            process: acceleration of the cause at samples and over steps [m/s^2, rad/s^2], shape (3, 2 n).
            specific: the same as an accelerometer reads it, by default ``process`` itself.
            reading: its additions to the readings u, v, r, ax, ay, rdot, psi, x, y, shape (n,) each.
            track: its addition to the velocity over ground over steps [m/s], shape (2, n).
        """
        n = self.log.n
        seen = self.at_samples(process if specific is None else specific)
        added = reading or {}
        # An addition to a reading and an acceleration of the motion have opposite signs in the errors.
        inputs: dict[tuple[int, str], Array] = {}
        for k in range(3):
            inputs[k, "process"] = -process[k, n:]
            if "acceleration" in self.axes[k].outputs:
                name = ("ax", "ay", "rdot")[k]
                inputs[k, "acceleration"] = seen[k] + added[name] if name in added else seen[k]
            if (x := added.get(("u", "v", "r")[k])) is not None:
                inputs[k, "velocity"] = x
        # Heading and position count from their first readings.
        if (x := added.get("psi")) is not None and self.rate is None:
            inputs[2, "position"] = x - x[0]
        inputs |= {
            (k, "velocity"): x - x[0] for k in range(3, len(self.axes)) if (x := added.get("xy"[k - 3])) is not None
        }
        if track is not None:
            inputs |= {(k, "process"): -track[k - 3] for k in range(3, len(self.axes))}
        return self.filters.errors(inputs)

    def mass(self, states: FilteredStates) -> Mass:
        """The mass matrix at the times of the states."""
        return self.constant_mass(states.h) or Mass(self.vehicle, states.h.terms, changed(states.h, states.points.t))

    def difference(self, states: FilteredStates, other: Hypothesis, mass: Mass | None = None) -> Array:
        """Prediction errors that remain under one hypothesis if another is true, shape (rows, n).

        Args:
            states: of the hypothesis.
            other: the true one.
            mass: the mass matrix of the hypothesis, if it is known already.
        """
        h = states.h
        moved = of_kind((*h.given, *other.given), Thrust, Response)
        points = states.points.under(*self.driving.force(other)) if moved else states.points
        mass = mass or self.mass(states)
        added = added_force(self.vehicle, h, states.points, other, points)
        process = acceleration(self.vehicle, other, points) - states.nudot if added is None else mass.solve(added)
        reading: dict[str, Array] = {}
        if of_kind((*h.given, *other.given), Reading):
            later = self.later(h)
            reading = self.sensed(other.given, states, later)
            if of_kind(h.given, Reading):
                before = self.sensed(h.given, states, later)
                reading = {k: x - before[k] for k, x in reading.items()}
        if any(np.any(x) for x in reading.values()):
            return self.misread(states, reading, process, mass)
        if moved and (there := self.driving.around(other)) is not None and (here := self.driving.around(h)) is not None:
            # Other thrusts move the means of readings apart from the velocities at their samples.
            moved_by = mass.solve(there - here) + self.driving.bend(process[:, self.log.n :])
            reading = dict(zip(("u", "v", "r"), moved_by, strict=True))
        return self.answer(process, reading=reading)

    def misread(
        self,
        states: FilteredStates,
        reading: Mapping[str, Array],
        process: Array | float = 0.0,
        mass: Mass | None = None,
    ) -> Array:
        """Prediction errors that wrong readings leave, in themselves and in the model's acceleration at them, shape (rows, n).

        Args:
            states: of the hypothesis.
            reading: errors of the readings, shape (n,) each, by channel.
            process: acceleration of a cause beside them, shape (3, 2 n).
            mass: the mass matrix, if it is known already.
        """
        n = self.log.n
        g = np.zeros((3, 2 * n))
        for k, q in enumerate(("u", "v", "r")):
            if q in reading:
                g[k, :n] = g[k, n:] = reading[q]
        if self.log.turned:
            # No gyro is read, and an error of the heading turns the hull as it changes.
            g[2] = np.tile(np.gradient(reading["psi"], self.log.h), 2) if "psi" in reading else 0.0
        elif self.rate is not None and self.rate.heading is not None:
            # The heading holds the yaw rate, whatever the gyro reads.
            g[2] = 0.0
        elif "position" in self.axes[2].outputs:
            g[2] = self._turning(reading)
        specific = process
        track = None
        turn = None if "psi" not in reading else np.concatenate([reading["psi"], reading["psi"]])
        if np.any(g) or turn is not None:
            shifted = states.points.moved(g, turn)
            there = self.dynamics(states.h, mass).acceleration(shifted)
            believed = there - states.nudot
            process = process - believed
            specific = specific - (as_logged(shifted.nu, there, self.log.rates) - states.specific)
            rotated = states.turn if turn is None else (shifted.heading.cos()[n:], shifted.heading.sin()[n:])
            track = -(over_ground(shifted, rotated) - states.over)
        if np.isscalar(process):
            process = np.zeros_like(states.nudot)
        if np.isscalar(specific):
            specific = np.zeros_like(states.nudot)
        return self.answer(np.asarray(process), specific=np.asarray(specific), reading=reading, track=track)

    def _turning(self, reading: Mapping[str, Array]) -> Array:
        """Errors of the yaw rate that the filter of yaw makes of wrong readings of gyro and heading, at samples and over steps, shape (2 n,).

        The heading corrects what a gyro adds up to: of an error that lasts the filter keeps little.
        """
        here = self.axes[2]
        none = np.zeros(self.log.n)
        psi, r = reading.get("psi", none), reading.get("r", none)
        e = here.errors({"position": psi - psi[0], "velocity": r})
        before = r - e[here.outputs.index("velocity")]
        return np.concatenate([before, before + here.kalman_gain[1] @ e])


def replaced(h: Hypothesis, values: Mapping[str, float]) -> Hypothesis:
    """A hypothesis with other values of some terms."""
    return replace(h, values={**h.values, **values})
