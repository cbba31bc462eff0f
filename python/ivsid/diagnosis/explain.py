"""A diagnosis in words, made from its numbers."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

from ivsid.diagnosis.diagnose import Diagnosis, Finding
from ivsid.diagnosis.families import Scored
from ivsid.effects import EFFECTS


def explain(result: Diagnosis) -> list[str]:
    """A paragraph for each finding: what, how much, how sure, what else, what next."""
    return [_unknown(f) if f.effect == "unknown" else _paragraph(result, f) for f in result.findings]


def _outward(x: float, rounding: str) -> str:
    """Four digits that the interval does not lose anything by."""
    return f"{float(Context(prec=4, rounding=rounding).create_decimal(Decimal(x))):g}"


def _paragraph(result: Diagnosis, f: Finding) -> str:
    effect = EFFECTS[f.effect]
    words = [f"{f.effect}: {effect.cause}."]
    sizes = [
        f"{name} lies between {_outward(b.lower, ROUND_FLOOR)} and {_outward(b.upper, ROUND_CEILING)} "
        f"{b.unit if b.unit != '1' else ''}".rstrip()
        for name, b in f.parameters.items()
    ]
    if sizes:
        words.append(f"{'; '.join(sizes)}.")
    z = f.evidence.get("z", 0.0)
    words.append(
        f"It stands out by {z:.0f} standard deviations, most in {f.evidence.get('channel') or 'several channels'}."
    )
    if f.alternatives:
        words.append(f"The log does not tell it from {', '.join(f.alternatives)}. To separate them: {f.separate_by}.")
    else:
        words.append("No other cause of the catalogue explains the log as well.")
    better = [
        f"{name} by a factor of {b / a:.2f}"
        for name, (b, a) in result.gain.simulation_rms.items()
        if a > 0 and (b / a > 1.05 or b / a < 0.95)
    ]
    if better:
        words.append(f"With all findings in the model, the simulation of the other log changes in {', '.join(better)}.")
    return " ".join(words)


def _unknown(f: Finding) -> str:
    return f"Unknown: {f.description}"


def why_rejected(result: Diagnosis, s: Scored) -> str:
    """Why a candidate is no finding."""
    for f in result.findings:
        if s.id in f.alternatives:
            return f"in the set of {f.effect}"
    seen = result.visible.get(s.id)
    if seen is not None and seen.z < 8.0:
        return "this log does not test it"
    if not s.physical:
        return "its sign is not one that the cause can have"
    left = {q.id: q.gain for q in result.selection.leftover}
    if s.chance > float(result.calibration["threshold"]):
        return "no more than chance"
    if result.findings and left.get(s.id, 0.0) < 0.2 * s.gain:
        return "explained by what was found"
    return "the blocks of the log do not agree on it"
