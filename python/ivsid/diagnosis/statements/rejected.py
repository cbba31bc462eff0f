"""Rejected candidates, ranked, each with the rule that refused it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.statements.findings import Finding


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
        refusal: by the first rule that it did not keep.
    """

    effect: str
    fall: float
    numbers: int
    chance: float
    full: tuple[float, float] | None
    beside: float | None
    refusal: Refusal

    @property
    def reason(self) -> str:
        """The refusal in a sentence, with what stood beside the candidate."""
        others = " and ".join(self.refusal.beside)
        return f"beside {others}: {self.refusal.sentence}" if others else self.refusal.sentence

    def record(self) -> dict[str, object]:
        """An entry of ``rejected`` in result.json."""
        return {
            "effect": self.effect,
            "gain": self.fall,
            "numbers": self.numbers,
            "chance": self.chance,
            "full_fit": None if self.full is None else list(self.full),
            "beside_findings": self.beside,
            "rule": self.refusal.rule,
            "statistic": self.refusal.value,
            "limit": self.refusal.limit,
            "reason": self.reason,
        }


def rejected(
    findings: Sequence[Finding], selection: Selection, withdrawn: Mapping[str, Refusal]
) -> tuple[Rejected, ...]:
    """Candidates of the first round that no finding names, the best first.

    Args:
        findings: of the diagnosis.
        selection: behind them.
        withdrawn: refusals of causes that the extended model holds and that are no findings, by id.
    """
    named = {i for f in findings for i in (f.effect, *f.alternatives)}
    beside = {s.id: s.fall for s in selection.leftover}
    full: dict[str, tuple[float, float]] = {}
    for one in selection.found:
        for id_, fall in one.tried.items():
            if id_ not in full or fall > full[id_][0]:
                full[id_] = (fall, one.fall)
    said = {**selection.refused, **withdrawn}
    return tuple(
        Rejected(s.id, s.fall, s.count, s.chance, full.get(s.id), beside.get(s.id), said[s.id])
        for s in selection.screened
        if s.id not in named
    )
