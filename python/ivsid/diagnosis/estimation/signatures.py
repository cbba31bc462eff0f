"""Signatures: the prediction errors that one unit of a cause would leave, at a fitted model."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.plant.physics import Hypothesis, Mass, acceleration, term_column
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import (
    CATALOGUE,
    PAPER_TERMS,
    Effect,
    Given,
    Parameter,
    Term,
    on_hull,
)
from ivsid.effects.environment import STEADY_CURRENT, TETHER_RADIUS
from ivsid.effects.inertia import SHARED_MUNK

Array = NDArray[np.float64]
# Difference of a number of an effect from which a slope at "none" is taken, in its usual size.
# Source: geometry: the effects are smooth at none, and the slope of a quadratic changes by this share over it
STEP_FROM_NONE: Final = 1e-2
# The same for a current and for velocities [m/s].
# Source: geometry: a hundredth of a hull's speed of 1 m/s
FLOW_STEP: Final = 1e-2
# Difference of a number that a hypothesis holds, as a share of the number.
# Source: geometry: the slope of a quadratic changes by this share over it
STEP: Final = 1e-3
# The same for a number that divides (its effect grows as it falls to nothing).
# Source: measured: make constants
INVERSE_STEP: Final = 0.02
# Least size of a number in such a difference, in its usual size.
# Source: geometry: a number near zero still needs a difference above rounding
LEAST_SIZE: Final = 0.1
# Fitted error of a thrust, in its bound, from which on a cap is looked for on the curve of the file.
# Source: definition: no error that is declared comes near. From two bounds on, such caps take more of the errors from which the noise is learnt: a deck house
# in the wind, fitted as errors of 3.2 bounds, was adequate
HIDING: Final = 5.0
# Multiple of a cap that caps nothing.
# Source: definition: no thruster pushes by a million times what it is looked for
IDLE: Final = 1e6


def of_file(h: Hypothesis) -> Hypothesis:
    """A hypothesis without errors of the thrust curves."""
    kept = {n: x for n, x in h.declared_errors.items() if not n.startswith(("~thrust.", "~hysteresis."))}
    return replace(h, declared_errors=kept)


class Signatures:
    """All signatures at one hypothesis and its states; each has shape (rows, n).

    Attributes:
        h: the hypothesis.
        mass: its mass matrix.
    """

    def __init__(self, predictor: Predictor, states: FilteredStates) -> None:
        self.predictor, self.states = predictor, states
        self.h: Hypothesis = states.h
        self.mass: Mass = predictor.mass(states)

    @cached_property
    def on_file(self) -> Hypothesis:
        """The hypothesis with the thrust curves of the file, where a fitted error has left its bound far behind; else as it is.

        A cap on a curve that an error has capped already changes nothing, and the error hides the cause that it stands for.
        """
        errors = zip(self.predictor.vehicle.thrusters, self.predictor.propulsion.errors, strict=True)
        if max((e.largest(t.name, self.h.declared_errors) for t, e in errors), default=0.0) <= HIDING:
            return self.h
        return of_file(self.h)

    def fitted(self, claimed: Iterable[str]) -> Columns:
        """Signatures of the model's free parameters, and of the free parameters of the hypothesis's effects.

        Args:
            claimed: ids of parameters that are not fitted, unless the hypothesis has freed them.
        """
        out = Columns()
        fixed = set(claimed) - self.h.freed
        for term in self.h.terms:
            if term.id not in fixed:
                out.add(term.id, self.term(term))
        for g in self.h.given:
            for name, parameter, j in free_parameters(g):
                out.add(name, self._slope(g, parameter, j))
        return out

    def _slope(self, g: Given, parameter: Parameter, j: int) -> Array:
        """Slope of the errors with the j-th parameter of an effect of the hypothesis, by a difference."""
        scale = max(abs(g.values[j]), LEAST_SIZE * abs(parameter.scaled(self.predictor.vehicle.hull.mass)), 1e-9)
        step = (INVERSE_STEP if parameter.inverse else STEP) * scale
        values = list(g.values)
        values[j] += step
        other = self.h.with_effect(replace(g, values=tuple(values)))
        return self.predictor.difference(self.states, other, self.mass) / step

    def reading(self, effect: Effect) -> list[Array]:
        """Slopes of the errors with the parameters of a sensor effect, at the hypothesis's numbers or at none."""
        # The velocity's scale is a declared error as well: its slope is asked beside the effect.
        held = next((g.values for g in self.h.given if g.effect.id == effect.id), (0.0,) * len(effect.parameters))
        found = []
        for j, parameter in enumerate(effect.parameters):
            step = STEP_FROM_NONE * parameter.typical
            values = tuple(x + step * (i == j) for i, x in enumerate(held))
            found.append(self.whole(Given(effect, values)) / step)
        return found

    def whole(self, given: Given) -> Array:
        """The errors that an effect with these numbers leaves."""
        return self.predictor.difference(self.states, self.h.with_effect(given), self.mass)

    def secant(self, given: Given) -> Array:
        """The errors that an effect with these numbers leaves; those of a cap, on thrust curves that no error has capped."""
        bare = self.on_file
        if bare is self.h or not given.effect.form.limits:
            return self.whole(given)
        idle = replace(given, values=tuple(IDLE * x for x in given.values))
        found, without = (self.predictor.difference(self.states, bare.with_effect(g), self.mass) for g in (given, idle))
        return found - without

    def term(self, term: Term) -> Array:
        """The errors that one unit of a term's parameter leaves if the model lacks it."""
        p = self.predictor
        return p.answer(term_column(p.vehicle, self.h, self.mass, self.states.points, self.states.nudot, term))

    def fitting(self, term: Term) -> Term:
        """The term as it acts beside those of the hypothesis."""
        shared = any(t is PAPER_TERMS[0] for t in self.h.terms)
        if term.id == SHARED_MUNK.id and shared:
            return SHARED_MUNK
        return on_hull(term, self.predictor.vehicle) if term.id in CATALOGUE else term

    def force(self, force: Array) -> Array:
        """The errors that a force at samples and over steps leaves: X, Y [N], N [N m], shape (3, 2 n)."""
        return self.predictor.answer(self.mass.solve(force))

    def earth_wave(self, period: float) -> list[Array]:
        """Signatures of a swell of 1 N with this period [s]: sine north, sine east, cosine north, cosine east."""
        p = self.states.points
        w = 2 * np.pi / period
        c, s = np.cos(p.psi), np.sin(p.psi)
        found = []
        for wave in (np.sin(w * p.t), np.cos(w * p.t)):
            for north, east in ((wave, 0.0), (0.0, wave)):
                found.append(self.force(np.stack([north * c + east * s, east * c - north * s, 0.0 * wave])))
        return found

    def earth_flow(self, effect: Effect, period: float) -> list[Array]:
        """Signatures of a tide of 1 m/s with this period [s]: sine north, sine east, cosine north, cosine east."""
        size = FLOW_STEP
        found = []
        for phase in (0.0, 0.5 * np.pi):
            for north, east in ((size, 0.0), (0.0, size)):
                numbers = {"north": north, "east": east, "period": period, "phase": phase}
                values = tuple(numbers[p.part] for p in effect.parameters)
                found.append(self.whole(Given(effect, values)) / size)
        return found

    def flow_columns(self) -> Array:
        """Accelerations at samples by a steady current of 1 m/s north, and east, shape (2, 3, n)."""
        size, n = FLOW_STEP, self.predictor.log.n
        found = []
        for values in ((size, 0.0), (0.0, size)):
            other = self.h.with_effect(Given(STEADY_CURRENT, values))
            found.append(acceleration(self.predictor.vehicle, other, self.states.points) - self.states.nudot)
        return np.stack(found)[:, :, :n] / size

    def push(self, given: Given) -> float:
        """Force of an effect with these numbers on the hull, in the plane: its rms over the log [N]."""
        n = self.predictor.log.n
        other = self.h.with_effect(given)
        change = (acceleration(self.predictor.vehicle, other, self.states.points) - self.states.nudot)[:, :n]
        forces = np.linalg.solve(self.mass.inverse[: 1 if len(self.mass.inverse) == 1 else n], change.T[:, :, None])
        return float(np.sqrt((forces[:, :2] ** 2).sum() / n))

    def pull(self, anchor: tuple[float, float]) -> list[Array]:
        """Signatures of a pull of 1 N toward an anchor (north, east [m]), and of its moment on an arm of 1 m."""
        p = self.states.points
        north, east = anchor[0] - p.place[0], anchor[1] - p.place[1]
        distance = np.sqrt(north**2 + east**2 + TETHER_RADIUS**2)
        c, s = np.cos(p.psi), np.sin(p.psi)
        north, east = north / distance, east / distance
        surge, sway = north * c + east * s, east * c - north * s
        none = np.zeros_like(surge)
        return [self.force(np.stack([surge, sway, none])), self.force(np.stack([none, none, sway]))]

    def backward(self, weighted: Array) -> Array:
        """Correlation of weighted errors with the response to a unit acceleration at each sample and axis, shape (3, n).

        This is the transpose of the filters: it takes errors back to the accelerations that would explain them.

        Args:
            weighted: errors, shape (rows, n).
        """
        n = self.predictor.log.n
        found = np.zeros((3, n))
        row = 0
        for k in range(3):
            here = self.predictor.axes[k]
            count = len(here.outputs)
            impulse = np.zeros((1, n))
            impulse[0, 0] = 1.0
            inputs = {"process": -impulse}
            if "acceleration" in here.outputs:
                inputs["acceleration"] = impulse
            response = here.errors(inputs)[0]
            for j in range(count):
                found[k] += np.real(
                    np.fft.irfft(
                        np.fft.rfft(weighted[row + j], 2 * n) * np.conj(np.fft.rfft(response[j], 2 * n)), 2 * n
                    )[:n]
                )
            row += count
        return found


def free_parameters(g: Given) -> list[tuple[str, Parameter, int]]:
    """Name, parameter and index of each number of an effect that a fit moves.

    The index of a thruster, a start, and a number with which the errors jump have no slope, and are not among them.
    """
    if g.effect.form.jumps:
        return []
    return [
        (name, p, j)
        for j, (name, p) in enumerate(zip(g.parts, g.effect.parameters, strict=True))
        if p.draw not in ("thruster", "time")
    ]
