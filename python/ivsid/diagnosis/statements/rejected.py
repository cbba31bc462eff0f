"""The candidates that are no findings, ranked, and why each is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.null.thresholds import HIGH_SIDE
from ivsid.diagnosis.null.visibility import FAINT, VISIBLE, Visibility
from ivsid.diagnosis.selection.select import MARGIN, Selection
from ivsid.diagnosis.statements.findings import Finding

# A cause keeps less than this share of its gain beside what was found: it is explained.
EXPLAINED: Final = 0.2


@dataclass(frozen=True)
class Rejected:
    """A candidate that is no finding.

    Attributes:
        effect: its id.
        fall: fall of chi^2 with it alone beside the model, by its signature.
        numbers: that were fitted for it.
        chance: of such a gain without it.
        full: its fall of chi^2 in a full fit in a finding's place, and that finding's; None where it was not fitted in full.
        beside: the fall that is left for it beside all findings; None where it was not looked for.
        reason: in a sentence.
    """

    effect: str
    fall: float
    numbers: int
    chance: float
    full: tuple[float, float] | None
    beside: float | None
    reason: str

    def record(self) -> dict[str, Any]:
        """As in result.json."""
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
    """Every candidate of the first round that no finding holds, best first."""
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
            # The score of the first round, which stands there for those that were not fitted in full.
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
    if seen is not None and seen.z < VISIBLE:
        return f"this log does not test it: at its typical size it would stand out by {seen.z:.1f} standard deviations, and 8 are needed"
    if seen is not None and seen.blind:
        return "this log does not test it: its signature is mostly made of the sensors' own errors"
    if not s.physical:
        return "its sign is one that the cause cannot have"
    # As the test takes it: on the high side.
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
    return replace(s, fall=fall).chance
