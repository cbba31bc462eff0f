"""Findings: the causes that are named, with intervals and evidence, and ``unknown`` for structure that no cause explains.

Weights of alternatives are Akaike weights of their merits.

Source: Akaike 1974; Burnham and Anderson, *Model Selection and Multimodel Inference*, 2002, section 2.9.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound, Reach, intervals
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.null.rule import Refusal, first_refusal
from ivsid.diagnosis.selection.adequacy import ROUGHER, Adequacy, energy_of
from ivsid.diagnosis.selection.rivals import Found, swapped
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.statements.probability import COUNTS, Alike, alike
from ivsid.diagnosis.statements.residuals import FindingEvidence
from ivsid.diagnosis.statements.rules import ALTERNATIVES, HELD, UNNAMED, Held
from ivsid.diagnosis.statements.sensor_words import WORDS
from ivsid.diagnosis.statements.shallow_water import Change
from ivsid.diagnosis.statements.share import Share
from ivsid.effects import CHANNELS, EFFECTS, PAPER_TERMS
from ivsid.effects.environment import SHALLOW_WATER
from ivsid.effects.thrusters import ONE_FACTOR

# Half-width of the interval of shallow water, in standard deviations beside the worst declared errors.
# Source: definition: 6e-5 of normal errors lie beyond
WIDE: Final = 4.0
# Standard deviations between what two logs of one programme show of a cause, that chance does not make: three of a difference.
# Source: definition: 0.1 % of differences of two normal errors lie beyond on one side
REPEATED: Final = 3.0 * 2.0**0.5


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
        description: of an ``unknown``, in a sentence.
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
    selection: Selection, evidence: Mapping[str, FindingEvidence], rest: Adequacy, *, complete: bool
) -> tuple[tuple[Finding, ...], dict[str, Refusal]]:
    """Findings that are made of the selected causes, and the refusals of those that are none, by id.

    Args:
        selection: with the causes.
        evidence: residuals before and after, by channel.
        rest: adequacy of the extended model.
        complete: whether little enough structure is left.
    """
    last = selection.last
    made: dict[str, Finding] = {}
    withdrawn: dict[str, Refusal] = {}
    nothing = 0.0
    # The weakest first: what a cause takes that is none stays unexplained beside the stronger ones.
    for found in sorted(selection.found, key=lambda f: f.fall):
        one = finding(
            found, last, selection.leftover, evidence, rest, selection.curves, swapped(selection.found, found.id)
        )
        left = nothing + (rest.beside(last, own_columns(last, found.id)) if complete else rest.unexplained)
        effect = EFFECTS[found.id]
        parts = any(t.id == effect.shares and t in PAPER_TERMS for t in selection.plain.h.terms)
        boxed = found.first.boxed > found.fall
        beside = float(np.sqrt(max(min(found.first.shown, found.fall), 0.0))) - found.first.lost
        case = Held(
            effect, found.fall, left, one.parameters, complete, rest.quiet, len(rest.hulls), parts, boxed, beside
        )
        refusal = first_refusal(HELD, case, [f.id for f in selection.found if f is not found])
        if refusal is None:
            made[found.id] = one_sided(one, effect.parameters[0].none) if case.quiet and case.there else one
        else:
            nothing += found.fall
        for rank, rival in enumerate(found.rivals):
            if (said := refusal or UNNAMED.refuses(rank, [found.id])) is not None:
                withdrawn[rival.id] = said
    return tuple(made[f.id] for f in selection.found if f.id in made), withdrawn


def one_sided(f: Finding, none: float) -> Finding:
    """The finding of a cause that is there: its only number lies on one side of none, since chi-squared is convex in it."""
    cut = {}
    for name, b in f.parameters.items():
        above = b.lower + b.upper > 2.0 * none
        cut[name] = replace(b, lower=max(b.lower, none)) if above else replace(b, upper=min(b.upper, none))
    return replace(f, parameters=cut)


def finding(
    found: Found,
    last: Fit,
    left: Sequence[Scored],
    evidence: Mapping[str, FindingEvidence],
    rest: Adequacy,
    curves: Mapping[str, Reach],
    swaps: Mapping[str, tuple[float, float]],
) -> Finding:
    """Finding that is made of one cause.

    Args:
        found: the cause with its rivals.
        last: fit of the extended model.
        left: scores of the other causes beside it.
        evidence: residuals before and after, by channel.
        rest: adequacy of the extended model.
        curves: what any thrust curve inside its accuracy makes of each number, by column.
        swaps: shifts of each number where causes that could be taken for the others act in their place, by name.
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
        intervals(last, found.id, left, unknown=not rest.quiet, curves=curves, swapped=swaps),
        {
            "channel": channel,
            **evidence.get(channel, {}),
            "z": float(np.sqrt(max(found.fall, 0.0))),
            "chance": found.chance,
        },
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


def unknown(
    left: Adequacy, near: Sequence[str], *, proved: str = "", imitated: Mapping[str, float] | None = None
) -> Finding:
    """Finding ``unknown``: structure that no cause of the catalogue explains.

    Args:
        left: adequacy of the extended model.
        near: causes that the fit holds and that are no findings.
        proved: what the rows of the log prove, in a sentence, where statistics alone would leave the model adequate.
        imitated: why causes that passed every test are a force of no cause, a clause each that begins with the cause, with their falls of chi-squared.
    """
    likely = ", ".join(f"{name} in {channel} ({np.sqrt(fall):.0f} sigma)" for name, channel, fall in left.strongest)
    channel = left.strongest[0][1]
    text = (
        f"the errors that the model leaves still follow the motion (dictionary statistic {left.statistic:.2f}, about 1 where nothing is "
        f"left), strongest with {likely}; no cause of the catalogue explains it"
    )
    z = float(np.sqrt(left.strongest[0][2]))
    if not left.bounded:
        if left.pushed and left.leaving > left.strongest[0][2]:
            channel, z = left.pushed, float(np.sqrt(left.leaving))
        where = " and of ".join(f"{name} (fitted at {most:.1f} times its accuracy)" for name, most in left.outside)
        text = (
            "the errors that the model leaves follow the motion, and no thrust curve inside the stated accuracy takes them: either the thrust"
            f"{f' of {where}' if where else ''} differs from its curve by more than the stated accuracy, or a force that the model lacks goes with the demands; "
            "all masses and drags may be wrong with it; a bollard test of the thrust tells the two apart"
        )
    if not left.sensed and left.misread is not None:
        name, most, _ = left.misread
        said = WORDS[name]
        wrong = (
            f"the {said.name} would have to be {most.largest:.2g} times what the vehicle file allows for: the sensor is worse than it states, or "
            "a cause that the catalogue lacks looks like it; all masses and drags may be wrong with it"
        )
        if left.white and left.bounded:
            channel, z, text = said.channel, float(np.sqrt(most.fall)), wrong
        else:
            text += f"; {wrong}"
    if max(left.rougher) > ROUGHER:
        k = int(np.argmax(left.rougher))
        rough = (
            f"{'the moment' if k == 2 else 'the force'} in {CHANNELS[k]} that nothing explains is at least {left.rougher[k]:.2g} times what [ambient] and "
            "the thrusters' accuracy allow: the sea was rougher than the vehicle file declares, or a cause that the catalogue lacks acts there"
        )
        if left.white and left.bounded and left.sensed:
            channel, z, text = CHANNELS[k], 0.0, rough
        else:
            text += f"; {rough}"
    if left.hulls:
        numbers = " and ".join(
            f"{a.id} {'above' if a.estimate > a.limit else 'below'} {a.limit:.3g}" for a in left.hulls
        )
        text += (
            f"; the log asks for {numbers}, which no hull of this mass and length has: masses, thrust curves, units or signs in the vehicle "
            "file may be wrong, and the fit stops at the limit"
        )
        z = max(z, left.hulls[0].deviations)
    if imitated:
        force = f"a force that the catalogue lacks acts on the hull, or a sensor is worse than it states: {'; '.join(imitated)}"
        z, text = (float(np.sqrt(max(imitated.values()))), force) if left.quiet else (z, f"{text}; {force}")
    if proved:
        z, text = 0.0, f"{proved}; the statistics see no structure that the model lacks"
    if near:
        text += f"; the nearest are {' and '.join(near)}, which the fit holds and nothing proves, so that the extended model leaves them out"
    evidence: FindingEvidence = {
        "channel": channel,
        "z": z,
        "statistic": left.statistic,
        "chance": left.chance,
    }
    return Finding("unknown", 1.0, (), "", {}, evidence, text)


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
