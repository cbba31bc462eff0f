"""Least squares on cross-products, with soft priors, and the fall of chi-squared that further columns bring."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import brentq

from ivsid.diagnosis.estimation.cross_products import Gram

Array = NDArray[np.float64]
# A column whose part outside the base is less than this share of its squared length is explained by the base.
# Source: geometry: above the rounding of cross-products, 1e-16 times their number
NOTHING_LEFT: Final = 1e-10
# Least eigenvalue of the correlation matrix of further columns along which coefficients are solved for.
# Source: geometry: half the digits of a double
LEAST_EIGENVALUE: Final = 1e-8
# Logarithm of the range of pulls on coefficients, over the largest eigenvalue.
# Source: resource: beyond all numbers that a double tells from none or from all
PULLS: Final = 60.0


def largest_fall(g: Gram, base: Sequence[int], x: Array) -> float:
    """Largest fall of chi-squared by one of several further columns whose number is positive; 0 if none has such a number.

    Args:
        g: cross-products.
        base: indices of the columns that are fitted.
        x: the further columns, whitened, shape (columns, blocks, numbers).
    """
    if not len(x):
        return 0.0
    wide = g.joined([f"{k}" for k in range(len(x))], x, np.ones(len(x)))
    p, first = Projection(wide, base), len(g.names)
    return max(fall if theta[0] > 0.0 else 0.0 for theta, fall in (p.solve([first + k]) for k in range(len(x))))


def least_length(theta: Array, information: Array, errors: float) -> float:
    """Least length of coefficients within some standard errors of the fitted ones, over that of these.

    Where a log hardly shows one direction of a force, as sideways on a line, its size there is mostly error.

    Args:
        theta: fitted coefficients of one unit, shape (n,), farther from zero than that.
        information: on them, shape (n, n).
        errors: standard errors.
    """
    values, vectors = np.linalg.eigh(information)
    values, along = np.maximum(values, 0.0), vectors.T @ theta

    def pulled(force: float) -> Array:
        return np.asarray(values / (values + np.exp(force)))

    # The shortest lies where a pull to zero leaves this distance.
    ends = np.log(float(values.max())) + np.array([-PULLS, PULLS])
    force = brentq(lambda f: float(np.sum(values * (along * (1.0 - pulled(f))) ** 2)) - errors**2, *ends)
    return float(np.linalg.norm(along * pulled(force)) / np.linalg.norm(along))


class Projection:
    """Least squares on a base of columns, and the fall of chi-squared that further columns bring.

    Attributes:
        g: the cross-products.
        base: indices of the columns that are fitted.
        total: cross-products over the whole log, shape (columns, columns).
        normal: the normal matrix of the base, priors included, shape (base, base).
        coefficients: of the base, in unit lengths of the columns, shape (base,).
        chi2: that the fit leaves, deviations of declared errors from their priors included.
        left_score: every column times the errors that the fit leaves, shape (columns,).
    """

    def __init__(self, g: Gram, base: Sequence[int]) -> None:
        self.g, self.base = g, list(base)
        self.total, self.normal = g.total, g.normal(self.base)
        self.score = g.score.sum(axis=0) - g.prior * g.centre
        self.energy = float(g.energy.sum()) + float(g.prior @ g.centre**2)
        self._factor = cho_factor(self.normal)
        self.coefficients: Array = cho_solve(self._factor, self.score[self.base])
        # Cross-products of the residualised columns follow from this.
        self._solved: Array = cho_solve(self._factor, self.total[self.base])
        self.left_score = self.score - self.total[:, self.base] @ self.coefficients
        self.chi2 = self.energy - float(self.score[self.base] @ self.coefficients)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the coefficients of the base by the noise model, shape (base, base)."""
        return np.asarray(np.linalg.inv(self.normal), dtype=np.float64)

    def left(self, i: Sequence[int], j: Sequence[int]) -> Array:
        """Cross-products of the residualised columns."""
        return np.asarray(self.total[np.ix_(i, j)] - self.total[np.ix_(i, self.base)] @ self._solved[:, j])

    def information(self, columns: Sequence[int]) -> Array:
        """Information on the coefficients of further columns with the base free, their own priors included, shape (columns, columns)."""
        return self.left(columns, columns) + np.diag(self.g.prior[list(columns)])

    def held_back(self, columns: Sequence[int]) -> Array:
        """What priors leave of further columns in those of the base: their cross-products beside the fit, shape (base, columns).

        A deviation of one unit of a base's column moves the score of a further column by this number; without priors nothing is left.
        """
        # left = r - (N - P) N^-1 r = P N^-1 r, of the normal matrix N with the priors P.
        return np.asarray(self.g.prior[self.base][:, None] * self._solved[:, list(columns)])

    def taken(self, base: Sequence[int], columns: Sequence[int]) -> Array:
        """Coefficients of further columns in some of the base, in the columns' own units, shape (some, columns)."""
        rows = [self.base.index(k) for k in base]
        return np.asarray(self._solved[np.ix_(rows, columns)] * self.g.unit[columns] / self.g.unit[base][:, None])

    def solve(self, columns: Sequence[int]) -> tuple[Array, float]:
        """Coefficients of further columns, in their unit lengths, and the fall of chi-squared that they bring beside the base."""
        columns = list(columns)
        if len(columns) == 1:
            return self._single(columns[0])
        H = self.information(columns)
        own = np.diag(self.total)[columns]
        keep = np.diag(H) > NOTHING_LEFT * np.maximum(own, 1e-300)
        theta = np.zeros(len(columns))
        if not keep.any():
            return theta, 0.0
        at = np.flatnonzero(keep)
        s = self.left_score[np.array(columns)[at]]
        d = np.sqrt(np.diag(H)[at])
        values, vectors = np.linalg.eigh(H[np.ix_(at, at)] / np.outer(d, d))
        good = values > LEAST_EIGENVALUE
        w = (vectors[:, good] / values[good]) @ (vectors[:, good].T @ (s / d))
        theta[at] = w / d
        return theta, float(s @ theta[at])

    def _single(self, column: int) -> tuple[Array, float]:
        """The same of one column, to the bit."""
        own = self.total[column, column]
        solved = np.ascontiguousarray(self._solved[:, column])
        H = float(own - self.total[column, self.base] @ solved + self.g.prior[column])
        theta = np.zeros(1)
        if not NOTHING_LEFT * max(float(own), 1e-300) < H:
            return theta, 0.0
        s, d = float(self.left_score[column]), float(np.sqrt(H))
        theta[0] = 1.0 / (H / (d * d)) * (s / d) / d
        return theta, s * float(theta[0])
