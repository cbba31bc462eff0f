"""Prose: a diagnosis in sentences that are made from its numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from typing import Final

from ivsid.diagnosis.statements.comparison import BAND, POSITION_WINDOW, VELOCITY_WINDOW, Gain
from ivsid.diagnosis.statements.diagnosis import Diagnosis
from ivsid.diagnosis.statements.evidence import Evidence
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.losses import LEVEL
from ivsid.diagnosis.statements.share import AFTER
from ivsid.effects import CATALOGUE, EFFECTS, Effect
from ivsid.propulsion.thrust import ThrustCurve

# Chances below this are printed as a bound.
# Source: definition: a chance that no model of the noise is good for
TINY: Final = 1e-12
# Quantities of the gain in words, with their units.
_WHAT: Final = {
    "u": (f"simulated u over {VELOCITY_WINDOW:g} s", "m/s"),
    "v": (f"simulated v over {VELOCITY_WINDOW:g} s", "m/s"),
    "r": (f"simulated r over {VELOCITY_WINDOW:g} s", "rad/s"),
    "position": (f"simulated position over {POSITION_WINDOW:g} s", "m"),
    "X": ("missing force X", "N"),
    "Y": ("missing force Y", "N"),
    "N": ("missing moment N", "N m"),
}


def explain(result: Diagnosis, seen: Sequence[Evidence] = ()) -> list[list[str]]:
    """Paragraphs for each finding: the cause, its size, its certainty, alternatives and the next step.

    Args:
        result: the diagnosis.
        seen: evidence of the findings, from which their forces are told.
    """
    shown = {e.effect: e for e in seen}
    return [
        _unknown(f, shown.get(f.effect)) if f.effect == "unknown" else _paragraphs(result, f, shown.get(f.effect))
        for f in result.findings
    ]


def _outward(x: float, rounding: str) -> str:
    """A bound with four digits, rounded outward."""
    return f"{float(Context(prec=4, rounding=rounding).create_decimal(Decimal(x))):g}"


def _paragraphs(result: Diagnosis, f: Finding, seen: Evidence | None) -> list[str]:
    """Paragraphs of a named finding."""
    effect = EFFECTS[f.effect]
    return [
        f"{f.name}: {effect.cause}.",
        " ".join(["How much:", *_sizes(result, f, effect), *_explained(seen), *_matters(f)]),
        f"How sure: {_sure(result, f)}",
        f"What else: {f'{f.description}; ' if f.description else ''}{_else(result, f)}",
        f"What would change this: {_changed(f, effect)}",
        f"What next: {_next(result, f, effect)}",
    ]


def _sizes(result: Diagnosis, f: Finding, effect: Effect) -> list[str]:
    """Sentences on the intervals of a finding."""
    if not f.parameters:
        return ["no interval of its numbers could be made."]
    forms = (effect,) if effect.measured is None else (effect, effect.measured)
    largest = max((ThrustCurve(t).largest for t in result.vehicle.thrusters), default=0.0)
    typical = {
        n: p.scaled(result.vehicle.hull.mass, largest)
        for e in forms
        for n, p in zip(e.parts, e.parameters, strict=True)
        if p.draw in ("size", "north", "east")
    }
    words = []
    for name, b in f.parameters.items():
        if b.stands_for:
            words.append(f"{name} is {b.stands_for}.")
            continue
        unit = "" if b.unit == "1" else f" {b.unit}"
        # The number of one thruster has the usual size of its effect.
        usual = typical.get(name, typical.get(f.effect))
        size = "" if usual is None else f"; {usual:.3g}{unit} is usual for a vehicle of this mass"
        kind = "proved" if b.guaranteed else "statistical, not proved"
        least, most = _outward(b.lower, ROUND_FLOOR), _outward(b.upper, ROUND_CEILING)
        if not (math.isfinite(b.lower) or math.isfinite(b.upper)):
            words.append(f"{name} has no bound in this log ({kind}{size}).")
        elif not math.isfinite(b.upper):
            words.append(f"{name} is at least {least}{unit} ({kind}{size}).")
        elif not math.isfinite(b.lower):
            words.append(f"{name} is at most {most}{unit} ({kind}{size}).")
        else:
            words.append(f"{name} lies between {least} and {most}{unit} ({kind}{size}).")
    return words


def _explained(seen: Evidence | None) -> list[str]:
    """Sentences on the force that a finding explains."""
    if seen is None:
        return []
    before, after, own = seen.rms
    return [
        f"In {seen.channel} it accounts for {own:.2g} {seen.unit} (rms below {BAND:g} Hz): without it {before:.3g} {seen.unit} are missing, with it {after:.3g}. "
        f"It goes with {seen.quantity}."
    ]


def _matters(f: Finding) -> list[str]:
    """Sentence on the part of the simulation's error that a finding explains."""
    if f.matters is None:
        return []
    m = f.matters
    return [
        f"On the other log the simulated position is off by {m.without:.3g} m after {AFTER:g} s without it and by {m.held:.3g} m with it: "
        + (
            f"it explains {100 * max(m.interval[0], 0.0):.0f} to {100 * m.interval[1]:.0f} % of the squared error."
            if m.told and m.share > 0
            else "the log cannot tell that it matters there."
            if not m.told
            else "the model without it runs closer there."
        )
    ]


def _changed(f: Finding, effect: Effect) -> str:
    """Sentence on the log that would refute a finding."""
    how = f.separate_by or effect.separate
    words = []
    if f.refuted_below is not None and f.refuted_below > 0:
        words.append(
            f"a second log of this programme that shows it by less than {f.refuted_below:.0f} standard deviations"
        )
    if how:
        words.append(f"{'or ' if words else ''}a log of this manoeuvre that shows nothing of it: {how}")
    return f"{', '.join(words)}." if words else "a log that shows it with another size."


def _sure(result: Diagnosis, f: Finding) -> str:
    """Sentence on the certainty of a finding."""
    z = f.evidence.get("z", 0.0)
    words = [f"it stands out by {z:.0f} standard deviations, most in {f.evidence.get('channel') or 'several channels'}"]
    chance = f.evidence.get("chance")
    if chance is not None:
        words.append(f"the chance of that without it is {f'below {TINY:g}' if chance < TINY else f'{chance:.1g}'}")
    if f.like is not None:
        words.insert(
            0,
            f"{f.like.right} of {f.like.of} findings like it ({f.like.words}) were right in the examination, so that its set is right with "
            f"probability {f.like.probability:.2f}",
        )
    share = result.calibration["family_wise"]
    words.append(f"of logs with nothing hidden, {100 * share:g} % or fewer are meant to give any finding")
    return "; ".join(words) + "."


def _else(result: Diagnosis, f: Finding) -> str:
    """Sentence on the alternatives of a finding, or on the next best cause."""
    if f.alternatives:
        return (
            f"the log does not tell it from {', '.join(f.alternatives)}; among them it has the weight {f.confidence:.2f}. Take the set for the finding, "
            "not its first name: the interval is that of the first name without the others, and causes of one set may share in any parts what the log shows."
        )
    # A fall under the noise of another round is no share of this one's.
    near = [r for r in result.rejected if r.full is not None and 0.0 < _share(r.full) < 1.0]
    near = sorted(near, key=lambda r: -_share(r.full))[:1]
    if not near:
        return "no other cause of the catalogue comes near."
    return (
        f"no other cause of the catalogue explains the log as well; the next best in its place, {near[0].effect}, explains "
        f"{100 * _share(near[0].full):.0f} % of the fall of chi²."
    )


def _share(full: tuple[float, float] | None) -> float:
    """Share of a finding's fall of chi-squared that a candidate reaches in its place."""
    return 0.0 if full is None or full[1] <= 0 else max(full[0], 0.0) / full[1]


def _next(result: Diagnosis, f: Finding, effect: Effect) -> str:
    """Sentences on the next step after a finding."""
    words = []
    if f.alternatives:
        words.append(
            f"to separate them: {f.separate_by}; ivsid isolability says which manoeuvre does most in your programme."
        )
    elif effect.separate:
        words.append(f"to confirm it: {effect.separate}.")
    if result.against_model:
        words.append(f"There is no model.toml: {'; '.join(result.against_model)}.")
    elif f.effect in CATALOGUE:
        words.append("model.toml has it as a term; ivsid identify with that file gives a proved interval.")
    else:
        words.append("model.toml holds it with its numbers, for simulate, identify, validate and diagnose.")
    return " ".join(words)


def _unknown(f: Finding, seen: Evidence | None) -> list[str]:
    """Paragraphs of an ``unknown``."""
    words = [f"Unknown: {f.description}."]
    if f.like is not None:
        words.append(
            f"How sure: something was hidden in {f.like.right} of {f.like.of} logs of the examination that ended so; probability {f.like.probability:.2f}."
        )
    if seen is not None:
        words.append(
            f"How much: in {seen.channel} {seen.rms[1]:.3g} {seen.unit} (rms below {BAND:g} Hz) are missing with everything that was found; "
            f"they go with {seen.quantity}."
        )
    words.append(
        "What next: look at the figure for the shape of what is missing; a cause of your own can join the catalogue (docs: An effect of your own). Until it "
        "has a name, do not trust the parameters of that channel."
    )
    return words


def worth(gain: Gain) -> list[tuple[str, str, float, float, tuple[float, float] | None, str]]:
    """Gain of the extended model on the other log, quantity by quantity.

    Args:
        gain: of the diagnosis.

    Returns:
        Quantity, unit, error before, error after, 95 % interval of before over after (None without one), and the change in words.
    """
    return [
        (*_WHAT[name], before, after, gain.factors.get(name), _change(gain, name, before, after))
        for name, (before, after) in gain.errors.items()
    ]


def diverging(gain: Gain) -> str:
    """Sentence on the models whose simulation of the other log diverges; empty if none does."""
    before, after = gain.diverges
    if not gain.extended and before is not None:
        return f"The simulation of {gain.log} diverges from t = {before:.6g} s on."
    names = (("plain", before), ("extended", after))
    told = [f"of the {name} model from t = {since:.6g} s on" for name, since in names if since is not None]
    if not told:
        return ""
    return f"The simulation of {gain.log} diverges: {' and '.join(told)}. What diverges has no error, so no factor is told."


def lost(gain: Gain, beside: Gain | None = None) -> str:
    """Sentences on the quantities in which the extended model is worse on the other log, by more than chance; empty if there are none.

    Args:
        gain: of the extended model on the other log.
        beside: the same where both models keep the thrust errors that the first log shows, if the findings stand by it.
    """
    if not gain.losses:
        return ""
    said = (
        f"On {gain.log} the extended model is worse than the one before it in {', '.join(_WHAT[k][0] for k in gain.losses)}, by more than chance "
        f"({100 * LEVEL:g} % over all quantities): what the first log taught does not carry over to this motion, so trust it for motion "
        "like the first log's alone, and identify on both logs before you use it elsewhere."
    )
    if beside is None:
        return said
    still = ", ".join(
        f"{_WHAT[k][0]} (by a factor of {1.0 / max(beside.interval[k][1], 1e-12):.2g} or more)" for k in beside.losses
    )
    return (
        f"{said} The findings stand all the same: with the thrust errors that the first log shows in both models, the extended one is "
        f"{f'worse in {still} alone, which two logs may differ by' if still else 'worse in nothing'}. The drags of the model before it may hold such errors."
    )


def grown(gain: Gain) -> str:
    """Sentence on errors on the other log that are larger by a quarter with the extended model and no more than chance may make; empty without one."""
    found = [
        f"{_WHAT[k][0]} ({gain.errors[k][0]:.3g} {_WHAT[k][1]} before, {gain.errors[k][1]:.3g} after)"
        for k in gain.grown
        if k not in gain.losses
    ]
    if not found:
        return ""
    return (
        f"On {gain.log} the error with the extended model is larger by a quarter or more in {', '.join(found)}; its windows differ too much to tell that "
        "from chance, so compare both models on another log before you use it."
    )


def _change(gain: Gain, name: str, before: float, after: float) -> str:
    """Change of an error in words; which model diverges, where one does."""
    if not gain.extended:
        return "unchanged" if gain.diverges[0] is None else "diverges"
    names = [n for n, since in zip(("plain", "extended"), gain.diverges, strict=True) if since is not None]
    if names:
        return f"not compared: the {' and the '.join(names)} model diverge{'' if len(names) > 1 else 's'}"
    return _verdict(before, after, gain.interval.get(name))


def _verdict(before: float, after: float, interval: tuple[float, float] | None) -> str:
    """Change of an error in words."""
    if before == after:
        return "unchanged"
    if interval is None:
        return "better" if after < before else "worse"
    low, high = interval
    if low > 1:
        return f"better, by a factor of {low:.3g} to {high:.3g}"
    if high < 1:
        # The reciprocal is the factor by which the error has grown.
        return f"WORSE, by a factor of {1 / high:.3g} to {1 / max(low, 1e-12):.3g}"
    return "no change that this log can tell"
