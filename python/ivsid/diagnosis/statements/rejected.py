"""Rejected candidates, ranked, each with the reason in a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.null.family_wise import FAINT
from ivsid.diagnosis.null.thresholds import HIGH_SIDE
from ivsid.diagnosis.null.visibility import VISIBLE, Visibility
from ivsid.diagnosis.selection.rivals import MARGIN
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.statements.findings import Finding

# A candidate that keeps less than this share of its fall of chi-squared beside the findings is explained by them.
# Source: measured: make constants
EXPLAINED: Final = 0.2


@dataclass(frozen=True)
class Rejected:
    """A candidate that is no finding.

    Attributes:
        effect: id of the effect.
        fall: fall of chi-squared by its signature, alone beside the plain model.
        numbers: number of its parameters.
        chance: probability of such a fall without the effect.
        full: its fall in a full fit in the place of a finding, and the fall of that finding; None without a full fit.
        beside: its fall beside all findings; None if it was not scored there.
        reason: sentence.
    """

    effect: str
    fall: float
    numbers: int
    chance: float
    full: tuple[float, float] | None
    beside: float | None
    reason: str

    def record(self) -> dict[str, object]:
        """An entry of ``rejected`` in result.json."""
        return {
            "effect": self.effect,
            "gain": self.fall,
            "numbers": self.numbers,
            "chance": self.chance,
            "full_fit": None if self.full is None else list(self.full),
            "beside_findings": self.beside,
            "reason": self.reason,
        }


def rejected(
    findings: Sequence[Finding], selection: Selection, visible: Mapping[str, Visibility], threshold: float
) -> tuple[Rejected, ...]:
    """Candidates of the first round that no finding names, the best first.

    Args:
        findings: of the diagnosis.
        selection: behind them.
        visible: visibility by id.
        threshold: of the chance.
    """
    named = {i for f in findings for i in (f.effect, *f.alternatives)}
    beside = {s.id: s.fall for s in selection.leftover}
    full: dict[str, tuple[float, float, str]] = {}
    for one in selection.found:
        for id_, fall in one.rejected:
            if id_ not in full or fall > full[id_][0]:
                full[id_] = (fall, one.fall, one.id)
    made = []
    for s in selection.screened:
        if s.id in named:
            continue
        tried = full.get(s.id)
        if tried is not None and tried[0] == s.fall:
            # Candidates without a full fit are listed with their score of the first round.
            tried = None
        left = beside.get(s.id)
        made.append(
            Rejected(
                s.id,
                s.fall,
                s.count,
                s.chance,
                None if tried is None else tried[:2],
                left,
                _why(s, visible.get(s.id), threshold, tried, left, bool(findings)),
            )
        )
    return tuple(made)


def _why(
    s: Scored,
    seen: Visibility | None,
    threshold: float,
    tried: tuple[float, float, str] | None,
    left: float | None,
    found: bool,
) -> str:
    """Reason in a sentence: the first of the conditions of a finding that the candidate fails."""
    if seen is not None and seen.z < VISIBLE:
        return f"this log does not test it: at its typical size it would stand out by {seen.z:.1f} standard deviations, and {VISIBLE:g} are needed"
    if seen is not None and seen.blind:
        return "this log does not test it: its signature is mostly made of the sensors' own errors"
    if not s.physical:
        return "its sign is one that the cause cannot have"
    # The test divides the fall by the same factor.
    taken = s.fall / HIGH_SIDE
    if s.fall < FAINT:
        return f"no more than chance: a fall of chi² of {s.fall:.1f} is less than the {FAINT:.0f} that count"
    if found and left is not None and left < EXPLAINED * s.fall:
        return f"explained by what was found: beside it {max(left, 0.0):.1f} of its {s.fall:.0f} in chi² are left"
    if tried is not None and tried[1] - tried[0] > MARGIN:
        return f"fitted in full in the place of {tried[2]} it explains {tried[0]:.0f} in chi² against {tried[1]:.0f}; within {MARGIN:.0f} it would be a rival"
    if s.chance > threshold or _chance(s, taken) > threshold:
        return f"no more than chance: a fall of chi² of {s.fall:.1f} has probability {_chance(s, taken):.1g}, and {threshold:.1g} is the limit"
    return "the half-minutes of the log do not agree on it, or its size is none that it can have"


def _chance(s: Scored, fall: float) -> float:
    """Chance of another fall of chi-squared of the same candidate."""
    return replace(s, fall=fall).chance
