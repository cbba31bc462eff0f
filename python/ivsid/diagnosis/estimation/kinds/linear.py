"""Causes that are linear in their numbers: a column a number, the slope at none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.kinds.candidate import Candidate, Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import STEP_FROM_NONE, Signatures
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import PAPER_TERMS, PLAIN_TERMS, Effect, Given, Reading

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearCandidate(Candidate):
    """A cause that is linear in its numbers."""

    sums: ClassVar[bool] = True

    @classmethod
    def made(cls, s: Signatures, effect: Effect, out: Columns, alone: str | None = None) -> Sequence[Self]:
        """The candidate of an effect; terms have exact columns, other physics slopes at none; of one thruster alone, if one is named."""
        if effect.terms:
            for term in effect.terms:
                out.add(term.id, s.term(s.fitting(term)))
            return [cls(effect, (tuple(t.id for t in effect.terms),))]
        none = [p.none for p in effect.parameters]
        parts = Given(effect, tuple(none), alone).parts
        for j, (name, parameter) in enumerate(zip(parts, effect.parameters, strict=True)):
            step = STEP_FROM_NONE * (abs(parameter.scaled(s.predictor.vehicle.hull.mass)) or 1.0)
            values = list(none)
            values[j] += step
            out.add(name, s.whole(Given(effect, tuple(values), alone)) / step)
        return [cls(effect, (parts,), alone=alone)]

    def alone_on(self, s: Signatures, thruster: str, out: Columns) -> Sequence[Self]:
        """The same values, or slopes, of one thruster."""
        return self.made(s, self.effect, out, thruster)

    @property
    def limited(self) -> int:
        """All parameters."""
        return len(self.variants[0])

    def score(self, p: Projection, _s: Signatures) -> Scored:
        """The candidate at the coefficients of least squares."""
        at = p.g.at(self.variants[0])
        theta, fall = p.solve(at)
        real = tuple((theta / p.g.unit[at]).tolist())
        values = tuple(q.none + x for q, x in zip(self.effect.parameters, real, strict=True))
        return Scored(self, fall, len(at), 1.0, tuple(at), real, values, not self.sided or real[0] > 0)

    def shifted(self, s: Signatures) -> list[tuple[str, Array]]:
        """The columns of terms and of sensors; those of the heading are no products of noisy velocities."""
        if isinstance(self.effect.acts, Reading):
            return list(zip(self.variants[0], s.reading(self.effect), strict=True))
        if "psi" in self.effect.needs:
            return []
        return [(t.id, s.term(s.fitting(t))) for t in self.effect.terms]

    def adopted(self, h: Hypothesis, values: Sequence[float], s: Signatures) -> Hypothesis:
        """The hypothesis with the effect in it, or with its terms in the model."""
        if not self.effect.terms:
            return super().adopted(h, values, s)
        terms, numbers = list(h.terms), dict(h.values)
        other = self.effect.shares
        for term, value in zip(self.effect.terms, values, strict=True):
            own = value
            if any(t.id == other and t in PAPER_TERMS for t in terms):
                # A value of its own ends the sharing of the paper's column.
                plain = {t.id: t for t in PLAIN_TERMS}
                terms = [plain[other] if t.id == other else t for t in terms]
                own += numbers[other]
            terms.append(s.fitting(term))
            numbers[term.id] = float(own)
        return replace(h, terms=tuple(terms), values=numbers)
