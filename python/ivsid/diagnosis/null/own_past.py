"""Falls of chi-squared beside the log's own past errors.

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
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.beside import Beside

Array = NDArray[np.float64]
# Past errors beside which a cause has to stand, in samples: twice as many as the longest whitening has.
# Source: measured: a false delay in a swell kept a fall of 29 of 45 beside 6 of them and 6 beside 24, a false drag under an autopilot in a swell 58 of 86
# beside 6 and none beside 24; true causes keep theirs
LAGS: Final = 24
# A fall of chi-squared from here on is no colour of the noise, and is not asked beside past errors.
# Source: resource: products of all columns with past errors take a fifth of a second a round; false causes of a colour had falls up to 107
FORETOLD: Final = 1000.0
# Ridge of the products of past errors, as a share of their mean square.
# Source: geometry: ten thousand times the rounding of a double; rows without noise foretell each other
RIDGE: Final = 1e-12
# Past errors beside a row: its index, they, and the factor of their products.
Past: TypeAlias = "tuple[int, Array, tuple[Array, bool]]"


class OwnPast(Beside):
    """The base of a fit beside the log's own past errors."""

    def beside(self, g: Gram) -> Gram:
        """Cross-products over the whole log, of what the past errors leave of columns and of the log.

        Args:
            g: cross-products whose first columns are those of the base.
        """
        total, score = g.total.copy(), g.score.sum(axis=0)
        further = g.parts[len(self.fit.bare.parts) :]
        first = len(self.fit.bare.names)
        for (row, errors, factor), (known, held, taken) in zip(self._past, self._products, strict=True):
            own = np.concatenate([np.zeros((0, len(errors))), *(self._row(x, row) @ errors.T for x in further)])
            cross = own @ held
            total[:first, :first] -= taken
            total[first:, :first] -= cross
            total[:first, first:] -= cross.T
            total[first:, first:] -= own @ cho_solve(factor, own.T)
            score -= np.concatenate([known, own]) @ cho_solve(factor, errors @ self._row(g.y[None], row)[0])
        return replace(g.whole(), blocks=total[None], score=score[None])

    @cached_property
    def _past(self) -> tuple[Past, ...]:
        """Past errors of the rows that are whitened together, by row."""
        return tuple(self._rows())

    def _rows(self) -> Iterator[Past]:
        g, white = self.fit.bare, self.fit.noise.whitening
        every = range(len(g.names))
        left = (g.y - g.explained(every, Projection(g, every).coefficients))[None]
        for group, taps in zip(white.groups, white.taps, strict=True):
            # Rows of which means count alone hold each mean many times, and rows that do not count have no coefficients of the past.
            rows = [i for i in group if i not in white.slow and len(taps) > 1]
            if not rows:
                continue
            errors = np.concatenate([self._row(left, i) for i in rows])
            past = self._before(errors)
            for i, now in zip(rows, errors, strict=True):
                # Past errors count where the present one does.
                here = past * (now != 0.0)
                inner = here @ here.T
                inner += RIDGE * max(float(np.trace(inner)), 1e-300) * np.eye(len(inner))
                yield i, here, cho_factor(inner)

    def _before(self, errors: Array) -> Array:
        """What foretells errors of their past, shape (quantities, n)."""
        return np.concatenate([late(errors, lag) for lag in range(1, LAGS + 1)])

    @cached_property
    def _products(self) -> tuple[tuple[Array, Array, Array], ...]:
        """Products of the base's columns with the past errors, by row, their coefficients in these, and what these take of the base."""
        found = []
        for row, errors, factor in self._past:
            known = np.concatenate([self._row(x, row) @ errors.T for x in self.fit.bare.parts])
            held = cho_solve(factor, known.T)
            found.append((known, held, known @ held))
        return tuple(found)

    def _row(self, x: Array, row: int) -> Array:
        """One row of quantities of blocks, shape (quantities, n)."""
        rows, length = len(self.fit.noise.predictor.labels), self.fit.gram.length
        return x.reshape(len(x), -1, rows, length)[:, :, row].reshape(len(x), -1)


def late(x: Array, lag: int) -> Array:
    """Rows that come some samples later, with zeros before."""
    out = np.zeros_like(x)
    out[:, lag:] = x[:, :-lag]
    return out
