"""A hypothesis fitted to a log, with all signatures around it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.candidate_columns import candidate_columns
from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.declared_errors import nuisances
from ivsid.diagnosis.estimation.gauss_newton import DeclaredColumns, declared_columns, small_gram
from ivsid.diagnosis.estimation.kinds.candidate import Candidate
from ivsid.diagnosis.estimation.projection import Gram, Projection, gram
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.states import FilteredStates

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Noise:
    """The noise of a log, as it was learnt.

    Attributes:
        predictor: the log with its filters.
        whitening: of its prediction errors.
        good: samples that count, shape (n,).
        left_out: indices of the axes that are left out of the fit.
    """

    predictor: Predictor
    whitening: Whitening
    good: NDArray[np.bool_]
    left_out: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis with all signatures around it.

    Attributes:
        noise: filters and whitening.
        h: the hypothesis with its numbers.
        states: its states.
        signatures: at the hypothesis, for further columns.
        gram: cross-products of everything below.
        base: columns that are fitted: free parameters, then declared errors.
        free: names of the free parameters.
        candidates: effects that the log can show and that the hypothesis lacks, with the claims of the vehicle file.
        refused: reasons why the log cannot show an effect, by id.
        fixed: values of parameters that are not fitted, by id: claims, and those that only axes that are left out determine.
    """

    noise: Noise
    h: Hypothesis
    states: FilteredStates
    signatures: Signatures
    gram: Gram
    base: tuple[int, ...]
    free: tuple[str, ...]
    candidates: tuple[Candidate, ...]
    refused: Mapping[str, str]
    fixed: Mapping[str, float]

    @cached_property
    def projection(self) -> Projection:
        """Least squares on the base, over the whole log."""
        return Projection(self.gram, self.base)


def _joined(*parts: Columns) -> Columns:
    out = Columns()
    for part in parts:
        for name, array in zip(part.names, part.arrays, strict=True):
            out.add(name, array, part.prior.get(name))
    return out


def crossed(
    noise: Noise, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float], known: DeclaredColumns
) -> Gram:
    """Cross-products of declared errors and fitted parameters, with the columns themselves."""
    errors = noise.predictor.errors(h, states)
    return small_gram(noise.predictor, h, states, fixed, known, errors, sums=False)


def fitted_gram(noise: Noise, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float]) -> Gram:
    """Cross-products of declared errors and fitted parameters, as sums over the log."""
    known = declared_columns(noise.predictor, h, states, noise.whitening, noise.good)
    errors = noise.predictor.errors(h, states)
    return small_gram(noise.predictor, h, states, fixed, known, errors)


def chi2_of(
    noise: Noise, h: Hypothesis, states: FilteredStates, fixed: Mapping[str, float], known: DeclaredColumns
) -> float:
    """Chi-squared of the log under a hypothesis, with the declared errors fitted beside it."""
    errors = noise.predictor.errors(h, states)
    g = small_gram(noise.predictor, h, states, fixed, known, errors)
    return Projection(g, range(len(g.names))).chi2


def survey(
    noise: Noise,
    h: Hypothesis,
    states: FilteredStates,
    claimed: Mapping[str, float],
    only: frozenset[str] | None = None,
) -> Fit:
    """All signatures at a fitted hypothesis, whitened and crossed.

    Args:
        noise: of the log.
        h: the hypothesis.
        states: its states.
        claimed: values of parameters that are not fitted, by id.
        only: ids of effects whose signatures are made; all by default.
    """
    predictor = noise.predictor
    signatures = Signatures(predictor, h, states)
    fitted, stated = signatures.fitted(claimed), nuisances(signatures)
    extra, candidates, refused = candidate_columns(signatures, only)
    every = _joined(fitted, stated, extra)
    errors = predictor.errors(h, states)
    g = gram(
        every.names, every.arrays, errors, noise.whitening, noise.good, predictor.log.h, every.prior, h.declared_errors
    )
    count = len(fitted.names) + len(stated.names)
    return Fit(
        noise,
        h,
        states,
        signatures,
        g,
        tuple(range(count)),
        tuple(fitted.names),
        tuple(candidates),
        dict(refused),
        dict(claimed),
    )
