"""Findings beside any thrust curve inside its accuracy, and whether a declared error leaves its bound.

The declared errors of a fit follow a curve between few knots. Here the curve may jump: its error is free in each of many cells of demand, for
rising and for falling demands apart, with the bound as its prior. Beside them stand errors by the inflow and by plays (``null.curve_errors``).
What is left of a score is then held against the worst of all such curves.

Let s = w'y be the score of a direction beside the base, with y = A e + n, declared errors e inside the box |e_i| <= b_i, and noise n. The
errors move s by at most W = sum_i |(A'w)_i| b_i, the support function of the box. If F is the fall of chi-squared along the direction that
was found, the noise alone has a fall of at least ((F - W) / sqrt(F))^2.

``null.boxed`` asks whether values at the knots leave their bounds. Where they do, ``null.reached`` asks what all curves inside their accuracy reach.

Source: docs/theory.md, "Any thrust curve inside its accuracy"; Rockafellar, *Convex Analysis*, 1970, section 13 (support functions).
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from copy import copy
from dataclasses import replace
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.intervals import Reach
from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.curve_errors import curve_errors, kinds
from ivsid.diagnosis.plant.declared_readings import FIXED, SCALE
from ivsid.diagnosis.plant.thrust_errors import BOUNDED

Array = NDArray[np.float64]
# Share of a bound that the prior of a declared error stands for, by the first words of its name.
_SHARES: Final = {"~rudder.": BOUNDED, **dict.fromkeys(FIXED, SCALE)}
# Correlation of two signatures from which on they are one.
# Source: geometry: directions that differ by a thousandth of their length
SAME: Final = 1.0 - 1e-6
# Least chance that has a fall of chi-squared.
# Source: definition: the smallest normal double is 2e-308
LEAST: Final = 1e-300
# Eigenvalues of the information on thrust errors below this share of the largest belong to directions that nothing determines.
# Source: geometry: seven digits above the rounding of a double
DETERMINED: Final = 1e-9
# Probability of the errors at the knots from which on all curves inside their accuracy are asked.
# Source: resource: such curves cost half a second
DOUBT: Final = 0.05


class Besides(Protocol):
    """What may be taken out of cross-products."""

    def beside(self, g: Gram) -> Gram:
        """Cross-products of what it leaves of columns and of the log."""


class AnyCurve:
    """The base of a fit, with free thrust errors of each kind beside it.

    Args:
        fit: of the log.
        over: demands of each thruster from its neutral over which the cells stand; those of the log by default.
        finer: multiple of the number of cells.

    Attributes:
        g: cross-products over the whole log, the cells last.
        projection: least squares on the base and the cells.
        box: bound of each error of the base that has one, else 0, in unit lengths, shape (base,).
    """

    def __init__(self, fit: Fit, over: Sequence[Array] | None = None, finer: int = 1) -> None:
        self.fit = fit
        found = list(curve_errors(fit, over, finer))
        # Further columns join when they are asked for: most candidates are never held against a curve.
        g = fit.bare
        first = len(g.names)
        if found:
            x, unit = g.white.blocks([answer for _, answer in found], fit.gram.good, fit.gram.length)
            g = g.joined([name for name, _ in found], x, unit)
            prior = g.prior.copy()
            prior[first:] = 1.0 / (BOUNDED * np.maximum(unit, 1e-300)) ** 2
            g = replace(g, prior=prior)
        self.g = g
        self._other: tuple[Gram, Besides] | None = None
        self.projection = Projection(g, range(len(g.names)))
        # The cells alone make any curve, so that the knots of the fit have no bound of their own here.
        self.box = np.zeros(len(self.projection.base))
        self.box[len(fit.base) :] = g.unit[first:]
        for i, k in enumerate(fit.base):
            for words, share in _SHARES.items():
                if g.names[k].startswith(words):
                    self.box[i] = 1.0 / (np.sqrt(g.prior[k]) * share)
        names = [name for name, _ in found]
        self._kinds = [
            tuple(len(fit.base) + at for at in kinds(names, t.name)) for t in fit.noise.predictor.vehicle.thrusters
        ]
        own = np.concatenate([*itertools.chain(*self._kinds), np.zeros(0, dtype=np.int64)])
        self._rest = np.setdiff1d(np.arange(self.box.size), own)

    @property
    def errors(self) -> Array:
        """Prediction errors that are left beside any curve, in their units, shape (rows, n); 0 of samples that do not count."""
        left = self.g.left(self.projection.base, self.projection.coefficients)
        out = np.zeros((len(left), self.fit.noise.good.size))
        out[:, : left.shape[1]] = self.fit.noise.whitening.undone(left)
        return out

    def under(self, other: Besides) -> AnyCurve:
        """The same beside something that all causes share, such as slow forces.

        Args:
            other: beside which it stands.
        """
        found = copy(self)
        found.g, found._other = other.beside(self.g), (self.g, other)
        found.projection = Projection(found.g, self.projection.base)
        return found

    def worst(self, moved: Array) -> Array:
        """Most that declared errors inside their bounds move some sums by, shape (...).

        A thrust error is of one kind, or a mean of several: the worst of them counts.

        Args:
            moved: of each sum by a unit of each error of the base, shape (base, ...).
        """
        by = np.abs(moved) * self.box.reshape(-1, *[1] * (moved.ndim - 1))
        total = by[self._rest].sum(axis=0)
        for each in self._kinds:
            if each:
                total = total + np.max([by[at].sum(axis=0) for at in each], axis=0)
        return np.asarray(total)

    def joined(self, names: Sequence[str], late: Collection[str] = ()) -> Gram:
        """The cross-products with further columns of the fit, by name, some of them from the middle of the log on."""
        g = self.fit.gram
        at = g.at(names)
        x = g.columns(at)
        x[[k for k, n in enumerate(names) if n in late], : len(g.blocks) // 2] = 0.0
        return self.g.joined(names, x, g.unit[at])

    def reach(self) -> dict[str, Reach]:
        """What the noise and the worst declared errors make of each number of the fit, by column, in its unit."""
        p, count = self.projection, len(self.fit.base)
        held = p.covariance[:count] * p.g.prior[p.base]
        noise = np.sqrt(
            np.maximum(np.diag(p.covariance)[:count] - np.einsum("ij,ij->i", held, p.covariance[:count]), 0.0)
        )
        worst = self.worst(held.T)
        unit = p.g.unit[:count]
        names = p.g.names[:count]
        return {n: Reach(float(s / u), float(w / u)) for n, s, w, u in zip(names, noise, worst, unit, strict=True)}

    def worst_errors(self, moved: Array) -> Array:
        """The declared errors inside their bounds that move a sum most, shape (base,).

        Args:
            moved: of the sum by a unit of each error of the base, shape (base,).
        """
        out = np.sign(moved) * self.box
        by = np.abs(moved) * self.box
        for each in self._kinds:
            worst = int(np.argmax([by[at].sum() for at in each])) if each else 0
            for at in (*each[:worst], *each[worst + 1 :]):
                out[at] = 0.0
        return np.asarray(out)

    def beside(self, s: Scored) -> tuple[Gram, list[int]]:
        """The cross-products with the columns of a family, and the indices of these."""
        if self._other is None:
            return with_family(self.g, self.fit, s)
        bare, other = self._other
        g, at = with_family(bare, self.fit, s)
        return other.beside(g), at


def with_family(g: Gram, fit: Fit, s: Scored) -> tuple[Gram, list[int]]:
    """Cross-products with the columns of a family, those of a step in time from its start on, and the indices of these.

    Args:
        g: the cross-products that they join.
        fit: in which the family was scored.
        s: the family.
    """
    x, unit = fit.gram.columns(s.columns), fit.gram.unit[list(s.columns)]
    known = None
    if not s.candidate.starts and len(g.blocks) == 1 and len(g.parts[0]) == len(fit.base):
        # The whole log holds the products of its columns with the base, which comes first.
        known = fit.gram.total[np.ix_(fit.base, s.columns)][None]
    if s.candidate.starts:
        x[:, : s.first_block(fit.gram, fit.noise.predictor.log)] = 0.0
        unit = np.sqrt(np.maximum(np.einsum("cbi,cbi->c", x, x), 1e-300))
        x = x / unit[:, None, None]
    first = len(g.names)
    wide = g.joined([f"{s.id}@{k}" for k in s.columns], x, unit, known=known)
    return wide, list(range(first, len(wide.names)))


def is_declared(fit: Fit, s: Scored) -> bool:
    """Whether a family is itself an error of the base that has a bound: its prior takes of the cause what the bound does not."""
    g = fit.gram
    bounded = [k for k in fit.base if g.names[k].startswith(tuple(_SHARES))]
    return bool(bounded) and float(np.abs(g.total[np.ix_(s.columns, bounded)]).max()) > SAME


def beyond(fall: float, worst: float) -> float:
    """Least fall of chi-squared that the noise alone has, where declared errors move the score by at most ``worst``."""
    return max(fall - worst, 0.0) ** 2 / fall if fall > 0 else 0.0


def lost(fall: float, left: float) -> float:
    """Standard deviations of a score that are lost where of a fall of chi-squared another is left."""
    return max(float(np.sqrt(max(fall, 0.0)) - np.sqrt(left)), 0.0)
