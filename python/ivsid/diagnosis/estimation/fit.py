"""A hypothesis fitted to a log, with all signatures around it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from ivsid.diagnosis.estimation.candidate_columns import candidate_columns
from ivsid.diagnosis.estimation.cross_products import Gram, gram
from ivsid.diagnosis.estimation.declared_errors import nuisances
from ivsid.diagnosis.estimation.kinds.candidate import Candidate
from ivsid.diagnosis.estimation.noise import Noise
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.filtered_states import FilteredStates


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis with all signatures around it.

    Attributes:
        noise: filters and whitening.
        states: of the hypothesis with its numbers.
        signatures: at the hypothesis, for further columns.
        gram: cross-products of everything below.
        base: columns that are fitted: free parameters, then declared errors.
        free: names of the free parameters.
        candidates: effects that the log can show and that the hypothesis lacks, with the claims of the vehicle file.
        refused: reasons why the log cannot show an effect, by id.
        fixed: values of parameters that are not fitted, by id: claims, and those that only axes that are left out determine.
    """

    noise: Noise
    states: FilteredStates
    signatures: Signatures
    gram: Gram
    base: tuple[int, ...]
    free: tuple[str, ...]
    candidates: tuple[Candidate, ...]
    refused: Mapping[str, str]
    fixed: Mapping[str, float]

    @property
    def h(self) -> Hypothesis:
        """The hypothesis with its numbers."""
        return self.states.h

    @cached_property
    def projection(self) -> Projection:
        """Least squares on the base, over the whole log."""
        return Projection(self.gram, self.base)

    @cached_property
    def bare(self) -> Gram:
        """Cross-products of the base alone, over the whole log as one block."""
        return self.gram.only(self.base).whole()

    @cached_property
    def problem(self) -> Problem:
        """The log as it is for other hypotheses, with the signatures of the declared errors at this one."""
        return Problem.at(self.noise, self.fixed, self.states)


# A search adds the columns of waves, tethers and steps that explain most.
Search: TypeAlias = Callable[[Fit], Fit]


def survey(noise: Noise, states: FilteredStates, fixed: Mapping[str, float], only: frozenset[str] | None = None) -> Fit:
    """All signatures at a fitted hypothesis, whitened and crossed.

    Args:
        noise: of the log.
        states: of the hypothesis.
        fixed: values of parameters that are not fitted, by id.
        only: ids of effects whose signatures are made; all by default.
    """
    signatures = Signatures(noise.predictor, states)
    fitted, stated = signatures.fitted(fixed), nuisances(signatures)
    extra, candidates, refused = candidate_columns(signatures, only)
    g = gram(fitted.joined(stated, extra), noise.predictor.errors(states), noise, states.h)
    return Fit(
        noise,
        states,
        signatures,
        g,
        tuple(range(len(fitted.names) + len(stated.names))),
        tuple(fitted.names),
        tuple(candidates),
        dict(refused),
        dict(fixed),
    )
