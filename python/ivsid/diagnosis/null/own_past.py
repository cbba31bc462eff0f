"""Fall of chi-squared of a cause beside the log's own past errors.

States that an ambient force pushes answer to past errors, so the signature of a delay, a lag or a drag is partly a filter of them. The whitening is
learnt without all that the catalogue explains. Where the noise has a colour that its few coefficients leave, a cause whose signature is such a filter
stands for the coefficients that lack. It has to explain what the past errors of the same rows do not.

Source: docs/theory.md, "Own past"; Durbin, "Testing for serial correlation in least-squares regression when some of the regressors are lagged
dependent variables", Econometrica 38, 1970.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import with_family

Array = NDArray[np.float64]
# Past errors beside which a cause has to stand, in the lags of the whitening.
# Source: measured: a false delay in a swell kept a fall of 29 of 45 beside as many lags, and 7 beside twice as many; true delays keep theirs
TWICE: Final = 2
# Ridge of the products of past errors, as a share of their mean square.
# Source: geometry: ten thousand times the rounding of a double; rows without noise foretell each other
RIDGE: Final = 1e-12
# Past errors beside a row: its index, they, and the factor of their products.
Past: TypeAlias = "tuple[int, Array, tuple[Array, bool]]"


class OwnPast:
    """The base of a fit beside the log's own past errors, which all causes share.

    Args:
        fit: of the model without causes.
    """

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self._base = fit.gram.only(fit.base)

    def fall(self, s: Scored) -> float:
        """Fall of chi-squared of a cause beside the base and the past errors of the model without it.

        Args:
            s: the cause with its score.
        """
        g, at = with_family(self._base, self.fit, s)
        return Projection(self._beside(g, *self._without), range(len(self.fit.base))).solve(at)[1]

    def ratio(self, s: Scored) -> float:
        """The same where each model stands beside its own past errors: the likelihood ratio, for which the products with the base are made anew.

        A slow cause stays in the past errors of the model without it, which explain a part of it then. Neither model holds the other, so that the ratio
        may be negative.

        Args:
            s: the cause with its score.
        """
        g, at = with_family(self._base, self.fit, s)
        base = range(len(self.fit.base))
        theta, _ = Projection(g, base).solve(at)
        left = self._left - g.explained(at, theta) + g.explained(base, g.regression(at, base) @ theta)
        past = tuple(self._rows(left))
        without = Projection(self._beside(g, *self._without), base)
        return without.chi2 - Projection(self._beside(g, past, self._times(past)), [*base, *at]).chi2

    def _beside(self, g: Gram, past: tuple[Past, ...], products: tuple[Array, ...]) -> Gram:
        """Cross-products of the base and a cause beside past errors.

        Args:
            g: of the base, with the cause's columns last.
            past: errors by row.
            products: of the base with them.
        """
        total, score, energy = g.total.copy(), g.score.sum(axis=0), float(g.energy.sum())
        (x,) = g.parts[len(self._base.parts) :]
        for (row, errors, factor), known in zip(past, products, strict=True):
            own = np.concatenate([known, self._row(x, row) @ errors.T])
            now = errors @ self._row(g.y[None], row)[0]
            taken = cho_solve(factor, own.T)
            total -= own @ taken
            score -= now @ taken
            energy -= float(now @ cho_solve(factor, now))
        return replace(g.whole(), blocks=total[None], score=score[None], energy=np.array([energy]))

    @cached_property
    def _left(self) -> Array:
        """Errors that the base leaves, shape (blocks, numbers)."""
        g = self._base
        every = range(len(g.names))
        return g.y - g.explained(every, Projection(g, every).coefficients)

    @cached_property
    def _without(self) -> tuple[tuple[Past, ...], tuple[Array, ...]]:
        """Past errors of the model without causes, and their products with the base."""
        past = tuple(self._rows(self._left))
        return past, self._times(past)

    def _rows(self, left: Array) -> Iterator[Past]:
        """Past errors of the rows that are whitened together, by row, of errors of shape (blocks, numbers)."""
        white = self.fit.noise.whitening
        for rows, taps in zip(white.groups, white.taps, strict=True):
            lags = TWICE * (len(taps) - 1)
            errors = np.concatenate([self._row(left[None], i) for i in rows])
            errors = errors[errors.any(axis=1)]
            past = np.concatenate([np.zeros((0, errors.shape[1])), *(_late(errors, lag) for lag in range(1, lags + 1))])
            for i in rows if past.size else ():
                # Past errors count where the present one does.
                here = past * (self._row(left[None], i) != 0.0)
                inner = here @ here.T
                inner += RIDGE * max(float(np.trace(inner)), 1e-300) * np.eye(len(inner))
                yield i, here, cho_factor(inner)

    def _times(self, past: tuple[Past, ...]) -> tuple[Array, ...]:
        """Products of the base's columns with the past errors, by row, each of shape (base, past errors)."""
        return tuple(
            np.concatenate([self._row(x, row) @ errors.T for x in self._base.parts]) for row, errors, _ in past
        )

    def _row(self, x: Array, row: int) -> Array:
        """One row of quantities of blocks, shape (quantities, n)."""
        rows, length = len(self.fit.noise.predictor.labels), self.fit.gram.length
        return x.reshape(len(x), -1, rows, length)[:, :, row].reshape(len(x), -1)


def _late(x: Array, lag: int) -> Array:
    """Rows that come some samples later, with zeros before."""
    out = np.zeros_like(x)
    out[:, lag:] = x[:, :-lag]
    return out
