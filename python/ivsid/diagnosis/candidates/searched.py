"""Candidates whose columns are found by a search in the errors that the base leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.kinds.searched import SearchedCandidate
from ivsid.diagnosis.estimation.projection import Projection

Array = NDArray[np.float64]


def with_searched(fit: Fit, p: Projection) -> tuple[Fit, list[Scored]]:
    """The fit with exact columns of the best few values of each searched cause, and the scores of these causes.

    Args:
        fit: of the model.
        p: least squares beside which causes are scored.
    """
    wanted = [c for c in fit.candidates if isinstance(c, SearchedCandidate)]
    if not wanted:
        return fit, []
    # The transposes of whitening and filters take the errors that the base leaves back to the accelerations that would explain them.
    g, predictor = fit.gram, fit.noise.predictor
    n, rows = predictor.log.n, len(predictor.labels)
    left = g.left(p.base, p.coefficients)
    errors = np.zeros((rows, n))
    errors[:, : left.shape[1]] = left
    back = fit.signatures.backward(_unwhiten(fit, errors))
    names: list[str] = []
    arrays: list[Array] = []
    plans: list[tuple[SearchedCandidate, list[tuple[tuple[float, ...], tuple[int, ...]]], float]] = []
    for candidate in wanted:
        values, looks = candidate.search(fit.signatures, fit.noise.whitening, back)
        tried = []
        for value in values:
            first = len(g.names) + len(names)
            for j, x in enumerate(candidate.exact(fit.signatures, value)):
                names.append(f"{candidate.id}@{value!r}.{j}")
                arrays.append(x)
            tried.append((value, tuple(range(first, len(g.names) + len(names)))))
        plans.append((candidate, tried, looks))
    if not names:
        return fit, []
    fit = replace(fit, gram=g.extended(names, arrays))
    wide = Projection(fit.gram, p.base)
    return fit, [s for c, tried, looks in plans if (s := c.best(wide, tried, looks)) is not None]


def _unwhiten(fit: Fit, errors: Array) -> Array:
    """The transpose of the whitening, applied to errors of shape (rows, n)."""
    out = np.zeros_like(errors)
    for rows, taps in zip(fit.noise.whitening.groups, fit.noise.whitening.taps, strict=True):
        here = errors[list(rows)]
        for lag, tap in enumerate(taps):
            part = tap.T @ here
            if lag:
                part = np.concatenate([part[:, lag:], np.zeros((len(rows), lag))], axis=1)
            out[list(rows)] += part
    return out
