"""The columns of every effect that a log can show, by family."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.signatures import STEP_FROM_NONE, Signatures
from ivsid.effects import EFFECTS, Effect, Given, Terms

Kind: TypeAlias = Literal["linear", "claim", "secant", "step", "wave", "tether"]
# Lags and delays that are tried [s].
# Source: geometry: neighbours differ by a factor of 2.5 at most, less than the factor that a coefficient corrects (candidates.families.SECANT)
DELAYS: Final = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
# Least lag or delay that is tried, in steps of the clock.
# Source: geometry: a tenth of a sample stands for all delays below one sample, whose columns are proportional to each other
LEAST_DELAY: Final = 0.1
# Largest lag or delay that is tried, as a share of the log.
# Source: geometry: nine tenths of the log are left behind it
MOST_DELAY: Final = 0.1
# Dead bands that are tried, in the demand below which most demands stay: levels lie closer below, because a small band shows little of the
# signature of a larger one.
# Source: measured: make constants
BANDS: Final = (0.03, 0.05, 0.08, 0.125, 0.19, 0.28, 0.4, 0.55, 0.75, 1.0)
# The share of demands, apart from zero, that the unit of these levels exceeds.
# Source: measured: make constants
MOST_DEMANDS: Final = 0.7
# Largest demand that counts as none, in its own unit.
# Source: geometry: rounding of a demand
NO_DEMAND: Final = 1e-9
# Limits that are tried, in the largest thrust of the log.
# Source: measured: make constants
LIMITS: Final = (0.97, 0.92, 0.85, 0.77, 0.68, 0.58, 0.47, 0.35)
# Loss of a thruster, as a share, from which the slope of a failure is taken.
# Source: geometry: thrust is linear in the loss
SMALL_LOSS: Final = 0.01
# Load, as a share of the dry mass, from which the slope of a payload is taken.
# Source: geometry: accelerations are linear in a small load, up to its square
SMALL_LOAD: Final = 1e-3
# Terms of the plain model that another model may lack.
LACKED: Final = ("mass.sway", "drag.surge.quadratic", "drag.sway.quadratic")
# Effects whose columns are found by a search.
_SEARCHED: Final[dict[str, Kind]] = {"wave.force": "wave", "current.oscillating": "wave", "tether.tension": "tether"}


@dataclass(frozen=True)
class Family:
    """A cause among the candidates.

    Attributes:
        effect: of the catalogue, in the form that the log supports.
        variants: names of its columns, one group for each value that is tried of a number that is not linear.
        values: the effect's numbers that belong to each variant.
        kind: "linear", "claim" (a number that is not fitted), "secant" (a column is the whole effect at a value), "step" (it starts at a time),
            "wave" or "tether" (columns are found by a search).
        thruster: index of the thruster that fails, of a failure.
        idle: largest dead band, or least limit, that changes nothing in this log.
    """

    effect: Effect
    variants: tuple[tuple[str, ...], ...]
    values: tuple[tuple[float, ...], ...] = ()
    kind: Kind = "linear"
    thruster: int | None = None
    idle: float | None = None

    @property
    def id(self) -> str:
        """The id of its effect."""
        return self.effect.id


def candidate_columns(
    s: Signatures, only: frozenset[str] | None = None
) -> tuple[Columns, list[Family], dict[str, str]]:
    """Signatures of the effects that a log can show, their families, and the reason why each other effect is left out, by id.

    Args:
        s: signatures at a hypothesis; its own effects are no candidates.
        only: ids of effects that are looked at; all by default.
    """
    out = Columns()
    families: list[Family] = []
    refused: dict[str, str] = {}
    present = {g.effect.id for g in s.h.given} | {t.id for t in s.h.terms}
    present |= {e.id for e in EFFECTS.values() if isinstance(e.acts, Terms) and present.issuperset(e.parts)}
    for term in s.h.terms:
        if term.id in s.predictor.vehicle.model.values and term.id not in s.h.freed and term.id in EFFECTS:
            out.add(term.id, s.predictor.term(s.h, s.states, s.mass, term))
            families.append(Family(EFFECTS[term.id], ((term.id,),), kind="claim"))
    for effect in EFFECTS.values():
        if only is not None and effect.id not in only:
            continue
        if effect.id in present and not (effect.plain and _shared(s, effect)):
            continue
        form = effect
        if effect.measured is not None and all(s.predictor.log.has(n) for n in effect.measured.needs):
            form = effect.measured
        missing = [n for n in form.needs if not s.predictor.log.has(n)]
        if missing:
            refused[effect.id] = "no " + " and no ".join(n.replace("|", " or ") for n in missing)
            continue
        reason = _impossible(s, form)
        if reason is not None:
            refused[effect.id] = reason
            continue
        families += _family(s, form, out)
    return out, families, refused


def _shared(s: Signatures, effect: Effect) -> bool:
    """Whether the model lacks a term of the plain model, because the paper's columns share one parameter among two terms."""
    return effect.id not in {t.id for t in s.h.terms}


def _impossible(s: Signatures, effect: Effect) -> str | None:
    """The reason why a log cannot show an effect, or None."""
    vehicle = s.predictor.vehicle
    id_ = effect.id
    if effect.plain and (id_ not in LACKED or not _shared(s, effect)):
        return "a term of every model"
    if id_ == "environment.shallow_water":
        return "one log at one depth does not tell it from other masses and drags"
    if id_ == "thruster.gain" and not set(vehicle.model.values) - s.h.freed:
        return "it scales every mass and drag alike, and none is claimed"
    if id_ == "drag.cross_flow" and vehicle.hull.length is None:
        return "the vehicle file gives no hull.length"
    if id_.startswith("thruster.") and not vehicle.thrusters:
        return "the forces are given, and no thruster"
    if id_ == "thruster.asymmetry":
        sides = [t.position[1] for t in vehicle.thrusters]
        if not min(sides) < 0 < max(sides):
            return "no thrusters on both sides"
    if id_ == "thruster.curve" and not all(c.largest for c in s.predictor.propulsion.curves):
        return "a thrust curve without an end"
    return None


def _family(s: Signatures, effect: Effect, out: Columns) -> list[Family]:
    """The families of an effect, whose columns are added to ``out``."""
    id_ = effect.id
    if isinstance(effect.acts, Terms):
        for term in effect.acts.terms:
            out.add(term.id, s.predictor.term(s.h, s.states, s.mass, s.fitting(term)))
        return [Family(effect, (tuple(t.id for t in effect.acts.terms),))]
    if id_ in _SEARCHED:
        return [Family(effect, (), kind=_SEARCHED[id_])]
    if id_ in _SPECIAL:
        return _SPECIAL[id_](s, effect, out)
    none = [p.none for p in effect.parameters]
    for j, (name, parameter) in enumerate(zip(effect.parts, effect.parameters, strict=True)):
        step = STEP_FROM_NONE * (abs(parameter.scaled(s.predictor.vehicle.hull.mass)) or 1.0)
        values = list(none)
        values[j] += step
        out.add(name, s.whole(Given(effect, tuple(values))) / step)
    return [Family(effect, (effect.parts,))]


def _late(s: Signatures, effect: Effect, out: Columns) -> list[Family]:
    """A lag or a delay, at several values."""
    h = s.predictor.log.h
    values = sorted({LEAST_DELAY * h, *(d for d in DELAYS if d < MOST_DELAY * s.predictor.log.n * h)})
    names = []
    for value in values:
        out.add(f"{effect.id}@{value:.6g}", s.whole(Given(effect, (value,))))
        names.append((out.names[-1],))
    return [Family(effect, tuple(names), tuple((v,) for v in values), "secant")]


def _levels(s: Signatures, effect: Effect, out: Columns) -> list[Family]:
    """A dead band or a limit, at several levels of the demands or thrusts of the log."""
    predictor = s.predictor
    if effect.id == "thruster.deadband":
        used = np.abs(np.concatenate(predictor.propulsion.demands))
        low = used[used > NO_DEMAND]
        if not low.size:
            return []
        idle, values = float(low.min()), [float(np.quantile(low, MOST_DEMANDS)) * q for q in BANDS]
    else:
        used = np.abs(predictor.propulsion.thrusts(s.h.given).now)
        idle = float(used.max())
        if idle <= 0:
            return []
        values = [idle * q for q in LIMITS]
    names, kept = [], []
    for value in values:
        column = s.whole(Given(effect, (value,)))
        if np.any(column):
            out.add(f"{effect.id}@{value:.6g}", column)
            names.append((out.names[-1],))
            kept.append((value,))
    return [Family(effect, tuple(names), tuple(kept), "secant", idle=idle)] if names else []


def _failure(s: Signatures, effect: Effect, out: Columns) -> list[Family]:
    """A failure of each thruster, as if it began before the log."""
    families = []
    for k, thruster in enumerate(s.predictor.vehicle.thrusters):
        name = f"thruster.failure.{thruster.name}"
        start = float(s.predictor.log.t[0])
        out.add(name, s.whole(Given(effect, (float(k), SMALL_LOSS, start - 1.0))) / SMALL_LOSS)
        families.append(Family(effect, ((name,),), kind="step", thruster=k))
    return families


def _payload(s: Signatures, effect: Effect, out: Columns) -> list[Family]:
    """A load, as if it came aboard before the log."""
    step = SMALL_LOAD * s.predictor.vehicle.hull.mass
    start = float(s.predictor.log.t[0])
    out.add("payload.step.mass", s.whole(Given(effect, (step, start - 1.0))) / step)
    return [Family(effect, (("payload.step.mass",),), kind="step")]


_SPECIAL: Final[dict[str, Callable[[Signatures, Effect, Columns], list[Family]]]] = {
    "thruster.lag": _late,
    "thruster.delay": _late,
    "sensor.velocity.delay": _late,
    "thruster.deadband": _levels,
    "thruster.saturation": _levels,
    "thruster.failure": _failure,
    "payload.step": _payload,
}
