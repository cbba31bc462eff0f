"""A log as a least-squares problem: all that stays the same while hypotheses are compared on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import Gram, gram
from ivsid.diagnosis.estimation.declared_errors import nuisances
from ivsid.diagnosis.estimation.noise import Noise
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates

Array = NDArray[np.float64]
# Ids of causes, the only thruster of each or None, and their numbers.
Edges: TypeAlias = "frozenset[tuple[str, str | None, tuple[float, ...]]]"


@dataclass(frozen=True)
class Problem:
    """What of a log does not change while hypotheses are compared.

    Attributes:
        noise: filters and whitening.
        fixed: values of parameters that are not fitted, by id.
        declared: signatures of the declared errors over the whole log, whitened; they hardly depend on the hypothesis, and are made once for many.
        edges: the causes at whose edges they end, with their thrusters and numbers: below a dead band and above a cap a thrust has no error.
    """

    noise: Noise
    fixed: Mapping[str, float]
    declared: Gram
    edges: Edges = frozenset()

    @classmethod
    def at(cls, noise: Noise, fixed: Mapping[str, float], states: FilteredStates) -> Self:
        """The problem with the signatures of the declared errors at these states."""
        predictor = noise.predictor
        none = np.zeros((len(predictor.labels), predictor.log.n))
        declared = gram(nuisances(Signatures(predictor, states)), none, noise, states.h).whole()
        return cls(noise, fixed, declared, _edges(states.h))

    def under(self, states: FilteredStates) -> Self:
        """The problem of a hypothesis: with declared errors that end at its own edges.

        Errors that jump where a dead band ends would let a model without the band follow it, and one with it lack what they took.
        """
        if _edges(states.h) == self.edges:
            return self
        return self.at(self.noise, self.fixed, self.noise.predictor.settle(states, 2))

    @property
    def count(self) -> int:
        """Number of the declared errors; they stand first among the columns of a fit."""
        return len(self.declared.names)

    def bare(self, h: Hypothesis, errors: Array) -> Gram:
        """Cross-products of the declared errors alone, with the part of each that the hypothesis holds.

        Args:
            h: the hypothesis.
            errors: its prediction errors, shape (rows, n).
        """
        g = self.declared.of(errors)
        return replace(g, centre=np.array([h.declared_errors.get(n, 0.0) for n in g.names]) * g.unit)

    def beside(self, g: Gram, states: FilteredStates, *, sums: bool = True) -> Gram:
        """With the signatures of the fitted parameters at these states; with ``sums`` the columns themselves are not kept."""
        fitted = Signatures(self.noise.predictor, states).fitted(self.fixed)
        return g.extended(fitted.names, fitted.arrays, sums=sums) if fitted.names else g

    def gram(self, states: FilteredStates, *, sums: bool = True) -> Gram:
        """Cross-products of the declared errors, then of the fitted parameters, at a hypothesis."""
        return self.beside(self.bare(states.h, self.noise.predictor.errors(states)), states, sums=sums)

    def chi2(self, states: FilteredStates) -> float:
        """Chi-squared of the log under a hypothesis, with the declared errors fitted beside it."""
        g = self.gram(states)
        return Projection(g, range(len(g.names))).chi2


def _edges(h: Hypothesis) -> Edges:
    """The causes of a hypothesis that have an edge at one demand or one thrust."""
    return frozenset((g.effect.id, g.thruster, tuple(g.values)) for g in h.given if g.effect.form.edged)
