"""Signatures: the prediction errors that one unit of each cause would leave, at the fitted model."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.physics import Hypothesis, Mass, acceleration
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.states import FilteredStates
from ivsid.effects import (
    CATALOGUE,
    EFFECTS,
    PAPER_TERMS,
    Effect,
    Given,
    Inflow,
    Parameter,
    Reading,
    Term,
    Terms,
    on_hull,
)
from ivsid.effects.inertia import SHARED_MUNK

Array = NDArray[np.float64]
# Lags and delays that are tried [samples] and [s]; from a tenth of a sample on.
DELAYS: Final = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
# Dead bands that are tried, in what most demands stay below: small ones hide little, and little of a larger one's signature.
BANDS: Final = (0.03, 0.05, 0.08, 0.125, 0.19, 0.28, 0.4, 0.55, 0.75, 1.0)
# Limits that are tried, in the largest thrust.
LIMITS: Final = (0.97, 0.92, 0.85, 0.77, 0.68, 0.58, 0.47, 0.35)
# In the numbers of these the errors bend or jump.
BENT: Final = ("thruster.deadband", "thruster.saturation", "thruster.lag", "thruster.delay", "sensor.velocity.delay")
# Terms of the plain model that another model may lack.
LACKED: Final = ("mass.sway", "drag.surge.quadratic", "drag.sway.quadratic")


@dataclass
class Columns:
    """Signatures by name, while they are collected; ``prior`` is the standard deviation of those that are declared."""

    names: list[str] = field(default_factory=list)
    arrays: list[Array] = field(default_factory=list)
    prior: dict[str, float] = field(default_factory=dict)

    def add(self, name: str, array: Array, prior: float | None = None) -> None:
        """One more."""
        self.names.append(name)
        self.arrays.append(array)
        if prior is not None:
            self.prior[name] = prior

    def stack(self) -> Array:
        """All of them, shape (columns, rows, n)."""
        return np.stack(self.arrays)


@dataclass(frozen=True)
class Family:
    """A cause among the candidates.

    Attributes:
        effect: of the catalogue, in the form that the log supports.
        variants: groups of columns, each a value of what is not linear; the parameters' values that belong to each.
        kind: "linear", "claim" (a number that is not fitted), "secant" (a column is the whole effect at a value), "step" (starts at a time), "wave", "tether".
        thruster: index of the thruster that a failure is of.
        idle: of a dead band or limit, the value up to which it does nothing in this log.
    """

    effect: Effect
    variants: tuple[tuple[str, ...], ...]
    values: tuple[tuple[float, ...], ...] = ()
    kind: str = "linear"
    thruster: int | None = None
    idle: float | None = None

    @property
    def id(self) -> str:
        """Of the effect."""
        return self.effect.id


class Signatures:
    """All signatures at one hypothesis and its states."""

    def __init__(self, predictor: Predictor, h: Hypothesis, states: FilteredStates) -> None:
        self.predictor, self.h, self.states = predictor, h, states
        self.mass: Mass = predictor.mass(h, states)

    def fitted(self, claimed: Iterable[str]) -> Columns:
        """Those of the model's free parameters, and of the parameters of effects that the hypothesis has."""
        out = Columns()
        fixed = set(claimed) - self.h.freed
        for term in self.h.terms:
            if term.id not in fixed:
                out.add(term.id, self.predictor.term(self.h, self.states, self.mass, term))
        for g in self.h.given:
            for name, parameter, j in free_parameters(g):
                out.add(name, self._slope(g, parameter, j))
        return out

    def _slope(self, g: Given, parameter: Parameter, j: int) -> Array:
        """The slope of the errors with a parameter of an effect that is there, by a difference."""
        scale = max(abs(g.values[j]), 0.1 * abs(parameter.scaled(self.predictor.vehicle.hull.mass)), 1e-9)
        step = (0.02 if parameter.inverse or g.effect.id == "thruster.deadband" else 1e-3) * scale
        values = list(g.values)
        values[j] += step
        other = self.h.with_effect(replace(g, values=tuple(values)))
        return self.predictor.difference(self.h, self.states, other, self.mass) / step

    def reading(self, id_: str) -> list[Array]:
        """Slopes of the errors with the parameters of a sensor effect at none."""
        effect = EFFECTS[id_]
        found = []
        for j, parameter in enumerate(effect.parameters):
            step = 1e-2 * parameter.typical
            values = tuple(step if i == j else 0.0 for i in range(len(effect.parameters)))
            found.append(self._whole(Given(effect, values)) / step)
        return found

    def _whole(self, given: Given) -> Array:
        """The errors that an effect leaves, whole."""
        return self.predictor.difference(self.h, self.states, self.h.with_effect(given), self.mass)

    def candidates(self, only: frozenset[str] | None = None) -> tuple[Columns, list[Family], dict[str, str]]:
        """Signatures of every effect, or of ``only`` some, that the log can show, their families, and why the others are left out."""
        out = Columns()
        families: list[Family] = []
        refused: dict[str, str] = {}
        present = {g.effect.id for g in self.h.given} | {t.id for t in self.h.terms}
        present |= {e.id for e in EFFECTS.values() if isinstance(e.acts, Terms) and present.issuperset(e.parts)}
        for term in self.h.terms:
            if term.id in self.predictor.vehicle.model.values and term.id not in self.h.freed and term.id in EFFECTS:
                out.add(term.id, self.predictor.term(self.h, self.states, self.mass, term))
                families.append(Family(EFFECTS[term.id], ((term.id,),), kind="claim"))
        for effect in EFFECTS.values():
            if only is not None and effect.id not in only:
                continue
            if effect.id in present and not (effect.plain and self._shared(effect)):
                continue
            form = effect
            if effect.measured is not None and all(self.predictor.log.has(n) for n in effect.measured.needs):
                form = effect.measured
            missing = [n for n in form.needs if not self.predictor.log.has(n)]
            if missing:
                refused[effect.id] = "no " + " and no ".join(n.replace("|", " or ") for n in missing)
                continue
            reason = self._impossible(form)
            if reason is not None:
                refused[effect.id] = reason
                continue
            families += self._family(form, out)
        return out, families, refused

    def _shared(self, effect: Effect) -> bool:
        """Whether the model lacks a term of the plain model because it shares another's column."""
        return effect.id not in {t.id for t in self.h.terms}

    def _impossible(self, effect: Effect) -> str | None:
        vehicle = self.predictor.vehicle
        id_ = effect.id
        if effect.plain and (id_ not in LACKED or not self._shared(effect)):
            return "a term of every model"
        if id_ == "environment.shallow_water":
            return "one log at one depth does not tell it from other masses and drags"
        if id_ == "thruster.gain" and not set(vehicle.model.values) - self.h.freed:
            return "it scales every mass and drag alike, and none is claimed"
        if id_ == "drag.cross_flow" and vehicle.hull.length is None:
            return "the vehicle file gives no hull.length"
        if id_.startswith("thruster.") and not vehicle.thrusters:
            return "the forces are given, and no thruster"
        if id_ == "thruster.asymmetry":
            sides = [t.position[1] for t in vehicle.thrusters]
            if not min(sides) < 0 < max(sides):
                return "no thrusters on both sides"
        if id_ == "thruster.curve" and not all(c.largest for c in self.predictor.propulsion.curves):
            return "a thrust curve without an end"
        return None

    def _family(self, effect: Effect, out: Columns) -> list[Family]:
        id_ = effect.id
        if isinstance(effect.acts, Terms):
            for term in effect.acts.terms:
                out.add(term.id, self.predictor.term(self.h, self.states, self.mass, self.fitting(term)))
            return [Family(effect, (tuple(t.id for t in effect.acts.terms),))]
        special: dict[str, Callable[[Effect, Columns], list[Family]]] = {
            "thruster.lag": self._late,
            "thruster.delay": self._late,
            "sensor.velocity.delay": self._late,
            "thruster.deadband": self._levels,
            "thruster.saturation": self._levels,
            "thruster.failure": self._failure,
            "payload.step": self._payload,
            "wave.force": self._wave,
            "current.oscillating": self._oscillating,
            "tether.tension": self._tether,
        }
        if id_ in special:
            return special[id_](effect, out)
        none = [p.none for p in effect.parameters]
        for j, (name, parameter) in enumerate(zip(effect.parts, effect.parameters, strict=True)):
            step = 1e-2 * (abs(parameter.scaled(self.predictor.vehicle.hull.mass)) or 1.0)
            values = list(none)
            values[j] += step
            out.add(name, self._whole(Given(effect, tuple(values))) / step)
        return [Family(effect, (effect.parts,))]

    def fitting(self, term: Term) -> Term:
        """The term as it acts beside the hypothesis's own."""
        shared = any(t is PAPER_TERMS[0] for t in self.h.terms)
        if term.id == "added_mass.munk" and shared:
            return SHARED_MUNK
        return on_hull(term, self.predictor.vehicle) if term.id in CATALOGUE else term

    def _late(self, effect: Effect, out: Columns) -> list[Family]:
        h = self.predictor.log.h
        values = sorted({0.1 * h, *(d for d in DELAYS if d < 0.1 * self.predictor.log.n * h)})
        names = []
        for value in values:
            out.add(f"{effect.id}@{value:.6g}", self._whole(Given(effect, (value,))))
            names.append((out.names[-1],))
        return [Family(effect, tuple(names), tuple((v,) for v in values), "secant")]

    def _levels(self, effect: Effect, out: Columns) -> list[Family]:
        predictor = self.predictor
        if effect.id == "thruster.deadband":
            used = np.abs(np.concatenate(predictor.propulsion.demands))
            low = used[used > 1e-9]
            if not low.size:
                return []
            idle, values = float(low.min()), [float(np.quantile(low, 0.7)) * q for q in BANDS]
        else:
            used = np.abs(predictor.propulsion.thrusts(self.h.given).now)
            idle = float(used.max())
            if idle <= 0:
                return []
            values = [idle * q for q in LIMITS]
        names, kept = [], []
        for value in values:
            column = self._whole(Given(effect, (value,)))
            if np.any(column):
                out.add(f"{effect.id}@{value:.6g}", column)
                names.append((out.names[-1],))
                kept.append((value,))
        return [Family(effect, tuple(names), tuple(kept), "secant", idle=idle)] if names else []

    def _failure(self, effect: Effect, out: Columns) -> list[Family]:
        families = []
        for k, thruster in enumerate(self.predictor.vehicle.thrusters):
            name = f"thruster.failure.{thruster.name}"
            start = float(self.predictor.log.t[0])
            out.add(name, self._whole(Given(effect, (float(k), 0.01, start - 1.0))) / 0.01)
            families.append(Family(effect, ((name,),), kind="step", thruster=k))
        return families

    def _payload(self, effect: Effect, out: Columns) -> list[Family]:
        step = 1e-3 * self.predictor.vehicle.hull.mass
        start = float(self.predictor.log.t[0])
        out.add("payload.step.mass", self._whole(Given(effect, (step, start - 1.0))) / step)
        return [Family(effect, (("payload.step.mass",),), kind="step")]

    def _wave(self, effect: Effect, out: Columns) -> list[Family]:
        del out
        return [Family(effect, (), kind="wave")]

    def _oscillating(self, effect: Effect, out: Columns) -> list[Family]:
        del out
        return [Family(effect, (), kind="wave")]

    def _tether(self, effect: Effect, out: Columns) -> list[Family]:
        del out
        return [Family(effect, (), kind="tether")]

    def force(self, force: Array) -> Array:
        """The errors that a force at samples and over steps, shape (3, 2 n), leaves."""
        return self.predictor.answer(self.mass.solve(force))

    def earth_wave(self, period: float) -> list[Array]:
        """Sine and cosine of a force of 1 N toward north, and toward east."""
        p = self.states.points
        w = 2 * np.pi / period
        c, s = np.cos(p.psi), np.sin(p.psi)
        found = []
        for wave in (np.sin(w * p.t), np.cos(w * p.t)):
            for north, east in ((wave, 0.0), (0.0, wave)):
                found.append(self.force(np.stack([north * c + east * s, east * c - north * s, 0.0 * wave])))
        return found

    def earth_flow(self, period: float) -> list[Array]:
        """Sine and cosine of a current toward north, and toward east."""
        effect = EFFECTS["current.oscillating"]
        size = 1e-2
        found = []
        for phase in (0.0, 0.5 * np.pi):
            for north, east in ((size, 0.0), (0.0, size)):
                found.append(self._whole(Given(effect, (north, east, period, phase))) / size)
        return found

    def flow_columns(self) -> Array:
        """Accelerations at samples by a unit of steady current north, and east, shape (2, 3, n)."""
        effect, size, n = EFFECTS["current.steady"], 1e-2, self.predictor.log.n
        found = []
        for values in ((size, 0.0), (0.0, size)):
            other = self.h.with_effect(Given(effect, values))
            found.append(acceleration(self.predictor.vehicle, other, self.states.points) - self.states.nudot)
        return np.stack(found)[:, :, :n] / size

    def pull(self, states: tuple[float, float]) -> list[Array]:
        """A pull of 1 N toward a point, and its moment on an arm of 1 m."""
        from ivsid.effects.environment import TETHER_RADIUS  # noqa: PLC0415 - one number

        p = self.states.points
        north, east = states[0] - p.place[0], states[1] - p.place[1]
        distance = np.sqrt(north**2 + east**2 + TETHER_RADIUS**2)
        c, s = np.cos(p.psi), np.sin(p.psi)
        north, east = north / distance, east / distance
        surge, sway = north * c + east * s, east * c - north * s
        none = np.zeros_like(surge)
        return [self.force(np.stack([surge, sway, none])), self.force(np.stack([none, none, sway]))]

    def backward(self, weighted: Array) -> Array:
        """For each sample and axis, how strongly a brief unit acceleration there would answer to weighted errors, shape (3, n)."""
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
    """The parameters of an effect that a fit moves: not the index of a thruster, nor a start, nor a dead band, which have no slope."""
    if g.effect.id == "thruster.deadband":
        return []
    names = g.named if g.thruster is not None else None
    parts = list(names) if names is not None else list(g.effect.parts)
    return [
        (name, p, j)
        for j, (name, p) in enumerate(zip(parts, g.effect.parameters, strict=True))
        if p.draw not in ("thruster", "time")
    ]


def model_force(predictor: Predictor, h: Hypothesis, states: FilteredStates) -> Array:
    """The model's acceleration at samples and over steps, shape (3, 2 n)."""
    return acceleration(predictor.vehicle, h, states.points)


__all__ = ["Columns", "Family", "Inflow", "Reading", "Signatures", "free_parameters", "model_force"]
