"""First screen of a diagnosis: the verdict, its causes with their sizes, how much and how sure, and what to sail next."""

from __future__ import annotations

import math
import re
from typing import Final

from ivsid import diagnosis
from ivsid.diagnosis import Bound, Diagnosis, Finding
from ivsid.effects import CATALOGUE, EFFECTS
from ivsid.intervals import shown
from ivsid.report.page import Card, First

# Digits of a number on the first screen.
# Source: definition: no interval is read off more finely
DIGITS: Final = 4
# Remedies that are named where nothing was found.
# Source: definition: what a day on the water has room for
REMEDIES: Final = 3
TONES: Final = {"adequate": "good", "wrong": "bad", "unknown": "open"}


def first_screen(result: Diagnosis) -> First:
    """The verdict, the causes and the next steps of a diagnosis, for a reader who opens nothing else."""
    return First(
        _verdict(result),
        TONES[result.verdict],
        " ".join(_follows(result)),
        tuple(_card(f, k) for k, f in enumerate(result.findings, start=1)),
        tuple(_following(result)),
        tuple(worse(result)),
    )


def worse(result: Diagnosis) -> list[str]:
    """What is worse on the other log, or diverges: it stands first."""
    gain = result.gain
    return [w for w in (diagnosis.diverging(gain), diagnosis.lost(gain, result.beside), diagnosis.grown(gain)) if w]


def best_gain(result: Diagnosis) -> str:
    """The clearest gain on the other log in a sentence; empty without one, and where another error grows by a quarter."""
    if result.gain.grown:
        return ""
    rows = [q for q in diagnosis.worth(result.gain) if q[4] is not None and q[4][0] > 1.0]
    if not rows:
        return ""
    what, unit, before, after, interval, _ = max(rows, key=lambda q: q[4][0] if q[4] else 0.0)
    assert interval is not None
    return (
        f"With the extended model the error on {result.gain.log} falls from {before:.3g} to {after:.3g} {unit} ({what}): better by a factor of "
        f"{interval[0]:.3g} to {interval[1]:.3g}."
    )


def size(b: Bound) -> str:
    """An interval in words, its ends rounded outward, or the thruster that an index stands for; an interval without ends has no bound."""
    if b.stands_for:
        return b.stands_for
    if not (math.isfinite(b.lower) or math.isfinite(b.upper)):
        return "no bound"
    low, high = shown(b.lower, b.upper, DIGITS)[1:-1].split(", ")
    unit = "" if b.unit == "1" else f" {b.unit}"
    return f"{low} to {high}{unit} ({'proved' if b.guaranteed else 'statistical'})"


def _verdict(result: Diagnosis) -> str:
    named = [f.effect for f in result.findings if f.effect != "unknown"]
    if result.verdict == "adequate":
        return "The simulation is adequate for what this log could show"
    if not named:
        return "Something is wrong that no known cause explains"
    more = " and something that no known cause explains" if len(named) < len(result.findings) else ""
    return f"The simulation is wrong: {', '.join(named)}{more}"


def _follows(result: Diagnosis) -> list[str]:
    """What the summary, which stands above, does not say."""
    words = []
    tested = sum(v.tested for v in result.visible.values())
    if result.verdict == "adequate":
        words.append(
            f"{tested} causes of typical size would have shown in {result.inputs[1][0]}, and none did beyond the declared errors; "
            f"{len(result.not_tested)} could not be tested with it."
        )
    elif all(f.effect == "unknown" for f in result.findings):
        rest = ", ".join(
            f"{k} {before:.3g} {'N m' if k == 'N' else 'N'}" for k, (before, _) in result.gain.force_rms.items()
        )
        words.append(f"The model lacks these forces on {result.gain.log}: {rest} (rms).")
    elif not best_gain(result):
        words.append(f"{result.gain.log} does not tell that the extended model is better there.")
    return words


def _card(f: Finding, k: int) -> Card:
    unknown = f.effect == "unknown"
    facts = [
        ("size" if len(f.parameters) == 1 else name.removeprefix(f"{f.effect}."), size(b))
        for name, b in f.parameters.items()
    ]
    if not unknown:
        facts.append(("of the position error after 60 s", _share(f)))
    facts.append(("how sure", _sure(f)))
    if f.alternatives:
        facts.append(("could also be", f"{', '.join(f.alternatives)} (weight of the first name {f.confidence:.2f})"))
    # The numbers of the description stand below, beside the finding.
    words = re.sub(r" \([^()]*\)", "", f.description) if unknown else EFFECTS[f.effect].cause
    return Card(f.name, words[:1].upper() + words[1:] + ".", tuple(facts), f"finding-{k}")


def _share(f: Finding) -> str:
    m = f.matters
    if m is None:
        return "not known: the other log has no position, or is too short"
    distances = f"{m.without:.3g} m off without it, {m.held:.3g} m with it"
    if not m.told:
        return f"the other log cannot tell ({distances})"
    if m.share <= 0:
        return f"none: the model without it runs closer ({distances})"
    return f"{100 * max(m.interval[0], 0.0):.0f} to {100 * m.interval[1]:.0f} % of its square explained ({distances})"


def _sure(f: Finding) -> str:
    if f.like is None:
        return "no finding of the examination is like it"
    what = "had a hidden cause" if f.effect == "unknown" else "were right"
    return f"probability {f.like.probability:.2f}: {f.like.right} of {f.like.of} findings like it {what}"


def _following(result: Diagnosis) -> list[str]:
    words = []
    for f in result.findings:
        if f.effect == "unknown":
            words.append(
                f"Look at what is missing, below, and do not trust the parameters of {f.evidence.get('channel') or 'its channel'} until it has a name."
            )
        elif f.alternatives:
            words.append(
                f"Sail to tell {f.effect} from {', '.join(f.alternatives)}: {f.separate_by or 'see ivsid isolability'}."
            )
        elif how := EFFECTS[f.effect].separate:
            words.append(f"Sail to confirm {f.effect}: {how}.")
    if result.verdict == "adequate":
        lacking = [q for q in result.not_tested if q["needs"]]
        words += [f"To test {q['effect']} as well: {q['needs']}." for q in lacking[:REMEDIES]]
    elif result.against_model:
        words.append(f"No model.toml is written: {'; '.join(result.against_model)}.")
    elif any(f.effect in CATALOGUE for f in result.findings):
        words.append("Run ivsid identify with model.toml: it gives proved intervals of the terms.")
    else:
        words.append("Use model.toml beside this page: the vehicle file with the causes and their numbers.")
    return words
