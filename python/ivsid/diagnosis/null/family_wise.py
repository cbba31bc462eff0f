"""Family-wise test: the causes that keep every rule of the screening, at one threshold over all of them.

Source: docs/theory.md, "Diagnosis"; docs/rules.md.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.rule import Refusal, first_refusal
from ivsid.diagnosis.null.screening import SCREENING, WORST, Case, chance, chance_beside
from ivsid.diagnosis.null.thresholds import Calibration
from ivsid.diagnosis.null.visibility import Visibility


@dataclass(frozen=True)
class Screened:
    """Outcome of a screening.

    Attributes:
        round: fit and scores.
        passed: causes that keep every rule, in the given order, with what declared errors may make of their scores.
        refused: refusals of the others, by id.
    """

    round: Round
    passed: tuple[Scored, ...]
    refused: Mapping[str, Refusal]

    def measured(self, s: Scored) -> Scored:
        """A cause with what declared errors may make of its score, also if it did not pass."""
        return next((p for p in self.passed if p.id == s.id), None) or self._held(s)

    def _held(self, s: Scored) -> Scored:
        s = self.round.in_box(s)
        return replace(s, lost=self.round.lost(s))


@dataclass(frozen=True)
class Threshold:
    """Family-wise test of a log: every family against one threshold.

    Attributes:
        calibration: the threshold of this programme.
        seen: visibility by id.
        barred: causes that are not asked, with the reason, by id.
    """

    calibration: Calibration
    seen: Mapping[str, Visibility]
    barred: Mapping[str, Refusal] = field(default_factory=dict)

    @property
    def visible(self) -> frozenset[str]:
        """Ids that the log can show."""
        return frozenset(i for i, v in self.seen.items() if v.tested)

    def __call__(self, fit: Fit, scored: Sequence[Scored], beside: Iterable[str] = ()) -> Screened:
        """The screening of causes by their scores.

        Args:
            fit: of the model without them.
            scored: causes with their scores.
            beside: causes that the model holds already.
        """
        return self.screened(Round(fit, scored, self.calibration.chance, self.seen), beside)

    def screened(self, here: Round, beside: Iterable[str] = ()) -> Screened:
        """The screening of a round.

        Args:
            here: fit and scores.
            beside: causes that the model holds already.
        """
        passed, refused, stands = [], dict(self.barred), tuple(beside)
        for s in map(here.in_box, (q for q in here.scored if q.id not in self.barred)):
            case = Case(here, s)
            refusal = first_refusal(SCREENING, case, stands)
            if refusal is None:
                passed.append(replace(s, lost=case.lost))
            else:
                refused[s.id] = refusal
        return Screened(here, tuple(passed), refused)

    def eligible(self, s: Scored) -> bool:
        """Whether a family may stand among alternatives; a blind family and a barred one may not."""
        return s.id not in self.barred and (s.id not in self.seen or not self.seen[s.id].blind)

    def chance(self, s: Scored, fall: float) -> float:
        """Probability of a family's fall of chi-squared in a full fit.

        Beside the worst declared errors inside their bounds it has to be below ``WORST``, and counts in that proportion to the threshold.
        """
        # Beside errors that keep their bounds a full fit explains more in the same proportion as the score does.
        whole = fall * s.shown / s.fall if s.fall > 0 else fall
        return max(chance(replace(s, fall=whole, boxed=0.0)), chance_beside(s, whole) * self.level / WORST)

    @property
    def level(self) -> float:
        """The threshold of the chance."""
        return self.calibration.chance
