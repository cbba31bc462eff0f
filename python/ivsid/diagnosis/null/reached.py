"""What curves inside their accuracy can reach of the thrust errors at the knots, and whether a log asks for more.

Free errors at the knots are estimated from a log. A curve that is a constant share e_i of its bound in each of many cells of demand, |e_i| <= 1,
moves these estimates by linear functions of e, so that what it can reach is a zonotope. The distance of the estimates from it, in their own
noise, is at most that from the true e: chi-squared with as many degrees of freedom as there are knots.

Source: docs/theory.md, "Errors that leave their bound"; Ziegler, *Lectures on Polytopes*, 1995, section 7.3 (zonotopes).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear
from scipy.special import chdtrc, chdtri

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import DETERMINED, LEAST, AnyCurve
from ivsid.diagnosis.null.beside import Beside
from ivsid.diagnosis.null.curve_errors import BEYOND_DEMAND
from ivsid.diagnosis.null.frequencies import Spectrum, excess

Array = NDArray[np.float64]


class Reached:
    """Distance of a log from all curves inside their accuracy.

    Args:
        free: the fit's base with free errors beside it.
        other: beside which the distance stands, too, or None.
        noise: spectrum that scatters the estimates beyond what white noise does, or None; of curves alone.

    Attributes:
        leaving: squared distance from them, in standard deviations.
        knots: its degrees of freedom at most; 0 if no accuracy is declared.
        other: beside which it stands, with those errors.
    """

    def __init__(self, free: AnyCurve, other: Beside | None = None, noise: Spectrum | None = None) -> None:
        names = free.g.names
        self.free, self.noise = free, noise
        self.at = [k for k, n in enumerate(names) if n.startswith(("~thrust.", "~hysteresis."))]
        self.cells = [k for k, n in enumerate(names) if n.startswith("~cell.")]
        # Free errors by inflow or play would take what errors by demand may not.
        beyond = [k for k, n in enumerate(names) if n.startswith(BEYOND_DEMAND)]
        self.others = [k for k in range(len(names)) if k not in {*self.at, *self.cells, *beyond}]
        self.leaving, self.knots, self.other = 0.0, 0, other
        # A screening asks for a cause beside the accuracy, and again for what declared errors make of its score.
        self._known: dict[tuple[tuple[int, ...], int], float] = {}
        if self.at and self.cells:
            g = free.g if other is None else other.beside(free.g)
            self.leaving, self.knots, errors = self._distance(g, self.at, self.others)
            if other is not None:
                # What these errors leave of the log is more than free ones do.
                known = np.zeros(len(names))
                known[self.at], known[self.cells] = -g.centre[self.at], g.unit[self.cells] * errors
                self.other = other.under(free.g, self.others, known)
                if self.other is not other:
                    self.leaving, self.knots, _ = self._distance(self.other.beside(free.g), self.at, self.others)

    def _distance(self, g: Gram, data: Sequence[int], others: Sequence[int]) -> tuple[float, int, Array]:
        """Least squared distance, over the curves, of the scores of some columns beside others, its degrees of freedom, and the errors of cells at it."""
        total, score = g.total, g.score.sum(axis=0)
        known = np.isin(np.arange(len(g.names)), self.at)
        # Errors of the log without the part that the hypothesis holds: the bounds are those of the whole errors.
        score = score + total[:, self.at] @ g.centre[self.at] - np.where(known, 0.0, g.prior * g.centre)
        cross = g.regression([*data, *self.cells], others)
        left = total[np.ix_(data, [*data, *self.cells])] - total[np.ix_(data, others)] @ cross
        S, C = left[:, : len(data)], left[:, len(data) :] * g.unit[self.cells]
        r = score[list(data)] - cross[:, : len(data)].T @ score[list(others)]
        values, vectors = np.linalg.eigh(0.5 * (S + S.T))
        kept = values > DETERMINED * max(float(values.max()), 1e-300)
        root = vectors[:, kept] / np.sqrt(values[kept])
        if self.noise is not None:
            more = excess(self.free.fit, Projection(g, others), data, self.noise).more
            scatter = np.linalg.cholesky(np.eye(root.shape[1]) + root.T @ more @ root)
            root = solve_triangular(scatter, root.T, lower=True).T
        solved = lsq_linear(root.T @ C, root.T @ r, bounds=(-1.0, 1.0))
        return 2.0 * float(solved.cost), int(kept.sum()), np.asarray(solved.x)

    def of(self, s: Scored) -> float:
        """Fall of chi-squared of a family by its own numbers alone that is as rare as what it takes off the distance.

        Zero for a step in time, whose column is a sum over later blocks.
        """
        if s.candidate.starts or not self.knots:
            return 0.0
        asked = tuple(s.columns), s.count
        if asked not in self._known:
            self._known[asked] = self._of(s)
        return self._known[asked]

    def _of(self, s: Scored) -> float:
        own = self.free.fit.gram.names
        g = self.free.joined([own[k] for k in s.columns])
        first = len(self.free.g.names)
        columns = list(range(first, len(g.names)))
        without, freedom, _ = self._distance(g, [*self.at, *columns], self.others)
        held, _, _ = self._distance(g, self.at, [*self.others, *columns])
        return float(chdtri(s.count, max(chdtrc(freedom, max(without - held, 0.0)), LEAST)))
