"""A log on the bench: prediction errors of any hypothesis, and how they answer to forces and to readings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.plant.driving import Driving
from ivsid.diagnosis.plant.physics import (
    Hypothesis,
    Mass,
    acceleration,
    added_force,
    changed,
    term_column,
)
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.readings import added_readings
from ivsid.diagnosis.prediction.kalman import Axis, Filters, axis
from ivsid.effects import Given, Reading, Response, Term, Thrust
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
AXES: Final = ("surge", "sway", "yaw", "north", "east")
# Where nothing better is known, the velocity over ground that a heading and a Doppler log give is off by this much [m/s].
TRACK: Final = 2e-3
TRACK_TIME: Final = 20.0
# How far beyond the readings states may go, in ranges of the readings.
FAR: Final = 1.0


@dataclass(frozen=True)
class Ambient:
    """Random acceleration of each axis: standard deviation [m/s^2, rad/s^2] and correlation time [s]."""

    deviation: tuple[float, float, float]
    time: tuple[float, float, float]


@dataclass(frozen=True)
class FilteredStates:
    """The states at which a hypothesis is evaluated: first at each sample, then in the middle of each step, shape 2 n.

    Each depends on the past alone: those at a sample are predicted without its readings, those in a step filtered with them.

    Attributes:
        points: the states.
        nudot: the model's accelerations there, shape (3, 2 n).
        ambient: rdot that the ambient moment adds at each sample, as the past lets expect it, shape (n,): a sensor off the origin sees it.
    """

    points: Points
    nudot: Array
    ambient: Array | float = 0.0


class Predictor:
    """A vehicle's log with its filters."""

    def __init__(self, vehicle: Vehicle, log: Channels, ambient: Ambient) -> None:
        self.vehicle, self.log, self.ambient = vehicle, log, ambient
        self.driving = Driving(vehicle, log)
        self.propulsion = self.driving.propulsion
        self._heading: tuple[Array, Array, Array] | None = None
        t = (np.arange(log.n) + 0.5) / log.n
        self.slow = [np.cos(np.pi * j * t) for j in range(3)]
        low, high = log.nu.min(axis=1), log.nu.max(axis=1)
        margin = FAR * (high - low)
        self.reach = ((low - margin)[:, None], (high + margin)[:, None])
        noise = log.noise
        measured: list[dict[str, str]] = [
            {"velocity": "u", "acceleration": "ax"},
            {"velocity": "v", "acceleration": "ay"},
            {"position": "psi", "velocity": "r", "acceleration": "rdot"},
        ]
        self.axes: list[Axis] = []
        self.labels: list[tuple[int, str]] = []
        for k, names in enumerate(measured):
            here = {kind: noise[name] for kind, name in names.items() if name in noise}
            self.axes.append(axis(log.h, here, ambient.deviation[k], ambient.time[k]))
            self.labels += [(k, names[o]) for o in self.axes[-1].outputs]
        if log.place is not None and log.psi is not None:
            for k, name in enumerate(("x", "y"), start=3):
                self.axes.append(axis(log.h, {"velocity": noise[name]}, TRACK, TRACK_TIME))
                self.labels.append((k, name))
        self.filters = Filters(self.axes)

    @property
    def channels(self) -> list[str]:
        """The axis of each row of errors."""
        return [AXES[k] for k, _ in self.labels]

    def start(self, h: Hypothesis) -> FilteredStates:
        """States from the readings themselves."""
        log = self.log
        nu = log.nu.copy()
        psi = np.zeros(log.n) if log.psi is None else log.psi
        return self._anchor(h, nu, psi, None)

    def settle(self, h: Hypothesis, states: FilteredStates, times: int = 1) -> FilteredStates:
        """The filtered states under a hypothesis, from those of another."""
        for _ in range(times):
            readings = self.readings(h, states)
            errors = self._filter(readings, states)
            nu = np.empty((3, self.log.n))
            before = np.empty_like(nu)
            psi = states.points.psi[: self.log.n].copy()
            row = 0
            for k in range(3):
                here = self.axes[k]
                e = errors[row : row + len(here.outputs)]
                row += len(here.outputs)
                at = here.outputs.index("velocity")
                before[k] = readings[k]["velocity"] - e[at]
                nu[k] = before[k] + here.kalman_gain[1] @ e
                if "position" in here.outputs:
                    psi = readings[k]["position"] - e[0] + here.kalman_gain[0] @ e
                if k == 2:
                    ambient = here.ambient(e)
            states = replace(self._anchor(h, nu, psi, states.nudot, before), ambient=ambient)
        return states

    def _anchor(
        self, h: Hypothesis, nu: Array, psi: Array, nudot: Array | None, before: Array | None = None
    ) -> FilteredStates:
        log, n = self.log, self.log.n
        half = 0.5 * log.h
        rate = np.zeros((3, n)) if nudot is None else nudot[:, n:]
        # No hypothesis is tried at states that are far from anything that was measured: there its states would only run away.
        nu = np.clip(nu, *self.reach)
        before = None if before is None else np.clip(before, *self.reach)
        place = np.zeros((2, n)) if log.place is None else log.place
        thrusts, bollard, early = self.driving.whole(h)
        if early is not None and nudot is not None:
            # Over a step the mean of the velocities counts; a push that comes early carries them further than one that comes late.
            rate = rate + Mass(self.vehicle, h.terms, changed(h, np.asarray(log.t))).solve(early)
        points = Points(
            np.concatenate([nu if before is None else before, np.clip(nu + half * rate, *self.reach)], axis=1),
            np.r_[psi, psi + half * nu[2]],
            _twice(place),
            np.r_[log.t, log.t + half],
            thrusts,
            self.driving.turned,
            self.driving.sent,
            None if log.wind is None else _twice(log.wind),
            self.driving.steered,
            bollard,
        )
        return FilteredStates(points, acceleration(self.vehicle, h, points))

    def readings(self, h: Hypothesis, states: FilteredStates) -> list[dict[str, Array]]:
        """What the sensors would read without the hypothesis's sensor effects, by axis."""
        log = self.log
        wrong = self.sensed(h.given, states)
        scale = h.declared_errors.get("~scale.velocity", 0.0)
        nu = [
            log.nu[k] - wrong[q] - (scale * states.points.nu[k, : log.n] if k < 2 else self._bias(h, "r"))
            for k, q in enumerate(("u", "v", "r"))
        ]
        out: list[dict[str, Array]] = []
        for k in range(3):
            here = {"velocity": nu[k]}
            if (a := log.acceleration[k]) is not None:
                name = ("ax", "ay", "rdot")[k]
                here["acceleration"] = a - wrong[name] - self._bias(h, name)
            out.append(here)
        if log.psi is not None:
            out[2]["position"] = log.psi
        return out

    def _bias(self, h: Hypothesis, name: str) -> Array | float:
        parts = [h.declared_errors.get(f"~bias.{name}.{j}", 0.0) * wave for j, wave in enumerate(self.slow)]
        return sum(parts)

    def _filter(self, readings: list[dict[str, Array]], states: FilteredStates) -> Array:
        log, n = self.log, self.log.n
        inputs: dict[tuple[int, str], Array] = {}
        specific = self._specific(states.points.nu, states.nudot)
        for k in range(3):
            here = readings[k]
            first = here["velocity"][0]
            inputs[k, "velocity"] = here["velocity"] - first
            inputs[k, "process"] = states.nudot[k, n:]
            if "position" in self.axes[k].outputs:
                inputs[k, "position"] = here["position"] - here["position"][0] - first * (np.arange(n) * log.h)
            if "acceleration" in self.axes[k].outputs:
                inputs[k, "acceleration"] = here["acceleration"] - self._at_samples(specific[k])
        if len(self.axes) > 3 and log.place is not None:
            over = self._over_ground(states.points)
            for k in range(2):
                x = log.place[k]
                inputs[3 + k, "velocity"], inputs[3 + k, "process"] = x - x[0], over[k]
        return self.filters.errors(inputs)

    def errors(self, h: Hypothesis, states: FilteredStates) -> Array:
        """Prediction errors of a hypothesis at these states, shape (rows, n)."""
        return self._filter(self.readings(h, states), states)

    def _at_samples(self, x: Array) -> Array:
        """What an accelerometer sees of a quantity at samples and over steps, shape (..., 2 n): the value, or the step before."""
        n = self.log.n
        if not self.log.averaged:
            return x[..., :n]
        return np.concatenate([x[..., :1], x[..., n:-1]], axis=-1)

    def _specific(self, nu: Array, nudot: Array) -> Array:
        """What an accelerometer reads: udot - v r, vdot + u r; and rdot."""
        return np.stack([nudot[0] - nu[1] * nu[2], nudot[1] + nu[0] * nu[2], nudot[2]])

    def _over_ground(self, p: Points) -> Array:
        n = self.log.n
        u, v = p.nu[0, n:], p.nu[1, n:]
        # Signatures are all made at one heading.
        kept = self._heading
        if kept is None or kept[0] is not p.psi:
            kept = self._heading = p.psi, np.cos(p.psi[n:]), np.sin(p.psi[n:])
        _, c, s = kept
        return np.stack([u * c - v * s, u * s + v * c])

    def answer(
        self,
        process: Array,
        *,
        specific: Array | None = None,
        reading: Mapping[str, Array] | None = None,
        track: Array | None = None,
    ) -> Array:
        """Prediction errors that an unmodelled cause leaves, shape (rows, n).

        Args:
            process: its acceleration at samples and over steps, shape (3, 2 n).
            specific: the same as an accelerometer sees it; by default the same.
            reading: what it adds to the readings u, v, r, ax, ay, psi, shape (n,).
            track: what it adds to the velocity over ground over steps, shape (2, n).
        """
        n = self.log.n
        seen = self._at_samples(process if specific is None else specific)
        added = reading or {}
        # What it adds to a reading or to what a sensor sees stands against what it does to the motion.
        inputs: dict[tuple[int, str], Array] = {}
        for k in range(3):
            inputs[k, "process"] = -process[k, n:]
            if "acceleration" in self.axes[k].outputs:
                name = ("ax", "ay", "rdot")[k]
                inputs[k, "acceleration"] = seen[k] + added[name] if name in added else seen[k]
            if (x := added.get(("u", "v", "r")[k])) is not None:
                inputs[k, "velocity"] = x
        if track is not None:
            inputs |= {(k, "process"): -track[k - 3] for k in range(3, len(self.axes))}
        return self.filters.errors(inputs)

    def term(self, h: Hypothesis, states: FilteredStates, mass: Mass, term: Term) -> Array:
        """The errors that one unit of a term's parameter leaves when the model lacks it."""
        return self.answer(term_column(self.vehicle, h, mass, states.points, states.nudot, term))

    def damping(self, h: Hypothesis, states: FilteredStates) -> tuple[float, float, float]:
        """How fast each axis alone comes to rest, on average over the log [1/s]."""
        found = []
        here = acceleration(self.vehicle, h, states.points)
        for k in range(3):
            size = 1e-3 * max(float(np.std(states.points.nu[k])), 1e-6)
            shift = np.zeros((3, 1))
            shift[k] = size
            rate = acceleration(self.vehicle, h, states.points.moved(shift)) - here
            found.append(max(float(-np.mean(rate[k]) / size), 0.0))
        return found[0], found[1], found[2]

    def mass(self, h: Hypothesis, states: FilteredStates) -> Mass:
        """The mass matrix at the anchor's times."""
        return Mass(self.vehicle, h.terms, changed(h, states.points.t))

    def difference(self, h: Hypothesis, states: FilteredStates, other: Hypothesis, mass: Mass | None = None) -> Array:
        """The errors that the other hypothesis, were it true, leaves under this one, whose masses may be known."""
        thrust_kind = (Thrust, Response)
        moved = any(isinstance(g.effect.acts, thrust_kind) for g in (*h.given, *other.given))
        points = states.points.under(*self.driving.force(other)) if moved else states.points
        mass = mass or self.mass(h, states)
        added = added_force(self.vehicle, h, states.points, other, points)
        process = acceleration(self.vehicle, other, points) - states.nudot if added is None else mass.solve(added)
        if not any(isinstance(g.effect.acts, Reading) for g in (*h.given, *other.given)):
            return self.answer(process)
        wrong, before = self.sensed(other.given, states), self.sensed(h.given, states)
        reading = {k: wrong[k] - before[k] for k in wrong}
        if not any(np.any(x) for x in reading.values()):
            return self.answer(process)
        return self.misread(h, states, reading, process, mass)

    def misread(
        self,
        h: Hypothesis,
        states: FilteredStates,
        reading: Mapping[str, Array],
        process: Array | float = 0.0,
        mass: Mass | None = None,
    ) -> Array:
        """The errors that wrong readings leave: in themselves, and in the model's acceleration, which believes them."""
        g = np.stack([_twice(reading.get(q, np.zeros(self.log.n))) for q in ("u", "v", "r")])
        specific = process
        track = None
        if np.any(g):
            shifted = states.points.moved(g)
            there = acceleration(self.vehicle, h, shifted, mass)
            believed = there - states.nudot
            process = process - believed
            specific = specific - (self._specific(shifted.nu, there) - self._specific(states.points.nu, states.nudot))
            track = -(self._over_ground(shifted) - self._over_ground(states.points))
        if np.isscalar(process):
            process = np.zeros_like(states.nudot)
        if np.isscalar(specific):
            specific = np.zeros_like(states.nudot)
        return self.answer(np.asarray(process), specific=np.asarray(specific), reading=reading, track=track)

    def sensed(self, given: tuple[Given, ...], states: FilteredStates) -> dict[str, Array]:
        """What sensor effects add to the readings, at these states."""
        specific = self._at_samples(self._specific(states.points.nu, states.nudot))
        return added_readings(given, states.points, states.nudot, specific, states.ambient, self.log.h)

    def adopt(self, ambient: Ambient) -> Predictor:
        """The same log with other filters."""
        made = Predictor.__new__(Predictor)
        made.__dict__.update(self.__dict__)
        noise = self.log.noise
        made.ambient = ambient
        names = ({"velocity": "u", "acceleration": "ax"}, {"velocity": "v", "acceleration": "ay"})
        last = {"position": "psi", "velocity": "r", "acceleration": "rdot"}
        made.axes = [
            axis(
                self.log.h,
                {kind: noise[name] for kind, name in q.items() if name in noise},
                ambient.deviation[k],
                ambient.time[k],
            )
            for k, q in enumerate((*names, last))
        ] + self.axes[3:]
        made.filters = Filters(made.axes)
        return made


def _twice(x: Array) -> Array:
    """The same at samples and over steps."""
    return np.concatenate([x, x], axis=-1)


def replaced(h: Hypothesis, values: Mapping[str, float]) -> Hypothesis:
    """With other values of the terms."""
    return replace(h, values={**h.values, **values})
