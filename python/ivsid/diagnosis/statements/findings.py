"""Findings: the causes that are named, with intervals and evidence, and ``unknown`` for structure that no cause explains.

Weights of alternatives are Akaike weights of their merits.

Source: Akaike 1974; Burnham and Anderson, *Model Selection and Multimodel Inference*, 2002, section 2.9.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound, Reach, intervals
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.kinds.step import StepCandidate
from ivsid.diagnosis.null.modulated import EVERY, FALL
from ivsid.diagnosis.null.rule import Refusal, first_refusal
from ivsid.diagnosis.null.screening import FAINT
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.selection.rivals import Found, swapped
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.selection.structure import Adequacy, energy_of
from ivsid.diagnosis.statements.probability import COUNTS, Alike, alike
from ivsid.diagnosis.statements.residuals import FindingEvidence
from ivsid.diagnosis.statements.rules import ALTERNATIVES, EXCLUDES, HELD, UNNAMED, Held
from ivsid.diagnosis.statements.shallow_water import Change
from ivsid.diagnosis.statements.share import Share
from ivsid.effects import EFFECTS, PAPER_TERMS
from ivsid.effects.environment import SHALLOW_WATER
from ivsid.effects.thrusters import ONE_FACTOR

# Half-width of the interval of shallow water, in standard deviations beside the worst declared errors.
# Source: definition: 6e-5 of normal errors lie beyond
WIDE: Final = 4.0
# Standard deviations between what two logs of one programme show of a cause, that chance does not make: three of a difference.
# Source: definition: 0.1 % of differences of two normal errors lie beyond on one side
REPEATED: Final = 3.0 * 2.0**0.5


# What is said of a cause that starts at a time, where the log shows no less of the same force that comes gradually.
LINGERS: Final = (
    "the log does not tell a start at this time from a change over minutes, as of a motor that warms or a load that grows: "
    "hold one demand for ten minutes"
)


@dataclass(frozen=True)
class Finding:
    """A cause with the causes that could be taken for it.

    Attributes:
        effect: id of the effect, or ``unknown``.
        confidence: weight of the cause among its alternatives, from 0 to 1.
        alternatives: ids of the effects that the log does not tell from it.
        separate_by: manoeuvre that separates them, in words.
        parameters: intervals by parameter.
        evidence: numbers of the log that show the cause.
        description: of an ``unknown``, or of what a log does not tell of a cause, in a sentence.
        matters: share of the simulation's error in position that the cause explains; None without a position.
        like: findings of the examination that are like it; None before all findings are known.
    """

    effect: str
    confidence: float
    alternatives: tuple[str, ...]
    separate_by: str
    parameters: dict[str, Bound]
    evidence: FindingEvidence
    description: str = ""
    matters: Share | None = None
    like: Alike | None = None

    @property
    def name(self) -> str:
        """What a reader calls it: the effect's id, or id.NAME where it is that of one thruster."""
        effect = EFFECTS.get(self.effect)
        return next(iter(self.parameters), self.effect) if effect is not None and effect.per_thruster else self.effect

    @property
    def refuted_below(self) -> float | None:
        """Standard deviations that a second log of the same programme has to show, or the cause is another one; None for an ``unknown``.

        Both logs show the cause with an error of one standard deviation.
        """
        z = self.evidence.get("z")
        return None if z is None or self.effect == "unknown" else max(z - REPEATED, 0.0)

    def record(self) -> dict[str, object]:
        """An entry of ``findings`` in result.json."""
        out: dict[str, object] = {
            "effect": self.effect,
            "confidence": self.confidence,
            "alternatives": list(self.alternatives),
            "separate_by": self.separate_by,
            "parameters": {k: b.record() for k, b in self.parameters.items()},
            "evidence": self.evidence,
        }
        if self.refuted_below is not None:
            out["refuted_below"] = self.refuted_below
        if self.like is not None:
            out["probability"] = self.like.probability
            out["like"] = {"kind": self.like.words, "right": self.like.right, "of": self.like.of}
        if self.matters is not None:
            out["matters"] = self.matters.record()
        if self.description:
            out["description"] = self.description
        return out


def findings_of(
    selection: Selection,
    evidence: Mapping[str, FindingEvidence],
    rest: Adequacy,
    *,
    complete: bool,
    louder: bool = False,
) -> tuple[tuple[Finding, ...], dict[str, Refusal]]:
    """Findings that are made of the selected causes, and the refusals of those that are none, by id.

    Args:
        selection: with the causes.
        evidence: residuals before and after, by channel.
        rest: adequacy of the extended model.
        complete: whether little enough structure is left.
        louder: whether that is more than noise of all frequencies alone makes.
    """
    last = selection.last
    made: dict[str, Finding] = {}
    withdrawn: dict[str, Refusal] = {}
    nothing = 0.0
    # The weakest first: what a cause takes that is none stays unexplained beside the stronger ones.
    for found in sorted(selection.found, key=lambda f: f.fall):
        swaps = swapped(selection.found, found.id)
        said = partial(finding, found, last, selection.leftover, evidence, selection.curves, swaps)
        one = said(unknown=not rest.quiet)
        # A force that no cause explains may pass for noise, which leaves no structure: what counts as no finding is left at the least.
        left = nothing + (
            rest.beside(last, own_columns(last, found.id), memory=louder)
            if complete
            else max(rest.unexplained, FAINT, sum(f.fall for f in selection.imitating))
        )
        case = _held(selection, found, one, rest, left, complete=complete, louder=louder, refused=nothing)
        refusal = first_refusal(HELD, case, [f.id for f in selection.found if f is not found])
        if refusal is None:
            # A cause is named by what it is beside what explains the rest, which may have moved its numbers.
            one = said(unknown=True) if rest.quiet and rest.leans else one
            made[found.id] = one_sided(one, last.h) if case.quiet and case.there else one
        else:
            nothing += found.fall
        for rank, rival in enumerate(found.rivals):
            if (out := refusal or UNNAMED.refuses(rank, [found.id])) is not None:
                withdrawn[rival.id] = out
    return tuple(made[f.id] for f in selection.found if f.id in made), withdrawn


def _held(
    selection: Selection,
    found: Found,
    one: Finding,
    rest: Adequacy,
    left: float,
    *,
    complete: bool,
    louder: bool = False,
    refused: float = 0.0,
) -> Held:
    """A cause with what the rules of findings ask of it."""
    effect = EFFECTS[found.id]
    parts = any(t.id == effect.shares and t in PAPER_TERMS for t in selection.plain.h.terms)
    boxed = found.first.boxed > found.fall
    beside = float(np.sqrt(max(min(found.first.shown, found.fall), 0.0))) - found.first.lost
    far = max((most for _, most in rest.outside), default=0.0)
    return Held(
        effect,
        found.fall,
        left,
        one.parameters,
        complete,
        rest.quiet,
        len(rest.hulls),
        parts,
        boxed,
        beside,
        far,
        louder,
        refused,
        _varying(selection.last, found, rest),
    )


def _varying(last: Fit, found: Found, rest: Adequacy) -> float:
    """Fall of chi-squared by a change of the thrust of a cause's own thrusters, among what is left most; 0 for a cause at none.

    Args:
        last: fit of the extended model.
        found: the cause.
        rest: what is left.
    """
    c, known = found.first.candidate, last.noise.predictor.vehicle.thrusters
    if not c.effect.acts.at_thruster:
        return 0.0
    alone = known[c.thruster].name if isinstance(c, StepCandidate) and c.thruster is not None else c.alone
    # A single thruster is all of them.
    words = next((t.words for t in known if t.name == alone or len(known) == 1), EVERY)
    return max((fall for name, _, fall in rest.strongest if name.startswith(f"{FALL} {words} ")), default=0.0)


def nameless(selection: Selection) -> dict[str, Refusal]:
    """Causes of several numbers that may all be none, though they explain more than others in their place, with the refusal of each, by id."""
    asked = [f for f in selection.found if f.others and len(EFFECTS[f.id].parameters) > 1]
    if not asked:
        return {}
    rest, out = selection.after, {}
    for found in asked:
        swaps = swapped(selection.found, found.id)
        one = finding(found, selection.last, selection.leftover, {}, selection.curves, swaps, unknown=not rest.quiet)
        case = _held(selection, found, one, rest, 0.0, complete=rest.quiet)
        if (refusal := first_refusal((EXCLUDES,), case, [f.id for f in selection.found if f is not found])) is not None:
            out[found.id] = refusal
    return out


def one_sided(f: Finding, h: Hypothesis) -> Finding:
    """The finding of a cause that is there: its only number lies on the estimate's side of none, since chi-squared is convex in it.

    Args:
        f: the finding.
        h: the extended model.
    """
    if len(f.parameters) != 1:
        return f
    none = EFFECTS[f.effect].parameters[0].none
    fitted = [g.values[0] for g in h.given if g.effect.id == f.effect] or [h.values[f.effect]]
    if len(fitted) != 1:
        return f
    ((name, b),) = f.parameters.items()
    cut = replace(b, lower=max(b.lower, none)) if fitted[0] > none else replace(b, upper=min(b.upper, none))
    return replace(f, parameters={name: cut})


def finding(
    found: Found,
    last: Fit,
    left: Sequence[Scored],
    evidence: Mapping[str, FindingEvidence],
    curves: Mapping[str, Reach],
    swaps: Mapping[str, tuple[float, float]],
    *,
    unknown: bool,
) -> Finding:
    """Finding that is made of one cause.

    Args:
        found: the cause with its rivals.
        last: fit of the extended model.
        left: scores of the other causes beside it.
        evidence: residuals before and after, by channel.
        curves: what any thrust curve inside its accuracy makes of each number, by column.
        swaps: shifts of each number where causes that could be taken for the others act in their place, by name.
        unknown: whether its intervals have room for something unknown.
    """
    channel = _channel(last, found.id)
    weights = np.array([np.exp(-0.5 * (found.rivals[0].merit - r.merit)) for r in found.rivals])
    names = [r.id for r in found.rivals]
    for twin, odds in EFFECTS[found.id].always_equivalent.items():
        if twin not in names:
            names.append(twin)
            weights = np.r_[weights, odds]
    confidence = float(weights[0] / weights.sum())
    alternatives = tuple(n for n in names if n != found.id)[:ALTERNATIVES]
    effect = EFFECTS[found.id]
    return Finding(
        found.id,
        confidence,
        alternatives,
        effect.separate if alternatives else "",
        intervals(last, found.id, left, unknown=unknown, curves=curves, swapped=swaps),
        {
            "channel": channel,
            **evidence.get(channel, {}),
            "z": float(np.sqrt(max(found.fall, 0.0))),
            "chance": found.chance,
        },
        LINGERS if found.lingers else "",
    )


def shallow(moved: Change) -> Finding:
    """Finding of shallow water.

    Args:
        moved: change between the logs, with a common factor.
    """
    assert moved.factor is not None
    p = SHALLOW_WATER.parameters[0]
    bound = Bound(*moved.factor.within(WIDE), p.unit, p.symbol)
    evidence: FindingEvidence = {
        "channel": "surge",
        "z": moved.factor.z,
        "ratio": {k: r for k, (r, _) in moved.ratio.items()},
        "ratio_deviation": {k: sigma for k, (_, sigma) in moved.ratio.items()},
    }
    id_ = SHALLOW_WATER.id
    if not moved.thrusts:
        return Finding(id_, 1.0, (), "", {id_: bound}, evidence)
    # Two explanations of equal merit.
    separate = f"{SHALLOW_WATER.separate}; or {ONE_FACTOR.separate} between the runs"
    return Finding(id_, 0.5, (ONE_FACTOR.id,), separate, {id_: bound}, evidence)


def weighed(findings: Sequence[Finding], shares: Mapping[str, Share]) -> tuple[Finding, ...]:
    """Findings with what each explains of the error in position, and with those of the examination that are like it."""
    made = []
    for f in findings:
        kind = alike(f.effect, f.evidence.get("z", 0.0), [g.effect for g in findings if g is not f])
        made.append(replace(f, matters=shares.get(f.effect), like=COUNTS[kind]))
    return tuple(made)


def _channel(fit: Fit, id_: str) -> str:
    """Channel with most of an effect's signature."""
    own = own_columns(fit, id_)
    return fit.noise.predictor.channels[int(np.argmax(energy_of(fit, own)))] if own else ""


def own_columns(fit: Fit, id_: str) -> list[int]:
    """Indices of an effect's columns in a fit that has it."""
    g = fit.gram
    return [k for k in fit.base if g.names[k] == id_ or g.names[k].startswith(f"{id_}.")]


def verdict_of(findings: Sequence[Finding]) -> str:
    """Verdict on the model: ``adequate``, ``wrong`` or ``unknown``."""
    return "adequate" if not findings else ("wrong" if any(f.effect != "unknown" for f in findings) else "unknown")
