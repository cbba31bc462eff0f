"""Filtered states of a hypothesis on a log, and its prediction errors there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.plant.declared_readings import declared, slow_shapes
from ivsid.diagnosis.plant.driving import Driving
from ivsid.diagnosis.plant.physics import Dynamics, Hypothesis, Mass, acceleration, changed
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.readings import added_readings, exact_readings, lateness
from ivsid.diagnosis.prediction.axes import AXES, Ambient, labels_of, motion_axes, track_axes
from ivsid.diagnosis.prediction.filtered_states import Carried, FilteredStates, twice
from ivsid.diagnosis.prediction.inside_steps import InsideSteps, Places, inside
from ivsid.diagnosis.prediction.kalman import Axis, Filters, apart
from ivsid.diagnosis.prediction.passes import handed_on, passes
from ivsid.diagnosis.prediction.yaw_rate import YawRate, yaw_rate
from ivsid.effects import Change, Given, Reading, of_kind
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Farthest distance of a state beyond the readings, in ranges of the readings: a hypothesis that goes further runs away.
# Source: measured: make constants
REACH: Final = 1.0
# Error of the middle of a step for its mean, in the filtered velocity's error, from which on accelerations are taken inside the steps.
# Source: definition: ten thousand samples with it have a chi-squared of one
COARSE: Final = 0.01
# The same of what headings add up from step to step, in the noise of a heading.
# Source: definition: ten thousand samples with it have a chi-squared of nine, of the 25 that count
COARSE_HEADING: Final = 0.03
# Difference of a velocity from which slopes of accelerations are read, as a share of its standard deviation.
# Source: geometry: the slope of a quadratic drag changes by this share over it
DAMPING_STEP: Final = 1e-3
# Least standard deviation of a velocity in such a difference, in its unit.
# Source: geometry: keeps the difference above rounding where a velocity never changes
LEAST_SPREAD: Final = 1e-6


class StateFilter:
    """A vehicle's log with its filters: the states of a hypothesis, and its prediction errors.

    Args:
        vehicle: whose log it is.
        log: on its clock.
        ambient: random acceleration that the filters expect.
        driving: thrusts of this log that another predictor has worked out already.
        axes: its filters, if they are known already.
        turning: whether the yaw rate is that of the filter of yaw; else it is that of its sensors alone.

    Attributes:
        propulsion: the thrusters.
        slow: shapes in time of a slow sensor bias, shape (n,) each.
        reach: lowest and highest states, shape (3, 1) each.
        axes: filters of surge, sway, yaw, and of north and east if the log has its position.
        labels: axis and channel of each row of errors.
        filters: all filters together.
        rate: the yaw rate by its sensors alone, or None.
        fine: whether steps are so long that their middles do not stand for them; None until states have settled once.
        passes: how far a pass moves the errors toward those that it works out, and passes in the place of one; None until states have settled once.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        log: Channels,
        ambient: Ambient,
        *,
        driving: Driving | None = None,
        axes: Sequence[Axis] | None = None,
        turning: bool = True,
    ) -> None:
        self.vehicle, self.log, self.ambient = vehicle, log, ambient
        self.driving = driving or Driving(vehicle, log)
        self.propulsion = self.driving.propulsion
        self.slow = slow_shapes(log.n)
        low, high = log.nu.min(axis=1), log.nu.max(axis=1)
        margin = REACH * (high - low)
        self.reach = ((low - margin)[:, None], (high + margin)[:, None])
        self.axes: list[Axis] = motion_axes(log, ambient) + track_axes(log) if axes is None else list(axes)
        self.rate: YawRate | None = None if turning else yaw_rate(log)
        if self.rate is not None:
            self.axes[2] = apart(self.axes[2].outputs, self.rate.spread)
        self.labels: list[tuple[int, str]] = labels_of(self.axes)
        self.filters = Filters(self.axes)
        self.fine: bool | None = None
        self.passes: tuple[float, int] | None = None
        self._mass: tuple[object, object, Mass] | None = None
        self._dynamics: tuple[Hypothesis, Mass | None, Dynamics] | None = None

    @property
    def channels(self) -> list[str]:
        """The axis of each row of errors."""
        return [AXES[k] for k, _ in self.labels]

    def constant_mass(self, h: Hypothesis) -> Mass | None:
        """The mass matrix of a hypothesis, that of the last one if its numbers are the same; None if it changes in time."""
        if of_kind(h.given, Change):
            return None
        known = self._mass
        if known is None or known[0] is not h.terms or known[1] is not h.values:
            known = self._mass = h.terms, h.values, Mass(self.vehicle, h.terms, h.values)
        return known[2]

    def dynamics(self, h: Hypothesis, mass: Mass | None) -> Dynamics:
        """The equations of motion of a hypothesis with its mass matrix, those of the last call if both are the same."""
        known = self._dynamics
        if known is None or known[0] is not h or known[1] is not mass:
            known = self._dynamics = h, mass, Dynamics(self.vehicle, h, mass)
        return known[2]

    def start(self, h: Hypothesis) -> FilteredStates:
        """The states as they are read, without any filter: a start for ``settle``."""
        log = self.log
        nu = log.nu.copy()
        psi = np.zeros(log.n) if log.psi is None else log.psi
        return self._evaluated(h, nu, psi, None)

    def settle(self, states: FilteredStates, times: int = 1) -> FilteredStates:
        """The filtered states under a hypothesis.

        Args:
            states: its start.
            times: passes of the filters; each evaluates the model at the states of the pass before. Where such passes would not settle, each after the
                first moves the errors a share of the way, and there are more of them.

        Source: Young, *Iterative Solution of Large Linear Systems*, 1971 (under-relaxation).
        """
        if self.passes is None:
            self.passes = passes(handed_on(self.axes, self.slopes(states), still=self.rate is not None))
        share, more = self.passes
        errors: Array | None = None
        for _ in range(more * times):
            readings = self.readings(states)
            there = self._errors(readings, states)
            errors = there if errors is None or more == 1 else errors + share * (there - errors)
            nu = np.empty((3, self.log.n))
            before, pushed = np.empty_like(nu), np.empty_like(nu)
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
                ambient, pushed[k] = here.ambient(e)
            states = replace(self._evaluated(states.h, nu, psi, states, before, pushed), ambient=ambient)
        return states

    def slopes(self, states: FilteredStates) -> Array:
        """Slopes of each acceleration (first axis) with each velocity (second) at the states [1/s], shape (3, 3, 2 n)."""
        here = acceleration(self.vehicle, states.h, states.points)
        found = np.empty((3, *here.shape))
        for k in range(3):
            size = DAMPING_STEP * max(float(np.std(states.points.nu[k])), LEAST_SPREAD)
            shift = np.zeros((3, 1))
            shift[k] = size
            found[:, k] = (acceleration(self.vehicle, states.h, states.points.moved(shift)) - here) / size
        return found

    def _evaluated(
        self,
        h: Hypothesis,
        nu: Array,
        psi: Array,
        last: FilteredStates | None,
        before: Array | None = None,
        pushed: Array | float = 0.0,
    ) -> FilteredStates:
        log, n = self.log, self.log.n
        half = 0.5 * log.h
        # A hypothesis is evaluated near measured states alone: elsewhere its states would run away.
        nu = np.clip(nu, *self.reach)
        before = None if before is None else np.clip(before, *self.reach)
        place = np.zeros((2, n)) if log.place is None else log.place
        thrusts, bollard, early = self.driving.whole(h)
        if early is not None:
            early = Mass(self.vehicle, h.terms, changed(h, np.asarray(log.t))).solve(early)
        carried = Carried(nu, psi, pushed, last, early, log.h)
        later = self._inside_reach(carried.mean(), 0.5)
        points = Points(
            np.concatenate([nu if before is None else before, later], axis=1),
            np.r_[psi, psi + half * nu[2]],
            twice(place),
            np.r_[log.t, log.t + half],
            thrusts,
            self.driving.turned,
            None if log.wind is None else twice(log.wind),
            self.driving.steered,
            bollard,
            self.driving.swing,
        )
        nudot = acceleration(self.vehicle, h, points, self.constant_mass(h))
        if last is None or before is None or self.fine is False:
            return FilteredStates(h, points, nudot, rates=log.rates)
        within = self._inside(h, points, carried)
        if self.fine is None:
            self.fine = self._coarse(within, nudot[:, n:])
        return FilteredStates(h, points, nudot, inside=within if self.fine else None, rates=log.rates)

    def _coarse(self, within: InsideSteps, middle: Array) -> bool:
        """Whether the middles of the steps are wrong by more than a share of what the sensors tell of the velocities or of the heading."""
        good, h = self.log.good, self.log.h
        velocity = h * np.sqrt(np.mean((within.mean - middle)[:, good] ** 2, axis=1))
        # A heading adds up what each step turns beyond its share.
        turned = h**2 * float(np.std(np.cumsum(within.moment[2])[good]))
        told = self.log.noise.get("psi", np.inf) if self.log.psi is not None else np.inf
        return turned > COARSE_HEADING * told or any(
            x > COARSE * k.spread for x, k in zip(velocity, self.axes, strict=False)
        )

    def _inside_reach(self, nu: Array, place: float) -> Array:
        """Velocities at a place in the steps, near measured ones, with the yaw rate of the sensors where that is the vehicle's."""
        out = np.clip(nu, *self.reach)
        if self.rate is not None:
            r = self.rate.rate
            out[2] = (1.0 - place) * r + place * np.r_[r[1:], r[-1]]
        return out

    def _inside(self, h: Hypothesis, points: Points, carried: Carried) -> InsideSteps:
        """Accelerations inside the steps, by those of the pass before."""
        places = Places.of(self.log.between)
        driven = self.driving.inside(h, places.at)
        nu = np.concatenate([self._inside_reach(carried.velocity(c), c) for c in places.at], axis=1)
        psi = np.concatenate([carried.heading(c) for c in places.at])
        t = np.concatenate([np.asarray(self.log.t) + c * self.log.h for c in places.at])
        found = acceleration(self.vehicle, h, inside(points, nu, psi, t, driven), self.constant_mass(h))
        return InsideSteps(np.stack(np.split(found, len(places.at), axis=1)), places)

    def readings(self, states: FilteredStates) -> list[dict[str, Array]]:
        """The readings without the hypothesis's sensor effects and declared sensor errors, shape (n,) each, by axis and output."""
        log, h = self.log, states.h
        later = self.later(h)
        wrong = self.sensed(h.given, states, later)
        off = declared(h.declared_errors, self.exact(states), self.slow, earth=log.earth)
        nu = [log.nu[k] - wrong[q] - off.get(q, 0.0) for k, q in enumerate(("u", "v", "r"))]
        if (apart := self.from_samples(states)) is not None:
            nu = [x - apart[k] for k, x in enumerate(nu)]
        if later:
            nu = [*(x + self._read_later(k, later, x, states) for k, x in enumerate(nu[:2])), nu[2]]
        out: list[dict[str, Array]] = []
        for k in range(3):
            here = {"velocity": nu[k]}
            if (a := log.acceleration[k]) is not None:
                name = ("ax", "ay", "rdot")[k]
                here["acceleration"] = a - wrong[name] - off.get(name, 0.0)
            out.append(here)
        if log.psi is not None:
            out[2]["position"] = log.psi - off.get("psi", 0.0)
            if log.between is not None and states.inside is not None:
                # What turns inside a step counts in both or in none of the heading and of its mean.
                turned = states.inside.turned(log.between, states.points.nu[2, log.n :], log.h)
                out[2]["position"] = out[2]["position"] - turned
        if len(self.axes) > 3 and log.place is not None:
            out += [{"position": x - off.get(q, 0.0)} for q, x in zip("xy", log.place, strict=True)]
        return out

    def later(self, h: Hypothesis) -> int:
        """Steps by which each sample has later readings of the velocities than its own: those of a hypothesis's delay beyond what the filters follow.

        A filter that gets late readings at their own samples answers to its own past, and swings up over a delay of about twice its memory.
        """
        if not of_kind(h.given, Reading):
            return 0
        return lateness(h.given, self.log.h, min(axis.memory for axis in self.axes[:2]))

    def _read_later(self, k: int, steps: int, now: Array, states: FilteredStates) -> Array:
        """What a velocity's reading some steps later has beyond that of each sample, shape (n,); the filtered state stands for one that is missing."""
        read, n = self.log.nu[k], self.log.n
        later = np.minimum(np.arange(n) + steps, n - 1)
        there = self.log.good[later] & (np.arange(n) + steps < n)
        return np.where(there, read[later] - read, states.points.nu[k, :n] - now)

    def from_samples(self, states: FilteredStates) -> Array | None:
        """Means of averaged readings of the velocity less the velocity at their samples, shape (3, n); None where no readings are averaged.

        Thrusts jump between the readings; what else accelerates the hull changes evenly from one step to the next.
        """
        impulse = self.driving.around(states.h)
        if impulse is None:
            return None
        if states.inside is not None and self.log.between is not None:
            return self.log.h * states.inside.apart(self.log.between)
        mass = self.constant_mass(states.h) or Mass(self.vehicle, states.h.terms, changed(states.h, states.points.t))
        return mass.solve(impulse) + self.driving.bend(states.nudot[:, self.log.n :])

    def _errors(self, readings: list[dict[str, Array]], states: FilteredStates) -> Array:
        """Prediction errors of readings at these states, shape (rows, n)."""
        log, n = self.log, self.log.n
        inputs: dict[tuple[int, str], Array] = {}
        seen, over_steps = self.at_samples(states.specific), states.over_steps
        for k in range(3):
            here = readings[k]
            if k == 2 and self.rate is not None:
                inputs[k, "velocity"] = here["velocity"] - self.rate.rate
                if log.psi is not None and self.rate.heading is not None:
                    # Both move along with an error of the heading.
                    inputs[k, "position"] = log.psi - self.rate.heading
                continue
            first = here["velocity"][0]
            inputs[k, "velocity"] = here["velocity"] - first
            inputs[k, "process"] = over_steps[k]
            if "position" in self.axes[k].outputs:
                turned = here["position"] - here["position"][0] - first * (np.arange(n) * log.h)
                if states.inside is not None:
                    # A filter takes accelerations as even over a step: those that come early turn the hull further.
                    turned -= log.h**2 * np.r_[0.0, np.cumsum(states.inside.moment[k, :-1])]
                inputs[k, "position"] = turned
            if "acceleration" in self.axes[k].outputs:
                inputs[k, "acceleration"] = here["acceleration"] - seen[k]
        for k in range(3, len(self.axes)):
            x = readings[k]["position"]
            inputs[k, "velocity"], inputs[k, "process"] = x - x[0], states.over[k - 3]
        return self.filters.errors(inputs)

    def errors(self, states: FilteredStates) -> Array:
        """Prediction errors of a hypothesis at its states, shape (rows, n)."""
        return self._errors(self.readings(states), states)

    def at_samples(self, x: Array) -> Array:
        """Readings of accelerations at samples and over steps, shape (3, 2 n) to (3, n).

        Each is the value at a sample, or, of accelerometers that average, the mean over the step before; ``rdot`` has a sensor of its own.
        """
        n = self.log.n
        if not self.log.averaged:
            return x[:, :n]
        return np.concatenate([np.concatenate([x[:2, :1], x[:2, n:-1]], axis=1), x[2:, :n]])

    def exact(self, states: FilteredStates) -> dict[str, Array]:
        """Readings of exact sensors at the origin at these states, shape (n,) each, by channel."""
        return exact_readings(states.points, states.nudot, self.at_samples(states.specific), states.ambient)

    def sensed(self, given: tuple[Given, ...], states: FilteredStates, later: int = 0) -> dict[str, Array]:
        """The numbers that sensor effects add to the readings at these states, shape (n,) each, by channel; ``later`` as of ``added_readings``."""
        return added_readings(given, states.points, states.nudot, self.exact(states), self.log.h, later)
