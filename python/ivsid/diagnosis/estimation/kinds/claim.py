"""Claims: numbers that the vehicle file states, and that are fitted after all if the log contradicts them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.kinds.candidate import Candidate, Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import EFFECTS, Effect


@dataclass(frozen=True)
class ClaimCandidate(Candidate):
    """A number of the vehicle file that may be wrong."""

    @classmethod
    def made(cls, s: Signatures, effect: Effect, out: Columns) -> Sequence[Self]:
        """The candidate of a term whose parameter is claimed."""
        term = next(t for t in s.h.terms if t.id == effect.id)
        out.add(term.id, s.term(term))
        return [cls(effect, ((term.id,),))]

    @classmethod
    def all(cls, s: Signatures, out: Columns) -> list[Candidate]:
        """The candidates of all claims of the vehicle file that still stand, whose columns are added to ``out``."""
        claimed = s.predictor.vehicle.model.values
        ids = [t.id for t in s.h.terms if t.id in claimed and t.id not in s.h.freed and t.id in EFFECTS]
        return [c for id_ in ids for c in cls.made(s, EFFECTS[id_], out)]

    @property
    def sided(self) -> bool:
        """A claim may be too large as well as too small."""
        return False

    def score(self, p: Projection, s: Signatures) -> Scored:
        """The claim with the change of its number by least squares."""
        at = p.g.at(self.variants[0])
        theta, fall = p.solve(at)
        real = tuple((theta / p.g.unit[at]).tolist())
        value = float(s.h.values[self.id]) + real[0]
        return Scored(self, fall, 1, 1.0, tuple(at), real, (value,), value > 0)

    def share(self, _values: Sequence[float], _mass: float) -> float:
        """A claim has no typical error."""
        return 1.0

    def adopted(self, h: Hypothesis, values: Sequence[float], _s: Signatures) -> Hypothesis:
        """The hypothesis with the number free."""
        return replace(h, values={**h.values, self.id: values[0]}, freed=h.freed | {self.id})
